#include "boxgrasp/geometry/surface_normal.h"

#include <Eigen/Eigenvalues>

namespace boxgrasp {
namespace {

constexpr double kCollinear = 1e-12;  // ratio of variances: the square of a millionth

}  // namespace

std::optional<SurfacePlane> fitSurface(const PointGrid& grid, const Vector3d& p, double radius_m) {
  const std::vector<std::uint32_t> neighbours = grid.within(p, radius_m);
  if (neighbours.size() < 3) return std::nullopt;
  // Sums are taken relative to p: the neighbours' extent is small beside their distance from the origin.
  Vector3d sum = Vector3d::Zero();
  Matrix3d squares = Matrix3d::Zero();
  for (const std::uint32_t i : neighbours) {
    const Vector3d offset = grid.cloud().point(i) - p;
    sum += offset;
    squares.noalias() += offset * offset.transpose();
  }
  const double n = static_cast<double>(neighbours.size());
  const Vector3d mean = sum / n;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(squares / n - mean * mean.transpose());
  const Vector3d variances = axes.eigenvalues().cwiseMax(0.0);  // ascending
  if (!(variances[1] > kCollinear * variances[2])) return std::nullopt;
  return SurfacePlane{p + mean, axes.eigenvectors().col(0), variances[0] / variances.sum()};
}

}  // namespace boxgrasp
