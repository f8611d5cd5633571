#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>

#include "boxgrasp/cloud/parsers.h"

namespace boxgrasp {

void appendFan(TriangleMesh& mesh, std::span<const std::uint32_t> polygon) {
  for (std::size_t i = 2; i < polygon.size(); ++i)
    mesh.triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
}

std::uint32_t checkedVertex(const Cursor& cursor, double index, std::size_t vertices) {
  if (index >= 0.0 && index < static_cast<double>(vertices) && index == std::floor(index)) {
    return static_cast<std::uint32_t>(index);
  }
  cursor.fail(fmt::format("a face refers to vertex {}, but only 0 to {} have been read", index,
                          static_cast<double>(vertices) - 1));
}

Vector3d parsePosition(const Cursor& cursor, Words& words) {
  Vector3d p;
  p.x() = cursor.number(words.next(), "x");
  p.y() = cursor.number(words.next(), "y");
  p.z() = cursor.number(words.next(), "z");
  return p;
}

namespace {

// ---- OFF

// Reads past the format's keyword to the line of counts, which may follow it on the same line.
Words offCounts(Cursor& cursor) {
  Words words(cursor.contentLine('#', "the keyword OFF"));
  const std::string_view keyword = words.next();
  if (!keyword.ends_with("OFF") || keyword.find_first_of("4n") != keyword.npos) {
    cursor.fail(fmt::format("the keyword is {}, but must be OFF", quoted(keyword)));
  }
  Words rest = words;
  const std::string_view next = rest.next();
  if (next == "BINARY") cursor.fail("binary OFF is not read; convert the file to PLY");
  return next.empty() ? Words(cursor.contentLine('#', "the counts of vertices and faces")) : words;
}

void readOffFace(Cursor& cursor, TriangleMesh& mesh, std::vector<std::uint32_t>& polygon) {
  Words words(cursor.contentLine('#', "a face"));
  const std::size_t corners = cursor.count(words.next(), "the number of corners");
  polygon.clear();
  for (std::size_t i = 0; i < corners; ++i) {
    polygon.push_back(checkedVertex(cursor, cursor.number(words.next(), "a corner"), mesh.vertices.size()));
  }
  appendFan(mesh, polygon);
}

// ---- OBJ

// The vertex that a corner such as 7, 7/1, 7//3 or -1 names; counted from 1, or backwards from the last
// vertex.
std::uint32_t objCorner(const Cursor& cursor, std::string_view word, std::size_t vertices) {
  const double number = cursor.number(word.substr(0, word.find('/')), "a corner of a face");
  return checkedVertex(cursor, number < 0 ? static_cast<double>(vertices) + number : number - 1, vertices);
}

void readObjLine(const Cursor& cursor, Words words, TriangleMesh& mesh, std::vector<std::uint32_t>& polygon) {
  const std::string_view keyword = words.next();
  if (keyword == "v") mesh.vertices.push_back(parsePosition(cursor, words));
  if (keyword != "f") return;
  polygon.clear();
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    polygon.push_back(objCorner(cursor, word, mesh.vertices.size()));
  }
  appendFan(mesh, polygon);
}

// ---- STL

constexpr std::size_t kStlTitleBytes = 80, kStlTriangleBytes = 50;

// An STL file repeats a vertex in each of its triangles: equal positions become one vertex.
class Welder {
 public:
  explicit Welder(TriangleMesh& mesh) : mesh_(mesh) {}

  std::uint32_t vertex(const Cursor& cursor, const Vector3d& p) {
    if (!p.allFinite()) cursor.fail("a vertex is not finite");
    const auto [known, added] = vertices_.try_emplace({p.x(), p.y(), p.z()}, vertices_.size());
    if (added) mesh_.vertices.push_back(p);
    return known->second;
  }

 private:
  TriangleMesh& mesh_;
  std::map<std::array<double, 3>, std::uint32_t> vertices_;
};

void readBinaryStl(Cursor& cursor, TriangleMesh& mesh) {
  cursor.take(kStlTitleBytes, "the title");
  const auto count = cursor.value<std::uint32_t>(std::endian::little, "the count of triangles");
  const std::string_view data =
      cursor.take(count * kStlTriangleBytes, fmt::format("a list of {} triangles", count));
  Welder welder(mesh);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<std::uint32_t, 3> triangle;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const char* at =
          data.data() + i * kStlTriangleBytes + 12 * (corner + 1);  // the first twelve are the normal
      triangle[corner] = welder.vertex(
          cursor, Vector3d(loadAs<float>(at, std::endian::little), loadAs<float>(at + 4, std::endian::little),
                           loadAs<float>(at + 8, std::endian::little)));
    }
    mesh.triangles.push_back(triangle);
  }
}

// The next line's words after its keyword, which must be the given one.
Words expectStl(Cursor& cursor, std::string_view line, std::string_view keyword) {
  Words words(line);
  if (const auto word = words.next(); word != keyword) {
    cursor.fail(fmt::format("{} stands where '{}' should; is this an STL file?", quoted(word), keyword));
  }
  return words;
}

void readStlFacet(Cursor& cursor, Welder& welder, TriangleMesh& mesh) {
  expectStl(cursor, cursor.contentLine('\n', "outer loop"), "outer");
  std::array<std::uint32_t, 3> triangle;
  for (std::uint32_t& corner : triangle) {
    Words words = expectStl(cursor, cursor.contentLine('\n', "a vertex"), "vertex");
    corner = welder.vertex(cursor, parsePosition(cursor, words));
  }
  mesh.triangles.push_back(triangle);
  expectStl(cursor, cursor.contentLine('\n', "endloop"), "endloop");
  expectStl(cursor, cursor.contentLine('\n', "endfacet"), "endfacet");
}

void readAsciiStl(Cursor& cursor, TriangleMesh& mesh) {
  Welder welder(mesh);
  while (const auto solid = cursor.contentLine('\n')) {
    expectStl(cursor, *solid, "solid");
    for (;;) {
      const std::string_view line = cursor.contentLine('\n', "endsolid");
      if (Words(line).next() == "endsolid") break;
      expectStl(cursor, line, "facet");
      readStlFacet(cursor, welder, mesh);
    }
  }
}

}  // namespace

FileContent parseOff(Cursor& cursor, std::size_t max_points) {
  Words counts = offCounts(cursor);
  const std::size_t vertices = cursor.count(counts.next(), "the number of vertices");
  const std::size_t faces = cursor.count(counts.next(), "the number of faces");
  requireFewPoints(cursor, vertices, max_points);
  cursor.requireRoomFor(vertices, 6, "vertices");
  cursor.requireRoomFor(faces, 2, "faces");
  FileContent content;
  content.format = "off";
  for (std::size_t i = 0; i < vertices; ++i) {
    Words words(cursor.contentLine('#', "a vertex"));
    content.mesh.vertices.push_back(parsePosition(cursor, words));
  }
  std::vector<std::uint32_t> polygon;
  for (std::size_t i = 0; i < faces; ++i) readOffFace(cursor, content.mesh, polygon);
  return content;
}

FileContent parseObj(Cursor& cursor, std::size_t max_points) {
  FileContent content;
  content.format = "obj";
  std::vector<std::uint32_t> polygon;
  while (const auto line = cursor.contentLine('#')) {
    readObjLine(cursor, Words(*line), content.mesh, polygon);
    requireFewPoints(cursor, content.mesh.vertices.size(), max_points);
  }
  return content;
}

bool isBinaryStl(std::string_view bytes) {
  constexpr std::size_t kHeaderBytes = kStlTitleBytes + 4;
  if (bytes.size() < kHeaderBytes) return false;
  const auto count = loadAs<std::uint32_t>(bytes.data() + kStlTitleBytes, std::endian::little);
  return bytes.size() == kHeaderBytes + count * kStlTriangleBytes;
}

FileContent parseStl(Cursor& cursor, std::size_t max_points) {
  FileContent content;
  content.format = "stl";
  if (cursor.rest().starts_with("solid") && !isBinaryStl(cursor.rest())) {
    readAsciiStl(cursor, content.mesh);
  } else {
    readBinaryStl(cursor, content.mesh);
  }
  requireFewPoints(cursor, content.mesh.vertices.size(), max_points);
  return content;
}

}  // namespace boxgrasp
