#include "boxgrasp/objects/mesh_properties.h"

#include <gtest/gtest.h>

#include <cmath>

#include "boxgrasp/base/error.h"
#include "boxgrasp/objects/polygonise.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

// The box from the origin to `size`.
TriangleMesh box(const Vector3d& size) {
  TriangleMesh mesh;
  for (int c = 0; c < 8; ++c) mesh.vertices.push_back(size.cwiseProduct(Vector3d(c & 1, c >> 1 & 1, c >> 2)));
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

TriangleMesh tetrahedron(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  return {{a, b, c, d}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
  const auto offset = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return a;
}

TriangleMesh transformed(TriangleMesh mesh, const Pose& X) {
  for (Vector3d& v : mesh.vertices) v = X * v;
  return mesh;
}

// --- mass properties

TEST(MassProperties, OfABoxAreThoseOfTheFormula) {
  const Vector3d size(0.2, 0.3, 0.5);
  const MassProperties mass = massPropertiesOf(box(size));
  const double m = size.prod();
  EXPECT_NEAR(mass.volume, m, 1e-16);
  EXPECT_LT((mass.center_M - 0.5 * size).norm(), 1e-16);
  const Vector3d squares = size.cwiseAbs2();
  const Matrix3d expected =
      m / 12.0 * (squares.sum() * Matrix3d::Identity() - Matrix3d(squares.asDiagonal()));
  EXPECT_LT((mass.inertia_M - expected).norm(), 1e-15);
}

// The regular tetrahedron of edge s: inertia m s^2 / 20 about every axis through its centre.
TEST(MassProperties, OfARegularTetrahedronAreThoseOfTheFormula) {
  const MassProperties mass = massPropertiesOf(tetrahedron({1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}));
  const double volume = std::pow(8.0, 1.5) / (6.0 * std::sqrt(2.0));
  EXPECT_NEAR(mass.volume, volume, 1e-14);
  EXPECT_LT(mass.center_M.norm(), 1e-15);
  EXPECT_LT((mass.inertia_M - volume * 8.0 / 20.0 * Matrix3d::Identity()).norm(), 1e-14);
}

TEST(MassProperties, OfASphereApproachThoseOfTheFormula) {
  const Vector3d center(0.3, -0.2, 0.1);
  const TriangleMesh mesh =
      polygonise(sphere(center, 1.0), {Vector3d::Constant(-1.5), Vector3d::Constant(1.5)}, 0.04);
  const MassProperties mass = massPropertiesOf(mesh);
  const double volume = 4.0 / 3.0 * M_PI;
  EXPECT_NEAR(mass.volume, volume, 2e-3 * volume);
  EXPECT_LT((mass.center_M - center).norm(), 1e-4);
  EXPECT_LT((mass.inertia_M - 0.4 * volume * Matrix3d::Identity()).norm(), 3e-3 * volume);
  EXPECT_NEAR(surfaceArea(mesh), 4.0 * M_PI, 2e-3 * 4.0 * M_PI);
  EXPECT_NEAR(largestDistance(mesh, center), 1.0, 1e-3);
}

// Volume is invariant; the centre moves with the body; the inertia turns with it, I' = R I R^T.
TEST(MassProperties, MoveWithTheBody) {
  std::mt19937_64 random(1);
  const TriangleMesh mesh = box({0.2, 0.3, 0.5});
  const MassProperties before = massPropertiesOf(mesh);
  for (int i = 0; i < 50; ++i) {
    const Pose X = test::randomPose(random);
    const MassProperties after = massPropertiesOf(transformed(mesh, X));
    EXPECT_NEAR(after.volume, before.volume, 1e-14);
    EXPECT_LT((after.center_M - X * before.center_M).norm(), 1e-13);
    EXPECT_LT((after.inertia_M - X.linear() * before.inertia_M * X.linear().transpose()).norm(), 1e-14);
  }
}

TEST(MassProperties, StayExactFarFromTheOrigin) {
  const MassProperties mass =
      massPropertiesOf(transformed(box({0.2, 0.3, 0.5}), makePose(Matrix3d::Identity(), {1e6, 0, 0})));
  EXPECT_NEAR(mass.volume, 0.03, 1e-10);
  EXPECT_NEAR(mass.inertia_M(0, 0), 0.03 * (0.09 + 0.25) / 12.0, 1e-11);
}

// The whole is the sum of two halves: volumes add, and inertias add after Steiner's shift to the common
// centre.
TEST(MassProperties, OfHalvesAddUpToTheWhole) {
  const MassProperties whole = massPropertiesOf(box({2, 1, 1})), half = massPropertiesOf(box({1, 1, 1}));
  EXPECT_NEAR(whole.volume, 2 * half.volume, 1e-15);
  const double steiner = half.volume * 0.25;
  EXPECT_NEAR(whole.inertia_M(1, 1), 2 * (half.inertia_M(1, 1) + steiner), 1e-15);
  EXPECT_NEAR(whole.inertia_M(0, 0), 2 * half.inertia_M(0, 0), 1e-15);
}

TEST(MassProperties, ScaleWithThePowersOfLength) {
  const MassProperties one = massPropertiesOf(box({1, 2, 3})), two = massPropertiesOf(box({2, 4, 6}));
  EXPECT_NEAR(two.volume, 8 * one.volume, 1e-12);
  EXPECT_LT((two.inertia_M - 32 * one.inertia_M).norm(), 1e-11);
  EXPECT_NEAR(surfaceArea(box({2, 4, 6})), 4 * surfaceArea(box({1, 2, 3})), 1e-12);
}

TEST(SurfaceArea, OfABoxIsTheSumOfItsFaces) { EXPECT_NEAR(surfaceArea(box({1, 2, 3})), 22.0, 1e-14); }

TEST(LargestDistance, IsToTheFarthestCornerInUse) {
  TriangleMesh mesh = box({1, 2, 2});
  mesh.vertices.push_back({100, 0, 0});
  EXPECT_EQ(largestDistance(mesh, Vector3d::Zero()), 3.0) << "the vertex at 100 belongs to no triangle";
  EXPECT_EQ(largestDistance({}, Vector3d::Ones()), 0.0);
}

// --- topology

TEST(Topology, OfABoxBoundsASolid) {
  const MeshTopology topology = topologyOf(box({1, 1, 1}));
  EXPECT_TRUE(topology.boundsSolid());
  EXPECT_TRUE(topology.oriented);
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.euler_characteristic, 2);
}

TEST(Topology, SeesAMissingTriangle) {
  TriangleMesh mesh = box({1, 1, 1});
  mesh.triangles.pop_back();
  const MeshTopology topology = topologyOf(mesh);
  EXPECT_FALSE(topology.closed);
  EXPECT_FALSE(topology.outward);
  EXPECT_TRUE(topology.manifold) << "with a border";
  EXPECT_TRUE(topology.oriented);
}

TEST(Topology, SeesATurnedTriangle) {
  TriangleMesh mesh = box({1, 1, 1});
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  const MeshTopology topology = topologyOf(mesh);
  EXPECT_TRUE(topology.closed);
  EXPECT_TRUE(topology.manifold);
  EXPECT_FALSE(topology.oriented);
  EXPECT_FALSE(topology.outward);
}

TEST(Topology, SeesAMeshTurnedInsideOut) {
  TriangleMesh mesh = box({1, 1, 1});
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  EXPECT_TRUE(topologyOf(mesh).oriented);
  EXPECT_FALSE(topologyOf(mesh).outward);
}

TEST(Topology, ChecksEveryComponent) {
  TriangleMesh inward = tetrahedron({0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1});
  const TriangleMesh both = joined(box({1, 1, 1}), inward);
  EXPECT_EQ(topologyOf(both).components, 2u);
  EXPECT_EQ(topologyOf(both).euler_characteristic, 4);
  EXPECT_TRUE(topologyOf(both).outward);
  for (auto& t : inward.triangles) std::swap(t[0], t[1]);
  EXPECT_FALSE(topologyOf(joined(box({1, 1, 1}), inward)).outward) << "though the whole volume is positive";
}

// Two tetrahedra that share one vertex: each edge is fine, the vertex is not.
TEST(Topology, SeesAVertexWhereTwoSurfacesTouch) {
  TriangleMesh mesh = tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  for (const Vector3d& v : {Vector3d(-1, 0, 0), Vector3d(0, -1, 0), Vector3d(0, 0, -1)})
    mesh.vertices.push_back(v);
  for (const std::array<std::uint32_t, 3>& t :
       {std::array<std::uint32_t, 3>{0, 4, 5}, {0, 6, 4}, {4, 6, 5}, {5, 6, 0}}) {
    mesh.triangles.push_back(t);
  }
  EXPECT_TRUE(topologyOf(mesh).closed);
  EXPECT_FALSE(topologyOf(mesh).manifold);
}

// A third sheet on an edge of the box.
TEST(Topology, SeesAnEdgeWithThreeTriangles) {
  TriangleMesh mesh = box({1, 1, 1});
  mesh.vertices.push_back({-1, -1, 0.5});
  mesh.triangles.push_back({0, 4, 8});
  EXPECT_FALSE(topologyOf(mesh).manifold);
  EXPECT_FALSE(topologyOf(mesh).oriented);
  EXPECT_FALSE(topologyOf(mesh).closed);
}

TEST(Topology, OfNothingIsNothing) {
  const MeshTopology topology = topologyOf({});
  EXPECT_FALSE(topology.closed || topology.manifold || topology.oriented || topology.outward);
  EXPECT_EQ(topology.components, 0u);
}

TEST(Topology, RefusesTrianglesThatAreNone) {
  TriangleMesh mesh = box({1, 1, 1});
  mesh.triangles[5][1] = 8;
  EXPECT_THROW(topologyOf(mesh), InputError) << "there is no vertex 8";
  mesh.triangles[5] = {1, 1, 2};
  EXPECT_THROW(topologyOf(mesh), InputError);
}

}  // namespace
}  // namespace boxgrasp
