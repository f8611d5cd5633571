#include "boxgrasp/decomposition/even_surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "boxgrasp/geometry/point_grid.h"
#include "boxgrasp/geometry/voxels.h"

namespace boxgrasp {
namespace {

constexpr double kTrimmed = 0.02;  // share of the points at each end
constexpr double kVoxel = 0.9;     // edge of the voxels in units of the resolution
constexpr double kReach = 2.5;     // of the Gaussian: the rest weighs 4 %
constexpr int kShifts = 2;         // the second takes in what noise of twice the
                                   // resolution has thrown far out
constexpr double kSupport = 0.12;  // of the median density: less is a stray

// Voxels of a cloud as weighted points.
struct Lumps {
  PointCloud means;
  std::vector<double> weights;  // how many points each stands for
};

Lumps lumpsOf(const PointCloud& cloud, const Voxels& voxels) {
  Lumps lumps{meansOf(cloud, voxels), {}};
  for (std::size_t i = 0; i < voxels.size(); ++i)
    lumps.weights.push_back(static_cast<double>(voxels.points(i).size()));
  return lumps;
}

// The smoothed density at a point, in points, and the mean of what it weighs.
struct Smoothed {
  double density = 0.0;
  Vector3d mean = Vector3d::Zero();
};

Smoothed smoothedAt(const Vector3d& p, const PointGrid& grid, const Lumps& lumps, double resolution_m) {
  const double reach = kReach * resolution_m;
  Smoothed result;
  grid.visitBox({(p.array() - reach).matrix(), (p.array() + reach).matrix()}, [&](std::uint32_t i) {
    const Vector3d q = lumps.means.point(i);
    const double squared = (q - p).squaredNorm();
    if (squared > reach * reach) return false;
    const double weight = lumps.weights[i] * std::exp(-0.5 * squared / (resolution_m * resolution_m));
    result.density += weight;
    result.mean += weight * q;
    return false;
  });
  result.mean /= result.density;
  return result;
}

// Shifts every lump and gives the density where it ends up.
std::vector<double> shift(const Lumps& lumps, double resolution_m, PointCloud& shifted,
                          const StopToken& stop) {
  const PointGrid grid(lumps.means, kReach * resolution_m);
  std::vector<double> density(shifted.size());
  for (int round = 0; round < kShifts; ++round) {
    stop.check();
    for (std::size_t i = 0; i < shifted.size(); ++i) {
      const Smoothed at = smoothedAt(shifted.point(i), grid, lumps, resolution_m);
      density[i] = at.density;
      shifted.x[i] = static_cast<float>(at.mean.x());
      shifted.y[i] = static_cast<float>(at.mean.y());
      shifted.z[i] = static_cast<float>(at.mean.z());
    }
  }
  return density;
}

// The density that half of the points have.
double medianDensity(const std::vector<double>& density, const std::vector<double>& weights) {
  std::vector<std::size_t> order(density.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return density[a] < density[b]; });
  double left = std::accumulate(weights.begin(), weights.end(), 0.0) / 2;
  for (const std::size_t i : order) {
    left -= weights[i];
    if (left <= 0) return density[i];
  }
  return density[order.back()];
}

}  // namespace

double trimmedSize(const PointCloud& cloud_C, const Matrix3d& axes_C) {
  PointCloud along = transformed(cloud_C, makePose(axes_C, Vector3d::Zero()).inverse());
  const auto cut = static_cast<std::ptrdiff_t>(kTrimmed * static_cast<double>(cloud_C.size()));
  double size = 0.0;
  for (auto* values : {&along.x, &along.y, &along.z}) {
    std::nth_element(values->begin(), values->begin() + cut, values->end());
    const double low = (*values)[static_cast<std::size_t>(cut)];
    std::nth_element(values->begin(), values->end() - 1 - cut, values->end());
    size = std::max(size, *(values->end() - 1 - cut) - low);
  }
  return size;
}

PointCloud evenSurface(const PointCloud& cloud_C, double resolution_m, const Matrix3d& axes_C,
                       const StopToken& stop) {
  const Pose X_CG = makePose(axes_C, cloud_C.point(0));
  const PointCloud cloud_G = transformed(cloud_C, X_CG.inverse());
  const Lumps lumps = lumpsOf(cloud_G, sortIntoVoxels(cloud_G, kVoxel * resolution_m));
  PointCloud shifted = lumps.means, kept;
  const std::vector<double> density = shift(lumps, resolution_m, shifted, stop);
  const double least = kSupport * medianDensity(density, lumps.weights);
  for (std::size_t i = 0; i < shifted.size(); ++i) {
    if (density[i] >= least) kept.push(shifted.point(i));
  }
  return transformed(meansOf(kept, sortIntoVoxels(kept, kVoxel * resolution_m)), X_CG);
}

}  // namespace boxgrasp
