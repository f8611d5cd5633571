#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/simd.h"
#include "boxgrasp/base/tolerances.h"
#include "boxgrasp/cloud/clean.h"

namespace boxgrasp {

void ValidationOptions::validate() const {
  requireOption(min_extent_m >= 0.0, "min_extent_m", min_extent_m, "0 or more");
  requireOption(max_extent_m > min_extent_m && max_extent_m <= 1000.0, "max_extent_m", max_extent_m,
                "above min_extent_m and at most 1000");
}

namespace validation_passes {

BOXGRASP_SIMD std::size_t countNonFinite(const float* values, std::size_t n) {
  constexpr std::uint32_t kExponent = 0x7f800000;
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < n; ++i)
    count += (std::bit_cast<std::uint32_t>(values[i]) & kExponent) == kExponent;
  return count;
}

}  // namespace validation_passes

namespace {

bool allFinite(const std::vector<float>& values) {
  return validation_passes::countNonFinite(values.data(), values.size()) == 0;
}

FiniteCloud finitePoints(PointCloud cloud_C) {
  if (allFinite(cloud_C.x) && allFinite(cloud_C.y) && allFinite(cloud_C.z)) return {std::move(cloud_C), 0};
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cloud_C.size(); ++i) {
    if (!cloud_C.point(i).allFinite()) continue;
    cloud_C.x[kept] = cloud_C.x[i];
    cloud_C.y[kept] = cloud_C.y[i];
    cloud_C.z[kept] = cloud_C.z[i];
    ++kept;
  }
  const std::size_t non_finite = cloud_C.size() - kept;
  cloud_C.resize(kept);
  return {std::move(cloud_C), non_finite};
}

void requirePoints(const FiniteCloud& finite) {
  if (finite.cloud_C.empty() && finite.non_finite == 0)
    throw InputError("the cloud is empty; give one with points");
  if (finite.cloud_C.empty()) {
    throw InputError(
        fmt::format("none of the cloud's {} points is finite; the sensor saw nothing", finite.non_finite));
  }
  if (finite.cloud_C.size() == 1)
    throw InputError("the cloud has one finite point only; an object needs more");
}

void requireExtent(const PointCloud& cloud_C, const Eigen::AlignedBox3d& box,
                   const ValidationOptions& options) {
  const double extent = box.sizes().maxCoeff();
  if (extent <= tolerance::kCoincident) {
    throw InputError(
        fmt::format("all {} points of the cloud lie on one spot, ({}, {}, {}); an object has an extent",
                    cloud_C.size(), box.min().x(), box.min().y(), box.min().z()));
  }
  if (extent < options.min_extent_m) {
    throw InputError(fmt::format(
        "the cloud's extent is {} m, below min_extent_m = {}; if its unit is not the metre, scale "
        "it, for kilometres by `--scale 1000`",
        extent, options.min_extent_m));
  }
  if (extent > options.max_extent_m) {
    throw InputError(fmt::format(
        "the cloud's extent is {} m, above max_extent_m = {}; if its unit is the millimetre, scale "
        "it by `--scale 0.001`; else cut it to the objects",
        extent, options.max_extent_m));
  }
}

// Far from the origin neighbouring floats are millimetres apart, and shapes dissolve.
void requireResolution(const Eigen::AlignedBox3d& box) {
  const double farthest = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  const double resolution = farthest * std::numeric_limits<float>::epsilon();
  if (resolution <= tolerance::kFlatExtent) return;
  throw InputError(
      fmt::format("the cloud lies up to {} m from the origin, where its numbers resolve only {} m; subtract "
                  "an offset first, or scale millimetres by `--scale 0.001`",
                  farthest, resolution));
}

}  // namespace

FiniteCloud validated(PointCloud cloud_C, const ValidationOptions& options) {
  options.validate();
  FiniteCloud finite = finitePoints(std::move(cloud_C));
  requirePoints(finite);
  const Eigen::AlignedBox3d box = bounds(finite.cloud_C);
  requireExtent(finite.cloud_C, box, options);
  requireResolution(box);
  return finite;
}

}  // namespace boxgrasp
