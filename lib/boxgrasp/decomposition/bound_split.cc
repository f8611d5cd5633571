#include <algorithm>
#include <limits>

#include "boxgrasp/decomposition/splits.h"

namespace boxgrasp {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kMostCuts = 10'000;  // along an edge: bounds the work on clouds far larger than a hand

// A bounding rectangle that grows: along the direction that is cut and across it.
struct Bounds {
  float low = kInfinity, high = -kInfinity, low_across = kInfinity, high_across = -kInfinity;
  std::size_t points = 0;

  void add(float along, float across) {
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
  double area() const {
    if (points == 0) return 0.0;
    return (static_cast<double>(high) - low) * (static_cast<double>(high_across) - low_across);
  }
};

struct Position {
  double theta = kInfinity;
  float offset = 0.0f;  // the last coordinate on the first side
};

// Points fall into strips between neighbouring cuts; the sides of each cut are the sums of the strips before
// and behind it.
Position bestPosition(std::span<const float> along, std::span<const float> across, double area, double step_m,
                      std::size_t least) {
  const auto [low, high] = std::minmax_element(along.begin(), along.end());
  const double start = *low, length = static_cast<double>(*high) - start;
  const double step = std::max(step_m, length / kMostCuts);
  std::vector<Bounds> strips(static_cast<std::size_t>(length / step) + 2);
  for (std::size_t i = 0; i < along.size(); ++i) {
    const double place = (along[i] - start) / step;
    const auto whole = static_cast<std::uint32_t>(place);
    strips[whole + (place > whole ? 1 : 0)].add(along[i], across[i]);
  }
  std::vector<Bounds> behind(strips.size() + 1);
  for (std::size_t k = strips.size(); k-- > 0;) {
    behind[k] = behind[k + 1];
    behind[k].add(strips[k]);
  }
  Position best;
  Bounds before;
  for (std::size_t k = 0; k < strips.size(); ++k) {
    before.add(strips[k]);
    const double theta = (before.area() + behind[k + 1].area()) / area;
    if (before.points >= least && behind[k + 1].points >= least && theta < best.theta)
      best = {theta, before.high};
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
    best = BestLine{position.theta, f, upright ? Line{1, 0, position.offset} : Line{0, 1, position.offset}};
  }
  return best;
}

}  // namespace boxgrasp
