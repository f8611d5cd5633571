#include "boxgrasp/cloud/write_cloud.h"

#include <fmt/format.h>

#include <fstream>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

// Readers take 0 0 0 1 0 0 0 for not known. A sensor in the origin is told from that by the rotation: -1 0 0
// 0 is the same one as 1 0 0 0.
std::string viewpointText(const std::optional<Vector3d>& viewpoint_C) {
  if (!viewpoint_C) return "0 0 0 1 0 0 0";
  return fmt::format("{} {} {} {} 0 0 0", viewpoint_C->x(), viewpoint_C->y(), viewpoint_C->z(),
                     viewpoint_C->isZero(0) ? -1 : 1);
}

std::string pcdHeader(std::size_t points, const std::optional<Vector3d>& viewpoint_C) {
  return fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT "
      "1 1 1\n"
      "WIDTH {0}\nHEIGHT 1\nVIEWPOINT {1}\nPOINTS {0}\nDATA binary\n",
      points, viewpointText(viewpoint_C));
}

std::string plyHeader(std::size_t points) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n",
      points);
}

std::string binary(const PointCloud& cloud) {
  std::string bytes;
  bytes.reserve(3 * sizeof(float) * cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float xyz[] = {cloud.x[i], cloud.y[i], cloud.z[i]};
    bytes.append(reinterpret_cast<const char*>(xyz), sizeof xyz);
  }
  return bytes;
}

std::string text(const PointCloud& cloud) {
  std::string lines;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    fmt::format_to(std::back_inserter(lines), "{} {} {}\n", cloud.x[i], cloud.y[i], cloud.z[i]);
  return lines;
}

std::string content(const PointCloud& cloud, const std::filesystem::path& file,
                    const std::optional<Vector3d>& viewpoint_C) {
  const std::string ending = file.extension();
  if (ending == ".pcd") return pcdHeader(cloud.size(), viewpoint_C) + binary(cloud);
  if (ending == ".ply") return plyHeader(cloud.size()) + binary(cloud);
  if (ending == ".xyz") return text(cloud);
  throw InputError(fmt::format("cannot tell the format of '{}': name it .pcd, .ply or .xyz", file.string()));
}

}  // namespace

void writeCloud(const PointCloud& cloud_C, const std::filesystem::path& file,
                const std::optional<Vector3d>& viewpoint_C) {
  const std::string bytes = content(cloud_C, file, viewpoint_C);
  const std::filesystem::path unfinished = file.string() + ".part";
  std::ofstream stream(unfinished, std::ios::binary | std::ios::trunc);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  std::error_code error;
  if (stream) std::filesystem::rename(unfinished, file, error);
  if (stream && !error) return;
  std::filesystem::remove(unfinished, error);
  throw InputError(fmt::format(
      "cannot write the cloud to '{}': check that the folder exists and has free space", file.string()));
}

}  // namespace boxgrasp
