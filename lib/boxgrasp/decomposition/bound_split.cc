#include <algorithm>
#include <cmath>
#include <limits>

#include "boxgrasp/decomposition/splits.h"

namespace boxgrasp {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A bounding rectangle that grows: along the direction that is cut and across it.
struct Bounds {
  double low = kInfinity, high = -kInfinity, low_across = kInfinity, high_across = -kInfinity;
  std::size_t points = 0;

  void add(double along, double across) {
    low = std::min(low, along), high = std::max(high, along);
    low_across = std::min(low_across, across), high_across = std::max(high_across, across);
    ++points;
  }
  void add(const Bounds& other) {
    low = std::min(low, other.low), high = std::max(high, other.high);
    low_across = std::min(low_across, other.low_across),
    high_across = std::max(high_across, other.high_across);
    points += other.points;
  }
  double area() const { return points ? (high - low) * (high_across - low_across) : 0.0; }
};

struct Position {
  double theta = kInfinity;
  double offset = 0.0;
};

// Points fall into strips between neighbouring cuts; the sides of each cut are the sums of the strips before
// and behind it.
Position bestPosition(const std::vector<double>& along, const std::vector<double>& across, double area,
                      double step, std::size_t least) {
  const auto [low, high] = std::minmax_element(along.begin(), along.end());
  const auto strips = static_cast<std::size_t>(std::ceil((*high - *low) / step)) + 1;
  std::vector<Bounds> strip(strips);
  for (std::size_t i = 0; i < along.size(); ++i) {
    const double place = std::ceil((along[i] - *low) / step);
    strip[std::min(strips - 1, static_cast<std::size_t>(place))].add(along[i], across[i]);
  }
  std::vector<Bounds> behind(strips + 1);
  for (std::size_t k = strips; k-- > 0;) {
    behind[k] = behind[k + 1];
    behind[k].add(strip[k]);
  }
  Position best;
  Bounds before;
  for (std::size_t k = 0; k + 1 < strips; ++k) {
    before.add(strip[k]);
    const double theta = (before.area() + behind[k + 1].area()) / area;
    if (before.points >= least && behind[k + 1].points >= least && theta < best.theta)
      best = {theta, *low + step * static_cast<double>(k)};
  }
  return best;
}

}  // namespace

std::optional<BestLine> bestBoundLine(const FaceProjections& faces, const DecompositionOptions& options) {
  const std::size_t least = leastPoints(faces[0].size(), options.min_point_fraction);
  std::optional<BestLine> best;
  for (int f = 0; f < 3; ++f) {
    const FaceProjection& face = faces[f];
    const Position vertical = bestPosition(face.x, face.y, face.area, options.bound_step_m, least);
    const Position horizontal = bestPosition(face.y, face.x, face.area, options.bound_step_m, least);
    const bool upright = vertical.theta <= horizontal.theta;
    const Position& position = upright ? vertical : horizontal;
    if (position.theta == kInfinity || (best && position.theta >= best->theta)) continue;
    best = BestLine{position.theta, f, {upright ? Vector2d::UnitX() : Vector2d::UnitY(), position.offset}};
  }
  return best;
}

}  // namespace boxgrasp
