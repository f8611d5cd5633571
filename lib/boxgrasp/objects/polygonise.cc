#include "boxgrasp/objects/polygonise.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

using Eigen::Vector3i;

// A cube's corner c is at (c & 1, c >> 1 & 1, c >> 2). Edge e runs along axis e / 4 from the corner at
// kEdgeStart[e].
constexpr int kCorners = 8, kEdges = 12, kFaces = 6;
constexpr int kEdgeStart[kEdges] = {0, 2, 4, 6, 0, 1, 4, 5, 0, 1, 2, 3};
// Corners of each face, counter-clockwise seen from outside the cube.
constexpr int kFaceCorners[kFaces][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

constexpr int kNone = -1;

Vector3i cornerOffset(int corner) { return {corner & 1, corner >> 1 & 1, corner >> 2}; }

int edgeBetween(int a, int b) {
  for (int e = 0; e < kEdges; ++e) {
    const int start = kEdgeStart[e], end = start | 1 << e / 4;
    if ((a == start && b == end) || (a == end && b == start)) return e;
  }
  return kNone;
}

bool onOneFace(int edge_a, int edge_b) {
  const auto ends = [](int e) { return std::array{kEdgeStart[e], kEdgeStart[e] | 1 << e / 4}; };
  for (int axis = 0; axis < 3; ++axis) {
    const auto [a, b] = ends(edge_a);
    const auto [c, d] = ends(edge_b);
    const int bits = (a >> axis & 1) + (b >> axis & 1) + (c >> axis & 1) + (d >> axis & 1);
    if (bits == 0 || bits == 4) return true;
  }
  return false;
}

using Loop = std::vector<int>;  // edges of a cube, in the order in which the surface's boundary meets them

// Where the surface crosses one face: walking around it, from each edge where the walk enters the solid to
// the edge where it leaves it again. A face with two inside corners on a diagonal so parts them, on both of
// its sides alike.
void linkAcrossFace(int inside, const int (&corners)[4], std::array<int, kEdges>& next) {
  const auto isInside = [&](int k) { return (inside >> corners[k % 4] & 1) != 0; };
  for (int k = 0; k < 4; ++k) {
    if (isInside(k) || !isInside(k + 1)) continue;
    int last = k + 1;
    while (isInside(last + 1)) ++last;
    next[static_cast<std::size_t>(edgeBetween(corners[k], corners[(k + 1) % 4]))] =
        edgeBetween(corners[last % 4], corners[(last + 1) % 4]);
  }
}

// The closed loops in which the surface meets the faces of a cube whose corners are inside by the bits of
// `inside`.
std::vector<Loop> loopsOf(int inside) {
  std::array<int, kEdges> next;
  next.fill(kNone);
  for (const auto& corners : kFaceCorners) linkAcrossFace(inside, corners, next);
  std::vector<Loop> loops;
  for (std::size_t start = 0; start < kEdges; ++start) {
    if (next[start] == kNone) continue;
    Loop loop;
    for (std::size_t e = start; next[e] != kNone;) {
      loop.push_back(static_cast<int>(e));
      e = static_cast<std::size_t>(std::exchange(next[e], kNone));
    }
    loops.push_back(loop);
  }
  return loops;
}

// Turns the loop so that all diagonals of a fan from its first vertex run inside the cube: one that lies in a
// face could meet its twin in the next cube, and four triangles would share an edge. False when there is no
// such turn.
bool turnForFan(Loop& loop) {
  for (std::size_t turn = 0; turn < loop.size(); ++turn) {
    bool fits = true;
    for (std::size_t i = 2; i + 1 < loop.size(); ++i) fits = fits && !onOneFace(loop[0], loop[i]);
    if (fits) return true;
    std::rotate(loop.begin(), loop.begin() + 1, loop.end());
  }
  return false;
}

struct Patch {
  Loop loop;
  bool fan;  // from the first vertex; else around a vertex in the middle
};
using Cases = std::array<std::vector<Patch>, 256>;

Cases allCases() {
  Cases cases;
  for (int inside = 0; inside < 256; ++inside) {
    for (Loop& loop : loopsOf(inside)) {
      const bool fan = turnForFan(loop);
      cases[static_cast<std::size_t>(inside)].push_back({loop, fan});
    }
  }
  return cases;
}

constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

class Polygoniser {
 public:
  Polygoniser(const Field& field, const Eigen::AlignedBox3d& bounds, double cell)
      : field_(field), origin_(bounds.min()), cell_(cell), size_(latticeSize(bounds, cell)) {
    sample();
  }

  TriangleMesh run() {
    edge_vertices_.assign(3 * values_.size(), kNoVertex);
    const Cases cases = allCases();
    for (int k = 0; k + 1 < size_.z(); ++k) {
      for (int j = 0; j + 1 < size_.y(); ++j) {
        for (int i = 0; i + 1 < size_.x(); ++i) addCube({i, j, k}, cases);
      }
    }
    return std::move(mesh_);
  }

 private:
  static Vector3i latticeSize(const Eigen::AlignedBox3d& bounds, double cell) {
    const Vector3d cells = (bounds.sizes() / cell).array().ceil() + 1.0;
    if (!(cells.prod() <= 0x1p25)) {
      throw InputError(fmt::format("cells of {} in bounds of {} x {} x {} are too many; take larger cells",
                                   cell, bounds.sizes().x(), bounds.sizes().y(), bounds.sizes().z()));
    }
    return cells.cast<int>();
  }

  std::size_t indexOf(const Vector3i& node) const {
    return (static_cast<std::size_t>(node.z()) * static_cast<std::size_t>(size_.y()) +
            static_cast<std::size_t>(node.y())) *
               static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(node.x());
  }
  Vector3d positionOf(const Vector3i& node) const { return origin_ + cell_ * node.cast<double>(); }
  bool isInside(const Vector3i& node) const { return values_[indexOf(node)] < 0.0; }

  void sample() {
    for (int k = 0; k < size_.z(); ++k) {
      for (int j = 0; j < size_.y(); ++j) {
        for (int i = 0; i < size_.x(); ++i) sampleAt({i, j, k});
      }
    }
  }

  void sampleAt(const Vector3i& node) {
    values_.push_back(field_(positionOf(node)));
    const bool border = (node.array() == 0).any() || (node.array() == size_.array() - 1).any();
    if (!border || values_.back() > 0.0) return;
    const Vector3d p = positionOf(node);
    throw InputError(
        fmt::format("the shape reaches the border of its bounds at ({}, {}, {}); take larger bounds", p.x(),
                    p.y(), p.z()));
  }

  void addCube(const Vector3i& cube, const Cases& cases) {
    int inside = 0;
    for (int c = 0; c < kCorners; ++c) inside |= static_cast<int>(isInside(cube + cornerOffset(c))) << c;
    for (const Patch& patch : cases[static_cast<std::size_t>(inside)]) addPatch(cube, patch);
  }

  void addPatch(const Vector3i& cube, const Patch& patch) {
    std::vector<std::uint32_t> rim;
    for (const int edge : patch.loop) rim.push_back(vertexOn(cube, edge));
    if (!patch.fan) return addAround(rim);
    for (std::size_t i = 2; i < rim.size(); ++i) mesh_.triangles.push_back({rim[0], rim[i - 1], rim[i]});
  }

  void addAround(const std::vector<std::uint32_t>& rim) {
    Vector3d middle = Vector3d::Zero();
    for (const std::uint32_t v : rim) middle += mesh_.vertices[v] / static_cast<double>(rim.size());
    const auto hub = static_cast<std::uint32_t>(mesh_.vertices.size());
    mesh_.vertices.push_back(middle);
    for (std::size_t i = 0; i < rim.size(); ++i)
      mesh_.triangles.push_back({hub, rim[i], rim[(i + 1) % rim.size()]});
  }

  std::uint32_t vertexOn(const Vector3i& cube, int edge) {
    const Vector3i start = cube + cornerOffset(kEdgeStart[edge]);
    const int axis = edge / 4;
    std::uint32_t& vertex = edge_vertices_[3 * indexOf(start) + static_cast<std::size_t>(axis)];
    if (vertex == kNoVertex) {
      vertex = static_cast<std::uint32_t>(mesh_.vertices.size());
      mesh_.vertices.push_back(crossing(start, start + Vector3i::Unit(axis)));
    }
    return vertex;
  }

  // By bisection, to a thousandth of a cell and never on a lattice node, where triangles would lose their
  // area.
  Vector3d crossing(const Vector3i& start, const Vector3i& end) const {
    const Vector3d a = positionOf(start), b = positionOf(end);
    double from = 0.0, to = 1.0;
    for (int halving = 0; halving < 10; ++halving) {
      const double middle = 0.5 * (from + to);
      ((field_(a + middle * (b - a)) < 0.0) == isInside(start) ? from : to) = middle;
    }
    return a + 0.5 * (from + to) * (b - a);
  }

  const Field& field_;
  Vector3d origin_;
  double cell_;
  Vector3i size_;  // lattice nodes along each axis
  std::vector<double> values_;
  std::vector<std::uint32_t> edge_vertices_;  // of the three edges that start at each node
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh polygonise(const Field& field, const Eigen::AlignedBox3d& bounds, double cell) {
  assert(!bounds.isEmpty() && cell > 0.0);
  return Polygoniser(field, bounds, cell).run();
}

}  // namespace boxgrasp
