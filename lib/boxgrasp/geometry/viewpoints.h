// Where the sensors stood that saw a cloud.
#pragma once

#include <vector>

#include "boxgrasp/geometry/pose.h"

namespace boxgrasp {

// In the cloud's frame; several where views were joined into one cloud. Empty: nobody knows.
using Viewpoints = std::vector<Vector3d>;
constexpr std::size_t kMaxViewpoints = 16;  // in a request: each costs time and memory

// Whether a surface at p with this outward normal (any length) is turned to a sensor; what is turned away
// from all of them cannot be in the cloud.
bool facesASensor(const Vector3d& p_C, const Vector3d& outward_C, const Viewpoints& viewpoints_C);

}  // namespace boxgrasp
