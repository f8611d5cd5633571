// Reading point clouds and meshes from files and bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "boxgrasp/geometry/point_cloud.h"
#include "boxgrasp/geometry/triangle_mesh.h"

namespace boxgrasp {

struct ReadOptions {
  std::size_t mesh_samples = 100'000;  // points sampled on the surface of a mesh
  std::uint64_t seed = 1;              // of that sampling
  double scale = 1.0;                  // multiplies every coordinate: 0.001 for a file in millimetres
  std::size_t max_points =
      20'000'000;  // more points than this in a file are refused, before memory is asked for
  std::uintmax_t max_file_bytes = 1u << 30;  // larger files are refused
  void validate() const;
};

struct LoadedCloud {
  PointCloud cloud_C;                 // as in the file: non-finite points of organised clouds are still there
  std::vector<std::uint32_t> labels;  // the PCD field `label`, one a point; empty where the file has none
  std::optional<Vector3d>
      viewpoint_C;  // where the sensor stood, when the file says so: the VIEWPOINT of a PCD that is
                    // organised, or whose VIEWPOINT is not 0 0 0 1 0 0 0 (not known)
  bool sampled_from_mesh = false;
  std::string
      format;  // "pcd ascii", "pcd binary", "pcd binary_compressed", "ply", "xyz", "off", "obj", "stl"
};

// Reads PCD (ascii, binary, binary_compressed), PLY (ascii, little and big endian; points or mesh), XYZ, and
// OFF, OBJ, STL meshes. The format comes from the content where it can be told, else from the name. Throws
// InputError that names the file, the place and the remedy for anything unreadable, truncated, mislabelled,
// too large, or a directory.
LoadedCloud readCloud(const std::filesystem::path& file, const ReadOptions& options = {});

// The same for bytes in memory; the name stands for the file's in messages and tells the format where the
// content does not.
LoadedCloud parseCloud(std::span<const char> bytes, const std::string& name, const ReadOptions& options = {});

// Reads a mesh (OFF, OBJ, STL, PLY) without sampling it. Polygons are cut into triangle fans.
TriangleMesh readMesh(const std::filesystem::path& file, const ReadOptions& options = {});
TriangleMesh parseMesh(std::span<const char> bytes, const std::string& name, const ReadOptions& options = {});

}  // namespace boxgrasp
