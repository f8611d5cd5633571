#include "boxgrasp/decomposition/face_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "boxgrasp/decomposition/line_bounds.h"

namespace boxgrasp {
namespace {

constexpr int kSupports = 32;            // directions whose farthest points make the first guess of a hull
constexpr std::size_t kFewSpread = 128;  // points in the inside that are known before a line is measured

}  // namespace

FaceSearch::FaceSearch(const FaceProjection& face, const DecompositionOptions& options)
    : face_(face), blocks_(face) {
  hull_ = outerHull();
  outermost_.assign(hull_);
  cuts_ = cutLines(hull_, options);
  bounds_.resize(cuts_.lines.size(), 0.0);
  few_ = withSpread(hull_, kFewSpread);
  std::sort(few_.begin(), few_.end(),
            lexicographic);  // their hulls are found faster so
}

void FaceSearch::bound(std::size_t spread, const MeasuredLines& measured) {
  raiseThetaBounds(
      face_, withSpread(hull_, spread), cuts_, [&](double b) { return measured.mayWin(b); }, bounds_);
}

std::size_t FaceSearch::fans(const MeasuredLines& measured) const {
  std::size_t count = 0, last = cuts_.samples.size();
  for (std::size_t i = 0; i < bounds_.size(); ++i) {
    if (!measured.mayWin(bounds_[i]) || cuts_.lines[i].from == last) continue;
    last = cuts_.lines[i].from;
    ++count;
  }
  return count;
}

double FaceSearch::take(std::size_t index, const MeasuredLines& measured) {
  bounds_[index] = std::numeric_limits<double>::infinity();
  return theta(line(index), measured);
}

std::vector<Vector2d> FaceSearch::withSpread(std::vector<Vector2d> points, std::size_t spread) const {
  const std::vector<Vector2d> inside = blocks_.spreadPoints(spread);
  points.insert(points.end(), inside.begin(), inside.end());
  return points;
}

// Theta on all points, or a bound that shows that the line cannot win. The points next to the line join the
// known few, and what the hulls of these leave open is looked at.
double FaceSearch::theta(const Line& line, const MeasuredLines& measured) const {
  Sides sides;
  part(few_, line, sides);
  std::vector<Vector2d> found;
  sides = hullsOf(std::move(sides));
  blocks_.appendNearest(openBlocks(sides, line), line, found);
  part(found, line, sides);
  sides = hullsOf(std::move(sides));
  if (const double bound = thetaOf(sides, face_); !measured.mayWin(bound)) return bound;
  found.clear();
  const auto [first, second] = regionsOf(sides, line);
  blocks_.appendOpenPoints(blocks_.openBlocks(first, second), first, second, found);
  part(found, line, sides);
  return thetaOf(hullsOf(std::move(sides)), face_);
}

Polygon FaceSearch::outerHull() const {
  std::vector<Vector2d> points;
  for (int i = 0; i < kSupports; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSupports;
    points.push_back(
        blocks_.support(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))));
  }
  points = convexHull(std::move(points));
  const Region inside = insideOf(points, {});
  blocks_.appendOpenPoints(blocks_.openBlocks(inside, inside), inside, inside, points);
  return convexHull(std::move(points));
}

std::pair<Region, Region> FaceSearch::regionsOf(const Sides& hulls, const Line& line) const {
  Region first = insideOf(hulls.first, outermost_), second = insideOf(hulls.second, outermost_);
  first.push_back({line.normal_x, line.normal_y, line.offset});
  second.push_back({-line.normal_x, -line.normal_y, -line.offset});
  return {std::move(first), std::move(second)};
}

std::vector<std::uint32_t> FaceSearch::openBlocks(const Sides& hulls, const Line& line) const {
  const auto [first, second] = regionsOf(hulls, line);
  return blocks_.openBlocks(first, second);
}

}  // namespace boxgrasp
