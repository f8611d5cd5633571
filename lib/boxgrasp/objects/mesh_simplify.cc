#include "boxgrasp/objects/mesh_simplify.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "boxgrasp/objects/mesh_properties.h"

namespace boxgrasp {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

// Collapses edges of a closed manifold, each vertex with the list of its triangles. A triangle that went
// names a vertex twice.
class Simplifier {
 public:
  explicit Simplifier(TriangleMesh& mesh)
      : mesh_(mesh), around_(mesh.vertices.size()), left_(mesh.triangles.size()) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      for (const std::uint32_t v : mesh.triangles[t]) around_[v].push_back(t);
    }
  }

  std::size_t left() const { return left_; }

  // Takes edges shorter than `length`, in the order of the triangles.
  void pass(double length, std::size_t target, const StopToken& stop) {
    for (std::uint32_t t = 0; t < mesh_.triangles.size() && left_ > target; ++t) {
      if (t % 4096 == 0) stop.check();
      for (std::size_t i = 0; i < 3 && !isGone(t); ++i) {
        const std::uint32_t keep = mesh_.triangles[t][i], gone = mesh_.triangles[t][(i + 1) % 3];
        const double distance = (mesh_.vertices[keep] - mesh_.vertices[gone]).norm();
        if (distance < length && mayCollapse(keep, gone)) collapse(keep, gone);
      }
    }
  }

  TriangleMesh remaining() const {
    TriangleMesh rest;
    std::vector<std::uint32_t> place(mesh_.vertices.size());
    for (std::uint32_t v = 0; v < around_.size(); ++v) {
      place[v] = static_cast<std::uint32_t>(rest.vertices.size());
      if (!around_[v].empty()) rest.vertices.push_back(mesh_.vertices[v]);
    }
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto [a, b, c] = mesh_.triangles[t];
      if (!isGone(t)) rest.triangles.push_back({place[a], place[b], place[c]});
    }
    return rest;
  }

 private:
  static constexpr std::size_t kMostNeighbours = 16;  // a vertex with more makes slivers

  bool isGone(std::uint32_t t) const {
    const auto [a, b, c] = mesh_.triangles[t];
    return a == b || b == c || c == a;
  }

  bool has(std::uint32_t t, std::uint32_t v) const {
    return std::ranges::find(mesh_.triangles[t], v) != mesh_.triangles[t].end();
  }

  std::vector<std::uint32_t> ring(std::uint32_t v) const {
    std::vector<std::uint32_t> vertices;
    for (const std::uint32_t t : around_[v]) {
      for (const std::uint32_t other : mesh_.triangles[t]) {
        if (other != v) vertices.push_back(other);
      }
    }
    std::ranges::sort(vertices);
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
  }

  // The surface stays a manifold when the two vertices have no neighbours in common but the two across the
  // edge (the link condition), and it is no tetrahedron.
  bool mayCollapse(std::uint32_t keep, std::uint32_t gone) const {
    const std::vector<std::uint32_t> a = ring(keep), b = ring(gone);
    std::vector<std::uint32_t> common;
    std::ranges::set_intersection(a, b, std::back_inserter(common));
    const std::size_t joint = a.size() + b.size() - 4;
    if (common.size() != 2 || joint < 3 || joint > kMostNeighbours) return false;
    return std::ranges::all_of(around_[gone],
                               [&](std::uint32_t t) { return has(t, keep) || staysUpright(t, keep, gone); });
  }

  bool staysUpright(std::uint32_t t, std::uint32_t keep, std::uint32_t gone) const {
    constexpr double kLeastCosine = 0.25;
    Triangle moved = mesh_.triangles[t];
    std::ranges::replace(moved, gone, keep);
    const Vector3d before = twiceArea(mesh_.triangles[t]), after = twiceArea(moved);
    return before.dot(after) > kLeastCosine * before.norm() * after.norm();
  }

  Vector3d twiceArea(const Triangle& t) const {
    const Vector3d& a = mesh_.vertices[t[0]];
    return (mesh_.vertices[t[1]] - a).cross(mesh_.vertices[t[2]] - a);
  }

  void collapse(std::uint32_t keep, std::uint32_t gone) {
    const std::vector<std::uint32_t> touched = std::exchange(around_[gone], {});
    for (const std::uint32_t t : touched) {
      if (has(t, keep)) {
        for (const std::uint32_t v : mesh_.triangles[t]) std::erase(around_[v], t);
        --left_;
      } else {
        around_[keep].push_back(t);
      }
      std::ranges::replace(mesh_.triangles[t], gone, keep);
    }
  }

  TriangleMesh& mesh_;
  std::vector<std::vector<std::uint32_t>> around_;  // the triangles at every vertex
  std::size_t left_;
};

}  // namespace

TriangleMesh simplified(TriangleMesh mesh, std::size_t triangles, const StopToken& stop) {
  if (mesh.triangles.size() <= triangles) return mesh;
  constexpr double kGrowth = 1.3, kLongest = 1e3;  // of edges that go, pass by pass, in typical edges
  const double typical = std::sqrt(2.3 * surfaceArea(mesh) / static_cast<double>(mesh.triangles.size()));
  Simplifier simplifier(mesh);
  for (double length = 0.5; simplifier.left() > triangles && length < kLongest; length *= kGrowth) {
    simplifier.pass(length * typical, triangles, stop);
  }
  return simplifier.remaining();
}

}  // namespace boxgrasp
