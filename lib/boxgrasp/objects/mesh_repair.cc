#include "boxgrasp/objects/mesh_repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "boxgrasp/objects/mesh_properties.h"

namespace boxgrasp {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;  // the smaller vertex first

Edge edgeOf(std::uint32_t a, std::uint32_t b) { return std::minmax(a, b); }

double extentOf(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : mesh.vertices) box.extend(v);
  return box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
}

// For each vertex the first one in its cell of the given size.
std::vector<std::uint32_t> firstInCell(const std::vector<Vector3d>& vertices, double cell) {
  std::map<std::array<std::int64_t, 3>, std::uint32_t> first;
  std::vector<std::uint32_t> same(vertices.size());
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    std::array<std::int64_t, 3> key;
    for (int k = 0; k < 3; ++k) key[k] = std::llround(vertices[i][k] / cell);
    same[i] = first.try_emplace(key, i).first->second;
  }
  return same;
}

std::size_t weld(TriangleMesh& mesh) {
  constexpr double kSamePlace = 1e-6;  // of the mesh's extent
  const double extent = extentOf(mesh);
  if (extent <= 0) return 0;
  const auto same = firstInCell(mesh.vertices, kSamePlace * extent);
  for (Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& v : triangle) v = same[v];
  }
  std::size_t merged = 0;
  for (std::uint32_t i = 0; i < same.size(); ++i) merged += same[i] != i;
  return merged;
}

bool degenerate(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

std::size_t dropIdle(TriangleMesh& mesh) {
  std::set<Triangle> seen;
  return std::erase_if(mesh.triangles, [&](const Triangle& triangle) {
    Triangle key = triangle;
    std::sort(key.begin(), key.end());
    return degenerate(triangle) || !seen.insert(key).second;
  });
}

// The others keep their order.
void dropUnusedVertices(TriangleMesh& mesh) {
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) used[v] = true;
  }
  std::vector<std::uint32_t> renamed(mesh.vertices.size());
  std::vector<Vector3d> kept;
  for (std::size_t v = 0; v < used.size(); ++v) {
    renamed[v] = static_cast<std::uint32_t>(kept.size());
    if (used[v]) kept.push_back(mesh.vertices[v]);
  }
  for (Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& v : triangle) v = renamed[v];
  }
  mesh.vertices = std::move(kept);
}

std::map<Edge, std::vector<std::uint32_t>> trianglesAtEdges(const TriangleMesh& mesh) {
  std::map<Edge, std::vector<std::uint32_t>> at;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    for (int k = 0; k < 3; ++k) at[edgeOf(mesh.triangles[i][k], mesh.triangles[i][(k + 1) % 3])].push_back(i);
  }
  return at;
}

bool runsAlong(const Triangle& t, std::uint32_t a, std::uint32_t b) {
  for (int k = 0; k < 3; ++k) {
    if (t[k] == a && t[(k + 1) % 3] == b) return true;
  }
  return false;
}

double signedVolume(const TriangleMesh& mesh, const std::vector<std::uint32_t>& part) {
  double volume = 0;
  for (const auto i : part) {
    const auto& [a, b, c] = mesh.triangles[i];
    volume += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c])) / 6;
  }
  return volume;
}

// Turns the triangles of one connected part like its first one, then the whole part outward. Returns how many
// triangles were turned.
class Orienter {
 public:
  explicit Orienter(TriangleMesh& mesh)
      : mesh_(mesh),
        at_(trianglesAtEdges(mesh)),
        seen_(mesh.triangles.size()),
        turned_(mesh.triangles.size()) {}

  std::size_t run() {
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
      if (!seen_[i]) orient(partFrom(i));
    }
    return static_cast<std::size_t>(std::count(turned_.begin(), turned_.end(), true));
  }

 private:
  void turn(std::uint32_t i) {
    std::swap(mesh_.triangles[i][1], mesh_.triangles[i][2]);
    turned_[i] = !turned_[i];
  }

  std::vector<std::uint32_t> partFrom(std::uint32_t start) {
    std::vector<std::uint32_t> part{start};
    seen_[start] = true;
    for (std::size_t next = 0; next < part.size(); ++next) visitNeighbours(part[next], part);
    return part;
  }

  void visitNeighbours(std::uint32_t i, std::vector<std::uint32_t>& part) {
    const Triangle triangle = mesh_.triangles[i];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle[k], b = triangle[(k + 1) % 3];
      const auto& both = at_.at(edgeOf(a, b));
      if (both.size() != 2) continue;
      const std::uint32_t other = both[0] == i ? both[1] : both[0];
      if (seen_[other]) continue;
      seen_[other] = true;
      if (runsAlong(mesh_.triangles[other], a, b)) turn(other);
      part.push_back(other);
    }
  }

  void orient(const std::vector<std::uint32_t>& part) {
    if (signedVolume(mesh_, part) >= 0) return;
    for (const auto i : part) turn(i);
  }

  TriangleMesh& mesh_;
  const std::map<Edge, std::vector<std::uint32_t>> at_;
  std::vector<bool> seen_, turned_;
};

}  // namespace

RepairedMesh repaired(const TriangleMesh& mesh) {
  RepairedMesh result{mesh, {}};
  const auto note = [&](std::size_t count, std::string_view what) {
    if (count > 0) result.repairs.push_back(fmt::format("{} {}", count, what));
  };
  note(dropIdle(result.mesh), "triangles without area or twice there dropped");
  if (topologyOf(result.mesh).open_edges > 0) {
    note(weld(result.mesh), "vertices merged with others at the same place");
    note(dropIdle(result.mesh), "triangles that this left without area dropped");
  }
  dropUnusedVertices(result.mesh);
  note(Orienter(result.mesh).run(), "triangles turned outward");
  return result;
}

}  // namespace boxgrasp
