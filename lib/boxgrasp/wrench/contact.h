// Contacts of a grasp.
#pragma once

#include "boxgrasp/geometry/pose.h"

namespace boxgrasp {

// A frictional point contact (Coulomb). The normal points into the object: the direction in which the finger pushes.
struct Contact {
  Vector3d p_C = Vector3d::Zero();        // position, metres
  Vector3d normal_C = Vector3d::Zero();   // unit, inward
  double friction = -1.0;                 // coefficient; < 0: the options' coefficient holds
};

}  // namespace boxgrasp
