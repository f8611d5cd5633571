// Triplets that a hand can hold by construction: made from a random pose and posture of the hand.
#pragma once

#include <numbers>

#include "boxgrasp/base/random.h"
#include "boxgrasp/hand/configurations.h"

namespace boxgrasp::test {

struct KnownGrasp {
  Triplet triplet;           // points in the order F1, F2, thumb
  double thumb_angle = NAN;  // of the hand that made it
  double spread = NAN;
  std::array<double, 3> extension_m{};
};

inline Vector2d turned(const Vector2d& v, double angle) { return Eigen::Rotation2Dd(angle) * v; }

// All angles between pushes and normals are below `max_tilt`. The upper edge of the surface is at random
// depths around those of the fingertips.
inline KnownGrasp randomGrasp(const HandDescription& hand, std::mt19937_64& random, double max_tilt) {
  const Reach reach = fingerReach(hand);
  KnownGrasp grasp;
  grasp.spread = uniform(random, 0.05, std::numbers::pi - 0.05);
  const double turn = uniform(random, -std::numbers::pi, std::numbers::pi),
               stand_off = uniform(random, 0.01, 0.04);
  const Vector2d origin_F(uniform(random, -0.1, 0.1), uniform(random, -0.1, 0.1));
  for (int finger = 0; finger < 3; ++finger) {
    // Fingers that reach outwards from their spread axes, well inside their range.
    const double e = uniform(random, -hand.base_radius + 0.005, reach.extension_max_m - 0.02);
    const double height = tipHeight(hand, *innerForExtension(hand, e, reach));
    const Vector2d outwards_P = fingerDirection(static_cast<Finger>(finger), grasp.spread);
    const double side = finger == kF1 ? 1 : finger == kF2 ? -1 : 0;
    const Vector2d point_P = Vector2d(side * hand.spread_offset, 0) + (hand.base_radius + e) * outwards_P;
    const double tilt = uniform(random, -max_tilt, max_tilt);
    grasp.extension_m[finger] = e;
    grasp.triplet.points_F[finger] = origin_F + turned(point_P, turn);
    grasp.triplet.normals_F[finger] = turned(-outwards_P, turn - tilt);
    grasp.triplet.nearest_depth_m[finger] = std::max(0.0, height - stand_off - uniform(random, 0.0, 0.03));
    grasp.triplet.farthest_depth_m[finger] = height - stand_off + uniform(random, 0.0, 0.05);
    if (finger == kThumb) grasp.thumb_angle = tilt;
  }
  grasp.triplet.regions = {0, 1, 2};
  return grasp;
}

}  // namespace boxgrasp::test
