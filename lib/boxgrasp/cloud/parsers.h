// The parsers of the single file formats. Each trusts nothing that the bytes declare before it has checked
// that the bytes can hold it, asks for memory in proportion to the bytes, and throws InputError for anything
// else. Internal to this room.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "boxgrasp/cloud/cursor.h"
#include "boxgrasp/geometry/point_cloud.h"
#include "boxgrasp/geometry/triangle_mesh.h"

namespace boxgrasp {

// What a file holds, unscaled: a mesh when mesh.triangles is not empty, else points, either in `cloud` or as
// the mesh's vertices.
struct FileContent {
  std::string format;
  PointCloud cloud;
  std::vector<std::uint32_t> labels;
  std::optional<Vector3d> viewpoint;
  TriangleMesh mesh;
};

FileContent parsePcd(Cursor& cursor, std::size_t max_points);
FileContent parsePly(Cursor& cursor, std::size_t max_points);
FileContent parseXyz(Cursor& cursor, std::size_t max_points);
FileContent parseOff(Cursor& cursor, std::size_t max_points);
FileContent parseObj(Cursor& cursor, std::size_t max_points);
FileContent parseStl(Cursor& cursor, std::size_t max_points);

// Whether bytes are a binary STL file: its count of triangles fits its size to the byte.
bool isBinaryStl(std::string_view bytes);

// Fails when a file declares or holds more points than are allowed.
void requireFewPoints(const Cursor& cursor, std::size_t points, std::size_t max_points);

// Cuts a polygon into a fan of triangles; fewer than three corners make none.
void appendFan(TriangleMesh& mesh, std::span<const std::uint32_t> polygon);

// A vertex number that a file gives, checked against the vertices read so far.
std::uint32_t checkedVertex(const Cursor& cursor, double index, std::size_t vertices);

// The next three words as a position.
Vector3d parsePosition(const Cursor& cursor, Words& words);

}  // namespace boxgrasp
