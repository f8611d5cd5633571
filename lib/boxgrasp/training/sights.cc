#include "boxgrasp/training/sights.h"

#include <fmt/format.h>

#include <algorithm>

#include "boxgrasp/base/error.h"
#include "boxgrasp/objects/depth_camera.h"
#include "boxgrasp/objects/mesh_properties.h"
#include "boxgrasp/ranking/model_file.h"
#include "boxgrasp/training/analytic_labels.h"

namespace boxgrasp {
namespace {

constexpr std::string_view kWhole = "whole";

std::vector<std::string> numbered(std::string_view name, int count) {
  std::vector<std::string> names;
  for (int i = 0; i < count; ++i) names.push_back(fmt::format("{}{}", name, i));
  return names;
}

// The cameras of the ring that a view is made by.
std::vector<std::size_t> camerasOf(const std::string& view, int cameras) {
  const auto placeIn = [&](const std::vector<std::string>& names) {
    return static_cast<std::size_t>(std::ranges::find(names, view) - names.begin());
  };
  const auto count = static_cast<std::size_t>(cameras);
  if (const std::size_t i = placeIn(viewNames(cameras)); i < count) return {i};
  if (const std::size_t i = placeIn(pairNames(cameras)); i < count)
    return {i, (i + std::max<std::size_t>(1, count / 4)) % count};
  throw InputError(
      fmt::format("view '{}' is none of the {} cameras; label with more --views", view, cameras));
}

}  // namespace

std::string wholeName() { return std::string(kWhole); }
std::vector<std::string> viewNames(int cameras) { return numbered("view", cameras); }
std::vector<std::string> pairNames(int cameras) { return numbered("pair", cameras); }

std::uint64_t derivedSeed(std::uint64_t seed, const ModelKey& key, std::string_view purpose, int index) {
  const std::string text =
      fmt::format("{} {} {} {} {} {}", seed, purpose, index, key.scale, key.view, key.object);
  return std::stoull(blake2bHex(text).substr(0, 16), nullptr, 16);
}

PlanRequest sightOf(const TriangleMesh& mesh_O, const ModelKey& key, const SightOptions& options,
                    const StopToken& stop) {
  PlanRequest request;
  if (key.view == kWhole) {
    request.cloud_C = sampleSurface(mesh_O, options.points, options.seed);
    return request;
  }
  const std::vector<std::size_t> cameras = camerasOf(key.view, options.cameras);
  const std::vector<NamedPose> ring = viewRing(mesh_O, {.views = options.cameras});
  request.gravity_C = -Vector3d::UnitZ();  // the table was seen too
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    DepthCameraOptions camera;
    camera.seed = derivedSeed(options.seed, key, "camera", static_cast<int>(i));
    const Pose& X_OS = ring[cameras[i]].X_OS;
    const PointCloud seen =
        seeFrom({.object_O = mesh_O, .others_O = {}, .table = true}, X_OS, camera, stop).objectCloud_O();
    request.cloud_C = joined(std::move(request.cloud_C), seen);
    request.viewpoints_C.push_back(X_OS.translation());
  }
  return request;
}

}  // namespace boxgrasp
