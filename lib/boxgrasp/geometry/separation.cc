#include "boxgrasp/geometry/separation.h"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace boxgrasp {

Support ballAround(const Vector3d& center, double radius) { return capsuleBetween(center, center, radius); }

Support capsuleBetween(const Vector3d& a, const Vector3d& b, double radius) {
  return [=](const Vector3d& direction) -> Vector3d {
    return (direction.dot(b - a) > 0 ? b : a) + radius * direction.normalized();
  };
}

Support cylinderBetween(const Vector3d& a, const Vector3d& b, double radius) {
  const Vector3d axis = (b - a).normalized();
  return [=](const Vector3d& direction) -> Vector3d {
    const Vector3d across = direction - direction.dot(axis) * axis;
    return (direction.dot(axis) > 0 ? b : a) + radius * across.stableNormalized();
  };
}

Support alignedBox(const Eigen::AlignedBox3d& box) {
  return [=](const Vector3d& direction) -> Vector3d {
    return (direction.array() > 0).select(box.max(), box.min());
  };
}

Support swept(Support body, const Vector3d& way) {
  return [body = std::move(body), way](const Vector3d& direction) -> Vector3d {
    const Vector3d p = body(direction);
    return direction.dot(way) > 0 ? Vector3d(p + way) : p;
  };
}

namespace {

// The corners of a simplex, at most four, and its point nearest to the origin.
struct Simplex {
  std::vector<Vector3d> corners;
  Vector3d nearest = Vector3d::Zero();
};

// The nearest point of the corners' affine hull, if it lies within the simplex.
std::optional<Vector3d> nearestInside(const std::vector<Vector3d>& corners) {
  const Eigen::Index n = static_cast<Eigen::Index>(corners.size()) - 1;
  if (n == 0) return corners.front();
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> edges(3, n);
  for (Eigen::Index i = 0; i < n; ++i) edges.col(i) = corners[i + 1] - corners[0];
  const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> weights =
      edges.colPivHouseholderQr().solve(-corners[0]);
  if (!(weights.minCoeff() >= 0 && weights.sum() <= 1)) return std::nullopt;
  return corners[0] + edges * weights;
}

// Of all simplices with some of these corners the one that comes nearest to the origin.
Simplex nearestPart(const std::vector<Vector3d>& corners) {
  Simplex best{{}, Vector3d::Constant(INFINITY)};
  for (unsigned some = 1; some < 1u << corners.size(); ++some) {
    std::vector<Vector3d> chosen;
    for (unsigned i = 0; i < corners.size(); ++i) {
      if (some >> i & 1) chosen.push_back(corners[i]);
    }
    const std::optional<Vector3d> nearest = nearestInside(chosen);
    if (nearest && nearest->squaredNorm() < best.nearest.squaredNorm()) best = {std::move(chosen), *nearest};
  }
  return best;
}

}  // namespace

// Works on the difference of the bodies, a - b: they meet if the origin is in it.
bool apart(const Support& a, const Support& b, double margin_m) {
  constexpr int kSteps = 100;
  const auto support = [&](const Vector3d& direction) -> Vector3d { return a(direction) - b(-direction); };
  Simplex simplex = nearestPart({support(Vector3d::UnitX())});
  for (int step = 0; step < kSteps && simplex.nearest.norm() > margin_m && simplex.corners.size() < 4;
       ++step) {
    const Vector3d furthest = support(-simplex.nearest);  // towards the origin
    if (furthest.dot(simplex.nearest) > 0) return true;
    simplex.corners.push_back(furthest);
    simplex = nearestPart(simplex.corners);
  }
  return false;
}

}  // namespace boxgrasp
