#include "boxgrasp/simulation/motions.h"

#include <cmath>
#include <numbers>

namespace boxgrasp {
namespace {

// From 0 to 2 and back in each period.
double swing(const Shake& shake, double t) {
  return 1.0 - std::cos(2 * std::numbers::pi * shake.frequency_hz * t);
}

}  // namespace

PalmMotion liftMotion(const Vector3d& up_W, double height_m, double acceleration_m_s2) {
  const double time_s = 2 * std::sqrt(height_m / acceleration_m_s2);
  return {time_s, [=](const Pose& X_WP_start, double t) {
            const double left = time_s - t;
            const double risen = t < 0.5 * time_s ? 0.5 * acceleration_m_s2 * t * t
                                                  : height_m - 0.5 * acceleration_m_s2 * left * left;
            return Eigen::Translation3d(risen * up_W) * X_WP_start;
          }};
}

PalmMotion shakeAlong(const Vector3d& axis_P, double amplitude_m, const Shake& shake) {
  return {shake.periods / shake.frequency_hz, [=](const Pose& X_WP_start, double t) {
            return X_WP_start * Eigen::Translation3d(amplitude_m * swing(shake, t) * axis_P);
          }};
}

PalmMotion shakeAbout(const Vector3d& axis_P, double angle_rad, const Shake& shake) {
  return {shake.periods / shake.frequency_hz, [=](const Pose& X_WP_start, double t) {
            return X_WP_start * Eigen::AngleAxisd(0.5 * angle_rad * swing(shake, t), axis_P);
          }};
}

}  // namespace boxgrasp
