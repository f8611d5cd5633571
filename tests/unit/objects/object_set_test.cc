#include "boxgrasp/objects/object_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <numbers>

#include "boxgrasp/base/error.h"
#include "boxgrasp/objects/mesh_simplify.h"
#include "boxgrasp/objects/parametric.h"
#include "boxgrasp/objects/polygonise.h"

namespace boxgrasp {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

TriangleMesh box(const Vector3d& size) {
  TriangleMesh mesh;
  for (int c = 0; c < 8; ++c) mesh.vertices.push_back(size.cwiseProduct(Vector3d(c & 1, c >> 1 & 1, c >> 2)));
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

TriangleMesh ball(double radius, double cell) {
  const Vector3d corner = Vector3d::Constant(radius + 2 * cell);
  return polygonise(sphere(Vector3d::Zero(), radius), {-corner, corner}, cell);
}

// A folder of one test, gone after it.
class MeshFolder : public ::testing::Test {
 protected:
  MeshFolder() {
    std::string name = (fs::temp_directory_path() / "boxgrasp-objects-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~MeshFolder() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  fs::path writeOff(const std::string& name, const TriangleMesh& mesh) const {
    std::ofstream out(folder_ / name);
    out.precision(17);
    out << "OFF\n" << mesh.vertices.size() << " " << mesh.triangles.size() << " 0\n";
    for (const Vector3d& v : mesh.vertices) out << v.x() << " " << v.y() << " " << v.z() << "\n";
    for (const auto& t : mesh.triangles) out << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
    return folder_ / name;
  }

  static ObjectSource source(const fs::path& file) {
    ObjectSource source;
    source.name = file.stem();
    source.file = file;
    return source;
  }

  // The message with which the mesh is refused.
  std::string refusal(const TriangleMesh& mesh) const { return refusalOf(writeOff("bad.off", mesh)); }
  static std::string refusalOf(const fs::path& file) {
    try {
      loadObject(source(file));
    } catch (const InputError& error) {
      return error.what();
    }
    return "was not refused";
  }

  fs::path folder_;
};

TEST(BuiltinObjects, AreEveryObjectInEveryScale) {
  const std::vector<ObjectSource> sources = builtinObjects({0.8, 1.0, 1.2});
  EXPECT_EQ(sources.size(), 3 * parametricNames().size());
  EXPECT_GE(parametricNames().size(), 14u);
  EXPECT_THROW(builtinObjects({}), InputError);
  EXPECT_THROW(builtinObjects({1.0, -1.0}), InputError);
}

TEST(PaperObjects, CanAllBeBuilt) {
  const std::vector<std::string> names = parametricNames();
  const std::vector<ObjectSource> sources = paperObjects({1.0});
  EXPECT_EQ(sources.size(), 17u);
  for (const ObjectSource& source : sources) EXPECT_THAT(names, ::testing::Contains(source.name));
}

// Volume grows with the cube of the scale, the inertia with its fifth power.
TEST(LoadObject, ScalesMassPropertiesByTheirLaws) {
  ObjectSource duck;
  duck.name = "duck";
  const MassProperties once = loadObject(duck).solid;
  duck.scale = 1.5;
  const MassProperties larger = loadObject(duck).solid;
  EXPECT_NEAR(larger.volume, std::pow(1.5, 3) * once.volume, 1e-12 * larger.volume);
  EXPECT_LT((larger.center_M - 1.5 * once.center_M).norm(), 1e-12);
  EXPECT_LT((larger.inertia_M - std::pow(1.5, 5) * once.inertia_M).norm(), 1e-12 * larger.inertia_M.norm());
}

TEST_F(MeshFolder, IsReadInTheOrderOfNames) {
  const TriangleMesh cube = box(Vector3d::Constant(0.1));
  writeOff("b.off", cube);
  writeOff("a.OFF", cube);
  write("notes.txt", "no mesh");
  MeshFolderOptions options;
  options.scales = {1.0, 2.0};
  const std::vector<ObjectSource> sources = meshFolder(folder_, options);
  ASSERT_EQ(sources.size(), 4u);
  EXPECT_EQ(sources[0].name, "a");
  EXPECT_EQ(sources[1].name, "a");
  EXPECT_EQ(sources[1].scale, 2.0);
  EXPECT_EQ(sources[2].name, "b");
  EXPECT_NEAR(loadObject(sources[3]).solid.volume, 0.008, 1e-12);
}

TEST_F(MeshFolder, WithoutMeshesIsRefusedWithTheEndingsThatAreRead) {
  const auto message = [&](const fs::path& folder) -> std::string {
    try {
      meshFolder(folder);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message(folder_),
              AllOf(HasSubstr(".off"), HasSubstr(".obj"), HasSubstr(".stl"), HasSubstr(".ply")));
  EXPECT_THAT(message(folder_ / "nowhere"), HasSubstr("nowhere"));
}

TEST_F(MeshFolder, TargetSizeIsTheLongestSide) {
  ObjectSource cube = source(writeOff("cube.off", box({20, 30, 50})));
  cube.target_size_m = 0.1;
  EXPECT_NEAR(loadObject(cube).solid.volume, 0.04 * 0.06 * 0.1, 1e-15);
  cube.scale = 0.5;
  EXPECT_NEAR(loadObject(cube).solid.volume, 0.04 * 0.06 * 0.1 / 8, 1e-15);
}

TEST_F(MeshFolder, GoodMeshesStayAsTheyAre) {
  const TriangleMesh mesh = box({0.1, 0.2, 0.3});
  const LoadedObject object = loadObject(source(writeOff("box.off", mesh)));
  EXPECT_TRUE(object.repairs.empty());
  EXPECT_EQ(object.mesh_O.triangles, mesh.triangles);
  EXPECT_EQ(object.mesh_O.vertices, mesh.vertices);
}

// As in STL: each triangle has its own three vertices.
TEST_F(MeshFolder, SeparateTrianglesAreWelded) {
  const TriangleMesh mesh = box({0.1, 0.2, 0.3});
  TriangleMesh soup;
  for (const auto& t : mesh.triangles) {
    const auto n = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t) soup.vertices.push_back(mesh.vertices[v]);
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  const LoadedObject object = loadObject(source(writeOff("soup.off", soup)));
  EXPECT_EQ(object.mesh_O.vertices.size(), 8u);
  EXPECT_NEAR(object.solid.volume, 0.006, 1e-15);
  ASSERT_EQ(object.repairs.size(), 1u);
  EXPECT_THAT(object.repairs[0], HasSubstr("28 vertices"));
}

// Two cubes that share a corner's place, but no vertex, are two good solids.
TEST_F(MeshFolder, PartsThatTouchStayApart) {
  TriangleMesh both = box(Vector3d::Constant(0.1));
  const TriangleMesh one = both;
  for (const Vector3d& v : one.vertices) both.vertices.push_back(v + Vector3d::Constant(0.1));
  for (const auto& t : one.triangles) both.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  EXPECT_NEAR(loadObject(source(writeOff("two.off", both))).solid.volume, 0.002, 1e-15);
}

TEST_F(MeshFolder, TurnedTrianglesAreTurnedBack) {
  TriangleMesh mesh = box({0.1, 0.2, 0.3});
  for (const std::size_t t : {1u, 5u, 6u}) std::swap(mesh.triangles[t][0], mesh.triangles[t][2]);
  const LoadedObject some = loadObject(source(writeOff("some.off", mesh)));
  EXPECT_NEAR(some.solid.volume, 0.006, 1e-15);
  ASSERT_EQ(some.repairs.size(), 1u);
  mesh = box({0.1, 0.2, 0.3});
  for (auto& t : mesh.triangles) std::swap(t[0], t[2]);
  const LoadedObject all = loadObject(source(writeOff("all.off", mesh)));
  EXPECT_NEAR(all.solid.volume, 0.006, 1e-15);
  ASSERT_EQ(all.repairs.size(), 1u);
  EXPECT_THAT(all.repairs[0], HasSubstr("12 triangles"));
}

TEST_F(MeshFolder, OpenMeshIsRefusedWithItsOpenEdges) {
  TriangleMesh mesh = box(Vector3d::Constant(0.1));
  mesh.triangles.pop_back();
  EXPECT_THAT(refusal(mesh), AllOf(HasSubstr("bad.off"), HasSubstr("open"), HasSubstr("3 edges")));
}

TEST_F(MeshFolder, BowTieIsRefused) {
  TriangleMesh both = box(Vector3d::Constant(0.1));
  const TriangleMesh one = both;
  for (const Vector3d& v : one.vertices) both.vertices.push_back(v + Vector3d::Constant(0.1));
  for (auto t : one.triangles) {
    for (std::uint32_t& v : t) v = v == 0 ? 7 : v + 8;
    both.triangles.push_back(t);
  }
  EXPECT_THAT(refusal(both), HasSubstr("touch"));
}

TEST_F(MeshFolder, MillimetresAreSuspectedAndTheRemedyNamed) {
  EXPECT_THAT(refusal(box({100, 200, 300})), AllOf(HasSubstr("300 m"), HasSubstr("0.001")));
  ObjectSource cube = source(writeOff("mm.off", box({100, 200, 300})));
  cube.unit_m = 0.001;
  EXPECT_NEAR(loadObject(cube).solid.volume, 0.006, 1e-15);
}

TEST_F(MeshFolder, FlatEmptyAndBrokenFilesAreRefusedByName) {
  EXPECT_THAT(refusal(box({0.1, 0.1, 0.0})), HasSubstr("volume"));
  EXPECT_THAT(refusalOf(write("empty.stl", "")), AllOf(HasSubstr("empty.stl"), HasSubstr("empty")));
  EXPECT_THAT(refusalOf(write("nan.off", "OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n")),
              HasSubstr("nan.off"));
  EXPECT_THAT(refusalOf(folder_ / "gone.ply"), HasSubstr("gone.ply"));
}

// A sphere keeps its volume, its place and its genus when nine tenths of its triangles go.
TEST(Simplify, KeepsTheShape) {
  const TriangleMesh fine = ball(0.05, 0.0015);
  const TriangleMesh coarse = simplified(fine, fine.triangles.size() / 10);
  const MeshTopology topology = topologyOf(coarse);
  EXPECT_LE(coarse.triangles.size(), fine.triangles.size() / 10);
  EXPECT_GE(coarse.triangles.size(), fine.triangles.size() / 12);
  EXPECT_TRUE(topology.boundsSolid());
  EXPECT_EQ(topology.euler_characteristic, 2);
  const MassProperties mass = massPropertiesOf(coarse);
  EXPECT_NEAR(mass.volume, 4.0 / 3.0 * kPi * std::pow(0.05, 3), 0.02 * mass.volume);
  EXPECT_LT(mass.center_M.norm(), 5e-4);
  for (const Vector3d& v : coarse.vertices) EXPECT_NEAR(v.norm(), 0.05, 1e-5);
}

TEST(Simplify, KeepsTheHandleOfAMug) {
  const TriangleMesh mug = parametricObject("mug");
  const TriangleMesh coarse = simplified(mug, 4000);
  EXPECT_LE(coarse.triangles.size(), 4000u);
  EXPECT_TRUE(topologyOf(coarse).boundsSolid());
  EXPECT_EQ(topologyOf(coarse).euler_characteristic, 0);
  const double volume = massPropertiesOf(mug).volume;
  EXPECT_NEAR(massPropertiesOf(coarse).volume, volume, 0.05 * volume);
}

TEST(Simplify, NeverEndsWithLessThanATetrahedron) {
  const TriangleMesh least = simplified(ball(0.05, 0.01), 0);
  EXPECT_GE(least.triangles.size(), 4u);
  EXPECT_TRUE(topologyOf(least).closed);
}

TEST(Simplify, StopsWhenTold) {
  const StopToken stop{StopToken::Clock::now()};
  EXPECT_THROW(simplified(ball(0.05, 0.005), 100, stop), Stopped);
}

TEST_F(MeshFolder, MeshOfManyTrianglesIsSimplified) {
  const TriangleMesh fine = ball(0.05, 0.0008);
  ASSERT_GT(fine.triangles.size(), 100'000u);
  const LoadedObject object = loadObject(source(writeOff("fine.off", fine)));
  EXPECT_LE(object.mesh_O.triangles.size(), 100'000u);
  ASSERT_EQ(object.repairs.size(), 1u);
  EXPECT_THAT(object.repairs[0], HasSubstr("simplified"));
  EXPECT_NEAR(object.solid.volume, 4.0 / 3.0 * kPi * std::pow(0.05, 3), 1e-3 * object.solid.volume);
}

}  // namespace
}  // namespace boxgrasp
