#include "boxgrasp/objects/mesh_properties.h"

#include <algorithm>
#include <numeric>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

struct HalfEdge {
  std::uint32_t from, to;
  auto operator<=>(const HalfEdge&) const = default;
};

std::vector<HalfEdge> sortedHalfEdges(const TriangleMesh& mesh) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) edges.push_back({t[i], t[(i + 1) % 3]});
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

std::size_t count(const std::vector<HalfEdge>& sorted, const HalfEdge& edge) {
  const auto [first, last] = std::equal_range(sorted.begin(), sorted.end(), edge);
  return static_cast<std::size_t>(last - first);
}

void checkTriangles(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [a, b, c] = mesh.triangles[i];
    if (std::max({a, b, c}) < mesh.vertices.size() && a != b && b != c && c != a) continue;
    throw InputError(
        fmt::format("mesh: triangle {} of vertices {}, {}, {} must name three different ones of the {} "
                    "vertices; remove it",
                    i, a, b, c, mesh.vertices.size()));
  }
}

// Which of n things belong together.
class Partition {
 public:
  explicit Partition(std::size_t n) : parent_(n) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::size_t> parent_;
};

struct EdgeCounts {
  std::size_t edges = 0, open = 0, crowded = 0;
  bool oriented = true;
};

EdgeCounts countEdges(const std::vector<HalfEdge>& half_edges) {
  EdgeCounts counts;
  for (std::size_t i = 0; i < half_edges.size(); ++i) {
    const HalfEdge& edge = half_edges[i];
    if (i > 0 && edge == half_edges[i - 1]) continue;
    const std::size_t along = count(half_edges, edge), against = count(half_edges, {edge.to, edge.from});
    counts.oriented = counts.oriented && along == 1;
    if (against > 0 && edge.to < edge.from) continue;
    ++counts.edges;
    counts.open += along + against == 1;
    counts.crowded += along + against > 2;
  }
  return counts;
}

// Whether the triangles around every vertex hang together by the edges that meet there: a corner (triangle,
// vertex) is joined with the corner across each such edge, and then a vertex must have a single group of
// corners.
bool verticesAreFans(const TriangleMesh& mesh) {
  struct Spoke {
    std::uint32_t vertex, other;
    std::size_t corner;
    auto operator<=>(const Spoke&) const = default;
  };
  std::vector<Spoke> spokes;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto corners = mesh.triangles[t];
      spokes.push_back({corners[i], corners[(i + 1) % 3], 3 * t + i});
      spokes.push_back({corners[i], corners[(i + 2) % 3], 3 * t + i});
    }
  }
  std::sort(spokes.begin(), spokes.end());
  Partition fans(3 * mesh.triangles.size());
  for (std::size_t s = 1; s < spokes.size(); ++s) {
    const Spoke &a = spokes[s - 1], &b = spokes[s];
    if (a.vertex == b.vertex && a.other == b.other) fans.join(a.corner, b.corner);
  }
  for (std::size_t s = 1; s < spokes.size(); ++s) {
    const Spoke &a = spokes[s - 1], &b = spokes[s];
    if (a.vertex == b.vertex && fans.find(a.corner) != fans.find(b.corner)) return false;
  }
  return true;
}

double signedVolume(const TriangleMesh& mesh, const Triangle& t, const Vector3d& apex) {
  return (mesh.vertices[t[0]] - apex).dot((mesh.vertices[t[1]] - apex).cross(mesh.vertices[t[2]] - apex)) /
         6.0;
}

// Signed volume of every component, by component, zero elsewhere; and the components.
struct Components {
  std::vector<std::size_t> roots;
  std::vector<double> volumes;  // parallel to roots
};

Components componentsOf(const TriangleMesh& mesh) {
  Partition partition(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    partition.join(t[0], t[1]);
    partition.join(t[1], t[2]);
  }
  std::vector<double> volumes(mesh.vertices.size(), 0.0);
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Triangle& t : mesh.triangles) {
    const std::size_t root = partition.find(t[0]);
    volumes[root] += signedVolume(mesh, t, mesh.vertices[root]);
    used[root] = true;
  }
  Components components;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    components.roots.push_back(v);
    components.volumes.push_back(volumes[v]);
  }
  return components;
}

std::size_t usedVertices(const std::vector<HalfEdge>& sorted) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) n += i == 0 || sorted[i].from != sorted[i - 1].from;
  return n;
}

}  // namespace

MeshTopology topologyOf(const TriangleMesh& mesh) {
  checkTriangles(mesh);
  MeshTopology topology;
  if (mesh.triangles.empty()) return topology;
  const std::vector<HalfEdge> half_edges = sortedHalfEdges(mesh);
  const EdgeCounts counts = countEdges(half_edges);
  const Components components = componentsOf(mesh);
  topology.closed = counts.open == 0;
  topology.oriented = counts.oriented;
  topology.manifold = counts.crowded == 0 && verticesAreFans(mesh);
  topology.open_edges = counts.open;
  topology.crowded_edges = counts.crowded;
  topology.outward =
      topology.closed && topology.oriented &&
      std::all_of(components.volumes.begin(), components.volumes.end(), [](double v) { return v > 0.0; });
  topology.components = components.roots.size();
  topology.euler_characteristic = static_cast<int>(usedVertices(half_edges)) -
                                  static_cast<int>(counts.edges) + static_cast<int>(mesh.triangles.size());
  return topology;
}

// Sums over the tetrahedra from an apex to each triangle. The second moments of one with edge vectors a, b, c
// are volume / 20 (s s^T + a a^T + b b^T + c c^T), s = a + b + c. The apex is a vertex: far from the origin
// nothing cancels.
MassProperties massPropertiesOf(const TriangleMesh& mesh) {
  const Vector3d apex = mesh.vertices[mesh.triangles.front()[0]];
  double volume = 0.0;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  for (const Triangle& t : mesh.triangles) {
    const double v = signedVolume(mesh, t, apex);
    const Vector3d a = mesh.vertices[t[0]] - apex, b = mesh.vertices[t[1]] - apex,
                   c = mesh.vertices[t[2]] - apex;
    const Vector3d s = a + b + c;
    volume += v;
    first += v / 4.0 * s;
    second += v / 20.0 * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  const Vector3d center = first / volume;
  const Matrix3d central = second - volume * center * center.transpose();
  return {volume, apex + center, central.trace() * Matrix3d::Identity() - central};
}

double surfaceArea(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const Vector3d& a = mesh.vertices[t[0]];
    area += 0.5 * (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm();
  }
  return area;
}

double largestDistance(const TriangleMesh& mesh, const Vector3d& p_M) {
  double squared = 0.0;
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) squared = std::max(squared, (mesh.vertices[v] - p_M).squaredNorm());
  }
  return std::sqrt(squared);
}

}  // namespace boxgrasp
