#include "boxgrasp/cloud/read_cloud.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "boxgrasp/base/error.h"
#include "sample_files.h"

namespace boxgrasp {
namespace {

using sample_files::SampleFile;
using testing::AllOf;
using testing::HasSubstr;

// Few samples, and limits that no valid sample file reaches.
ReadOptions quick() {
  ReadOptions options;
  options.mesh_samples = 20;
  options.max_points = 10'000;
  return options;
}

LoadedCloud parse(const std::string& bytes, const std::string& name, const ReadOptions& options = quick()) {
  return parseCloud(bytes, name, options);
}

// The message with which bytes are refused; empty, and a failure, when they are not.
std::string refusal(const std::string& bytes, const std::string& name, const ReadOptions& options = quick()) {
  try {
    parse(bytes, name, options);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << name << " was accepted, but should be refused:\n" << bytes.substr(0, 300);
  return {};
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, text.npos) << "the sample lacks " << from;
  return at == text.npos ? text : text.replace(at, from.size(), to);
}

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "boxgrasp_XXXXXX").string();
    path = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path); }

  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path / name, std::ios::binary) << bytes;
    return path / name;
  }
  std::filesystem::path path;
};

TEST(ReadCloud, EveryFormatGivesTheSamePoints) {
  const TemporaryFolder folder;
  for (const SampleFile& file : sample_files::clouds()) {
    const LoadedCloud loaded = readCloud(folder.write(file.name, file.bytes), quick());
    EXPECT_EQ(loaded.cloud_C, sample_files::points()) << file.name;
    EXPECT_EQ(loaded.format, file.format) << file.name;
    EXPECT_FALSE(loaded.sampled_from_mesh) << file.name;
  }
}

TEST(ReadCloud, ContentTellsTheFormatWhereTheNameMisleads) {
  EXPECT_EQ(parse(sample_files::pcdBinary(), "cloud.xyz").format, "pcd binary");
  EXPECT_EQ(parse(sample_files::plyAscii(false), "cloud.pcd").format, "ply");
  EXPECT_EQ(parse(sample_files::off(), "mesh").format, "off");
  EXPECT_EQ(parse(sample_files::stlBinary(), "mesh").format, "stl");
  EXPECT_THAT(refusal("1 2 3\n", "cloud.dat"), AllOf(HasSubstr("cloud.dat"), HasSubstr(".pcd")));
}

TEST(ReadCloud, WindowsLineEndsAndUpperCaseNamesAreRead) {
  std::string bytes;
  for (const char c : sample_files::pcdAscii()) bytes += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(parse(bytes, "a.PCD").cloud_C, sample_files::points());
  bytes.clear();
  for (const char c : sample_files::plyAscii(false))
    bytes += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(parse(bytes, "a.ply").cloud_C, sample_files::points());
  EXPECT_EQ(parse("1 2 3\n", "A.XYZ").cloud_C.size(), 1u);
}

TEST(ReadCloud, PcdLabelsAndViewpointAreRead) {
  for (const auto& bytes :
       {sample_files::pcdAscii(), sample_files::pcdBinary(), sample_files::pcdCompressed()}) {
    const LoadedCloud loaded = parse(bytes, "a.pcd");
    EXPECT_THAT(loaded.labels, testing::ElementsAre(7, 8, 9, 10, 11, 12, 13, 14, 15));
    ASSERT_TRUE(loaded.viewpoint_C);
    EXPECT_EQ(*loaded.viewpoint_C, Vector3d(0.5, 0, -1));
  }
}

TEST(ReadCloud, AnUnknownViewpointIsNoViewpointUnlessTheCloudIsOrganised) {
  const std::string organised = replaced(sample_files::pcdAscii(), "VIEWPOINT 0.5 0 -1", "VIEWPOINT 0 0 0");
  EXPECT_EQ(parse(organised, "a.pcd").viewpoint_C, Vector3d(0, 0, 0));
  const std::string loose = replaced(replaced(organised, "WIDTH 3", "WIDTH 9"), "HEIGHT 3", "HEIGHT 1");
  EXPECT_FALSE(parse(loose, "a.pcd").viewpoint_C);
}

TEST(ReadCloud, NonFinitePointsOfOrganisedCloudsStay) {
  const LoadedCloud loaded =
      parse(replaced(sample_files::pcdAscii(), "0.000000 0.000000 -0.500000", "nan nan nan"), "a.pcd");
  ASSERT_EQ(loaded.cloud_C.size(), 9u);
  EXPECT_TRUE(std::isnan(loaded.cloud_C.x[0]));
  EXPECT_EQ(loaded.cloud_C.x[1], 0.25f);
}

TEST(ReadCloud, ScaleMultipliesPointsAndViewpoint) {
  ReadOptions options = quick();
  options.scale = 0.5;
  const LoadedCloud loaded = parse(sample_files::pcdBinary(), "a.pcd", options);
  for (std::size_t i = 0; i < 9; ++i)
    EXPECT_EQ(loaded.cloud_C.point(i), 0.5 * sample_files::points().point(i));
  EXPECT_EQ(*loaded.viewpoint_C, Vector3d(0.25, 0, -0.5));
}

TEST(ReadMesh, EveryFormatGivesAClosedTetrahedron) {
  const TemporaryFolder folder;
  for (const SampleFile& file : sample_files::meshes()) {
    if (file.format == "ply") continue;
    const TriangleMesh mesh = readMesh(folder.write(file.name, file.bytes), quick());
    EXPECT_EQ(mesh.vertices.size(), 4u) << file.name;
    ASSERT_EQ(mesh.triangles.size(), 4u) << file.name;
    double six_volumes = 0.0;  // by the divergence theorem, positive when all triangles face outwards
    for (const auto& [a, b, c] : mesh.triangles) {
      six_volumes += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c]));
    }
    EXPECT_DOUBLE_EQ(six_volumes, 1.0) << file.name;
  }
}

TEST(ReadMesh, PolygonsAreCutIntoFans) {
  for (const auto& bytes : {sample_files::plyAscii(true), sample_files::plyBinary(false, true),
                            sample_files::plyBinary(true, true)}) {
    const TriangleMesh mesh = parseMesh(bytes, "a.ply", quick());
    using Triangle = std::array<std::uint32_t, 3>;
    EXPECT_THAT(mesh.triangles,
                testing::ElementsAre(Triangle{0, 1, 4}, Triangle{0, 4, 3}, Triangle{4, 5, 8}));
  }
}

TEST(ReadMesh, APointCloudIsNoMesh) {
  EXPECT_THROW(parseMesh(sample_files::pcdAscii(), "a.pcd", quick()), InputError);
  EXPECT_THROW(parseMesh(sample_files::plyAscii(false), "a.ply", quick()), InputError);
}

TEST(ReadCloud, MeshesAreSampledOnTheirSurface) {
  for (const SampleFile& file : sample_files::meshes()) {
    const LoadedCloud loaded = parse(file.bytes, file.name);
    EXPECT_TRUE(loaded.sampled_from_mesh) << file.name;
    EXPECT_EQ(loaded.cloud_C.size(), 20u) << file.name;
    if (file.format == "ply") continue;
    for (std::size_t i = 0; i < 20; ++i) {
      const Vector3d p = loaded.cloud_C.point(i);
      EXPECT_NEAR(std::min(p.minCoeff(), 1.0 - p.sum()), 0.0, 1e-6)
          << file.name << ": a point off the surface";
    }
  }
}

TEST(ReadCloud, WhatIsNoFileIsRefused) {
  const TemporaryFolder folder;
  const auto message = [](const std::filesystem::path& path) {
    try {
      readCloud(path);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(message(folder.path / "none.pcd"), AllOf(HasSubstr("none.pcd"), HasSubstr("no such file")));
  EXPECT_THAT(message(folder.path), HasSubstr("is a directory"));
  EXPECT_THAT(message(folder.write("empty.pcd", "")), AllOf(HasSubstr("empty.pcd"), HasSubstr("is empty")));
  ASSERT_EQ(mkfifo((folder.path / "pipe.pcd").c_str(), 0600), 0);
  EXPECT_THAT(message(folder.path / "pipe.pcd"), HasSubstr("not a regular file"));
  ReadOptions small;
  small.max_file_bytes = 10;
  EXPECT_THROW(readCloud(folder.write("large.xyz", "1 2 3\n4 5 6\n"), small), InputError);
}

TEST(ReadCloud, OneByteIsRefusedUnderEveryName) {
  for (const char* name : {"a.pcd", "a.ply", "a.xyz", "a.off", "a.obj", "a.stl", "a"}) {
    for (int byte = 0; byte < 256; ++byte)
      EXPECT_THAT(refusal(std::string(1, static_cast<char>(byte)), name), HasSubstr(name));
  }
}

TEST(ReadCloud, DamagedPcdHeadersAreRefusedByName) {
  const struct {
    const char *from, *to, *message;
  } cases[] = {
      {"POINTS 9", "POINTS 8", "POINTS is 8"},
      {"POINTS 9", "POINTS -9", "'-9'"},
      {"WIDTH 3", "WIDTH 18446744073709551615", "POINTS is 9"},
      {"WIDTH 3", "WIDTH", "WIDTH is missing"},
      {"HEIGHT 3\n", "", "lacks HEIGHT"},
      {"HEIGHT 3", "HEIGHT 0", "POINTS is 9"},
      {"HEIGHT 3", "HEIGHT 3\nHEIGHT 3", "twice"},
      {"FIELDS x y z", "FIELDS x y w", "name z once"},
      {"FIELDS x y z label", "FIELDS x y z z", "name z once"},
      {"SIZE 4 4 4 4", "SIZE 4 4 4", "SIZE has fewer"},
      {"SIZE 4 4 4 4", "SIZE 4 4 4 4 4", "SIZE has more"},
      {"SIZE 4 4 4 4", "SIZE 4 4 4 3", "TYPE U and SIZE 3"},
      {"SIZE 4 4 4 4", "SIZE 4 4 2 4", "TYPE F and SIZE 2"},
      {"SIZE 4 4 4 4", "SIZE 4 4 4 99", "'99'"},
      {"TYPE F F F U", "TYPE F F F X", "'X'"},
      {"TYPE F F F U", "TYPE I F F U", "field x has TYPE I"},
      {"COUNT 1 1 1 1", "COUNT 1 1 1 99999999", "'99999999'"},
      {"COUNT 1 1 1 1", "COUNT 1 1 2 1", "COUNT 2"},
      {"VIEWPOINT 0.5", "VIEWPOINT a", "'a'"},
      {"VIEWPOINT 0.5", "VIEWPOINT nan", "not finite"},
      {"DATA ascii", "DATA base64", "'base64'"},
      {"DATA ascii", "DOTA ascii", "'DOTA'"},
      {"-0.500000 7", "-0.5x 7", "'-0.5x'"},
      {"-0.500000 7", "-0.5", "fewer than 4 values"},
      {"-0.500000 7", "-0.5 7 7", "more than 4 values"},
      {"-0.500000 7", "-0.5 -7", "'-7'"},
  };
  for (const auto& [from, to, message] : cases) {
    EXPECT_THAT(refusal(replaced(sample_files::pcdAscii(), from, to), "a.pcd"),
                AllOf(HasSubstr("a.pcd: line "), HasSubstr(message)));
  }
  EXPECT_THAT(refusal(sample_files::pcdAscii() + "1 2 3 4\n", "a.pcd"),
              HasSubstr("goes on after its 9 points"));
}

TEST(ReadCloud, TextNamedPcdIsRefused) {
  EXPECT_THAT(refusal("Hello, this is a text.\n", "a.pcd"),
              AllOf(HasSubstr("line 1"), HasSubstr("'Hello,'")));
  EXPECT_THAT(refusal("FIELDS of corn\n", "a.pcd"), HasSubstr("truncated"));
}

TEST(ReadCloud, HugeDeclaredCountsAreRefusedBeforeMemoryIsAskedFor) {
  ReadOptions unlimited = quick();
  unlimited.max_points = 1'000'000'000;
  const std::string n = "900000000";
  for (const char* data : {"ascii", "binary", "binary_compressed"}) {
    const std::string header = sample_files::pcdHeader(data, n, n, "1");
    EXPECT_THAT(refusal(header + "0 0 0 0\n", "a.pcd", unlimited), HasSubstr("a.pcd")) << data;
    EXPECT_THAT(refusal(header + "0 0 0 0\n", "a.pcd"), HasSubstr("limit of 10000")) << data;
  }
  for (const auto& bytes : {sample_files::plyAscii(true), sample_files::plyBinary(false, true)}) {
    for (const char* element : {"element vertex ", "element face "}) {
      for (const std::string count : {"900000000", "18446744073709551615", "99999999999999999999", "-1"}) {
        refusal(replaced(bytes, element, element + count + " was "), "a.ply", unlimited);
      }
    }
  }
  EXPECT_THAT(refusal(replaced(sample_files::off(), "4 4 6", n + " 4 6"), "a.off", unlimited),
              HasSubstr("remain"));
  EXPECT_THAT(refusal(replaced(sample_files::off(), "4 4 6", "4 " + n + " 6"), "a.off", unlimited),
              HasSubstr("remain"));
  refusal(replaced(sample_files::off(), "3 0 2 1", n + " 0 2 1"), "a.off", unlimited);
  std::string stl = sample_files::stlBinary();
  stl.replace(80, 4, "\xff\xff\xff\xff");
  EXPECT_THAT(refusal(stl, "a.stl", unlimited), HasSubstr("4294967295"));
}

TEST(ReadCloud, ACompressedBombIsRefused) {
  const std::uint32_t points = 1'000'000;
  const std::string header =
      sample_files::pcdHeader("binary_compressed", std::to_string(points), std::to_string(points), "1");
  ReadOptions options = quick();
  options.max_points = points;
  const std::string bytes =
      header + sample_files::raw(std::uint32_t{3}) + sample_files::raw(16 * points) + "abc";
  EXPECT_THAT(refusal(bytes, "a.pcd", options), HasSubstr("cannot hold"));
  std::string damaged = sample_files::pcdCompressed();
  damaged[damaged.size() - 60] = '\xff';
  try {
    EXPECT_EQ(parse(damaged, "a.pcd").cloud_C.size(), 9u);
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("damaged"));
  }
  EXPECT_THAT(refusal(replaced(sample_files::pcdCompressed(), std::string("\x90\0\0\0", 4),
                               std::string("\x91\0\0\0", 4)),
                      "a.pcd"),
              HasSubstr("uncompressed size is 145"));
}

TEST(ReadCloud, DamagedMeshesAreRefused) {
  EXPECT_THAT(refusal(replaced(sample_files::off(), "3 0 2 1", "3 0 2 4"), "a.off"), HasSubstr("vertex 4"));
  EXPECT_THAT(refusal(replaced(sample_files::off(), "3 0 2 1", "3 0 2 -1"), "a.off"), HasSubstr("vertex -1"));
  EXPECT_THAT(refusal(replaced(sample_files::off(), "3 0 2 1", "3 0 2 0.5"), "a.off"),
              HasSubstr("vertex 0.5"));
  EXPECT_THAT(refusal(replaced(sample_files::obj(), "f 1 2 4", "f 1 2 0"), "a.obj"), HasSubstr("vertex -1"));
  EXPECT_THAT(refusal(replaced(sample_files::obj(), "v 0 0 1", "v 0 0 inf"), "a.obj"), HasSubstr("inf"));
  EXPECT_THAT(refusal(replaced(sample_files::stlAscii(), "endloop", "vertex 0 0 0\n endloop"), "a.stl"),
              HasSubstr("'endloop'"));
  EXPECT_THAT(
      refusal(replaced(sample_files::plyAscii(true), "property double y", "property half y"), "a.ply"),
      HasSubstr("'half'"));
  EXPECT_THAT(refusal(replaced(sample_files::plyAscii(true), "property double y\n", ""), "a.ply"),
              HasSubstr("y once"));
  EXPECT_THAT(refusal(replaced(sample_files::plyAscii(true), "list uchar int", "list float int"), "a.ply"),
              HasSubstr("whole number"));
  EXPECT_THAT(refusal("OFF\n3 1 0\n0 0 0\n1 1 1\n2 2 2\n3 0 1 2\n", "flat.off"),
              testing::Not(testing::IsEmpty()));
}

TEST(ReadCloud, DamagedXyzIsRefused) {
  EXPECT_THAT(refusal("1 2 3\n4 5\n", "a.xyz"), AllOf(HasSubstr("line 2"), HasSubstr("fewer than three")));
  EXPECT_THAT(refusal("1 2 3\n4 5 6 7\n", "a.xyz"), AllOf(HasSubstr("line 2"), HasSubstr("4 columns")));
  EXPECT_THAT(refusal("1 2 3\n4 five 6\n", "a.xyz"), AllOf(HasSubstr("line 2"), HasSubstr("'five'")));
  EXPECT_THAT(refusal("x 2 z\n4 5 6\n", "a.xyz"), AllOf(HasSubstr("line 1"), HasSubstr("'x'")));
  EXPECT_THAT(refusal("x y z\n", "a.xyz"), HasSubstr("no points"));
  EXPECT_THAT(refusal("1,5 2,5 3,5 1\n1e999 0 0 0 0 0 0\n", "a.xyz"), HasSubstr("line 2"));
}

// Either a cloud of the expected kind or InputError; anything else is a defect.
void expectHarmless(const std::string& bytes, const std::string& name) {
  try {
    const LoadedCloud loaded = parse(bytes, name);
    EXPECT_FALSE(loaded.cloud_C.empty()) << name;
    EXPECT_TRUE(loaded.labels.empty() || loaded.labels.size() == loaded.cloud_C.size()) << name;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(name), std::string::npos)
        << "a message without the file's name: " << error.what();
  }
}

TEST(ReadCloud, TruncationAnywhereIsHarmlessAndIsRefusedWhereCountsAreDeclared) {
  for (const SampleFile& file : sample_files::all()) {
    for (std::size_t n = 0; n < file.bytes.size(); ++n) expectHarmless(file.bytes.substr(0, n), file.name);
  }
  for (const auto& bytes : {sample_files::pcdBinary(), sample_files::pcdCompressed()}) {
    for (std::size_t n = 0; n < bytes.size(); ++n) refusal(bytes.substr(0, n), "a.pcd");
  }
  for (const auto& bytes : {sample_files::plyBinary(false, true), sample_files::plyBinary(true, false)}) {
    for (std::size_t n = 0; n < bytes.size(); ++n) refusal(bytes.substr(0, n), "a.ply");
  }
  const std::string stl = sample_files::stlBinary();
  for (std::size_t n = 0; n < stl.size(); ++n) refusal(stl.substr(0, n), "a.stl");
}

TEST(ReadCloud, MutationsAreHarmless) {
  std::mt19937_64 random(5);
  for (const SampleFile& file : sample_files::all()) {
    for (int round = 0; round < 2000; ++round) {
      std::string bytes = file.bytes;
      for (auto changes = 1 + random() % 4; changes > 0; --changes) {
        const std::size_t at = random() % bytes.size();
        if (random() % 3 == 0) {
          bytes[at] = "0123456789 \n-.e"[random() % 15];
        } else {
          bytes[at] = static_cast<char>(random());
        }
      }
      expectHarmless(bytes, file.name);
    }
  }
}

TEST(ReadCloud, GarbageIsHarmlessUnderEveryName) {
  std::mt19937_64 random(6);
  for (const char* name : {"a.pcd", "a.ply", "a.xyz", "a.off", "a.obj", "a.stl", "a"}) {
    for (int round = 0; round < 500; ++round) {
      std::string bytes(1 + random() % 400, '\0');
      for (char& byte : bytes) byte = static_cast<char>(random());
      expectHarmless(bytes, name);
    }
  }
}

TEST(ReadOptions, BadValuesAreNamed) {
  ReadOptions options = quick();
  options.scale = 0.0;
  EXPECT_THAT(refusal("1 2 3\n", "a.xyz", options), AllOf(HasSubstr("'scale'"), HasSubstr("0")));
}

TEST(ReadCloud, ScannedFilesAreRead) {
  const std::filesystem::path folder = std::filesystem::path(BOXGRASP_SOURCE_DIR) / "../shared/data";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no test data in " << folder;
  const LoadedCloud scene = readCloud(folder / "scenes/mosd_learn33.pcd");
  EXPECT_EQ(scene.cloud_C.size(), 307'200u);
  EXPECT_EQ(scene.labels.size(), 307'200u);
  EXPECT_EQ(readCloud(folder / "scenes/krylon.pcd").cloud_C.size(), 4467u);
  const TriangleMesh box = readMesh(folder / "objects/ycb/CrackerBox.ply");
  EXPECT_EQ(box.vertices.size(), 7866u);
  EXPECT_EQ(box.triangles.size(), 15'728u);
}

}  // namespace
}  // namespace boxgrasp
