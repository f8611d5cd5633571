#include "boxgrasp/cloud/read_cloud.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include "boxgrasp/base/error.h"
#include "boxgrasp/cloud/parsers.h"

namespace boxgrasp {

void ReadOptions::validate() const {
  requireOption(mesh_samples >= 1 && mesh_samples <= 100'000'000, "mesh_samples", mesh_samples,
                "in [1, 100000000]");
  requireOption(std::isfinite(scale) && scale > 0.0, "scale", scale, "finite and above 0");
  requireOption(max_points >= 1 && max_points <= 1'000'000'000, "max_points", max_points,
                "in [1, 1000000000]");
  requireOption(max_file_bytes >= 1, "max_file_bytes", max_file_bytes, "1 or more");
}

void requireFewPoints(const Cursor& cursor, std::size_t points, std::size_t max_points) {
  if (points <= max_points) return;
  cursor.fail(fmt::format("{} points are more than the limit of {}; thin the cloud out or raise max_points",
                          points, max_points));
}

namespace {

using Parser = FileContent (*)(Cursor&, std::size_t max_points);

std::string extensionOf(const std::string& name) {
  std::string extension = std::filesystem::path(name).extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c; });
  return extension;
}

// The first word of the first line that is no comment.
std::string_view firstWord(std::string_view bytes) {
  while (bytes.starts_with('#')) bytes.remove_prefix(std::min(bytes.find('\n'), bytes.size() - 1) + 1);
  return Words(bytes.substr(0, 100)).next();
}

Parser parserByContent(std::string_view bytes) {
  const std::string_view word = firstWord(bytes);
  if (bytes.starts_with("# .PCD") || word == "VERSION" || word == "FIELDS") return parsePcd;
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r")) return parsePly;
  if (word == "OFF" || word == "COFF" || word == "NOFF" || word == "CNOFF") return parseOff;
  if (word == "solid" || isBinaryStl(bytes)) return parseStl;
  return nullptr;
}

Parser parserFor(std::string_view bytes, const std::string& name) {
  static const std::map<std::string, Parser, std::less<>> by_extension = {
      {".pcd", parsePcd}, {".ply", parsePly}, {".xyz", parseXyz}, {".txt", parseXyz}, {".csv", parseXyz},
      {".asc", parseXyz}, {".off", parseOff}, {".obj", parseObj}, {".stl", parseStl}};
  if (const Parser parser = parserByContent(bytes)) return parser;
  const auto found = by_extension.find(extensionOf(name));
  if (found != by_extension.end()) return found->second;
  throw InputError(
      fmt::format("{}: neither content nor name tells the format; known are .pcd, .ply, .xyz (.txt, .csv, "
                  ".asc), .off, .obj and .stl",
                  name));
}

FileContent parse(std::span<const char> bytes, const std::string& name, const ReadOptions& options) {
  if (bytes.empty()) throw InputError(fmt::format("{}: the file is empty", name));
  Cursor cursor(bytes, name);
  FileContent content = parserFor(cursor.rest(), name)(cursor, options.max_points);
  for (Vector3d& vertex : content.mesh.vertices) vertex *= options.scale;
  return content;
}

// A mesh is a finished shape: unlike a scan it has no holes to be marked by vertices that are not finite.
void requireFinite(const TriangleMesh& mesh, const std::string& name) {
  constexpr double kFarthest = 1e9;  // far beyond any object's size, and areas still far from overflow
  for (const Vector3d& vertex : mesh.vertices) {
    if (vertex.allFinite() && vertex.cwiseAbs().maxCoeff() < kFarthest) continue;
    throw InputError(fmt::format("{}: the mesh has a vertex at ({}, {}, {}); remove it", name, vertex.x(),
                                 vertex.y(), vertex.z()));
  }
}

void scaleBy(double scale, PointCloud& cloud) {
  for (std::vector<float>* axis : {&cloud.x, &cloud.y, &cloud.z}) {
    for (float& value : *axis) value = static_cast<float>(value * scale);
  }
}

std::vector<char> readBytes(const std::filesystem::path& file, const ReadOptions& options) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  const std::string name = file.string();
  if (status.type() == fs::file_type::not_found)
    throw InputError(fmt::format("{}: there is no such file", name));
  if (fs::is_directory(status)) throw InputError(fmt::format("{}: is a directory; name a file in it", name));
  if (!fs::is_regular_file(status)) throw InputError(fmt::format("{}: is not a regular file", name));
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) throw InputError(fmt::format("{}: cannot be read: {}", name, error.message()));
  if (size > options.max_file_bytes) {
    throw InputError(fmt::format("{}: has {} bytes, more than the limit of {}; raise max_file_bytes", name,
                                 size, options.max_file_bytes));
  }
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> bytes(size);
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  if (!stream) throw InputError(fmt::format("{}: cannot be read; check its permissions", name));
  return bytes;
}

}  // namespace

LoadedCloud parseCloud(std::span<const char> bytes, const std::string& name, const ReadOptions& options) {
  options.validate();
  FileContent content = parse(bytes, name, options);
  LoadedCloud loaded;
  loaded.format = std::move(content.format);
  loaded.labels = std::move(content.labels);
  if (content.viewpoint) loaded.viewpoint_C = *content.viewpoint * options.scale;
  loaded.sampled_from_mesh = !content.mesh.triangles.empty();
  if (loaded.sampled_from_mesh) {
    requireFinite(content.mesh, name);
    loaded.cloud_C = sampleSurface(content.mesh, options.mesh_samples, options.seed);
    return loaded;
  }
  loaded.cloud_C = std::move(content.cloud);
  scaleBy(options.scale, loaded.cloud_C);
  for (const Vector3d& vertex : content.mesh.vertices) loaded.cloud_C.push(vertex);
  if (loaded.cloud_C.empty()) throw InputError(fmt::format("{}: the file holds no points", name));
  return loaded;
}

TriangleMesh parseMesh(std::span<const char> bytes, const std::string& name, const ReadOptions& options) {
  options.validate();
  FileContent content = parse(bytes, name, options);
  if (content.mesh.triangles.empty()) {
    throw InputError(fmt::format("{}: the file holds no triangles, only points; a mesh is needed", name));
  }
  requireFinite(content.mesh, name);
  return std::move(content.mesh);
}

LoadedCloud readCloud(const std::filesystem::path& file, const ReadOptions& options) {
  options.validate();
  return parseCloud(readBytes(file, options), file.string(), options);
}

TriangleMesh readMesh(const std::filesystem::path& file, const ReadOptions& options) {
  options.validate();
  return parseMesh(readBytes(file, options), file.string(), options);
}

}  // namespace boxgrasp
