#include "boxgrasp/decomposition/face_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace boxgrasp {
namespace {

constexpr int kSupports = 32;            // directions whose farthest points make the first guess of a hull
constexpr int kOutermostDepth = 2;       // three points on either side of a line
constexpr std::size_t kFewSpread = 128;  // points in the inside that are known before a line is measured

}  // namespace

FaceSearch::FaceSearch(const FaceProjection& face, const BlockedValues& x, const BlockedValues& y,
                       const DecompositionOptions& options)
    : face_(face), blocks_(x, y) {
  Polygon hull = outerHull();
  if (hull.size() < 3) return;
  cuts_ = cutLines(hull, options);
  arcs_.emplace(std::move(hull));
  bounds_.emplace(*arcs_, cuts_, face_.area, blocks_.spreadPoints(kMostBoundPoints));
  few_ = PointPool(blocks_.spreadPoints(kFewSpread));
}

double FaceSearch::theta(const Line& line, const MeasuredLines& measured) {
  std::optional<Sides> sides = Sides::of(*arcs_, line);
  if (!sides) return plainTheta(face_, line);
  addAll(few_, *sides);
  const Polygon known_first = sides->first().cap(), known_second = sides->second().cap();
  const double theta = thetaByFewPoints(*sides, line, measured);
  remember(sides->first().cap(), known_first);
  remember(sides->second().cap(), known_second);
  return theta;
}

// The outermost points first: few others are open then.
void FaceSearch::addAll(const PointPool& points, Sides& sides) const {
  for (const HalfHull* half : {&sides.first(), &sides.second()}) {
    std::vector<Vector2d> outermost;
    PoolGrowth(points, half->side(), blocks_.margin())
        .beyond(half->chord(), kOutermostDepth, [&](const Vector2d& p) { outermost.push_back(p); });
    sides.add(outermost);
  }
  std::vector<Vector2d> open;
  points.appendOpenPoints(sides.first().inside(), sides.second().inside(), blocks_.margin(), open);
  sides.add(open);
}

// The points next to the line join the known few, and what the hulls of these leave open is looked at.
double FaceSearch::thetaByFewPoints(Sides& sides, const Line& line, const MeasuredLines& measured) const {
  if (const double bound = sides.area() / face_.area; !measured.mayWin(bound)) return bound;
  std::vector<Vector2d> found;
  blocks_.appendNearest(blocks_.openBlocks(sides.first().inside(), sides.second().inside()), line, found);
  sides.add(found);
  if (const double bound = sides.area() / face_.area; !measured.mayWin(bound)) return bound;
  const Region first = sides.first().inside(), second = sides.second().inside();
  found.clear();
  blocks_.appendOpenPoints(blocks_.openBlocks(first, second), first, second, found);
  sides.add(found);
  return sides.area() / face_.area;
}

void FaceSearch::remember(const Polygon& vertices, const Polygon& known) {
  for (const Vector2d& p : vertices) {
    if (std::ranges::find(known, p) == known.end()) few_.add(p);
  }
}

Polygon FaceSearch::outerHull() const {
  std::vector<Vector2d> points;
  for (int i = 0; i < kSupports; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSupports;
    points.push_back(
        blocks_.support(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))));
  }
  const Polygon guess = convexHull(points);
  if (guess.size() < 2) return guess;
  points = guess;
  for (std::size_t i = 0; i < guess.size(); ++i) {
    const Vector2d &from = guess[i], &to = guess[(i + 1) % guess.size()];
    const Polygon hull = hullBeyond(from, to, blocks_.pointsOutside(leftOf(from, to)));
    points.insert(points.end(), hull.begin(), hull.end());
  }
  return convexHull(std::move(points));
}

}  // namespace boxgrasp
