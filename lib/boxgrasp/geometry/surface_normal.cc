#include "boxgrasp/geometry/surface_normal.h"

#include <Eigen/Eigenvalues>

namespace boxgrasp {
namespace {

constexpr double kCollinear = 1e-12;  // ratio of variances: the square of a millionth

}  // namespace

std::optional<SurfacePlane> fitSurface(const PointGrid& grid, const Vector3d& p, double radius_m) {
  // Sums are taken relative to p: the neighbours' extent is small beside their distance from the origin.
  Vector3d sum = Vector3d::Zero();
  Matrix3d squares = Matrix3d::Zero();
  double n = 0.0;
  const Vector3d reach = Vector3d::Constant(radius_m);
  grid.visitBox({p - reach, p + reach}, [&](std::uint32_t i) {
    const Vector3d offset = grid.cloud().point(i) - p;
    if (offset.squaredNorm() > radius_m * radius_m) return false;
    sum += offset;
    squares.noalias() += offset * offset.transpose();
    ++n;
    return false;
  });
  if (n < 3) return std::nullopt;
  const Vector3d mean = sum / n;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(squares / n - mean * mean.transpose());
  const Vector3d variances = axes.eigenvalues().cwiseMax(0.0);  // ascending
  if (!(variances[1] > kCollinear * variances[2])) return std::nullopt;
  return SurfacePlane{p + mean, axes.eigenvectors().col(0), variances[0] / variances.sum()};
}

}  // namespace boxgrasp
