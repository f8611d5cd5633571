#include "boxgrasp/wrench/hull.h"

#include <Eigen/QR>
#include <algorithm>

#include "boxgrasp/base/tolerances.h"
#include "boxgrasp/wrench/general_hull.h"
#include "boxgrasp/wrench/simplicial_hull.h"

namespace boxgrasp {
namespace {

constexpr std::size_t kFewPoints = 128;  // sixteen contacts with eight edges: some 15,000 facets

std::vector<Wrench> distinct(std::vector<Wrench> points) {
  std::sort(points.begin(), points.end(), [](const Wrench& a, const Wrench& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

// Puts seven points that span the space first, and far apart. False: there are none.
bool spanningFirst(std::vector<Wrench>& points) {
  if (points.size() < 7) return false;
  WrenchMatrix edges(6, points.size() - 1);
  for (std::size_t i = 1; i < points.size(); ++i) edges.col(i - 1) = points[i] - points[0];
  Eigen::ColPivHouseholderQR<WrenchMatrix> qr(edges);
  const std::vector<Wrench> before = points;
  for (std::size_t i = 1; i < points.size(); ++i) {
    points[i] = before[1 + qr.colsPermutation().indices()[i - 1]];
  }
  return qr.setThreshold(tolerance::kWrenchRank).rank() == 6;
}

}  // namespace

WrenchHull wrenchHull(std::vector<Wrench> points) {
  points = distinct(std::move(points));
  if (!spanningFirst(points)) return {};
  if (points.size() <= kFewPoints) {
    const Eigen::Map<const WrenchMatrix> columns(points.front().data(), 6, points.size());
    if (const auto hull = simplicialHull(columns)) return *hull;
  }
  return generalHull(std::move(points));
}

}  // namespace boxgrasp
