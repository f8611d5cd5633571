#include "boxgrasp/geometry/exhaustive_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "boxgrasp/geometry/canonical_frame.h"
#include "boxgrasp/geometry/orientation_search.h"
#include "boxgrasp/geometry/oriented_box.h"

namespace boxgrasp {
namespace {

constexpr std::size_t kDirections = 4000;  // 2.3 degrees apart
constexpr std::size_t kRefined = 60;       // more than the local minima of any shape tried
constexpr double kFirstTurn = 0.04, kLastTurn = 1e-6;

struct Candidate {
  Vector3d edge;
  Matrix3d axes;
  double volume;
};

Candidate candidateAlong(const PointCloud& cloud, const Vector3d& edge) {
  const Matrix3d axes = smallestBoxAxes(cloud, edge);
  return {edge, axes, boxAround(cloud, axes).volume()};
}

bool smaller(const Candidate& a, const Candidate& b) { return a.volume < b.volume; }

Candidate refined(const PointCloud& cloud, Candidate best, const StopToken& stop) {
  for (double turn = kFirstTurn; turn > kLastTurn;) {
    stop.check();
    const Candidate before = best;
    const Vector3d u = before.edge.unitOrthogonal(), v = before.edge.cross(u);
    for (int k = 0; k < 8; ++k) {
      const double angle = k * std::numbers::pi / 4.0;
      const Vector3d edge = before.edge + turn * (std::cos(angle) * u + std::sin(angle) * v);
      best = std::min(best, candidateAlong(cloud, edge.normalized()), smaller);
    }
    if (best.volume == before.volume) turn *= 0.5;
  }
  return best;
}

}  // namespace

std::vector<Vector3d> halfSphere(std::size_t n) {
  const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::vector<Vector3d> directions;
  for (std::size_t i = 0; i < n; ++i) {
    const double z = (static_cast<double>(i) + 0.5) / static_cast<double>(n), radius = std::sqrt(1.0 - z * z);
    const double angle = golden_angle * static_cast<double>(i);
    directions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return directions;
}

Matrix3d exhaustiveBoxAxes(const PointCloud& cloud_C, const StopToken& stop) {
  const Matrix3d axes_CK = canonicalFrame(cloud_C).linear();
  std::vector<Candidate> candidates;
  for (const Vector3d& edge_K : halfSphere(kDirections)) {
    stop.check();
    candidates.push_back(candidateAlong(cloud_C, axes_CK * edge_K));
  }
  std::stable_sort(candidates.begin(), candidates.end(), smaller);
  Candidate best = candidates.front();
  for (std::size_t i = 0; i < kRefined; ++i)
    best = std::min(best, refined(cloud_C, candidates[i], stop), smaller);
  return best.axes;
}

}  // namespace boxgrasp
