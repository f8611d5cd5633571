#include "boxgrasp/projection/graspable_faces.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <map>

#include "boxgrasp/base/error.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

using test::randomPose;
using testing::HasSubstr;

BoxNode nodeOf(const OrientedBox& box, int parent) {
  BoxNode node;
  node.box = box;
  node.parent = parent;
  return node;
}

BoxTree treeOf(const std::vector<OrientedBox>& leaves) {
  BoxTree tree;
  if (leaves.size() == 1) {
    tree.nodes.push_back(nodeOf(leaves[0], -1));
    return tree;
  }
  // The root's own box is of no interest here: only leaves have faces.
  tree.nodes.push_back(nodeOf(leaves[0], -1));
  tree.nodes[0].first = 1;
  tree.nodes[0].second = 2;
  for (const auto& box : leaves) tree.nodes.push_back(nodeOf(box, 0));
  return tree;
}

std::vector<FaceDecision> decide(const BoxTree& tree, const PointCloud& scene,
                                 const Surroundings& around = {}, FaceOptions options = {}) {
  options.inner_boxes = false;
  return graspableFaces(tree, PointCloud(), PointGrid(scene, 0.01), around, options);
}

FaceRejection rejectionOf(const std::vector<FaceDecision>& decisions, int node, int axis, int sign) {
  for (const auto& d : decisions) {
    if (d.face.node == node && d.face.number == 2 * axis + (sign > 0)) return d.rejection;
  }
  ADD_FAILURE() << "no face of node " << node << ", axis " << axis << ", sign " << sign;
  return FaceRejection::none;
}

const OrientedBox kBox{Pose::Identity(), {0.12, 0.08, 0.05}};

TEST(GraspableFaces, FramesAreRightHandedAndLookIntoTheBox) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector3d extents(uniform(random, 0.02, 0.3), uniform(random, 0.02, 0.3),
                           uniform(random, 0.02, 0.3));
    const OrientedBox box{randomPose(random), extents};
    const auto decisions = decide(treeOf({box}), {});
    ASSERT_EQ(decisions.size(), 6u);
    for (int i = 0; i < 6; ++i) {
      const Face& face = decisions[i].face;
      EXPECT_EQ(face.number, i);
      const Vector3d outward_C = (i % 2 ? 1 : -1) * box.X_CB.linear().col(i / 2);
      EXPECT_TRUE(face.X_CF.linear().col(2).isApprox(-outward_C)) << "numbers tell axis and side";
      EXPECT_NEAR(face.X_CF.linear().determinant(), 1.0, 1e-12);
      EXPECT_GE(face.size.x(), face.size.y());
      EXPECT_NEAR(face.size.x() * face.size.y() * face.depth_m, box.volume(), 1e-12);
      // Walking from the face along its axes by the sizes stays in the box; any farther leaves it.
      for (const double sx : {-0.5, 0.5}) {
        for (const double sy : {-0.5, 0.5}) {
          const Vector3d top(sx * face.size.x(), sy * face.size.y(), 0),
              bottom = top + face.depth_m * Vector3d::UnitZ();
          EXPECT_TRUE(box.contains(face.X_CF * top, 1e-9) && box.contains(face.X_CF * bottom, 1e-9));
          EXPECT_FALSE(box.contains(face.X_CF * (1.001 * top + 1e-4 * Vector3d::UnitZ()), 1e-9));
        }
      }
      EXPECT_FALSE(box.contains(face.X_CF * Vector3d(0, 0, -1e-6))) << "outside is where z is negative";
      EXPECT_FALSE(box.contains(face.X_CF * Vector3d(0, 0, face.depth_m + 1e-6)));
    }
  }
}

TEST(GraspableFaces, AllFacesOfALonelyBoxAreGraspable) {
  for (const auto& decision : decide(treeOf({kBox}), {})) {
    EXPECT_TRUE(decision.graspable()) << describe(decision.rejection);
  }
}

TEST(GraspableFaces, SizesOutsideTheHandsRangeAreRejected) {
  const auto sizes = [](const Vector3d& extents) {
    return decide(treeOf({{Pose::Identity(), extents}}), {});
  };
  EXPECT_EQ(rejectionOf(sizes({0.30, 0.21, 0.1}), 0, 2, 1), FaceRejection::too_wide);
  EXPECT_EQ(rejectionOf(sizes({0.30, 0.19, 0.1}), 0, 2, 1), FaceRejection::none);
  EXPECT_EQ(rejectionOf(sizes({0.30, 0.004, 0.1}), 0, 2, 1), FaceRejection::too_narrow);
  EXPECT_EQ(rejectionOf(sizes({0.10, 0.10, 0.009}), 0, 2, -1), FaceRejection::too_shallow);
  EXPECT_EQ(rejectionOf(sizes({0.10, 0.10, 0.009}), 0, 1, -1), FaceRejection::none)
      << "a plate can be grasped from its edge";
}

TEST(GraspableFaces, FacesTurnedAwayFromTheSensorAreHidden) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const OrientedBox box{randomPose(random), kBox.extents};
    const Vector3d viewpoint_C =
        box.X_CB.translation() + Vector3d(normal(random), normal(random), normal(random));
    for (const auto& [face, rejection] : decide(treeOf({box}), {}, {std::nullopt, {viewpoint_C}})) {
      const bool seen = (face.X_CF.inverse() * viewpoint_C).z() < 0.0;
      EXPECT_EQ(rejection, seen ? FaceRejection::none : FaceRejection::hidden);
    }
    const Vector3d opposite_C = 2 * box.X_CB.translation() - viewpoint_C;
    for (const auto& [face, rejection] :
         decide(treeOf({box}), {}, {std::nullopt, {viewpoint_C, opposite_C}})) {
      const bool seen =
          (face.X_CF.inverse() * viewpoint_C).z() < 0.0 || (face.X_CF.inverse() * opposite_C).z() < 0.0;
      EXPECT_EQ(rejection, seen ? FaceRejection::none : FaceRejection::hidden) << "by both of two sensors";
    }
  }
}

TEST(GraspableFaces, TheFaceTowardsTheGroundIsSupported) {
  const auto decisions = decide(treeOf({kBox}), {}, {Vector3d(0, 0, -1), {}});
  for (const auto& [face, rejection] : decisions) {
    const bool down = faceName(face.number) == "-z";
    EXPECT_EQ(rejection, down ? FaceRejection::supported : FaceRejection::none);
  }
}

TEST(GraspableFaces, TheFacesOnBothSidesOfACutAreShared) {
  std::mt19937_64 random(3);
  const Pose X_CA = randomPose(random);
  const OrientedBox left{X_CA * Eigen::Translation3d(-0.05, 0, 0), {0.098, 0.08, 0.06}};
  const OrientedBox right{X_CA * Eigen::Translation3d(0.05, 0, 0), {0.098, 0.08, 0.06}};
  const auto decisions = decide(treeOf({left, right}), {});
  ASSERT_EQ(decisions.size(), 12u);
  for (const auto& [face, rejection] : decisions) {
    const bool inner = faceName(face.number) == (face.node == 1 ? "+x" : "-x");
    EXPECT_EQ(rejection, inner ? FaceRejection::shared : FaceRejection::none) << describe(rejection);
  }
}

TEST(GraspableFaces, AnEdgeIsSharedWhereOneOfItsFacesIs) {
  const OrientedBox left{Pose(Eigen::Translation3d(-0.05, 0, 0)), {0.098, 0.08, 0.06}};
  const OrientedBox right{Pose(Eigen::Translation3d(0.05, 0, 0)), {0.098, 0.08, 0.06}};
  BoxTree tree = treeOf({left, right});
  PointCloud cloud;
  for (const int leaf : {1, 2}) {
    for (const Vector3d& corner : tree.nodes[leaf].box.corners()) {
      tree.nodes[leaf].points.push_back(static_cast<std::uint32_t>(cloud.size()));
      cloud.push(corner);
    }
  }
  FaceOptions options;
  options.inner_boxes = false;
  options.edges = EdgeUse::always;
  const auto decisions = graspableFaces(tree, cloud, PointGrid(cloud, 0.01), {}, options);
  ASSERT_EQ(decisions.size(), 36u);
  for (const auto& [face, rejection] : decisions) {
    const bool inner = sidesOf(face.number)[0] == (face.node == 1 ? 1 : -1);
    EXPECT_EQ(rejection, inner ? FaceRejection::shared : FaceRejection::none) << faceName(face.number);
  }
}

TEST(GraspableFaces, SharedMeansMoreThanHalfCovered) {
  for (const double covered : {0.35, 0.65}) {
    const OrientedBox big{Pose::Identity(), {0.1, 0.1, 0.1}};
    const OrientedBox small{Pose(Eigen::Translation3d(0.1, 0.1 * (1 - covered), 0)), {0.1, 0.1, 0.1}};
    EXPECT_EQ(rejectionOf(decide(treeOf({big, small}), {}), 1, 0, 1),
              covered > 0.5 ? FaceRejection::shared : FaceRejection::none)
        << "covered: " << covered;
  }
}

// The definition, counted literally.
bool blockedByDefinition(const Face& face, const PointCloud& scene, const FaceOptions& options) {
  std::map<std::pair<int, int>, int> cells;
  for (std::size_t i = 0; i < scene.size(); ++i) {
    const Vector3d p_F = face.X_CF.inverse() * scene.point(i);
    if (p_F.z() > -0.003 || p_F.z() < -options.hand_depth_m) continue;
    if (p_F.head<2>().cwiseAbs().maxCoeff() > 0.5 * options.hand_width_m) continue;
    ++cells[{static_cast<int>(std::floor((p_F.x() + 0.5 * options.hand_width_m) / 0.005)),
             static_cast<int>(std::floor((p_F.y() + 0.5 * options.hand_width_m) / 0.005))}];
  }
  return static_cast<double>(cells.size()) > options.max_blocked_fraction * 18 * 18;
}

TEST(GraspableFaces, BlockedAgreesWithItsDefinition) {
  std::mt19937_64 random(4);
  int blocked = 0, faces = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const OrientedBox box{randomPose(random), kBox.extents};
    PointCloud scene;
    const Vector3d towards = Vector3d(normal(random), normal(random), normal(random)).normalized();
    for (int i = 0; i < 300; ++i) {
      const Vector3d q(normal(random), normal(random), normal(random));
      scene.push(box.X_CB * (0.1 * towards + 0.04 * q));
    }
    for (const auto& [face, rejection] : decide(treeOf({box}), scene)) {
      const bool expected = blockedByDefinition(face, scene, {});
      EXPECT_EQ(rejection == FaceRejection::blocked, expected) << "trial " << trial;
      blocked += expected;
      ++faces;
    }
  }
  EXPECT_GT(blocked, faces / 10) << "the test must see both outcomes";
  EXPECT_LT(blocked, faces * 9 / 10);
}

TEST(GraspableFaces, PointsOfTheFaceAndBeyondTheFingersDoNotBlock) {
  const auto wall = [](double height_m) {
    PointCloud points;
    for (double x = -0.06; x < 0.06; x += 0.004) {
      for (double y = -0.06; y < 0.06; y += 0.004) points.push({x, y, 0.025 + height_m});
    }
    return rejectionOf(decide(treeOf({kBox}), points), 0, 2, 1);
  };
  EXPECT_EQ(wall(-0.010), FaceRejection::none) << "inside the box";
  EXPECT_EQ(wall(0.002), FaceRejection::none) << "on the face";
  EXPECT_EQ(wall(0.005), FaceRejection::blocked);
  EXPECT_EQ(wall(0.105), FaceRejection::blocked);
  EXPECT_EQ(wall(0.115), FaceRejection::none) << "farther than the fingers are long";
}

TEST(GraspableFaces, AnExpiredTokenStops) {
  const StopToken expired(StopToken::Clock::now());
  const PointCloud scene;
  EXPECT_THROW(graspableFaces(treeOf({kBox}), scene, PointGrid(scene, 0.01), {}, {}, expired), Stopped);
}

TEST(GraspableFaces, ABadOptionIsNamed) {
  FaceOptions options;
  options.max_blocked_fraction = 1.5;
  try {
    decide(treeOf({kBox}), {}, {}, options);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("faces.max_blocked_fraction"));
    EXPECT_THAT(error.what(), HasSubstr("1.5"));
    EXPECT_THAT(error.what(), HasSubstr("[0, 1]"));
  }
}

TEST(GraspableFaces, EveryReasonHasItsOwnWords) {
  std::map<std::string_view, int> texts;
  for (int i = 0; i <= static_cast<int>(FaceRejection::too_shallow); ++i)
    ++texts[describe(static_cast<FaceRejection>(i))];
  EXPECT_EQ(texts.size(), 8u);
}

// Two cubes side by side in one root box: the root's six faces count too, and are not shared with the cubes
// inside it.
TEST(GraspableFaces, CountInnerBoxesOnRequest) {
  OrientedBox left, right, root;
  left.extents = right.extents = Vector3d::Constant(0.05);
  left.X_CB.translation().x() = -0.025;
  right.X_CB.translation().x() = 0.025;
  root.extents = {0.10, 0.05, 0.05};
  BoxTree tree = treeOf({left, right});
  tree.nodes[0].box = root;
  const PointCloud no_points;
  const PointGrid nothing(no_points, 0.01);
  FaceOptions options;
  options.inner_boxes = true;
  std::map<int, int> graspable;
  for (const FaceDecision& decision : graspableFaces(tree, no_points, nothing, {}, options))
    graspable[decision.face.node] += decision.graspable();
  EXPECT_EQ(graspable, (std::map<int, int>{{0, 6}, {1, 5}, {2, 5}}))
      << "only the cubes' common faces are shared";
  options.inner_boxes = false;
  EXPECT_EQ(graspableFaces(tree, no_points, nothing, {}, options).size(), 12u);
}

}  // namespace
}  // namespace boxgrasp
