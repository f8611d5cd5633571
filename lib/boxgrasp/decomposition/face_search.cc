#include "boxgrasp/decomposition/face_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace boxgrasp {
namespace {

constexpr int kSupports = 32;            // directions whose farthest points make the first guess of a hull
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
  few_ = blocks_.spreadPoints(kFewSpread);
  std::sort(few_.begin(), few_.end(), lexicographic);
}

// The points next to the line join the known few, and what the hulls of these leave open is looked at.
double FaceSearch::theta(const Line& line, const MeasuredLines& measured) const {
  std::optional<Sides> sides = Sides::of(*arcs_, line);
  if (!sides) return plainTheta(face_, line);
  sides->add(few_);
  if (const double bound = sides->area() / face_.area; !measured.mayWin(bound)) return bound;
  std::vector<Vector2d> found;
  blocks_.appendNearest(blocks_.openBlocks(sides->firstInside(), sides->secondInside()), line, found);
  sides->add(std::move(found));
  if (const double bound = sides->area() / face_.area; !measured.mayWin(bound)) return bound;
  const Region first = sides->firstInside(), second = sides->secondInside();
  found.clear();
  blocks_.appendOpenPoints(blocks_.openBlocks(first, second), first, second, found);
  sides->add(std::move(found));
  return sides->area() / face_.area;
}

Polygon FaceSearch::outerHull() const {
  std::vector<Vector2d> points;
  for (int i = 0; i < kSupports; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSupports;
    points.push_back(
        blocks_.support(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))));
  }
  points = convexHull(std::move(points));
  const Region inside = insideOf(points);
  blocks_.appendOpenPoints(blocks_.openBlocks(inside, inside), inside, inside, points);
  return convexHull(std::move(points));
}

}  // namespace boxgrasp
