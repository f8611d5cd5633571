// Writing point clouds.
#pragma once

#include <filesystem>

#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

// Writes the cloud as a binary PCD file (version 0.7, fields x y z, float32, metres). Throws InputError when
// it cannot be written whole; then no file of that name is left behind half written.
void writePcd(const PointCloud& cloud_C, const std::filesystem::path& file);

}  // namespace boxgrasp
