#include "trial_film.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace boxgrasp {
namespace {

constexpr double kEvery_s = 0.02;  // a fiftieth of the shortest stage's swings

// Of each phase, the moments that are drawn, as shares of the time it took.
const std::vector<double>& drawnShares(TrialPhase phase) {
  static const std::vector<double> kLast{1.0}, kMiddle{0.5, 1.0}, kApproach{0.7, 1.0};
  static const std::vector<double> kShake{0.25, 0.75, 1.0};  // a swing about x, one along z, and the end
  if (phase == TrialPhase::approach) return kApproach;
  if (phase == TrialPhase::press || phase == TrialPhase::lift) return kMiddle;
  return phase == TrialPhase::shake ? kShake : kLast;
}

Vector3d centerInPalm(const TrialMoment& moment, const Vector3d& center_O) {
  return moment.X_WP.inverse() * (moment.X_WO * center_O);
}

FilmFrame frameOf(const TrialMoment& moment, double slip_m) {
  FilmFrame frame;
  frame.caption = fmt::format("{}, {:.2f} s", describe(moment.phase), moment.time_s);
  if (moment.phase == TrialPhase::approach) frame.caption = describe(moment.phase);
  frame.X_WP = moment.X_WP;
  frame.X_WO = moment.X_WO;
  frame.links_W = moment.links_W;
  double total_n = 0.0;
  for (const TrialContact& contact : moment.contacts) {
    frame.forces.push_back({moment.X_WO * contact.p_O, moment.X_WO.linear() * contact.force_O});
    total_n += contact.force_O.norm();
  }
  frame.remark = fmt::format("{} contacts, {:.1f} N", moment.contacts.size(), total_n);
  if (slip_m > 0) frame.remark += fmt::format(", moved {:.1f} mm", 1e3 * slip_m);
  return frame;
}

}  // namespace

TrialObserver TrialRecorder::observer() {
  return {kEvery_s, [this](const TrialMoment& moment) {
            moments_[static_cast<std::size_t>(moment.phase)].push_back(moment);
          }};
}

Film TrialRecorder::film(const TriangleMesh& mesh_O, const Vector3d& center_O,
                         const TrialInput& input) const {
  Film film;
  film.object_O = mesh_O;
  film.up_W = -input.gravity_O.normalized();
  Vector3d grasped_P = Vector3d::Zero();
  for (const std::vector<TrialMoment>& moments : moments_) {
    if (moments.empty()) continue;
    const TrialPhase phase = moments.front().phase;
    for (const double share : drawnShares(phase)) {
      const auto last = static_cast<double>(moments.size() - 1);
      const TrialMoment& moment = moments[static_cast<std::size_t>(std::lround(share * last))];
      const Vector3d center_P = centerInPalm(moment, center_O);
      film.frames.push_back(frameOf(moment, phase > TrialPhase::press ? (center_P - grasped_P).norm() : 0.0));
      if (phase > TrialPhase::press) continue;
      film.grasped = film.frames.size() - 1;
      grasped_P = center_P;
    }
  }
  return film;
}

}  // namespace boxgrasp
