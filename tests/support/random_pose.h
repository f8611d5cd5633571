// Random poses for tests of laws that hold in every frame.
#pragma once

#include "boxgrasp/base/random.h"
#include "boxgrasp/geometry/pose.h"

namespace boxgrasp::test {

// Uniform over all rotations.
inline Matrix3d randomRotation(std::mt19937_64& random) {
  Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  return q.normalized().toRotationMatrix();
}

// A random rotation, and a translation of up to `reach_m` along each axis.
inline Pose randomPose(std::mt19937_64& random, double reach_m = 1.0) {
  const double x = uniform(random, -reach_m, reach_m), y = uniform(random, -reach_m, reach_m);
  return makePose(randomRotation(random), {x, y, uniform(random, -reach_m, reach_m)});
}

}  // namespace boxgrasp::test
