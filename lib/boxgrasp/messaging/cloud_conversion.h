// Clouds as messages and back.
#pragma once

#include <string>

#include "boxgrasp/geometry/point_cloud.h"
#include "drake/lcmt_point_cloud.hpp"

namespace boxgrasp {

// Unorganised, fields x, y, z as little-endian float32, 12 bytes a point. Coordinates keep their bits.
drake::lcmt_point_cloud toMessage(const PointCloud& cloud_C, const std::string& frame_name);

// Every point of every row, those that are not finite too. Fields x, y and z may be float32 or float64, of
// either byte order, anywhere in the point. Throws InputError naming the member and its value where sizes,
// offsets or types do not fit together. No more memory is asked for than the message's data accounts for.
PointCloud fromMessage(const drake::lcmt_point_cloud& message);

}  // namespace boxgrasp
