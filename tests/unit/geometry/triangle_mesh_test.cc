#include "boxgrasp/geometry/triangle_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

// Three triangles in the plane z = 1 of areas 1, 0 and 3, apart along x.
TriangleMesh flatMesh() {
  return {.vertices = {{0, 0, 1}, {2, 0, 1}, {0, 1, 1}, {10, 0, 1}, {12, 0, 1}, {10, 3, 1}},
          .triangles = {{0, 1, 2}, {0, 1, 1}, {3, 4, 5}}};
}

TEST(SampleSurface, SpreadsPointsByArea) {
  const PointCloud cloud = sampleSurface(flatMesh(), 4000, 1);
  ASSERT_EQ(cloud.size(), 4000u);
  int first = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) first += cloud.x[i] < 5.0f;
  EXPECT_NEAR(first, 1000, 1) << "expected a quarter of the points on a quarter of the area";
}

// The middle triangle of four equal ones must get a quarter of the points: the law for uniform density inside
// a triangle.
TEST(SampleSurface, IsUniformInsideATriangle) {
  const TriangleMesh mesh{.vertices = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, .triangles = {{0, 1, 2}}};
  const int n = 40000;
  const PointCloud cloud = sampleSurface(mesh, n, 7);
  int parts[4] = {};
  for (int i = 0; i < n; ++i) {
    ASSERT_TRUE(cloud.x[i] >= 0 && cloud.y[i] >= 0 && cloud.x[i] + cloud.y[i] <= 2.000001f);
    ++parts[cloud.x[i] > 1 ? 0 : cloud.y[i] > 1 ? 1 : cloud.x[i] + cloud.y[i] < 1 ? 2 : 3];
  }
  for (const int part : parts) EXPECT_NEAR(part, n / 4, 5.0 * std::sqrt(n / 4.0));
}

TEST(SampleSurface, IsSeeded) {
  EXPECT_EQ(sampleSurface(flatMesh(), 100, 3), sampleSurface(flatMesh(), 100, 3));
  EXPECT_NE(sampleSurface(flatMesh(), 100, 3), sampleSurface(flatMesh(), 100, 4));
  EXPECT_TRUE(sampleSurface(flatMesh(), 0, 3).empty());
}

TEST(SampleSurface, RefusesAMeshWithoutArea) {
  const TriangleMesh flat{.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, .triangles = {{0, 1, 2}}};
  const TriangleMesh bad{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, std::nan(""), 0}}, .triangles = {{0, 1, 2}}};
  EXPECT_THROW(sampleSurface(TriangleMesh(), 10, 1), InputError);
  EXPECT_THROW(sampleSurface(bad, 10, 1), InputError);
  try {
    sampleSurface(flat, 10, 1);
    FAIL() << "expected an InputError";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("1 triangles has the surface area 0 m^2"));
  }
}

}  // namespace
}  // namespace boxgrasp
