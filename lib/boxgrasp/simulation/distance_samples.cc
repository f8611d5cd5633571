#include "boxgrasp/simulation/distance_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace boxgrasp {
namespace {

using Index = Eigen::Vector3i;

constexpr std::int32_t kNone = -1;

std::array<Vector3d, 3> cornersOf(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
}

Index clampedIndex(const SampleGrid& grid, const Vector3d& p, double rounding) {
  const Eigen::Array3d steps = ((p - grid.origin) / grid.cell + Vector3d::Constant(rounding)).array().floor();
  return steps.max(0.0).min(grid.size.cast<double>().array() - 1.0).matrix().cast<int>();
}

// Distances as they become known, with the triangle that each was measured to.
class Nearest {
 public:
  Nearest(const TriangleMesh& mesh, const SampleGrid& grid)
      : mesh_(mesh),
        grid_(grid),
        squared_(grid.count(), std::numeric_limits<double>::infinity()),
        triangle_(grid.count(), kNone) {}

  void nearSurface();
  void sweep(const Index& direction);
  double distance(std::size_t sample) const { return std::sqrt(squared_[sample]); }

 private:
  void offer(const Index& at, std::int32_t triangle);
  void inherit(const Index& at, const Index& direction);

  const TriangleMesh& mesh_;
  const SampleGrid& grid_;
  std::vector<double> squared_;
  std::vector<std::int32_t> triangle_;
};

void Nearest::offer(const Index& at, std::int32_t triangle) {
  const std::size_t i = grid_.index(at);
  if (triangle == kNone || triangle == triangle_[i]) return;
  const Vector3d p = grid_.position(at);
  const double squared = (closestPoint(cornersOf(mesh_, triangle), p) - p).squaredNorm();
  if (squared >= squared_[i]) return;
  squared_[i] = squared;
  triangle_[i] = triangle;
}

void Nearest::nearSurface() {
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    const auto corners = cornersOf(mesh_, t);
    const Vector3d low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]);
    const Vector3d high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
    const Index first = clampedIndex(grid_, low, 0.0), last = clampedIndex(grid_, high, 1.0);
    for (int z = first.z(); z <= last.z(); ++z) {
      for (int y = first.y(); y <= last.y(); ++y) {
        for (int x = first.x(); x <= last.x(); ++x) offer({x, y, z}, static_cast<std::int32_t>(t));
      }
    }
  }
}

void Nearest::inherit(const Index& at, const Index& direction) {
  for (int which = 1; which < 8; ++which) {
    const Index from = at - Index(which & 1, which >> 1 & 1, which >> 2 & 1).cwiseProduct(direction);
    if (grid_.contains(from)) offer(at, triangle_[grid_.index(from)]);
  }
}

// Carries nearest triangles across the grid, towards one of the eight octants.
void Nearest::sweep(const Index& direction) {
  Index k;
  for (k.z() = 0; k.z() < grid_.size.z(); ++k.z()) {
    for (k.y() = 0; k.y() < grid_.size.y(); ++k.y()) {
      for (k.x() = 0; k.x() < grid_.size.x(); ++k.x()) {
        inherit((direction.array() > 0).select(k, grid_.size - Index::Ones() - k), direction);
      }
    }
  }
}

// Where the line along x through (y, z) crosses the triangle, if it does. A line through an edge or a vertex
// counts as crossing exactly one of the triangles about it: ends of edges belong to the upper side, and both
// triangles of an edge compute its crossing from the same numbers in the same order.
struct EdgeCrossing {
  double z, x;
};

EdgeCrossing crossEdge(const Vector3d& a, const Vector3d& b, double y) {
  const double t = (y - a.y()) / (b.y() - a.y());
  return {a.z() + t * (b.z() - a.z()), a.x() + t * (b.x() - a.x())};
}

class SignRow {
 public:
  SignRow(const TriangleMesh& mesh, const SampleGrid& grid)
      : mesh_(mesh), grid_(grid), crossings_(std::size_t(grid.size.y()) * grid.size.z()) {
    for (const auto& triangle : mesh.triangles) add(triangle);
    for (auto& row : crossings_) std::sort(row.begin(), row.end());
  }

  // The x of every crossing of the surface with the line of samples (y, z), rising.
  const std::vector<double>& crossings(int y, int z) const {
    return crossings_[std::size_t(z) * grid_.size.y() + y];
  }

 private:
  void add(const std::array<std::uint32_t, 3>& triangle);
  void addLine(const std::array<std::uint32_t, 3>& triangle, int y, int first_z, int last_z);

  const TriangleMesh& mesh_;
  const SampleGrid& grid_;
  std::vector<std::vector<double>> crossings_;
};

void SignRow::add(const std::array<std::uint32_t, 3>& triangle) {
  Vector3d low = mesh_.vertices[triangle[0]], high = low;
  for (const std::uint32_t v : triangle) {
    low = low.cwiseMin(mesh_.vertices[v]);
    high = high.cwiseMax(mesh_.vertices[v]);
  }
  const Index first = clampedIndex(grid_, low, 0.0), last = clampedIndex(grid_, high, 1.0);
  for (int y = first.y(); y <= last.y(); ++y) addLine(triangle, y, first.z(), last.z());
}

void SignRow::addLine(const std::array<std::uint32_t, 3>& triangle, int y, int first_z, int last_z) {
  const double at_y = grid_.position({0, y, 0}).y();
  std::vector<EdgeCrossing> ends;
  for (int i = 0; i < 3; ++i) {
    const auto [u, v] = std::minmax(triangle[i], triangle[(i + 1) % 3]);
    const Vector3d &a = mesh_.vertices[u], &b = mesh_.vertices[v];
    if ((a.y() <= at_y) != (b.y() <= at_y)) ends.push_back(crossEdge(a, b, at_y));
  }
  if (ends.size() != 2) return;
  if (ends[1].z < ends[0].z) std::swap(ends[0], ends[1]);
  for (int z = first_z; z <= last_z; ++z) {
    const double at_z = grid_.position({0, 0, z}).z();
    if ((ends[0].z <= at_z) == (ends[1].z <= at_z)) continue;
    const double t = (at_z - ends[0].z) / (ends[1].z - ends[0].z);
    crossings_[std::size_t(z) * grid_.size.y() + y].push_back(ends[0].x + t * (ends[1].x - ends[0].x));
  }
}

void setSigns(const TriangleMesh& mesh, const SampleGrid& grid, std::vector<float>& distances) {
  const SignRow rows(mesh, grid);
  for (int z = 0; z < grid.size.z(); ++z) {
    for (int y = 0; y < grid.size.y(); ++y) {
      const std::vector<double>& crossings = rows.crossings(y, z);
      auto next = crossings.begin();
      for (int x = 0; x < grid.size.x(); ++x) {
        const double at_x = grid.position({x, y, z}).x();
        while (next != crossings.end() && *next < at_x) ++next;
        float& distance = distances[grid.index({x, y, z})];
        if ((next - crossings.begin()) % 2 == 1) distance = -distance;
      }
    }
  }
}

}  // namespace

// Which feature is nearest follows from the signs of projections (Ericson, Real-Time Collision
// Detection, 5.1.5).
Vector3d closestPoint(const std::array<Vector3d, 3>& triangle, const Vector3d& p) {
  const auto& [a, b, c] = triangle;
  const Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double sum = va + vb + vc;
  return a + vb / sum * ab + vc / sum * ac;
}

std::vector<float> signedDistances(const TriangleMesh& mesh, const SampleGrid& grid) {
  Nearest nearest(mesh, grid);
  nearest.nearSurface();
  for (int octant = 0; octant < 8; ++octant) {
    nearest.sweep(Index(octant & 1, octant >> 1 & 1, octant >> 2 & 1) * 2 - Index::Ones());
  }
  std::vector<float> distances(grid.count());
  for (std::size_t i = 0; i < distances.size(); ++i) distances[i] = static_cast<float>(nearest.distance(i));
  setSigns(mesh, grid, distances);
  return distances;
}

}  // namespace boxgrasp
