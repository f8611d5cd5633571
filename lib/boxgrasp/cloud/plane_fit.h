// Finding the dominant plane of a cloud. Internal to this room.
#pragma once

#include <random>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/cloud/scene.h"

namespace boxgrasp {

inline double heightAbove(const Plane& plane, const Vector3d& p_C) {
  return plane.normal_C.dot(p_C) - plane.offset_m;
}

// The plane with the most of the points `among` within `distance_m`, by random sample consensus (Fischler and
// Bolles 1981), refined by least squares over the points it holds. The normal's sign is arbitrary. Pre: at
// least three points. The result does not depend on the number of threads (0 = all cores).
Plane dominantPlane(const PointCloud& cloud_C, const std::vector<std::uint32_t>& among, double distance_m,
                    std::mt19937_64& random, int threads, const StopToken& stop);

// The root mean square distance of those points that lie within `distance_m` of the plane.
double noiseAround(const Plane& plane, const PointCloud& cloud_C, double distance_m);

}  // namespace boxgrasp
