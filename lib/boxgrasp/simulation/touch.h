// Where the parts of a hand touch an object.
#pragma once

#include <string_view>
#include <vector>

#include "boxgrasp/hand/kinematics.h"
#include "boxgrasp/simulation/distance_field.h"

namespace boxgrasp {

// A part of the hand as spheres of one radius, so close together that they are one smooth part:
// links are capsules, the palm is a disc with a rounded rim, whose flat face is that of the hand. In some
// frame B of the part.
struct HandPart {
  std::string_view name;  // "palm", "F1 inner link", ...
  int finger = -1;        // 0, 1, 2; -1: the palm
  double radius = -1.0;
  std::vector<Vector3d> centers_B;
  Vector3d middle_B = Vector3d::Zero();  // of the smallest known ball around all spheres
  double reach = -1.0;                   // and its radius
};

HandPart linkPart(const Capsule& link);
HandPart palmPart(const HandDescription& hand);
HandPart moved(HandPart part_B, const Pose& X_AB);

struct Touch {
  Vector3d p_O = Vector3d::Zero();       // on the object's surface
  Vector3d normal_O = Vector3d::Zero();  // unit, into the object
  double depth = 0.0;                    // how far the part is in, metres
};

// At most max_touches points in which the part, in pose X_OB, is inside the object: the deepest, then always
// the one farthest from those before, so that a flat face stands on its corners.
std::vector<Touch> touches(const HandPart& part, const Pose& X_OB, const DistanceField& field,
                           int max_touches);

// The nearest points of two segments, from a to b each.
struct SegmentPair {
  Vector3d first, second;
};
SegmentPair closestPoints(const Vector3d& a1, const Vector3d& b1, const Vector3d& a2, const Vector3d& b2);

}  // namespace boxgrasp
