#include "boxgrasp/objects/parametric.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <map>
#include <set>

#include "boxgrasp/base/error.h"
#include "boxgrasp/objects/mesh_properties.h"

namespace boxgrasp {
namespace {

using ::testing::HasSubstr;

const TriangleMesh& built(const std::string& name) {
  static std::map<std::string, TriangleMesh> meshes;
  auto [mesh, is_new] = meshes.try_emplace(name);
  if (is_new) mesh->second = parametricObject(name);
  return mesh->second;
}

Eigen::AlignedBox3d boundsOf(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : mesh.vertices) box.extend(v);
  return box;
}

// How often the ray from p along `direction` crosses the surface.
int crossings(const TriangleMesh& mesh, const Vector3d& p, const Vector3d& direction) {
  int count = 0;
  for (const auto& t : mesh.triangles) {
    Matrix3d edges;
    edges << mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]], -direction;
    const Vector3d at = edges.inverse() * (p - mesh.vertices[t[0]]);
    count += at.allFinite() && at.minCoeff() >= 0.0 && at.x() + at.y() <= 1.0;
  }
  return count;
}

bool isInside(const TriangleMesh& mesh, const Vector3d& p_mm) {
  return crossings(mesh, 1e-3 * p_mm, Vector3d(0.3141, 0.2718, 0.9093)) % 2 == 1;
}

class EachObject : public ::testing::TestWithParam<std::string> {
 protected:
  const TriangleMesh& mesh() const { return built(GetParam()); }
};

TEST_P(EachObject, IsOneClosedOutwardManifold) {
  const MeshTopology topology = topologyOf(mesh());
  EXPECT_TRUE(topology.closed);
  EXPECT_TRUE(topology.manifold);
  EXPECT_TRUE(topology.oriented);
  EXPECT_TRUE(topology.outward);
  EXPECT_EQ(topology.components, 1u);
}

// One hole for each handle, and for the ring's; none elsewhere.
TEST_P(EachObject, HasAHoleForEachHandle) {
  static const std::set<std::string> with_one_hole = {"mug", "cup", "radio", "teapot", "torus"};
  EXPECT_EQ(topologyOf(mesh()).euler_characteristic, with_one_hole.contains(GetParam()) ? 0 : 2);
}

TEST_P(EachObject, HasASizeThatAHandCanGrasp) {
  const Eigen::AlignedBox3d box = boundsOf(mesh());
  EXPECT_GE(box.sizes().maxCoeff(), 0.05);
  EXPECT_LE(box.sizes().maxCoeff(), 0.25);
  EXPECT_GE(box.sizes().minCoeff(), 0.01);
  EXPECT_LE(box.sizes().minCoeff(), 0.20);
  EXPECT_EQ(box.min().z(), 0.0) << "stands on z = 0";
  EXPECT_TRUE((box.min().head(2).array() < 0.0).all() && (box.max().head(2).array() > 0.0).all())
      << "about the z axis";
}

TEST_P(EachObject, HasAPlausibleSolid) {
  const MassProperties mass = massPropertiesOf(mesh());
  const Eigen::AlignedBox3d box = boundsOf(mesh());
  EXPECT_GT(mass.volume, 0.03 * box.volume());
  EXPECT_LT(mass.volume, 0.8 * box.volume());
  EXPECT_TRUE(box.contains(mass.center_M));
  const Vector3d moments = Eigen::SelfAdjointEigenSolver<Matrix3d>(mass.inertia_M).eigenvalues();
  EXPECT_GT(moments[0], 0.0);
  EXPECT_GT(moments[0] + moments[1], moments[2])
      << "a solid's moments of inertia keep the triangle inequality";
}

TEST_P(EachObject, StaysBelow100000Triangles) {
  EXPECT_GT(mesh().triangles.size(), 5'000u);
  EXPECT_LT(mesh().triangles.size(), 100'000u);
  EXPECT_NEAR(static_cast<double>(mesh().vertices.size()), 0.5 * static_cast<double>(mesh().triangles.size()),
              2.0);
}

// Points of a surface sample have air on one side: a step along the outward normal never lies inside, a step
// against it does.
TEST_P(EachObject, HasASurfaceBetweenInsideAndOutside) {
  const std::size_t stride = mesh().triangles.size() / 6;
  for (std::size_t i = 0; i < mesh().triangles.size(); i += stride) {
    const auto& t = mesh().triangles[i];
    const Vector3d &a = mesh().vertices[t[0]], &b = mesh().vertices[t[1]], &c = mesh().vertices[t[2]];
    const Vector3d normal = (b - a).cross(c - a).normalized(), middle = (a + b + c) / 3.0;
    EXPECT_FALSE(isInside(mesh(), 1e3 * (middle + 1e-5 * normal))) << "triangle " << i;
    EXPECT_TRUE(isInside(mesh(), 1e3 * (middle - 1e-5 * normal))) << "triangle " << i;
  }
}

TEST_P(EachObject, GivesAPointCloud) {
  const PointCloud cloud = sampleSurface(mesh(), 500, 1);
  ASSERT_EQ(cloud.size(), 500u);
  Eigen::AlignedBox3d box = boundsOf(mesh());
  box.min().array() -= 1e-6;
  box.max().array() += 1e-6;
  for (std::size_t i = 0; i < cloud.size(); ++i) EXPECT_TRUE(box.contains(cloud.point(i))) << "point " << i;
}

INSTANTIATE_TEST_SUITE_P(Objects, EachObject, ::testing::ValuesIn(parametricNames()),
                         [](const auto& parameter) { return parameter.param; });

TEST(ParametricObject, HasAtLeast16DifferentNames) {
  const std::vector<std::string> names = parametricNames();
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  EXPECT_GE(names.size(), 16u);
}

TEST(ParametricObject, MugHasACavityWallsAFloorAndAHandle) {
  const TriangleMesh& mug = built("mug");
  EXPECT_FALSE(isInside(mug, {1, 2, 50})) << "the cavity";
  EXPECT_FALSE(isInside(mug, {1, 2, 89})) << "open at the top";
  EXPECT_TRUE(isInside(mug, {1, 2, 3})) << "the floor";
  EXPECT_TRUE(isInside(mug, {-38.7, 0.1, 50})) << "the wall";
  EXPECT_TRUE(isInside(mug, {66, 0.1, 46})) << "the handle";
  EXPECT_FALSE(isInside(mug, {50, 0.1, 46})) << "room for a finger";
  EXPECT_FALSE(isInside(mug, {33, 0.1, 68})) << "the handle does not reach into the cavity";
}

TEST(ParametricObject, VesselsAreOpen) {
  const std::map<std::string, double> level_mm = {
      {"cup", 50}, {"goblet", 140}, {"paper_cup", 60}, {"bowl", 50}};
  for (const auto& [name, z] : level_mm) {
    EXPECT_EQ(crossings(built(name), {0.0011, 0.0007, 1e-3 * z}, Vector3d::UnitZ()), 0)
        << name << " is open upwards";
    EXPECT_GE(crossings(built(name), {0.0011, 0.0007, 1e-3 * z}, -Vector3d::UnitZ()), 2)
        << name << " has a floor";
    EXPECT_EQ(crossings(built(name), {0.0011, 0.0007, 1e-3 * z}, -Vector3d::UnitX()), 2)
        << name << " has a wall";
  }
}

// Pappus: the volume of a torus of radii R and r is 2 pi^2 R r^2, its surface 4 pi^2 R r.
TEST(ParametricObject, TorusHasTheVolumeOfTheFormula) {
  const double pi2 = M_PI * M_PI;
  EXPECT_NEAR(massPropertiesOf(built("torus")).volume, 2 * pi2 * 0.05 * 0.016 * 0.016, 0.005 * 2.5e-4);
  EXPECT_NEAR(surfaceArea(built("torus")), 4 * pi2 * 0.05 * 0.016, 0.005 * 3.2e-2);
}

TEST(ParametricObject, ScalesAboutTheOrigin) {
  const TriangleMesh half = parametricObject("heart", 0.5);
  ASSERT_EQ(half.vertices.size(), built("heart").vertices.size());
  for (std::size_t i = 0; i < half.vertices.size(); ++i) {
    ASSERT_LT((half.vertices[i] - 0.5 * built("heart").vertices[i]).norm(), 1e-15) << "vertex " << i;
  }
}

TEST(ParametricObject, IsTheSameToTheBitAgain) {
  EXPECT_EQ(parametricObject("pen").vertices, built("pen").vertices);
  EXPECT_EQ(parametricObject("pen").triangles, built("pen").triangles);
}

TEST(ParametricObject, RefusesAnUnknownNameAndListsTheKnown) {
  try {
    parametricObject("spoon");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("'spoon'"));
    for (const std::string& name : parametricNames()) EXPECT_THAT(error.what(), HasSubstr(name));
  }
}

TEST(ParametricObject, RefusesABadScale) {
  for (const double scale : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(parametricObject("pen", scale), InputError) << scale;
  }
}

}  // namespace
}  // namespace boxgrasp
