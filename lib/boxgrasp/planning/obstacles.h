// What the hand may meet besides the object that it is to grasp.
#pragma once

#include "boxgrasp/cloud/scene.h"

namespace boxgrasp {

// Points on the table beneath and around an object, one every `spacing_m`, out to `reach_m` beyond the
// object's shadow: the sensor does not see the table under the object, but the hand would meet it.
PointCloud tablePatch(const Plane& table, const PointCloud& object_C, double reach_m, double spacing_m);

}  // namespace boxgrasp
