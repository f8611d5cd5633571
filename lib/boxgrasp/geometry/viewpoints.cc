#include "boxgrasp/geometry/viewpoints.h"

#include <algorithm>

namespace boxgrasp {

bool facesASensor(const Vector3d& p_C, const Vector3d& outward_C, const Viewpoints& viewpoints_C) {
  return std::any_of(viewpoints_C.begin(), viewpoints_C.end(),
                     [&](const Vector3d& viewpoint_C) { return outward_C.dot(viewpoint_C - p_C) > 0.0; });
}

}  // namespace boxgrasp
