// Writing point clouds.
#pragma once

#include <filesystem>
#include <optional>

#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

// Writes the cloud in the format of the file's ending: .pcd (version 0.7, binary), .ply (binary, little
// endian), or .xyz (text, three numbers a line); coordinates are float32 in metres, and read back to the bit.
// Where the sensor stood goes into the VIEWPOINT of a PCD, and reads back to the bit; the other formats have
// no place for it. Throws InputError for another ending, or when it cannot be written whole; then no file of
// that name is left behind half written.
void writeCloud(const PointCloud& cloud_C, const std::filesystem::path& file,
                const std::optional<Vector3d>& viewpoint_C = std::nullopt);

}  // namespace boxgrasp
