#include "boxgrasp/objects/polygonise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/objects/mesh_properties.h"

namespace boxgrasp {
namespace {

Eigen::AlignedBox3d cube(double half_size) {
  return {Vector3d::Constant(-half_size), Vector3d::Constant(half_size)};
}

void expectLaws(const Field& field, double volume, const std::string& what) {
  const TriangleMesh mesh = polygonise(field, cube(2.0), 0.05);
  EXPECT_TRUE(topologyOf(mesh).boundsSolid()) << what;
  EXPECT_NEAR(massPropertiesOf(mesh).volume, volume, 0.01 * volume) << what;
  double worst = 0.0;
  for (const Vector3d& v : mesh.vertices) worst = std::max(worst, std::abs(field(v)));
  EXPECT_LT(worst, 0.02) << what << ": vertices lie on the surface, hubs of odd patches near it";
}

TEST(Polygonise, EnclosesTheVolumeOfTheFormula) {
  const Vector3d z = Vector3d::UnitZ(), o = Vector3d::Zero();
  expectLaws(sphere({0.1, 0.2, -0.3}, 1.2), 4.0 / 3.0 * M_PI * std::pow(1.2, 3), "sphere");
  expectLaws(ellipsoid(o, {1.5, 1.0, 0.7}), 4.0 / 3.0 * M_PI * 1.5 * 0.7, "ellipsoid");
  expectLaws(capsule({0, 0, -0.7}, {0, 0, 0.7}, 0.8), M_PI * 0.64 * 1.4 + 4.0 / 3.0 * M_PI * 0.512,
             "capsule");
  expectLaws(roundedCylinder(o, z, 1.0, 1.3, 0.02), M_PI * 2.6, "cylinder");
  expectLaws(roundedBox(o, {1.1, 0.6, 0.9}, 0.02), 8 * 1.1 * 0.6 * 0.9, "box");
  expectLaws(torus(o, z, 1.2, 0.4), 2 * M_PI * M_PI * 1.2 * 0.16, "torus");
  expectLaws(revolved({{0, -1}, {1.2, -1}, {0, 1.4}}, 0.0), M_PI * 1.44 * 2.4 / 3.0, "cone of revolution");
  expectLaws(subtract(sphere(o, 1.5), sphere({0, 0, 5}, 1.0), 1e-6), 4.0 / 3.0 * M_PI * 3.375,
             "nothing cut away");
}

TEST(Polygonise, BooleansAddUp) {
  const Field a = sphere({-0.4, 0, 0}, 0.9), b = roundedBox({0.5, 0, 0}, {0.7, 0.6, 0.8}, 0.05);
  const auto volume = [](const Field& f) { return massPropertiesOf(polygonise(f, cube(2.0), 0.04)).volume; };
  const double difference = volume(subtract(a, b, 1e-6));
  EXPECT_NEAR(volume(unite({a, b})), difference + volume(b), 0.01);
  EXPECT_GT(volume(blend({a, b}, 0.3)), volume(unite({a, b}))) << "a fillet adds";
}

TEST(Polygonise, PosesMoveTheShape) {
  const Pose X_AB =
      makePose(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix(), {0.2, -0.3, 0.4});
  const Field box = roundedBox({0.1, 0.2, 0.3}, {0.9, 0.5, 0.3}, 0.1);
  const MassProperties at_B = massPropertiesOf(polygonise(box, cube(2.0), 0.04));
  const MassProperties at_A = massPropertiesOf(polygonise(moved(box, X_AB), cube(2.0), 0.04));
  EXPECT_NEAR(at_A.volume, at_B.volume, 0.01 * at_B.volume);
  EXPECT_LT((at_A.center_M - X_AB * at_B.center_M).norm(), 5e-3);
}

// All 256 cases and their meetings: random signs on a lattice, with every ambiguous face there is.
TEST(Polygonise, IsAClosedManifoldForRandomSigns) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Field noise = [seed](const Vector3d& p) {
      if (p.cwiseAbs().maxCoeff() > 7.5) return 1.0;
      const Eigen::Vector3i n = p.array().round().cast<int>();
      std::mt19937_64 random(seed * 1'000'003 +
                             static_cast<std::uint64_t>((n.x() + 8) * 4096 + (n.y() + 8) * 64 + n.z() + 8));
      random.discard(3);
      return uniform(random, -1.0, 1.0);
    };
    const MeshTopology topology = topologyOf(polygonise(noise, cube(8.0), 1.0));
    EXPECT_TRUE(topology.closed) << "seed " << seed;
    EXPECT_TRUE(topology.manifold) << "seed " << seed;
    EXPECT_TRUE(topology.oriented) << "seed " << seed;
    EXPECT_GT(topology.components, 1u) << "seed " << seed;
  }
}

TEST(Polygonise, OfNothingIsEmpty) {
  EXPECT_TRUE(polygonise(sphere(Vector3d::Constant(100.0), 1.0), cube(1.0), 0.1).triangles.empty());
}

TEST(Polygonise, RefusesAShapeThatReachesItsBounds) {
  EXPECT_THROW(polygonise(sphere(Vector3d::Zero(), 1.01), cube(1.0), 0.1), InputError);
}

TEST(Polygonise, RefusesTooManyCells) {
  EXPECT_THROW(polygonise(sphere(Vector3d::Zero(), 1.0), cube(2.0), 1e-5), InputError);
}

TEST(Smoothed, KeepsTheEndsAndTheStraight) {
  const std::vector<double> line = smoothed<double>({0.0, 1.0, 2.0, 3.0});
  EXPECT_EQ(line.front(), 0.0);
  EXPECT_EQ(line.back(), 3.0);
  EXPECT_TRUE(std::is_sorted(line.begin(), line.end()));
  for (const Vector2d& p : smoothed<Vector2d>({{0, 0}, {2, 1}, {4, 2}})) EXPECT_NEAR(p.y(), p.x() / 2, 1e-15);
}

}  // namespace
}  // namespace boxgrasp
