// Files of point clouds and meshes, one format a program: FORMAT, their ending.
#include "boxgrasp/cloud/read_cloud.h"
#include "fuzz_target.h"
#include "sample_files.h"

namespace boxgrasp::fuzz {
namespace {

ReadOptions options() {
  ReadOptions options;
  options.mesh_samples = 100;
  options.max_points = 10'000;
  return options;
}

}  // namespace

void feed(Bytes bytes) {
  static const ReadOptions kOptions = options();
  const std::span<const char> content(text(bytes).data(), bytes.size());
  accepts(
      [&] { promise(parseCloud(content, "fuzz." FORMAT, kOptions).cloud_C.size() <= kOptions.max_points); });
  accepts(
      [&] { promise(parseMesh(content, "fuzz." FORMAT, kOptions).vertices.size() <= kOptions.max_points); });
}

std::vector<std::string> seeds() {
  std::vector<std::string> result;
  for (const auto& file : sample_files::all()) {
    if (file.name.ends_with("." FORMAT)) result.push_back(file.bytes);
  }
  return result;
}

}  // namespace boxgrasp::fuzz
