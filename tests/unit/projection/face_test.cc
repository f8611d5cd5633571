#include "boxgrasp/projection/face.h"

#include <gtest/gtest.h>

#include <set>

#include "random_pose.h"

namespace boxgrasp {
namespace {

using test::randomPose;

Vector3d outward(int number) {
  const std::array<int, 3> sides = sidesOf(number);
  return Vector3d(sides[0], sides[1], sides[2]).normalized();
}

// A tree of one box around a cloud that fills it unevenly.
struct Filled {
  PointCloud cloud_C;
  BoxTree tree;
};

Filled filledBox(std::mt19937_64& random, const Pose& X_CB) {
  Filled filled;
  BoxNode node;
  node.box.X_CB = X_CB;
  node.box.extents = {uniform(random, 0.02, 0.3), uniform(random, 0.02, 0.3), uniform(random, 0.02, 0.3)};
  for (std::uint32_t i = 0; i < 60; ++i) {
    const Vector3d p(uniform(random, -0.5, 0.5), uniform(random, -0.5, 0.5), uniform(random, -0.5, 0.5));
    filled.cloud_C.push(X_CB * p.cwiseProduct(node.box.extents));
    if (i % 3) node.points.push_back(i);  // the others are another box's
  }
  filled.tree.nodes.push_back(node);
  return filled;
}

TEST(FaceNumbers, NameEachSideOnce) {
  std::set<std::array<int, 3>> sides;
  std::set<std::string> names;
  for (int number = 0; number < kFacesAndEdges; ++number) {
    sides.insert(sidesOf(number));
    names.insert(faceName(number));
    const Vector3d here = outward(number), opposite = outward(number ^ 1);
    EXPECT_TRUE(here.isApprox(-opposite)) << faceName(number) << ": opposite sides differ in the last bit";
    EXPECT_EQ(faceName(number).size(), isEdge(number) ? 4u : 2u);
  }
  EXPECT_EQ(sides.size(), 18u);
  EXPECT_EQ(names.size(), 18u);
}

TEST(FaceNumbers, AnEdgeHalvesTheAngleBetweenItsFaces) {
  for (int number = kFaces; number < kFacesAndEdges; ++number) {
    const auto [one, other] = facesBeside(number);
    EXPECT_FALSE(isEdge(one) || isEdge(other));
    EXPECT_NEAR(outward(one).dot(outward(other)), 0.0, 1e-15) << "faces that meet at " << faceName(number);
    EXPECT_TRUE(outward(number).isApprox((outward(one) + outward(other)).normalized()));
  }
}

TEST(FacesOf, ComeInTheOrderOfTheirNumbers) {
  std::mt19937_64 random(1);
  const Filled filled = filledBox(random, Pose::Identity());
  EXPECT_EQ(facesOf(filled.tree, 0, filled.cloud_C, false).size(), 6u);
  const auto faces = facesOf(filled.tree, 0, filled.cloud_C, true);
  ASSERT_EQ(faces.size(), 18u);
  for (int i = 0; i < 18; ++i) EXPECT_EQ(faces[static_cast<std::size_t>(i)].number, i);
}

TEST(FacesOf, LookIntoTheBoxFromTheSideThatTheirNumberSays) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 30; ++trial) {
    const Filled filled = filledBox(random, randomPose(random));
    const OrientedBox& box = filled.tree.nodes[0].box;
    for (const Face& face : facesOf(filled.tree, 0, filled.cloud_C, true)) {
      EXPECT_NEAR(face.X_CF.linear().determinant(), 1.0, 1e-12);
      EXPECT_TRUE(face.X_CF.linear().col(2).isApprox(-(box.X_CB.linear() * outward(face.number)), 1e-9))
          << faceName(face.number);
      EXPECT_GE(face.size.x(), face.size.y());
    }
  }
}

// Brute force over the points: an edge's frame is the tightest around its box's points, and around no others.
TEST(FacesOf, EdgesFitTightlyAroundThePointsOfTheirBox) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 30; ++trial) {
    const Filled filled = filledBox(random, randomPose(random));
    for (const Face& face : facesOf(filled.tree, 0, filled.cloud_C, true)) {
      if (!isEdge(face.number)) continue;
      Eigen::AlignedBox3d bounds_F;
      for (const auto i : filled.tree.nodes[0].points)
        bounds_F.extend(face.X_CF.inverse() * filled.cloud_C.point(i));
      const Vector3d half(0.5 * face.size.x(), 0.5 * face.size.y(), 0.0);
      EXPECT_TRUE(bounds_F.min().isApprox(-half, 1e-6)) << bounds_F.min().transpose();
      EXPECT_LT((bounds_F.max() - half - face.depth_m * Vector3d::UnitZ()).norm(), 1e-6);
    }
  }
}

TEST(FacesOf, MoveWithTheCloud) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 30; ++trial) {
    std::mt19937_64 same(static_cast<std::uint64_t>(trial));
    std::mt19937_64 again = same;
    const Pose X_DC = randomPose(random);
    const Filled still = filledBox(same, Pose::Identity()), moved = filledBox(again, X_DC);
    const auto before = facesOf(still.tree, 0, still.cloud_C, true);
    const auto after = facesOf(moved.tree, 0, moved.cloud_C, true);
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_TRUE(after[i].X_CF.isApprox(X_DC * before[i].X_CF, 1e-6)) << faceName(before[i].number);
      EXPECT_NEAR(after[i].depth_m, before[i].depth_m, 1e-6);
    }
  }
}

}  // namespace
}  // namespace boxgrasp
