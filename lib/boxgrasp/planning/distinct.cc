#include "boxgrasp/planning/distinct.h"

#include <algorithm>

namespace boxgrasp {
namespace {

bool contactsNear(const Grasp& a, const Grasp& b, const std::array<int, 3>& fingers, double distance_m) {
  for (int i = 0; i < 3; ++i) {
    if ((a.contacts[i].p_C - b.contacts[fingers[i]].p_C).norm() >= distance_m) return false;
  }
  return true;
}

double turnBetween(const Pose& a, const Pose& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

}  // namespace

bool nearlyIdentical(const Grasp& a, const Grasp& b, double distance_m, double angle_rad) {
  if (a.object != b.object) return false;
  if ((a.X_CP.translation() - b.X_CP.translation()).norm() >= distance_m) return false;
  if (turnBetween(a.X_CP, b.X_CP) >= angle_rad) return false;
  return contactsNear(a, b, {kF1, kF2, kThumb}, distance_m) ||
         contactsNear(a, b, {kF2, kF1, kThumb}, distance_m);
}

std::vector<Grasp> distinctGrasps(std::vector<Grasp> ranked, int top_k, double distance_m, double angle_rad,
                                  const StopToken& stop) {
  std::vector<Grasp> kept;
  for (Grasp& grasp : ranked) {
    stop.check();
    if (top_k > 0 && kept.size() == static_cast<std::size_t>(top_k)) break;
    const bool seen = std::any_of(kept.begin(), kept.end(), [&](const Grasp& other) {
      return nearlyIdentical(grasp, other, distance_m, angle_rad);
    });
    if (!seen) kept.push_back(std::move(grasp));
  }
  return kept;
}

}  // namespace boxgrasp
