#include "boxgrasp/decomposition/similarity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "boxgrasp/base/error.h"
#include "boxgrasp/geometry/pose.h"

namespace boxgrasp {
namespace {

using ::testing::HasSubstr;

BoxNode cubeAt(const Vector3d& center, double side) {
  BoxNode node;
  node.box.X_CB = makePose(Matrix3d::Identity(), center);
  node.box.extents = Vector3d::Constant(side);
  return node;
}

// A root of extent 1 over leaves of side 0.2 at the given places.
BoxTree treeOf(const std::vector<Vector3d>& centers, double side = 0.2) {
  BoxTree tree;
  tree.nodes.push_back(cubeAt(Vector3d::Zero(), 1.0));
  tree.nodes.front().first = 1, tree.nodes.front().second = 2;
  for (const Vector3d& center : centers) tree.nodes.push_back(cubeAt(center, side));
  return tree;
}

BoxTree scaled(BoxTree tree, double factor) {
  for (BoxNode& node : tree.nodes) {
    node.box.X_CB.translation() *= factor;
    node.box.extents *= factor;
  }
  return tree;
}

TEST(ConstellationSize, SumsVolumesAndDistancesOfLeaves) {
  const ConstellationSize size =
      constellationSize(treeOf({Vector3d::Zero(), {0.3, 0, 0}, {0.3, 0.4, 0}}), 1.0);
  EXPECT_NEAR(size.volume, 3 * 0.008, 1e-12) << "the root is no leaf";
  EXPECT_NEAR(size.distance, 0.3 + 0.4 + 0.5, 1e-12) << "each pair counts once";
}

TEST(ConstellationSize, IsInUnitsOfTheScale) {
  const ConstellationSize size = constellationSize(treeOf({Vector3d::Zero(), {0.3, 0, 0}}), 0.1);
  EXPECT_NEAR(size.volume, 16.0, 1e-9);
  EXPECT_NEAR(size.distance, 3.0, 1e-12);
}

TEST(BoxTree, CountsItsLeaves) {
  const BoxTree tree = treeOf({Vector3d::Zero(), {0.3, 0, 0}});
  EXPECT_EQ(tree.leaves(), (std::vector<int>{1, 2}));
  EXPECT_NEAR(tree.leafVolume(), 0.016, 1e-12);
}

TEST(Similar, IsReflexive) {
  const BoxTree tree = treeOf({Vector3d::Zero(), {0.3, 0, 0}});
  EXPECT_TRUE(similar(tree, tree, {.max_distance_difference = 0.0, .max_volume_difference = 0.0}));
}

TEST(Similar, ComparesDistancesWithTheirThreshold) {
  const auto apart = [](double distance) { return treeOf({Vector3d::Zero(), {distance, 0, 0}}); };
  for (const double within : {-0.09, 0.0, 0.09}) EXPECT_TRUE(similar(apart(0.3), apart(0.3 + within)));
  for (const double beyond : {-0.11, 0.11}) EXPECT_FALSE(similar(apart(0.3), apart(0.3 + beyond)));
}

TEST(Similar, ComparesVolumesWithTheirThreshold) {
  const BoxTree tree = treeOf({Vector3d::Zero(), {0.3, 0, 0}}),
                wider = treeOf({Vector3d::Zero(), {0.3, 0, 0}}, 0.3);
  const double difference = 2 * (0.027 - 0.008);
  EXPECT_TRUE(similar(tree, wider));
  EXPECT_TRUE(similar(tree, wider, {.max_volume_difference = difference + 1e-9}));
  EXPECT_FALSE(similar(tree, wider, {.max_volume_difference = difference - 1e-9}));
}

TEST(Similar, IsSymmetricWhereTheScaleIs) {
  const std::vector<BoxTree> trees{treeOf({Vector3d::Zero()}), treeOf({Vector3d::Zero(), {0.3, 0, 0}}),
                                   treeOf({Vector3d::Zero(), {0.38, 0, 0}}),
                                   treeOf({Vector3d::Zero(), {0.3, 0, 0}, {0, 0.3, 0}}, 0.6)};
  for (const BoxTree& a : trees) {
    for (const BoxTree& b : trees) {
      EXPECT_EQ(similar(a, b), similar(b, a));
      EXPECT_EQ(similar(a, b, {.scale_m = 0.4}), similar(b, a, {.scale_m = 0.4}));
    }
  }
}

TEST(Similar, DoesNotDependOnTheUnitOfLength) {
  const BoxTree a = treeOf({Vector3d::Zero(), {0.3, 0, 0}});
  for (const double shift : {0.05, 0.09, 0.11, 0.2}) {
    const BoxTree b = treeOf({Vector3d::Zero(), {0.3 + shift, 0, 0}});
    EXPECT_EQ(similar(a, b), similar(scaled(a, 0.01), scaled(b, 0.01)));
  }
}

TEST(Similar, NeedsBoxes) {
  const BoxTree tree = treeOf({Vector3d::Zero()});
  EXPECT_THROW(similar(tree, {}), InputError);
  EXPECT_THROW(similar({}, tree), InputError);
}

TEST(Similar, RefusesBadOptionsByName) {
  const auto message = [](const SimilarityOptions& options) -> std::string {
    try {
      options.validate();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no InputError";
  };
  EXPECT_EQ(message({}), "no InputError");
  EXPECT_THAT(message({.max_distance_difference = -1}), HasSubstr("option 'max_distance_difference' is -1"));
  EXPECT_THAT(message({.max_volume_difference = -2}), HasSubstr("option 'max_volume_difference' is -2"));
  EXPECT_THAT(message({.scale_m = 0}), HasSubstr("option 'scale_m' is 0"));
  EXPECT_THAT(message({.scale_m = -0.5}), HasSubstr("option 'scale_m' is -0.5"));
}

}  // namespace
}  // namespace boxgrasp
