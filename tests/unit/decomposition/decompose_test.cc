#include "boxgrasp/decomposition/decompose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <string>

#include "boxgrasp/base/error.h"
#include "boxgrasp/geometry/min_volume_box.h"
#include "error_of.h"
#include "shapes.h"

namespace boxgrasp {
namespace {

using test::errorOf;

using ::testing::HasSubstr;

DecompositionOptions optionsFor(GainMeasure gain) {
  DecompositionOptions options;
  options.gain = gain;
  return options;
}

BoxTree plainTree(const PointCloud& cloud, DecompositionOptions options) {
  options.exhaustive = true;
  return decompose(cloud, options);
}

void expectSameTree(const BoxTree& a, const BoxTree& b) {
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    SCOPED_TRACE("node " + std::to_string(i));
    const BoxNode &p = a.nodes[i], &q = b.nodes[i];
    EXPECT_EQ(p.parent, q.parent);
    EXPECT_EQ(p.first, q.first);
    EXPECT_EQ(p.points, q.points);
    EXPECT_NEAR(p.theta, q.theta, 1e-9);
    EXPECT_EQ(p.stop_reason, q.stop_reason);
    ASSERT_EQ(p.cut.has_value(), q.cut.has_value());
    if (!p.cut) continue;
    EXPECT_EQ(p.cut->axis, q.cut->axis);
    EXPECT_EQ(p.cut->normal_C, q.cut->normal_C);
    EXPECT_EQ(p.cut->offset_m, q.cut->offset_m);
  }
}

TEST(Decompose, GivesThePlainAlgorithmsTree) {
  for (const auto& [name, cloud] : test::allShapes(700)) {
    for (const GainMeasure gain : {GainMeasure::sum, GainMeasure::local}) {
      SCOPED_TRACE(std::string(name) + (gain == GainMeasure::sum ? ", sum" : ", local"));
      const DecompositionOptions options = optionsFor(gain);
      expectSameTree(decompose(cloud, options), plainTree(cloud, options));
    }
  }
}

TEST(Decompose, GivesThePlainAlgorithmsTreeForOtherOptions) {
  DecompositionOptions options;
  options.segment_fraction = 0.03;
  options.merge_angle_rad = 0.02;
  options.samples_per_segment = 3;
  options.min_point_fraction = 0.1;
  options.gain_t = 0.97;
  for (const auto& [name, cloud] : test::allShapes(500)) {
    SCOPED_TRACE(name);
    expectSameTree(decompose(cloud, options), plainTree(cloud, options));
  }
}

TEST(Decompose, GivesThePlainAlgorithmsTreeForManyPoints) {
  const PointCloud cloud = test::mug(4000);
  expectSameTree(decompose(cloud), plainTree(cloud, {}));
}

// Every law that the header promises of any tree.
void expectLawfulTree(const BoxTree& tree, const PointCloud& cloud) {
  ASSERT_EQ(tree.nodes.front().points.size(), cloud.size()) << "the root has all points";
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    SCOPED_TRACE("node " + std::to_string(i));
    const BoxNode& node = tree.nodes[i];
    EXPECT_TRUE(std::is_sorted(node.points.begin(), node.points.end())) << "points are ascending";
    for (const std::uint32_t p : node.points)
      ASSERT_TRUE(node.box.contains(cloud.point(p), 1e-6)) << "the box has to hold point " << p;
    EXPECT_EQ(node.leaf(), !node.stop_reason.empty()) << "leaves, and leaves alone, say why they stopped";
    if (node.leaf()) continue;
    const BoxNode &first = tree.nodes[node.first], &second = tree.nodes[node.second];
    EXPECT_EQ(first.parent, static_cast<int>(i));
    EXPECT_EQ(second.parent, static_cast<int>(i));
    EXPECT_GT(node.first, static_cast<int>(i)) << "a parent stands before its children";
    EXPECT_EQ(first.depth, node.depth + 1);
    std::vector<std::uint32_t> merged;
    std::merge(first.points.begin(), first.points.end(), second.points.begin(), second.points.end(),
               std::back_inserter(merged));
    EXPECT_EQ(merged, node.points) << "children part their parent's points";
    ASSERT_TRUE(node.cut.has_value());
    EXPECT_NEAR(node.cut->normal_C.norm(), 1.0, 1e-9);
    EXPECT_NEAR(node.cut->normal_C.dot(node.box.X_CB.linear().col(node.cut->axis)), 0.0, 1e-9)
        << "the cut is along the projected axis";
    for (const std::uint32_t p : first.points)
      EXPECT_LE(node.cut->normal_C.dot(cloud.point(p)), node.cut->offset_m + 1e-7);
    for (const std::uint32_t p : second.points)
      EXPECT_GT(node.cut->normal_C.dot(cloud.point(p)), node.cut->offset_m - 1e-7);
    EXPECT_NEAR(node.volume_gain, (first.box.volume() + second.box.volume()) / node.box.volume(), 1e-12);
  }
}

TEST(Decompose, PartsThePointsAndKeepsEachPartInItsBox) {
  for (const auto& [name, cloud] : test::allShapes(2000)) {
    for (const SplitRule rule : {SplitRule::hull, SplitRule::bound}) {
      for (const GainMeasure gain : {GainMeasure::sum, GainMeasure::local}) {
        SCOPED_TRACE(name);
        DecompositionOptions options = optionsFor(gain);
        options.split = rule;
        expectLawfulTree(decompose(cloud, options), cloud);
      }
    }
  }
}

TEST(Decompose, SplitsOnlyWhereTheVolumeShrinksBelowT) {
  for (const auto& [name, cloud] : test::allShapes(2000)) {
    SCOPED_TRACE(name);
    for (const BoxNode& node : decompose(cloud, optionsFor(GainMeasure::local)).nodes) {
      if (!node.leaf()) {
        EXPECT_LT(node.theta, 0.9);
        EXPECT_LT(node.volume_gain, 0.9);
      } else if (node.volume_gain >= 0) {
        EXPECT_GE(node.volume_gain, 0.9) << node.stop_reason;
      }
    }
  }
}

// Most boxes of splits that are not made are never found, so what is said of them must hold for the true
// ones.
TEST(Decompose, SaysNoMoreOfASplitThatItDidNotMakeThanIsTrue) {
  int given_up = 0;
  for (const auto& [name, cloud] : test::allShapes(2000)) {
    for (const GainMeasure gain : {GainMeasure::sum, GainMeasure::local}) {
      SCOPED_TRACE(name);
      for (const BoxNode& node : decompose(cloud, optionsFor(gain)).nodes) {
        if (!node.leaf() || node.volume_gain < 0) continue;
        given_up += node.stop_reason.find("of at least") != std::string::npos ? 1 : 0;
        std::array<PointCloud, 2> sides;
        for (const std::uint32_t p : node.points) {
          const Vector3d point = cloud.point(p);
          sides[node.cut->normal_C.dot(point) <= node.cut->offset_m ? 0 : 1].push(point);
        }
        const double volume = minVolumeBox(sides[0]).volume() + minVolumeBox(sides[1]).volume();
        EXPECT_GE(volume / node.box.volume(), node.volume_gain - 1e-5) << node.stop_reason;
        if (gain == GainMeasure::local) {
          EXPECT_GE(volume / node.box.volume(), 0.9) << node.stop_reason;
        }
      }
    }
  }
  EXPECT_GT(given_up, 10) << "expected many splits to be given up before their boxes were found";
}

TEST(Decompose, PartsAnLIntoItsTwoStrokes) {
  const PointCloud cloud = test::letterL(4000);
  const BoxTree tree = decompose(cloud);
  EXPECT_EQ(tree.leaves().size(), 2u);
  const double solid = 0.03 * 0.12 * 0.03 + 0.09 * 0.03 * 0.03;
  EXPECT_LT(tree.leafVolume(), 1.3 * solid) << "a cut near the inner corner wastes little";
  EXPECT_GT(tree.leafVolume(), 0.95 * solid);
}

TEST(Decompose, LeavesConvexBodiesWhole) {
  for (const PointCloud& cloud : {test::brick(3000), test::sphere(3000), test::cylinder(3000)}) {
    const BoxTree tree = decompose(cloud);
    EXPECT_EQ(tree.nodes.size(), 1u);
    EXPECT_FALSE(tree.nodes[0].stop_reason.empty());
  }
}

// The order of points may change the last bits of a box, so the geometry is compared, not the bits.
void expectSameBoxes(const BoxTree& a, const BoxTree& b, const Pose& X_BA) {
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    SCOPED_TRACE("node " + std::to_string(i));
    const OrientedBox &p = a.nodes[i].box, &q = b.nodes[i].box;
    EXPECT_LT((X_BA * p.X_CB.translation() - q.X_CB.translation()).norm(), 2e-4);
    EXPECT_LT((p.extents - q.extents).norm(), 4e-4);
    EXPECT_NEAR(p.volume() / q.volume(), 1.0, 5e-3);
  }
}

TEST(Decompose, DoesNotDependOnTheOrderOfPoints) {
  std::mt19937_64 random(5);
  for (const PointCloud& cloud : {test::letterL(1500), test::dumbbell(1500), test::mug(1500)}) {
    std::vector<std::uint32_t> order(cloud.size());
    std::iota(order.begin(), order.end(), 0u);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[uniformIndex(random, i)]);
    expectSameBoxes(decompose(cloud), decompose(select(cloud, order)), Pose::Identity());
  }
}

TEST(Decompose, MovesWithTheCloud) {
  std::mt19937_64 random(6);
  for (const PointCloud& cloud : {test::letterL(1500), test::dumbbell(1500), test::letterT(1500)}) {
    for (int i = 0; i < 3; ++i) {
      const Pose X_DC = test::randomPose(random);
      expectSameBoxes(decompose(cloud), decompose(transformed(cloud, X_DC)), X_DC);
    }
  }
}

TEST(Decompose, DoesNotDependOnTheNumberOfThreads) {
  for (const auto& [name, cloud] : test::allShapes(1500)) {
    SCOPED_TRACE(name);
    DecompositionOptions options = optionsFor(GainMeasure::local);
    const BoxTree one = decompose(cloud, options);
    for (const int threads : {0, 3}) {
      options.threads = threads;
      const BoxTree many = decompose(cloud, options);
      expectSameTree(one, many);
      for (std::size_t i = 0; i < one.nodes.size(); ++i)
        EXPECT_EQ(one.nodes[i].box.X_CB.matrix(), many.nodes[i].box.X_CB.matrix());
    }
  }
}

TEST(Decompose, GivesABoxToDegenerateClouds) {
  PointCloud point, coincident, line, plane;
  std::mt19937_64 random(7);
  point.push({1, 2, 3});
  for (int i = 0; i < 500; ++i) {
    coincident.push({1, 2, 3});
    line.push(Vector3d(0.2, 0.1, 0.3) * uniform(random));
    const double x = uniform(random), y = uniform(random);
    plane.push({0.2 * x, 0.1 * y, 0});
  }
  for (const PointCloud& cloud : {point, coincident, line, plane}) {
    for (const SplitRule rule : {SplitRule::hull, SplitRule::bound}) {
      DecompositionOptions options;
      options.split = rule;
      options.min_extent_m = 0.0;
      options.min_points = 2;
      const BoxTree tree = decompose(cloud, options);
      expectLawfulTree(tree, cloud);
    }
  }
}

TEST(Decompose, PartsAPlanarL) {
  PointCloud cloud = test::letterL(2000);
  std::fill(cloud.z.begin(), cloud.z.end(), 0.0f);
  EXPECT_EQ(decompose(cloud).leaves().size(), 2u);
}

TEST(Decompose, SaysWhyItStopped) {
  const auto reason = [](const PointCloud& cloud, const DecompositionOptions& options) {
    return decompose(cloud, options).nodes.back().stop_reason;
  };
  EXPECT_THAT(reason(test::letterL(30), {}), HasSubstr("30 points are fewer than 50"));
  DecompositionOptions options;
  options.min_extent_m = 0.2;
  EXPECT_THAT(reason(test::letterL(300), options), HasSubstr("thinner than a finger"));
  EXPECT_THAT(reason(test::brick(300), {}), HasSubstr("is not below t = 0.9"));
  options = {};
  options.gain_t = 0.1;
  EXPECT_THAT(reason(test::letterL(1000), options), HasSubstr("has a Theta below t = 0.1"));
  options = {};
  options.max_leaves = 1;
  EXPECT_THAT(reason(test::letterL(1000), options), HasSubstr("1 boxes already"));
  options = {};
  options.segment_fraction = 0.9;
  EXPECT_THAT(reason(test::letterL(1000), options), HasSubstr("no cut"));
}

TEST(Decompose, KeepsToTheLargestNumberOfLeaves) {
  DecompositionOptions options = optionsFor(GainMeasure::local);
  const PointCloud cloud = test::blobs(2000, 9);
  const std::size_t free = decompose(cloud, options).leaves().size();
  for (int most = 1; most <= 4; ++most) {
    options.max_leaves = most;
    EXPECT_EQ(decompose(cloud, options).leaves().size(), std::min<std::size_t>(free, most));
  }
}

TEST(Decompose, RefusesAnEmptyCloud) {
  EXPECT_THAT(errorOf([] { decompose({}); }), HasSubstr("empty"));
}

TEST(Decompose, RefusesPointsThatAreNotFinite) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    PointCloud cloud = test::brick(10);
    cloud.y[7] = bad;
    EXPECT_THAT(errorOf([&] { decompose(cloud); }), HasSubstr("point 7 is not finite"));
  }
}

TEST(Decompose, RefusesBadOptionsByName) {
  const auto message = [](auto field, auto value) {
    DecompositionOptions options;
    options.*field = value;
    return errorOf([&] { decompose(test::brick(10), options); });
  };
  using Options = DecompositionOptions;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(message(&Options::gain_t, 0.0), HasSubstr("option 'gain_t' is 0, but must be in (0, 1]"));
  EXPECT_THAT(message(&Options::gain_t, nan), HasSubstr("option 'gain_t' is nan"));
  EXPECT_THAT(message(&Options::segment_fraction, 1.0), HasSubstr("option 'segment_fraction' is 1"));
  EXPECT_THAT(message(&Options::samples_per_segment, 0), HasSubstr("option 'samples_per_segment' is 0"));
  EXPECT_THAT(message(&Options::merge_angle_rad, -1.0), HasSubstr("option 'merge_angle_rad' is -1"));
  EXPECT_THAT(message(&Options::min_point_fraction, 0.5), HasSubstr("option 'min_point_fraction' is 0.5"));
  EXPECT_THAT(message(&Options::min_points, 1), HasSubstr("option 'min_points' is 1"));
  EXPECT_THAT(message(&Options::min_extent_m, -0.1), HasSubstr("option 'min_extent_m' is -0.1"));
  EXPECT_THAT(message(&Options::bound_step_m, 0.0), HasSubstr("option 'bound_step_m' is 0"));
  EXPECT_THAT(message(&Options::max_leaves, 0), HasSubstr("option 'max_leaves' is 0"));
  EXPECT_THAT(message(&Options::threads, -1), HasSubstr("option 'threads' is -1"));
}

TEST(Decompose, ThrowsStoppedWhenTheDeadlineIsPast) {
  const StopToken expired(StopToken::Clock::now() - std::chrono::seconds(1));
  EXPECT_THROW(decompose(test::letterL(100), {}, expired), Stopped);
}

TEST(Decompose, ThrowsStoppedWhenCancelled) {
  const auto cancelled = std::make_shared<std::atomic<bool>>(true);
  EXPECT_THROW(decompose(test::letterL(100), {}, StopToken(std::nullopt, cancelled)), Stopped);
}

}  // namespace
}  // namespace boxgrasp
