// How the palm moves an object that it holds.
#pragma once

#include <functional>

#include "boxgrasp/geometry/pose.h"

namespace boxgrasp {

// The palm's pose X_WP at time t from 0 to time_s, from its pose at the start. Starts and ends at rest.
struct PalmMotion {
  double time_s = 0.0;
  std::function<Pose(const Pose& X_WP_start, double t)> pose;
};

// Straight along the unit vector, with this acceleration for the first half and as much braking for the
// second.
PalmMotion liftMotion(const Vector3d& up_W, double height_m, double acceleration_m_s2);

struct Shake {
  double frequency_hz = 2.0;
  int periods = 1;
};
// Harmonic about a point `amplitude_m` ahead, so from rest to rest: accelerations as of a sine of that
// amplitude. Axes are unit vectors of P; turns are about the palm's origin, from 0 to the angle and back.
PalmMotion shakeAlong(const Vector3d& axis_P, double amplitude_m, const Shake& shake);
PalmMotion shakeAbout(const Vector3d& axis_P, double angle_rad, const Shake& shake);

}  // namespace boxgrasp
