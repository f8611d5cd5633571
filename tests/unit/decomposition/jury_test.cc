#include "boxgrasp/decomposition/jury.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "boxgrasp/decomposition/even_surface.h"
#include "boxgrasp/decomposition/similarity.h"
#include "boxgrasp/geometry/min_volume_box.h"
#include "boxgrasp/geometry/polygon.h"
#include "shapes.h"

namespace boxgrasp {
namespace {

DecompositionOptions robustOptions(int jurors = 3) {
  DecompositionOptions options;
  options.split = SplitRule::robust;
  options.jurors = jurors;
  return options;
}

PointCloud noisy(PointCloud cloud, double deviation_m, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  for (auto* axis : {&cloud.x, &cloud.y, &cloud.z}) {
    for (float& value : *axis) value += static_cast<float>(deviation_m * normal(random));
  }
  return cloud;
}

// --- the even surface

TEST(TrimmedSize, LeavesOutliersOut) {
  PointCloud cloud = test::brick(2000);
  const double clean = trimmedSize(cloud, Matrix3d::Identity());
  EXPECT_NEAR(clean, 0.12, 0.01);
  for (int i = 0; i < 20; ++i) cloud.push({5.0 + i, 0, 0});
  EXPECT_NEAR(trimmedSize(cloud, Matrix3d::Identity()), clean, 0.003);
}

TEST(EvenSurface, TakesNoiseOffASphere) {
  const double radius = 0.05, resolution = 0.004;
  const auto spread = [&](const PointCloud& cloud) {
    double sum = 0.0, squared = 0.0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const double r = cloud.point(i).norm();
      sum += r;
      squared += r * r;
    }
    const double mean = sum / static_cast<double>(cloud.size());
    return std::sqrt(std::max(0.0, squared / static_cast<double>(cloud.size()) - mean * mean));
  };
  const PointCloud cloud = noisy(test::sphere(20'000, radius), 0.002, 4);
  const PointCloud surface = evenSurface(cloud, resolution, Matrix3d::Identity(), {});
  EXPECT_NEAR(spread(cloud), 0.002, 2e-4);
  EXPECT_LT(spread(surface), 0.0005) << "the smoothed surface is a thin shell";
}

// A half that was seen four times as densely counts no more.
TEST(EvenSurface, CountsAreaNotPoints) {
  PointCloud cloud;
  std::mt19937_64 random(3);
  for (int i = 0; i < 10'000; ++i) {
    const bool dense = i % 5 != 0;
    const double x = uniform(random) * (dense ? -0.1 : 0.1), y = 0.1 * uniform(random);
    cloud.push({x, y, 0});
  }
  const PointCloud even = evenSurface(cloud, 0.005, Matrix3d::Identity(), {});
  const auto left = std::count_if(even.x.begin(), even.x.end(), [](float x) { return x < 0; });
  EXPECT_NEAR(static_cast<double>(left) / static_cast<double>(even.size()), 0.5, 0.06);
}

TEST(EvenSurface, LeavesStraysOut) {
  PointCloud cloud = test::sphere(5000);
  cloud.push({0.3, 0.3, 0.3});
  cloud.push({-0.4, 0, 0});
  const PointCloud surface = evenSurface(cloud, 0.004, Matrix3d::Identity(), {});
  for (std::size_t i = 0; i < surface.size(); ++i) EXPECT_LT(surface.point(i).norm(), 0.06);
}

// --- cuts

// Theta of Eq. 1 for a cut on its face, written down anew.
double thetaOf(const PointCloud& cloud, const OrientedBox& box, const PlateauCut& cut) {
  const Vector3d x_C = cut.normal_C, y_C = cut.along_C.cross(cut.normal_C);
  std::vector<Vector2d> first, second;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3d p = cloud.point(i);
    (x_C.dot(p) <= cut.offset_m ? first : second).emplace_back(x_C.dot(p), y_C.dot(p));
  }
  int axis = -1;
  (box.X_CB.linear().transpose() * cut.along_C).cwiseAbs().maxCoeff(&axis);
  const double area = box.extents[(axis + 1) % 3] * box.extents[(axis + 2) % 3];
  return (signedArea(convexHull(first)) + signedArea(convexHull(second))) / area;
}

TEST(PlateauCuts, AreOnTheirPlateau) {
  for (const auto& [name, cloud] : test::allShapes(900)) {
    SCOPED_TRACE(name);
    const OrientedBox box = minVolumeBox(cloud);
    const std::vector<PlateauCut> cuts = plateauCuts(cloud, box, 20, 6);
    ASSERT_FALSE(cuts.empty());
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      EXPECT_NEAR(cuts[i].normal_C.dot(cuts[i].along_C), 0.0, 1e-9) << "a cut runs along its projection";
      EXPECT_LT(thetaOf(cloud, box, cuts[i]), cuts[i].theta + 0.06) << "the middle of a plateau is low too";
      EXPECT_GE(cuts[i].theta, cuts[i > 0 ? i - 1 : 0].theta) << "lowest first";
    }
  }
}

TEST(PlateauCuts, FindTheBarOfADumbbell) {
  const PointCloud cloud = test::dumbbell(3000);
  const PlateauCut best = plateauCuts(cloud, minVolumeBox(cloud), 30, 1).at(0);
  EXPECT_GT(std::abs(best.normal_C.x()), 0.95) << "across the bar";
  const double x = best.offset_m / best.normal_C.x();
  EXPECT_TRUE(x > 0.05 && x < 0.17) << "the cut is at x = " << x;
}

TEST(PlateauCuts, LeaveEnoughPointsOnBothSides) {
  EXPECT_TRUE(plateauCuts(test::brick(100), minVolumeBox(test::brick(100)), 60, 4).empty());
}

// --- votes

Juror jurorWith(std::vector<double> volumes, std::vector<double> distances) {
  Juror juror;
  juror.nodes.emplace_back();
  juror.nodes[0].box.extents = Vector3d::Constant(1.0);
  juror.volumes = std::move(volumes);
  juror.distances = std::move(distances);
  return juror;
}

TEST(VerdictOf, SplitsWhileTheMedianJurorSavesEnough) {
  const DecompositionOptions options;  // t = 0.9
  const Juror two = jurorWith({1.0, 0.7, 0.69}, {0, 0.5, 1.5}), one = jurorWith({1.0, 0.99}, {0, 0.5});
  EXPECT_EQ(verdictOf({two, two, one}, options).splits, 1u);
  EXPECT_EQ(verdictOf({two, one, one}, options).splits, 0u);
  EXPECT_NEAR(verdictOf({two, two, one}, options).next_ratio, 0.69 / 0.7, 1e-12);
}

TEST(VerdictOf, FollowsTheJurorThatMostAgreeWith) {
  const auto juror = [](double distance) { return jurorWith({1.0, 0.7, 0.7}, {0, distance, 9}); };
  EXPECT_EQ(verdictOf({juror(0.9), juror(0.5), juror(0.52), juror(0.3), juror(0.54)}, {}).juror, 2u);
  EXPECT_EQ(verdictOf({jurorWith({1.0}, {0}), juror(0.5), juror(0.9)}, {}).juror, 1u)
      << "a juror without that many boxes cannot speak";
}

// --- trees

void expectPartition(const BoxTree& tree, const PointCloud& cloud) {
  ASSERT_EQ(tree.nodes.front().points.size(), cloud.size());
  for (const BoxNode& node : tree.nodes) {
    EXPECT_EQ(node.leaf(), !node.stop_reason.empty());
    EXPECT_GE(node.box.extents[0], node.box.extents[1]);
    EXPECT_GE(node.box.extents[1], node.box.extents[2]);
    if (node.leaf()) continue;
    const BoxNode &first = tree.nodes[node.first], &second = tree.nodes[node.second];
    std::vector<std::uint32_t> merged;
    std::merge(first.points.begin(), first.points.end(), second.points.begin(), second.points.end(),
               std::back_inserter(merged));
    EXPECT_EQ(merged, node.points) << "children part their parent's points";
    EXPECT_NEAR(node.cut->normal_C.dot(node.box.X_CB.linear().col(node.cut->axis)), 0.0, 0.05);
  }
}

TEST(JuryTree, PartsThePoints) {
  for (const PointCloud& cloud : {test::letterT(1500), test::mug(1500), test::lattice(16)})
    expectPartition(decompose(cloud, robustOptions(1)), cloud);
}

TEST(JuryTree, PartsLettersAndLeavesConvexBodiesWhole) {
  EXPECT_EQ(decompose(test::letterL(4000), robustOptions()).leaves().size(), 2u);
  EXPECT_EQ(decompose(test::brick(3000), robustOptions()).leaves().size(), 1u);
  EXPECT_EQ(decompose(test::sphere(3000), robustOptions()).leaves().size(), 1u);
}

TEST(JuryTree, SurvivesNoiseOutliersAndUnevenDensity) {
  for (const PointCloud& cloud : {test::letterL(6000), test::letterT(6000), test::mug(6000)}) {
    const BoxTree whole = decompose(cloud, robustOptions());
    EXPECT_GE(whole.leaves().size(), 2u);
    EXPECT_TRUE(similar(whole, decompose(noisy(cloud, 0.002, 8), robustOptions()))) << "noise of 2 mm";
    PointCloud dirty = cloud;
    for (int i = 0; i < 30; ++i) dirty.push({0.3 - 0.01 * i, 0.2, -0.1 + 0.01 * i});
    EXPECT_TRUE(similar(whole, decompose(dirty, robustOptions()))) << "30 points far from the object";
    std::vector<std::uint32_t> kept;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
      if (cloud.x[i] > 0.03f || i % 4 == 0) kept.push_back(i);
    }
    EXPECT_TRUE(similar(whole, decompose(select(cloud, kept), robustOptions())))
        << "one side a quarter as dense";
  }
}

TEST(JuryTree, DoesNotDependOnTheNumberOfThreads) {
  DecompositionOptions options = robustOptions();
  const BoxTree one = decompose(test::mug(2000), options);
  options.threads = 3;
  const BoxTree many = decompose(test::mug(2000), options);
  ASSERT_EQ(one.nodes.size(), many.nodes.size());
  for (std::size_t i = 0; i < one.nodes.size(); ++i)
    EXPECT_EQ(one.nodes[i].box.X_CB.matrix(), many.nodes[i].box.X_CB.matrix());
}

TEST(JuryTree, GivesABoxToDegenerateClouds) {
  PointCloud point, coincident, line;
  std::mt19937_64 random(7);
  point.push({1, 2, 3});
  for (int i = 0; i < 300; ++i) {
    coincident.push({1, 2, 3});
    line.push(Vector3d(0.2, 0.1, 0.3) * uniform(random));
  }
  for (const PointCloud& cloud : {point, coincident, line}) {
    DecompositionOptions options = robustOptions(1);
    options.min_extent_m = 0.0;
    options.min_points = 2;
    expectPartition(decompose(cloud, options), cloud);
  }
}

TEST(JuryTree, StopsWhenToldTo) {
  const StopToken expired(StopToken::Clock::now() - std::chrono::seconds(1));
  EXPECT_THROW(juryTree(test::letterL(500), robustOptions(), expired), Stopped);
}

}  // namespace
}  // namespace boxgrasp
