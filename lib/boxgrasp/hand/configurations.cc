#include "boxgrasp/hand/configurations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/tolerances.h"

namespace boxgrasp {
namespace {

// A solution in the plane: the palm's origin lies `thumb_reach` along `h` from the thumb's point.
struct PlanarSolution {
  double thumb_angle;
  Vector2d h;  // +y of the palm, in F: the direction in which the thumb pushes
  std::array<int, 3> point_of_finger;
  double spread;
  std::array<double, 3> reach;  // from the spread axes (thumb: the hand's axis) to the points
  double tilt;                  // summed over the fingers: 1 - cosine of the angle between push and normal
};

// A point as seen from the thumb's point: a across the hand (along +x of P), b along it (+y of P).
struct HandCoordinates {
  double a, b;
};

bool within(double value, double min, double max) { return value >= min && value <= max; }

// The solutions for one triplet and one thumb point, for every step of the thumb angle.
class PlanarSearch {
 public:
  PlanarSearch(const HandDescription& hand, const Reach& reach, const Triplet& triplet,
               const ConfigurationOptions& options)
      : hand_(hand),
        triplet_(triplet),
        options_(options),
        cone_angle_(std::atan(options.friction)),
        cone_cosine_(std::cos(cone_angle_)),
        min_reach_(hand.base_radius + reach.extension_min_m),
        max_reach_(hand.base_radius + reach.extension_max_m) {}

  // Appends the solutions with this thumb point to `solutions`, and counts the steps that have none.
  void search(int thumb, std::vector<PlanarSolution>& solutions, std::array<std::size_t, 4>& rejected) {
    thumb_ = thumb;
    const int n = options_.thumb_steps;
    const auto angle = [&](int step) { return (2.0 * step + 1.0 - n) / n * cone_angle_; };
    // Turned on from step to step: a sine and a cosine for each would take most of the time.
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(2.0 * cone_angle_ / n).toRotationMatrix();
    Vector2d h = Eigen::Rotation2Dd(angle(0)) * triplet_.normals_F[thumb];
    for (int step = 0; step < n; ++step, h = turn * h) {
      if (const auto reason = solveStep(angle(step), h, solutions))
        ++rejected[static_cast<std::size_t>(*reason)];
    }
  }

 private:
  std::optional<ReachRejection> solveStep(double angle, const Vector2d& h,
                                          std::vector<PlanarSolution>& solutions) const {
    int f1 = (thumb_ + 1) % 3, f2 = (thumb_ + 2) % 3;
    HandCoordinates c1 = coordinates(f1, h), c2 = coordinates(f2, h);
    if (c1.a < c2.a) {
      std::swap(f1, f2);
      std::swap(c1, c2);
    }
    // F1 and F2 stand beyond their spread axes: their lines of push come from outside.
    const double B1 = c1.a - hand_.spread_offset, B2 = -c2.a - hand_.spread_offset;
    PlanarSolution solution{angle, h, {f1, f2, thumb_}, 0.0, {}, 0.0};
    const std::size_t before = solutions.size();
    std::optional<ReachRejection> reason = ReachRejection::spread_or_side;
    if (std::max(std::abs(B1), std::abs(B2)) < tolerance::kSymmetricFingers)
      reason = solveParallel(solution, c1.b, c2.b, solutions);
    if (B1 < 0 || B2 < 0) return solutions.size() > before ? std::nullopt : reason;
    reason = std::max(reason, solveExactly(solution, {B1, c1.b}, {B2, c2.b}, solutions));
    const double apart_a = std::abs(B1 - B2), apart_b = std::abs(c1.b - c2.b);
    if (apart_a < tolerance::kSymmetricFingers && apart_b < tolerance::kSymmetricFingers)
      reason = std::max(reason, sweepSpread(solution, {B1, c1.b}, {B2, c2.b}, solutions));
    return solutions.size() > before ? std::nullopt : reason;
  }

  // F1's and F2's points are straight ahead of their spread axes: the fingers stay parallel, whatever the
  // palm's place along them. It is put midway, where all three are closed alike and end at one depth. A jaw
  // cannot bend to two points of which one stands back: it may do so by what the object turns on it.
  std::optional<ReachRejection> solveParallel(PlanarSolution solution, double b1, double b2,
                                              std::vector<PlanarSolution>& solutions) const {
    if (hand_.prismatic()) {
      if (std::abs(b1 - b2) > 2 * hand_.spread_offset * options_.friction)
        return ReachRejection::friction_cone;
      b1 = b2 = std::max(b1, b2);
    }
    const double s = 0.25 * (b1 + b2);
    solution.reach = {b1 - s, b2 - s, s};
    return check(solution, {0.0, 1.0}, solutions);
  }

  // The mirror image of F2's point in the thumb's axis, F1's point and the spread axis lie on one line.
  // Points relative to their finger's spread axis in a, to the thumb's point in b, both counted outwards.
  std::optional<ReachRejection> solveExactly(PlanarSolution solution, const HandCoordinates& p1,
                                             const HandCoordinates& p2,
                                             std::vector<PlanarSolution>& solutions) const {
    if (p1.a == p2.a) return ReachRejection::extension;
    const double s = (p2.b * p1.a - p1.b * p2.a) / (p1.a - p2.a);
    const Vector2d from_axis(p1.a, p1.b - s);
    solution.reach = {from_axis.norm(), Vector2d(p2.a, p2.b - s).norm(), s};
    return check(solution, from_axis / solution.reach[kF1], solutions);
  }

  HandCoordinates coordinates(int point, const Vector2d& h) const {
    const Vector2d p = triplet_.points_F[point] - triplet_.points_F[thumb_];
    return {p.x() * h.y() - p.y() * h.x(), p.dot(h)};
  }

  // F1's and F2's points mirror each other: any spread fits, each with its own place of the palm.
  std::optional<ReachRejection> sweepSpread(PlanarSolution solution, const HandCoordinates& p1,
                                            const HandCoordinates& p2,
                                            std::vector<PlanarSolution>& solutions) const {
    std::optional<ReachRejection> furthest;
    const double mean_a = 0.5 * (p1.a + p2.a), mean_b = 0.5 * (p1.b + p2.b);
    const double step = (hand_.spread_max - hand_.spread_min) / options_.thumb_steps;
    for (int i = 0; i < options_.thumb_steps; ++i) {
      const double spread = hand_.spread_min + (i + 0.5) * step;
      const Vector2d direction(std::sin(spread), std::cos(spread));
      const double s = mean_b - mean_a * direction.y() / direction.x();
      solution.reach = {direction.dot(Vector2d(p1.a, p1.b - s)), direction.dot(Vector2d(p2.a, p2.b - s)), s};
      furthest = std::max(furthest, check(solution, direction, solutions));
    }
    return furthest;
  }

  // Appends the solution if the hand can take it. `direction`: from F1's spread axis to its tip, in hand
  // coordinates.
  std::optional<ReachRejection> check(PlanarSolution solution, const Vector2d& direction,
                                      std::vector<PlanarSolution>& solutions) const {
    for (const double reach : solution.reach) {
      if (!within(reach, min_reach_, max_reach_)) return ReachRejection::extension;
    }
    const Vector2d k(solution.h.y(), -solution.h.x());
    const double cosine1 = -(direction.y() * solution.h + direction.x() * k).dot(normalOf(solution, kF1));
    const double cosine2 = -(direction.y() * solution.h - direction.x() * k).dot(normalOf(solution, kF2));
    if (cosine1 < cone_cosine_ || cosine2 < cone_cosine_) return ReachRejection::friction_cone;
    solution.spread = std::atan2(direction.x(), direction.y());
    if (!within(solution.spread, hand_.spread_min, hand_.spread_max)) return ReachRejection::spread_or_side;
    solution.tilt = 3.0 - cosine1 - cosine2 - std::cos(solution.thumb_angle);
    solutions.push_back(solution);
    return std::nullopt;
  }

  const Vector2d& normalOf(const PlanarSolution& solution, Finger finger) const {
    return triplet_.normals_F[solution.point_of_finger[finger]];
  }

  const HandDescription& hand_;
  const Triplet& triplet_;
  const ConfigurationOptions& options_;
  double cone_angle_, cone_cosine_;
  double min_reach_, max_reach_;
  int thumb_ = -1;
};

// Thumb pushing straightest first; of two equally straight ones the better for the other fingers, so that a
// mirrored triplet gives the mirrored order.
bool straighter(const PlanarSolution& x, const PlanarSolution& y) {
  const double angle_x = std::abs(x.thumb_angle), angle_y = std::abs(y.thumb_angle);
  return std::tie(angle_x, x.tilt, x.thumb_angle, x.spread) <
         std::tie(angle_y, y.tilt, y.thumb_angle, y.spread);
}

// The height of the palm's origin over the face that brings the fingertips nearest (in the sense of least
// squares) to the depths that they aim at, with each within its surface's extent; nullopt when none does.
std::optional<double> standOff(const Triplet& triplet, const HandConfiguration& hand,
                               const ConfigurationOptions& options) {
  double low = options.palm_clearance_m, high = std::numeric_limits<double>::infinity(), best = 0.0;
  for (int finger = 0; finger < 3; ++finger) {
    const int point = hand.point_of_finger[finger];
    const double nearest = triplet.nearest_depth_m[point], farthest = triplet.farthest_depth_m[point];
    const double aim = nearest + std::min(options.insertion_m, 0.5 * (farthest - nearest));
    const double height = hand.tip_height_m[finger];
    low = std::max(low, height - farthest - options.depth_tolerance_m);
    high = std::min(high, height - nearest + options.depth_tolerance_m);
    best += (height - aim) / 3.0;
  }
  if (low > high) return std::nullopt;
  return std::clamp(best, low, high);
}

// The lines of push meet on the thumb's axis, this far from the hand's axis towards F1 and F2: for spreads
// near 0 and 180 degrees far away, where the bound keeps the number finite.
double realFocusFromAxis(const HandDescription& hand, double spread) {
  return -hand.spread_offset * std::cos(spread) / std::max(std::sin(spread), tolerance::kAngle);
}

// The whole hand for a planar solution; nullopt when no height of the palm brings all fingertips onto the
// surfaces' depths.
std::optional<HandConfiguration> raise(const HandDescription& hand, const Reach& reach,
                                       const Triplet& triplet, const PlanarSolution& planar,
                                       const ConfigurationOptions& options) {
  HandConfiguration result;
  result.point_of_finger = planar.point_of_finger;
  result.thumb_angle = planar.thumb_angle;
  result.joints.spread = planar.spread;
  const Vector2d &h = planar.h, k(h.y(), -h.x());
  for (int finger = 0; finger < 3; ++finger) {
    result.extension_m[finger] = planar.reach[finger] - hand.base_radius;
    result.joints.inner[finger] = innerForExtension(hand, result.extension_m[finger], reach).value();
    result.tip_height_m[finger] = options.depth_model == DepthModel::exact || hand.prismatic()
                                      ? tipHeight(hand, result.joints.inner[finger])
                                      : linearDepth(hand, result.extension_m[finger]);
    const Vector2d outwards = fingerDirection(static_cast<Finger>(finger), planar.spread);
    result.push_F[finger] = -(outwards.x() * k + outwards.y() * h);
  }
  const auto height = standOff(triplet, result, options);
  if (!height) return std::nullopt;
  for (int finger = 0; finger < 3; ++finger) result.depth_m[finger] = result.tip_height_m[finger] - *height;
  const Vector2d origin = triplet.points_F[planar.point_of_finger[kThumb]] + planar.reach[kThumb] * h;
  result.real_focus_F = origin + realFocusFromAxis(hand, planar.spread) * h;
  Matrix3d axes;
  axes << k.x(), h.x(), 0, k.y(), h.y(), 0, 0, 0, 1;
  result.X_FP = makePose(axes, {origin.x(), origin.y(), -*height});
  return result;
}

// Whether two hands of one triplet and thumb count as one.
bool alike(const HandDescription& hand, const PlanarSolution& x, const PlanarSolution& y, double min_turn) {
  const double finger = hand.inner_length + hand.tip_length;
  return std::abs(x.thumb_angle - y.thumb_angle) < min_turn && std::abs(x.spread - y.spread) < min_turn &&
         std::abs(x.reach[kThumb] - y.reach[kThumb]) < min_turn * finger;
}

// Takes the solutions in order, leaves out those like one already taken, and raises the others.
void keepDifferent(const HandDescription& hand, const Reach& reach, const Triplet& triplet,
                   const std::vector<PlanarSolution>& solutions, const ConfigurationOptions& options,
                   Configurations& result) {
  std::vector<const PlanarSolution*> kept;
  for (const PlanarSolution& solution : solutions) {
    const auto like = [&](const PlanarSolution* other) {
      return alike(hand, solution, *other, options.min_turn_rad);
    };
    if (std::any_of(kept.begin(), kept.end(), like)) {
      ++result.merged;
    } else if (auto configuration = raise(hand, reach, triplet, solution, options)) {
      kept.push_back(&solution);
      result.configurations.push_back(*std::move(configuration));
    } else {
      ++result.rejected[static_cast<std::size_t>(ReachRejection::depth)];
    }
  }
}

}  // namespace

void ConfigurationOptions::validate() const {
  requireOption(friction > 0 && friction <= 10, "configurations.friction", friction, "in (0, 10]");
  requireOption(thumb_steps >= 1 && thumb_steps <= 100000, "configurations.thumb_steps", thumb_steps,
                "in [1, 100000]");
  requireOption(insertion_m >= 0 && insertion_m <= 1, "configurations.insertion_m", insertion_m, "in [0, 1]");
  requireOption(depth_tolerance_m >= 0 && depth_tolerance_m <= 1, "configurations.depth_tolerance_m",
                depth_tolerance_m, "in [0, 1]");
  requireOption(palm_clearance_m >= 0 && palm_clearance_m <= 1, "configurations.palm_clearance_m",
                palm_clearance_m, "in [0, 1]");
  requireOption(min_turn_rad >= 0 && min_turn_rad <= std::numbers::pi, "configurations.min_turn_rad",
                min_turn_rad, "in [0, pi]");
}

std::string_view describe(ReachRejection rejection) {
  switch (rejection) {
    case ReachRejection::spread_or_side:
      return "points do not fit the sides of the fingers";
    case ReachRejection::extension:
      return "point out of a finger's reach";
    case ReachRejection::friction_cone:
      return "finger would push outside the friction cone";
    case ReachRejection::depth:
      return "fingertips not at the depth of the surface";
  }
  return "unknown";
}

Configurations findConfigurations(const HandDescription& hand, const Triplet& triplet, int triplet_index,
                                  const ConfigurationOptions& options) {
  return findConfigurations(hand, fingerReach(hand), triplet, triplet_index, options);
}

Configurations findConfigurations(const HandDescription& hand, const Reach& reach, const Triplet& triplet,
                                  int triplet_index, const ConfigurationOptions& options) {
  PlanarSearch search(hand, reach, triplet, options);
  Configurations result;
  std::vector<PlanarSolution> solutions;
  for (int thumb = 0; thumb < 3; ++thumb) {
    solutions.clear();
    search.search(thumb, solutions, result.rejected);
    std::sort(solutions.begin(), solutions.end(), straighter);
    keepDifferent(hand, reach, triplet, solutions, options, result);
  }
  for (HandConfiguration& configuration : result.configurations) configuration.triplet = triplet_index;
  return result;
}

}  // namespace boxgrasp
