#include "boxgrasp/geometry/min_volume_box.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "boxgrasp/geometry/canonical_frame.h"
#include "boxgrasp/geometry/exhaustive_search.h"

namespace boxgrasp {
namespace {

constexpr std::size_t kFewPoints = 96;           // a cloud this small is searched as it is
constexpr std::size_t kSeedDirections = 12;      // of the first outermost points
constexpr std::size_t kChecked = 3;              // orientations compared with the whole cloud in a round
constexpr int kRounds = 20;                      // smooth shapes need the most
constexpr int kPasses = 2;                       // the first pass can miss what only its own points reveal
constexpr int kTrials = 100, kTrialsAgain = 50;  // of each descent; much is known before the second pass
// Gains that are possible, relative to the volume: those below the first are not worth a comparison of more
// than the best orientation, those below the second not worth a round.
constexpr double kLittle = 5e-4, kNothing = 1e-5;
// Of the few points' volume: between two steps it is known roughly, and was up to 1.1 % too large in 2000
// runs.
constexpr double kRough = 0.02;

// The box with its axes in order of falling extent, the first two towards the mean of the cloud as seen from
// the middle.
OrientedBox ordered(const OrientedBox& box, const Vector3d& mean_C) {
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return box.extents[a] > box.extents[b]; });
  const Vector3d to_mean_C = mean_C - box.X_CB.translation();
  OrientedBox result = box;
  for (int i = 0; i < 3; ++i) {
    const Vector3d axis_C = box.X_CB.linear().col(order[i]);
    result.extents[i] = box.extents[order[i]];
    result.X_CB.linear().col(i) = axis_C.dot(to_mean_C) < 0.0 ? Vector3d(-axis_C) : axis_C;
  }
  result.X_CB.linear().col(2) = result.X_CB.linear().col(0).cross(result.X_CB.linear().col(1));
  return result;
}

}  // namespace

BoxSearch::BoxSearch(const PointCloud& cloud_C, const StopToken& stop)
    : supports_C_(cloud_C),
      X_CK_(canonicalFrame(cloud_C, supports_C_.bounds())),
      passes_(cloud_C.size() <= kFewPoints ? 1 : kPasses),
      axes_C_(X_CK_.linear()) {
  stop.check();
  takeIn(cloud_C.size() <= kFewPoints ? cloud_C : seeds());
  orientations_ = searchOrientations(few_K_, kTrials);
}

bool BoxSearch::advance(const StopToken& stop) {
  stop.check();
  if (passes_ == 0) return false;
  if (round_ < kRounds && mayGain(kNothing)) {
    const bool grown = takeIn(measure());
    if (grown || round_ == 0) {
      updateOrientations(few_K_, orientations_);
      ++round_;
      return true;
    }
  }
  if (--passes_ > 0) orientations_ = searchOrientations(few_K_, kTrialsAgain);
  round_ = 0;
  return true;
}

double BoxSearch::volumeAtLeast() const {
  return (1.0 - kRough) * static_cast<double>(orientations_.front().volume);
}

OrientedBox BoxSearch::box() const {
  return ordered(boxAround(supports_C_.ranges(axes_C_), axes_C_), X_CK_.translation());
}

PointCloud BoxSearch::seeds() const {
  std::vector<Vector3d> directions_C = halfSphere(kSeedDirections);
  for (Vector3d& direction : directions_C) direction = X_CK_.linear() * direction;
  PointCloud found;
  supports_C_.append(X_CK_.translation(), directions_C, found);
  return found;
}

bool BoxSearch::mayGain(double share) const {
  return static_cast<double>(orientations_.front().volume) * (1.0 + share) < volume_;
}

// Keeps the best box of the whole cloud in the first few of the orientations; returns the points that their
// faces touch.
PointCloud BoxSearch::measure() {
  const std::size_t checked = mayGain(kLittle) ? std::min(kChecked, orientations_.size()) : 1;
  PointCloud found;
  for (std::size_t i = 0; i < checked; ++i) {
    const auto rotation = orientations_[i].rotation.cast<double>().normalized();
    const Matrix3d axes_C = X_CK_.linear() * rotation.toRotationMatrix();
    PointCloud touched;
    supports_C_.append(X_CK_.translation(), {axes_C.col(0), axes_C.col(1), axes_C.col(2)}, touched);
    const double volume = boxAround(touched, axes_C).volume();
    if (volume < volume_) {
      volume_ = volume;
      axes_C_ = axes_C;
    }
    found = joined(std::move(found), touched);
  }
  return found;
}

// Adds the points that are not yet among the few; returns whether there were any.
bool BoxSearch::takeIn(const PointCloud& points_C) {
  const PointCloud points_K = transformed(points_C, X_CK_.inverse());
  const std::size_t before = few_K_.size();
  for (std::size_t i = 0; i < points_K.size(); ++i) {
    const Vector3d p_K = points_K.point(i);
    bool known = false;
    for (std::size_t k = 0; k < few_K_.size() && !known; ++k) known = few_K_.point(k) == p_K;
    if (!known) few_K_.push(p_K);
  }
  return few_K_.size() > before;
}

OrientedBox minVolumeBox(const PointCloud& cloud_C, const MinVolumeBoxOptions& options,
                         const StopToken& stop) {
  assert(!cloud_C.empty());
  stop.check();
  if (options.exhaustive) {
    return ordered(boxAround(cloud_C, exhaustiveBoxAxes(cloud_C, stop)),
                   canonicalFrame(cloud_C).translation());
  }
  BoxSearch search(cloud_C, stop);
  while (search.advance(stop)) continue;
  return search.box();
}

}  // namespace boxgrasp
