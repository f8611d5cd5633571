#include "boxgrasp/cloud/write_cloud.h"

#include <fmt/format.h>

#include <fstream>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

std::string pcdHeader(std::size_t points) {
  return fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT "
      "1 1 1\n"
      "WIDTH {0}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\nDATA binary\n",
      points);
}

std::vector<float> interleaved(const PointCloud& cloud) {
  std::vector<float> xyz;
  xyz.reserve(3 * cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) xyz.insert(xyz.end(), {cloud.x[i], cloud.y[i], cloud.z[i]});
  return xyz;
}

}  // namespace

void writePcd(const PointCloud& cloud_C, const std::filesystem::path& file) {
  const std::vector<float> xyz = interleaved(cloud_C);
  const std::filesystem::path unfinished = file.string() + ".part";
  std::ofstream stream(unfinished, std::ios::binary | std::ios::trunc);
  stream << pcdHeader(cloud_C.size());
  stream.write(reinterpret_cast<const char*>(xyz.data()),
               static_cast<std::streamsize>(xyz.size() * sizeof(float)));
  stream.close();
  std::error_code error;
  if (stream) std::filesystem::rename(unfinished, file, error);
  if (stream && !error) return;
  std::filesystem::remove(unfinished, error);
  throw InputError(fmt::format(
      "cannot write the cloud to '{}': check that the folder exists and has free space", file.string()));
}

}  // namespace boxgrasp
