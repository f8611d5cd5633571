#include "boxgrasp/cloud/completion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "boxgrasp/base/error.h"
#include "boxgrasp/cloud/sensor_view.h"
#include "boxgrasp/geometry/min_volume_box.h"
#include "boxgrasp/geometry/point_grid.h"

namespace boxgrasp {
namespace {

using Verdict = SensorView::Verdict;

constexpr std::size_t kSamples = 400;    // points that a mirror is judged by
constexpr int kOffsets = 40;             // places of a mirror that are tried at each azimuth
constexpr int kSettling = 12;            // places on each side, within the tolerance
constexpr double kEqualEvidence = 0.01;  // a difference of so little is chance
constexpr int kRefinements = 3;          // each halves the steps of azimuth and place
constexpr double kPixelSpacings = 2.0;   // pixels so wide, in spacings, that a seen surface leaves none empty
constexpr double kDuplicateSpacings = 1.0;  // guessed points nearer to a known one say nothing new
constexpr double kHidden_m = 0.02;          // behind what was seen: noise and slopes are less
constexpr double kBeyond = 0.5;             // mirrors are tried so far behind the cloud, in its extent there

// What a mirrored point is worth: a surface that was seen there is evidence; where none could be seen, it is
// possible, and the less probable the thicker it makes the object, or the thinner; where the sensor saw
// through, it speaks as much against the mirror. Chosen for the true surface of parametric and scanned
// objects; the figures around are nearly as good.
constexpr double kSeenWorth = 1.0, kHiddenWorth = 0.45, kThickness = 0.15, kContradictionCost = 1.0;
constexpr double kThin = 0.45;  // of the object's width: thinner things are few

Vector3d reflected(const Vector3d& p_C, const Plane& mirror) {
  return p_C - 2 * (mirror.normal_C.dot(p_C) - mirror.offset_m) * mirror.normal_C;
}

// Two directions across each other and across `up`; unit.
struct Horizon {
  Vector3d away_C, across_C;  // away from the sensor, and to its right or left
  Vector3d at(double azimuth) const { return std::cos(azimuth) * away_C + std::sin(azimuth) * across_C; }
};

// `looking_C`: from the sensor to the object.
Horizon horizonOf(const Vector3d& up_C, const Vector3d& looking_C) {
  Vector3d away_C = looking_C - looking_C.dot(up_C) * up_C;
  if (away_C.norm() < 1e-6 * looking_C.norm()) away_C = up_C.unitOrthogonal();
  away_C.normalize();
  return {away_C, up_C.cross(away_C)};
}

// The sensor's frame: z towards the object, x level.
Pose sensorPose(const Vector3d& viewpoint_C, const Vector3d& looking_C, const Vector3d& up_C) {
  const Vector3d z_C = looking_C.normalized(), x_C = horizonOf(up_C, looking_C).across_C;
  Matrix3d axes_C;
  axes_C << x_C, z_C.cross(x_C), z_C;
  return makePose(axes_C, viewpoint_C);
}

// Steps of the golden ratio around all indices: neighbours in the order of points are far apart in it, and no
// regular pattern of the points is hit in step.
std::size_t spreadIndex(std::size_t i, std::size_t n) {
  const double turns = static_cast<double>(i) * (std::numbers::phi - 1);
  return std::min(n - 1, static_cast<std::size_t>((turns - std::floor(turns)) * static_cast<double>(n)));
}

struct Mirror {
  Plane plane;
  double worth = -1.0;    // a point, at most kSeenWorth
  double evidence = 0.0;  // of that, from what was seen or seen through
  double contradicted = 1.0;
};

class MirrorSearch {
 public:
  MirrorSearch(const PointCloud& seen_C, const std::vector<SensorView>& views,
               const CompletionOptions& options, const StopToken& stop)
      : views_(views), options_(options), stop_(stop) {
    const std::size_t n = std::min(kSamples, seen_C.size());
    PointCloud samples_C;
    for (std::size_t i = 0; i < n; ++i) samples_C.push(seen_C.point(spreadIndex(i, seen_C.size())));
    const Vector3d mean_C = meanOf(samples_C);
    double squares = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      samples_C_.push_back(samples_C.point(i));
      squares += (samples_C_.back() - mean_C).squaredNorm();
    }
    width_m_ = std::max(2 * std::sqrt(squares / static_cast<double>(n)), options.tolerance_m);
  }

  // The mirror moved to the middle of the places where its evidence is best: what is hidden speaks for
  // thicker or thinner bodies alike, and says nothing of the place.
  Plane settled(const Plane& plane) const {
    double best = 0.0, sum = 0.0;
    int count = 0;
    for (int i = -kSettling; i <= kSettling; ++i) {
      const double offset_m = plane.offset_m + options_.tolerance_m * i / kSettling;
      const double evidence = judged({plane.normal_C, offset_m}, width_m_, options_.tolerance_m / 2).evidence;
      if (evidence > best + kEqualEvidence) {
        best = evidence;
        sum = count = 0;
      }
      if (evidence < best - kEqualEvidence || evidence <= 0) continue;
      sum += offset_m;
      ++count;
    }
    return {plane.normal_C, count > 0 ? sum / count : plane.offset_m};
  }

  // The two mirrors across each other, at the azimuth where both together are worth most.
  std::array<Mirror, 2> bestPair(const Horizon& horizon) const {
    std::array<Mirror, 2> best;
    double azimuth = 0.0, step = options_.azimuth_step_rad;
    const auto consider = [&](double at) {
      stop_.check();
      const std::array<Mirror, 2> pair{bestAt(horizon.at(at)), bestAt(horizon.at(at + std::numbers::pi / 2))};
      if (sumOf(pair) <= sumOf(best)) return;
      best = pair;
      azimuth = at;
    };
    for (double at = 0; at < std::numbers::pi / 2; at += step) consider(at);
    for (int i = 0; i < kRefinements; ++i) {
      step /= 2;
      const double around = azimuth;
      consider(around - step);
      consider(around + step);
    }
    return best;
  }

  static double sumOf(const std::array<Mirror, 2>& pair) {
    return std::max(0.0, pair[0].worth) + std::max(0.0, pair[1].worth);
  }

  // The best place of a mirror with this normal.
  Mirror bestAt(const Vector3d& normal_C) const {
    double low = INFINITY, high = -INFINITY;
    for (const Vector3d& p_C : samples_C_) {
      low = std::min(low, normal_C.dot(p_C));
      high = std::max(high, normal_C.dot(p_C));
    }
    const double margin = kBeyond * std::max(high - low, width_m_ / 2);
    double step = (high - low + 2 * margin) / kOffsets;
    Mirror best;
    const auto consider = [&](double offset) {
      const Mirror mirror = judged({normal_C, offset}, high - low, options_.tolerance_m);
      if (mirror.worth > best.worth) best = mirror;
    };
    for (int i = 0; i <= kOffsets; ++i) consider(low - margin + i * step);
    for (int i = 0; i < kRefinements; ++i) {
      step /= 2;
      const double around = best.plane.offset_m;
      consider(around - step);
      consider(around + step);
    }
    return best;
  }

 private:
  Mirror judged(const Plane& plane, double extent_m, double tolerance_m) const {
    Mirror mirror{plane, 0.0, 0.0, 0.0};
    double moved = 0.0, hidden = 0.0;
    for (const Vector3d& p_C : samples_C_) {
      const Vector3d q_C = reflected(p_C, plane);
      if ((q_C - p_C).squaredNorm() < 4 * tolerance_m * tolerance_m) continue;
      const SensorView::Judgement found = judge(views_, q_C, tolerance_m);
      moved += 1.0;
      if (found.verdict == Verdict::contradicted) {
        mirror.contradicted += 1.0;
        mirror.evidence -= kContradictionCost;
      } else if (!found.at_rim && found.verdict == Verdict::seen) {
        mirror.evidence += seenWorth(found.off_m / tolerance_m);
      } else if (!found.at_rim) {
        hidden += hiddenWorth(found.behind_m, extent_m);
      }
    }
    mirror.worth = (mirror.evidence + hidden) / static_cast<double>(samples_C_.size());
    mirror.evidence /= static_cast<double>(samples_C_.size());
    mirror.contradicted = moved > 0 ? mirror.contradicted / moved : 1.0;
    return mirror;
  }

  static double seenWorth(double off) { return kSeenWorth * (1.0 - off * off); }

  double hiddenWorth(double behind_m, double extent_m) const {
    const double size = std::max(extent_m, width_m_ / 2);
    return kHiddenWorth * std::min(1.0, behind_m / (kThin * width_m_)) -
           kThickness * std::min(1.0, behind_m / size / 2);
  }

  std::vector<Vector3d> samples_C_;
  const std::vector<SensorView>& views_;
  const CompletionOptions& options_;
  const StopToken& stop_;
  double width_m_;
};

// The mirrored points that may be there and are not known yet.
PointCloud newPoints(const PointCloud& known_C, const Plane& mirror, const std::vector<SensorView>& views,
                     double spacing_m, const CompletionOptions& options, std::size_t& contradicted) {
  const double near_m = kDuplicateSpacings * spacing_m;
  const PointGrid grid(known_C, std::max(near_m, 1e-6));
  PointCloud found_C;
  for (std::size_t i = 0; i < known_C.size(); ++i) {
    const Vector3d q_C = reflected(known_C.point(i), mirror);
    if (judge(views, q_C, options.tolerance_m).verdict == Verdict::contradicted) {
      ++contradicted;
    } else if (!grid.nearest(q_C, near_m)) {
      found_C.push(q_C);
    }
  }
  return found_C;
}

std::vector<Vector3d> upsToTry(const PointCloud& seen_C, const Observation& observation,
                               const StopToken& stop) {
  if (observation.up_C) return {*observation.up_C};
  const Matrix3d axes = minVolumeBox(seen_C, {}, stop).X_CB.linear();
  return {axes.col(0), axes.col(1), axes.col(2)};
}

std::vector<SensorView> viewsOf(const PointCloud& seen_C, const Observation& observation,
                                const Vector3d& up_C, double pitch_m) {
  std::vector<SensorView> views;
  for (const Vector3d& viewpoint_C : observation.viewpoints_C) {
    const Vector3d looking_C = meanOf(seen_C) - viewpoint_C;
    views.emplace_back(seen_C, observation.others_C, sensorPose(viewpoint_C, looking_C, up_C), pitch_m);
  }
  return views;
}

bool isWithinReach(const PointCloud& seen_C, const Vector3d& viewpoint_C) {
  const Vector3d mean_C = meanOf(seen_C);
  double reach_m = 0.0;
  for (std::size_t i = 0; i < seen_C.size(); ++i)
    reach_m = std::max(reach_m, (seen_C.point(i) - mean_C).norm());
  return (viewpoint_C - mean_C).norm() <= reach_m;
}

double hiddenShare(const PointCloud& seen_C, const std::vector<SensorView>& views) {
  std::size_t hidden = 0;
  for (std::size_t i = 0; i < seen_C.size(); ++i) {
    hidden += std::all_of(views.begin(), views.end(),
                          [&](const SensorView& view) { return view.behind(seen_C.point(i)) > kHidden_m; });
  }
  return static_cast<double>(hidden) / static_cast<double>(seen_C.size());
}

// The upright mirrors that may be used, the surer first, and then the level one.
std::vector<Plane> mirrorsOf(const MirrorSearch& search, const std::vector<Vector3d>& ups_C,
                             const Observation& observation, const Vector3d& looking_C,
                             const CompletionOptions& options) {
  std::array<Mirror, 2> upright;
  for (const Vector3d& up_C : ups_C) {
    const std::array<Mirror, 2> pair = search.bestPair(horizonOf(up_C, looking_C));
    if (MirrorSearch::sumOf(pair) > MirrorSearch::sumOf(upright)) upright = pair;
  }
  if (upright[0].worth < upright[1].worth) std::swap(upright[0], upright[1]);
  std::vector<Plane> usable;
  for (const Mirror& mirror : upright) {
    if (mirror.worth > 0 && mirror.contradicted <= options.max_contradicted)
      usable.push_back(search.settled(mirror.plane));
  }
  if (!observation.up_C) return usable;
  const Mirror level = search.bestAt(*observation.up_C);
  if (level.evidence > 0 && level.contradicted <= options.max_contradicted_level)
    usable.push_back(search.settled(level.plane));
  return usable;
}

Completion nothing(std::string why) {
  Completion result;
  result.why_not = std::move(why);
  return result;
}

}  // namespace

void CompletionOptions::validate() const {
  requireOption(tolerance_m > 0 && tolerance_m <= 0.1, "completion.tolerance_m", tolerance_m, "in (0, 0.1]");
  requireOption(azimuth_step_rad >= 0.01 && azimuth_step_rad <= std::numbers::pi / 2,
                "completion.azimuth_step_rad", azimuth_step_rad, "in [0.01, pi/2]");
  requireOption(max_contradicted >= 0 && max_contradicted <= 1, "completion.max_contradicted",
                max_contradicted, "in [0, 1]");
  requireOption(max_contradicted_level >= 0 && max_contradicted_level <= 1,
                "completion.max_contradicted_level", max_contradicted_level, "in [0, 1]");
  requireOption(max_hidden >= 0 && max_hidden <= 1, "completion.max_hidden", max_hidden, "in [0, 1]");
}

Completion completed(const PointCloud& seen_C, double spacing_m, const Observation& observation,
                     const CompletionOptions& options, const StopToken& stop) {
  options.validate();
  if (!options.enabled || spacing_m <= 0) return {};
  for (const Vector3d& viewpoint_C : observation.viewpoints_C) {
    if (isWithinReach(seen_C, viewpoint_C))
      return nothing(
          fmt::format("the sensor is said to have stood at ({:.3f} {:.3f} {:.3f}) m, within the object",
                      viewpoint_C.x(), viewpoint_C.y(), viewpoint_C.z()));
  }
  const std::vector<Vector3d> ups_C = upsToTry(seen_C, observation, stop);
  const std::vector<SensorView> views =
      viewsOf(seen_C, observation, ups_C.front(), kPixelSpacings * spacing_m);
  const double hidden = hiddenShare(seen_C, views);
  if (hidden > options.max_hidden)
    return nothing(fmt::format(
        "{:.0f} % of its points are hidden from where the sensor stood, and were seen from elsewhere",
        100 * hidden));
  const MirrorSearch search(seen_C, views, options, stop);
  Completion result;
  const Vector3d looking_C = meanOf(seen_C) - observation.viewpoints_C.front();
  result.mirrors = mirrorsOf(search, ups_C, observation, looking_C, options);
  for (const Plane& mirror : result.mirrors) {
    const PointCloud known_C = joined(seen_C, result.guessed_C);
    result.guessed_C = joined(std::move(result.guessed_C),
                              newPoints(known_C, mirror, views, spacing_m, options, result.contradicted));
  }
  if (result.guessed_C.empty()) result.why_not = "no mirror agrees with what was seen and adds to it";
  return result;
}

}  // namespace boxgrasp
