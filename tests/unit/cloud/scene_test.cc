#include "boxgrasp/cloud/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numeric>
#include <random>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/cloud/clean.h"
#include "boxgrasp/cloud/clusters.h"
#include "boxgrasp/cloud/read_cloud.h"
#include "boxgrasp/geometry/voxels.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

// A cloud whose points know what they belong to: 0 the table, 1.. the objects, -1 anything else.
struct Labelled {
  PointCloud cloud;
  std::vector<int> labels;

  void push(const Vector3d& p, int label) {
    cloud.push(p);
    labels.push_back(label);
  }
};

// A rectangle with one corner and two edges, a point every 3 mm, with noise along its normal.
void addRectangle(Labelled& scene, int label, const Vector3d& corner, const Vector3d& u, const Vector3d& v,
                  std::mt19937_64& random, double noise_m = 0.0005) {
  const Vector3d across = u.cross(v).normalized();
  const int m = static_cast<int>(u.norm() / 0.003), n = static_cast<int>(v.norm() / 0.003);
  for (int i = 0; i <= m; ++i) {
    for (int j = 0; j <= n; ++j) {
      scene.push(corner + u * i / m + v * j / n + noise_m * normal(random) * across, label);
    }
  }
}

// All faces of a box but its bottom.
void addBox(Labelled& scene, int label, const Vector3d& corner, const Vector3d& size,
            std::mt19937_64& random) {
  const Vector3d x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  addRectangle(scene, label, corner + z, x, y, random);
  addRectangle(scene, label, corner, x, z, random);
  addRectangle(scene, label, corner, y, z, random);
  addRectangle(scene, label, corner + x, y, z, random);
  addRectangle(scene, label, corner + y, x, z, random);
}

// A table of 0.8 m x 0.6 m at height 0 with three boxes on it.
Labelled tableWithBoxes(std::mt19937_64& random) {
  Labelled scene;
  addRectangle(scene, 0, {-0.4, -0.3, 0}, {0.8, 0, 0}, {0, 0.6, 0}, random);
  addBox(scene, 1, {-0.25, -0.1, 0.004}, {0.12, 0.10, 0.15}, random);
  addBox(scene, 2, {0.0, -0.1, 0.004}, {0.08, 0.08, 0.08}, random);
  addBox(scene, 3, {0.15, 0.05, 0.004}, {0.10, 0.05, 0.04}, random);
  return scene;
}

std::map<int, double> bestOverlaps(const Scene& scene, const std::vector<int>& labels) {
  std::map<int, std::size_t> sizes;
  std::map<int, double> best;
  for (const int label : labels) ++sizes[label];
  for (const auto& object : scene.objects) {
    std::map<int, std::size_t> shared;
    for (const std::uint32_t i : object) ++shared[labels[i]];
    for (const auto& [label, n] : shared) {
      const double overlap = static_cast<double>(n) / static_cast<double>(sizes[label] + object.size() - n);
      best[label] = std::max(best[label], overlap);
    }
  }
  return best;
}

void expectEveryPointCountedOnce(const Scene& scene, std::size_t points) {
  std::size_t sum = scene.table_points + scene.background_points + scene.small_cluster_points;
  std::vector<int> owners(points);
  for (const auto& object : scene.objects) {
    EXPECT_TRUE(std::ranges::is_sorted(object));
    for (const std::uint32_t i : object) ++owners.at(i);
    sum += object.size();
  }
  EXPECT_EQ(sum, points);
  EXPECT_LE(*std::ranges::max_element(owners), 1) << "a point in two objects";
  EXPECT_TRUE(
      std::ranges::is_sorted(scene.objects, std::ranges::greater{}, &std::vector<std::uint32_t>::size));
}

TEST(TakeApart, FindsTheTableAndEveryBoxInAnyPose) {
  std::mt19937_64 random(1);
  const Labelled made = tableWithBoxes(random);
  for (int round = 0; round < 8; ++round) {
    const Pose X_CW = test::randomPose(random);
    const bool seen = round % 2 == 0;  // with and without a known viewpoint
    const Scene scene =
        takeApart(transformed(made.cloud, X_CW), {}, {},
                  seen ? std::optional<Vector3d>(X_CW * Vector3d(0.5, 0.5, 1)) : std::nullopt);
    ASSERT_TRUE(scene.table) << "round " << round;
    EXPECT_FALSE(scene.isolated);
    EXPECT_GT(scene.table->normal_C.dot(X_CW.linear().col(2)), 0.9999) << "round " << round;
    EXPECT_NEAR(scene.table->normal_C.dot(X_CW.translation()), scene.table->offset_m, 0.001);
    ASSERT_EQ(scene.objects.size(), 3u) << "round " << round;
    const auto overlaps = bestOverlaps(scene, made.labels);
    for (const int label : {1, 2, 3})
      EXPECT_GT(overlaps.at(label), 0.95) << "box " << label << ", round " << round;
    expectEveryPointCountedOnce(scene, made.cloud.size());
  }
}

TEST(TakeApart, IsTheSameOnAnyNumberOfThreads) {
  std::mt19937_64 random(12);
  const Labelled made = tableWithBoxes(random);
  SceneOptions on_three;
  on_three.threads = 3;
  const Scene one = takeApart(made.cloud), three = takeApart(made.cloud, on_three);
  ASSERT_TRUE(one.table && three.table);
  EXPECT_EQ(one.table->normal_C, three.table->normal_C);
  EXPECT_EQ(one.table->offset_m, three.table->offset_m);
  EXPECT_EQ(one.objects, three.objects);
}

TEST(TakeApart, TheOrderOfThePointsDoesNotMatter) {
  std::mt19937_64 random(2);
  const Labelled made = tableWithBoxes(random);
  std::vector<std::uint32_t> order(made.cloud.size());
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[uniformIndex(random, i)]);
  const Scene scene = takeApart(made.cloud), other = takeApart(select(made.cloud, order));
  EXPECT_EQ(scene.table->normal_C, other.table->normal_C);
  ASSERT_EQ(scene.objects.size(), other.objects.size());
  for (std::size_t k = 0; k < scene.objects.size(); ++k) {
    std::vector<std::uint32_t> same;
    for (const std::uint32_t i : other.objects[k]) same.push_back(order[i]);
    std::sort(same.begin(), same.end());
    EXPECT_EQ(same, scene.objects[k]) << "object " << k;
  }
}

// A table that is told needs no points, and objects on it are as on one that is seen; what lies under it is
// not.
TEST(TakeApart, ATableThatIsToldIsNotLookedFor) {
  std::mt19937_64 random(12);
  Labelled made;
  addBox(made, 1, {-0.25, -0.1, 0.004}, {0.12, 0.10, 0.15}, random);
  addBox(made, 2, {0.1, -0.1, 0.004}, {0.08, 0.08, 0.08}, random);
  addBox(made, -1, {-0.1, -0.1, -0.5}, {0.2, 0.2, 0.2}, random);
  const Plane table{Vector3d::UnitZ(), 0.0};
  const Scene scene = takeApart(made.cloud, {}, {}, std::nullopt, table);
  ASSERT_TRUE(scene.table);
  ASSERT_EQ(scene.objects.size(), 2u);
  for (std::size_t object = 0; object < 2; ++object) {
    for (const std::uint32_t i : scene.objects[object])
      EXPECT_EQ(made.labels[i], static_cast<int>(object) + 1);
  }
  SceneOptions whole;
  whole.whole = true;
  const Scene left_whole = takeApart(made.cloud, whole, {}, std::nullopt, table);
  EXPECT_TRUE(left_whole.isolated);
  EXPECT_TRUE(left_whole.table) << "the hand must not meet it";
}

TEST(TakeApart, AWallLargerThanTheTableIsNoTable) {
  std::mt19937_64 random(3);
  Labelled made = tableWithBoxes(random);
  addRectangle(made, -1, {-1.0, 0.6, -0.8}, {2.0, 0, 0}, {0, 0, 1.6}, random);
  const Scene scene = takeApart(made.cloud);
  ASSERT_TRUE(scene.table);
  EXPECT_GT(scene.table->normal_C.z(), 0.999);
  EXPECT_EQ(scene.objects.size(), 3u);
  EXPECT_GT(scene.background_points, 300'000u);
}

TEST(TakeApart, SmallAndHugeClustersAreCountedAside) {
  std::mt19937_64 random(4);
  Labelled made = tableWithBoxes(random);
  const std::size_t before = takeApart(made.cloud).small_cluster_points;
  for (int i = 0; i < 50; ++i) made.push({0.3 + 0.0001 * i, -0.2, 0.1}, -1);
  addRectangle(made, -1, {-0.39, 0.2, 0.05}, {0.78, 0, 0}, {0, 0, 0.3}, random);
  const Scene scene = takeApart(made.cloud);
  EXPECT_EQ(scene.objects.size(), 3u);
  EXPECT_EQ(scene.small_cluster_points, before + 50);
  EXPECT_GT(scene.background_points, 20'000u);
  expectEveryPointCountedOnce(scene, made.cloud.size());
}

TEST(TakeApart, ABareTableHasNoObjects) {
  std::mt19937_64 random(5);
  Labelled made;
  addRectangle(made, 0, {-0.4, -0.3, 0}, {0.8, 0, 0}, {0, 0.6, 0}, random);
  const Scene scene = takeApart(made.cloud);
  EXPECT_TRUE(scene.table);
  EXPECT_TRUE(scene.objects.empty());
}

// Boxes from a matchbox to a moving box, closed and seen from one corner: their own faces are no tables.
TEST(TakeApart, AnIsolatedBoxIsLeftWhole) {
  std::mt19937_64 random(6);
  for (const Vector3d& size : {Vector3d(0.05, 0.03, 0.015), Vector3d(0.16, 0.21, 0.07),
                               Vector3d(0.4, 0.4, 0.4), Vector3d(0.5, 0.4, 0.1), Vector3d(0.35, 0.35, 0.2)}) {
    Labelled closed, corner;
    addBox(closed, 1, {0, 0, 0}, size, random);
    addRectangle(closed, 1, {0, 0, 0}, {size.x(), 0, 0}, {0, size.y(), 0}, random);
    addRectangle(corner, 1, {0, 0, size.z()}, {size.x(), 0, 0}, {0, size.y(), 0}, random);
    addRectangle(corner, 1, {0, 0, 0}, {size.x(), 0, 0}, {0, 0, size.z()}, random);
    addRectangle(corner, 1, {0, 0, 0}, {0, size.y(), 0}, {0, 0, size.z()}, random);
    for (const Labelled* made : {&closed, &corner}) {
      for (const auto& viewpoint : {std::optional<Vector3d>(), std::optional<Vector3d>({-1, -1, 1})}) {
        const Scene scene = takeApart(made->cloud, {}, {}, viewpoint);
        EXPECT_FALSE(scene.table) << "a box of " << size.transpose()
                                  << (made == &corner ? " seen from a corner" : "");
        ASSERT_TRUE(scene.isolated) << "a box of " << size.transpose();
        ASSERT_EQ(scene.objects.size(), 1u);
        EXPECT_EQ(scene.objects[0].size(), made->cloud.size());
      }
    }
  }
}

TEST(TakeApart, ASparseOrTinyCloudIsLeftWhole) {
  std::mt19937_64 random(7);
  for (const int n : {1, 2, 3, 10, 100, 1000}) {
    PointCloud cloud;
    for (int i = 0; i < n; ++i) cloud.push(0.2 * Vector3d(normal(random), normal(random), normal(random)));
    const Scene scene = takeApart(cloud);
    EXPECT_TRUE(scene.isolated) << n << " points";
    EXPECT_EQ(scene.objects.at(0).size(), static_cast<std::size_t>(n));
  }
}

TEST(TakeApart, TheOptionWholeLeavesATableWhole) {
  std::mt19937_64 random(8);
  SceneOptions options;
  options.whole = true;
  const Labelled made = tableWithBoxes(random);
  const Scene scene = takeApart(made.cloud, options);
  EXPECT_TRUE(scene.isolated);
  EXPECT_EQ(scene.objects.at(0).size(), made.cloud.size());
}

TEST(TakeApart, TwoClustersWithoutATableAreTwoObjects) {
  std::mt19937_64 random(9);
  Labelled made;
  addBox(made, 1, {0, 0, 0}, {0.1, 0.1, 0.1}, random);
  addBox(made, 2, {0.2, 0, 0}, {0.05, 0.1, 0.1}, random);
  const Scene scene = takeApart(made.cloud);
  EXPECT_FALSE(scene.table);
  EXPECT_FALSE(scene.isolated);
  ASSERT_EQ(scene.objects.size(), 2u);
  const auto overlaps = bestOverlaps(scene, made.labels);
  EXPECT_EQ(overlaps.at(1), 1.0);
  EXPECT_EQ(overlaps.at(2), 1.0);
  expectEveryPointCountedOnce(scene, made.cloud.size());
}

TEST(TakeApart, AnExpiredDeadlineStops) {
  std::mt19937_64 random(10);
  EXPECT_THROW(takeApart(tableWithBoxes(random).cloud, {}, StopToken(StopToken::Clock::now())), Stopped);
}

TEST(SceneOptions, BadValuesAreNamed) {
  SceneOptions options;
  options.cluster_distance_m = 0.0;
  EXPECT_THROW(options.validate(), InputError);
  options = {};
  options.min_plane_fraction = 2.0;
  EXPECT_THROW(options.validate(), InputError);
}

// What lets a cloud be left whole without a look for clusters.
TEST(EuclideanClusters, OfMeansOfVoxelsThatHangTogetherAreOne) {
  std::mt19937_64 random(5);
  int together = 0;
  for (int round = 0; round < 200; ++round) {
    PointCloud cloud;
    const int points = 10 + static_cast<int>(uniformIndex(random, 60));
    for (int i = 0; i < points; ++i)
      cloud.push(Vector3d(uniform(random, 0, 6), uniform(random, 0, 6), uniform(random, 0, 2)));
    const double distance_m = 4.0;
    if (!voxelsHangTogether(cloud, distance_m / 4.0)) continue;
    const PointCloud means = meansOf(cloud, sortIntoVoxels(cloud, distance_m / 4.0));
    EXPECT_EQ(euclideanClusters(means, distance_m, StopToken()).size(), 1u) << "cloud " << round;
    ++together;
  }
  EXPECT_GT(together, 20) << "the clouds should hang together now and then";
}

TEST(EuclideanClusters, AgreeWithBruteForce) {
  std::mt19937_64 random(11);
  for (const double distance_m : {0.02, 0.06, 0.1, 0.5}) {
    PointCloud cloud;
    for (int i = 0; i < 300; ++i) cloud.push({uniform(random), uniform(random), 0.2 * uniform(random)});
    std::vector<int> label(cloud.size(), -1);
    int count = 0;
    for (std::size_t start = 0; start < cloud.size(); ++start) {  // flood fill
      if (label[start] >= 0) continue;
      std::vector<std::size_t> open{start};
      label[start] = count;
      while (!open.empty()) {
        const std::size_t i = open.back();
        open.pop_back();
        for (std::size_t j = 0; j < cloud.size(); ++j) {
          if (label[j] >= 0 || (cloud.point(i) - cloud.point(j)).norm() > distance_m) continue;
          label[j] = count;
          open.push_back(j);
        }
      }
      ++count;
    }
    const auto clusters = euclideanClusters(cloud, distance_m, {});
    EXPECT_EQ(clusters.size(), static_cast<std::size_t>(count)) << "distance " << distance_m;
    for (const auto& cluster : clusters) {
      for (const std::uint32_t i : cluster) EXPECT_EQ(label[i], label[cluster[0]]);
    }
  }
}

// ---- Kinect scenes with ground truth

std::filesystem::path scenesFolder() {
  return std::filesystem::path(BOXGRASP_SOURCE_DIR) / "../shared/data/scenes";
}

struct View {
  FiniteCloud finite;
  LoadedCloud loaded;
  Scene scene;
};

View take(const std::string& name) {
  View view;
  view.loaded = readCloud(scenesFolder() / name);
  view.finite = validated(view.loaded.cloud_C);
  view.scene = takeApart(view.finite.cloud_C, {}, {}, view.loaded.viewpoint_C);
  expectEveryPointCountedOnce(view.scene, view.finite.cloud_C.size());
  return view;
}

// Ground truth: 1 is the table; 20, 30, ... are objects, whose parts have numbers such as 40 and 41.
std::vector<int> objectLabels(const View& view) {
  std::vector<int> labels;
  for (std::size_t i = 0; i < view.loaded.labels.size(); ++i) {
    if (view.loaded.cloud_C.point(i).allFinite())
      labels.push_back(static_cast<int>(view.loaded.labels[i] / 10));
  }
  return labels;
}

TEST(TakeApart, FindsTheObjectsOfKinectScenes) {
  if (!std::filesystem::exists(scenesFolder())) GTEST_SKIP() << "no scenes in " << scenesFolder();
  double sum = 0.0;
  int objects = 0, found = 0;
  for (const char* name : {"mosd_learn0", "mosd_learn17", "mosd_learn25", "mosd_learn33", "mosd_learn40"}) {
    const View view = take(std::string(name) + ".pcd");
    ASSERT_TRUE(view.scene.table) << name;
    const std::vector<int> labels = objectLabels(view);
    auto overlaps = bestOverlaps(view.scene, labels);
    for (int label = 2; label <= *std::ranges::max_element(labels); ++label) {
      ++objects;
      sum += overlaps[label];
      found += overlaps[label] > 0.5;
    }
  }
  EXPECT_EQ(objects, 14);
  EXPECT_GE(found, 12) << "objects with an overlap (intersection over union) above one half";
  EXPECT_GE(sum / objects, 0.8) << "mean overlap";
}

TEST(TakeApart, FindsTheMugAndLeavesTheSprayCanWhole) {
  if (!std::filesystem::exists(scenesFolder())) GTEST_SKIP() << "no scenes in " << scenesFolder();
  const View mug = take("table_mug.pcd");
  EXPECT_TRUE(mug.scene.table);
  ASSERT_EQ(mug.scene.objects.size(), 1u);
  const Vector3d size = bounds(select(mug.finite.cloud_C, mug.scene.objects[0])).sizes();
  EXPECT_GT(size.minCoeff(), 0.06);
  EXPECT_LT(size.maxCoeff(), 0.16);
  EXPECT_TRUE(take("krylon.pcd").scene.isolated);
}

}  // namespace
}  // namespace boxgrasp
