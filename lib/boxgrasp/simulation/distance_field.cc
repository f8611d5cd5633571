#include "boxgrasp/simulation/distance_field.h"

#include <algorithm>
#include <cmath>

#include "boxgrasp/base/error.h"
#include "boxgrasp/simulation/distance_samples.h"

namespace boxgrasp {
namespace {

Eigen::AlignedBox3d boundsOf(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d bounds;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) bounds.extend(mesh.vertices[v]);
  }
  return bounds;
}

SampleGrid gridFor(const Eigen::AlignedBox3d& bounds, const DistanceFieldOptions& options) {
  const Vector3d extent = bounds.sizes() + Vector3d::Constant(2 * options.margin_m);
  SampleGrid grid;
  for (grid.cell = options.cell_m;; grid.cell *= 1.1) {
    grid.size = (extent / grid.cell).array().ceil().cast<int>() + 1;
    if (grid.size.cast<double>().prod() <= static_cast<double>(options.max_samples)) break;
  }
  grid.origin = bounds.center() - 0.5 * grid.cell * (grid.size.cast<double>() - Vector3d::Ones());
  return grid;
}

}  // namespace

void DistanceFieldOptions::validate() const {
  requireOption(cell_m > 0, "cell_m", cell_m, "positive");
  requireOption(margin_m >= 0, "margin_m", margin_m, "at least 0");
  requireOption(max_samples >= 1000, "max_samples", max_samples, "at least 1000");
}

// The cell that holds a point, and where in it the point is.
struct DistanceField::Corner {
  const float* lowest;
  Eigen::Index row, slab;
  Vector3d fraction;

  double at(int x, int y, int z) const { return lowest[x + y * row + z * slab]; }
};

DistanceField::DistanceField(const TriangleMesh& mesh, const DistanceFieldOptions& options)
    : bounds_(boundsOf(mesh)) {
  options.validate();
  const SampleGrid grid = gridFor(bounds_, options);
  origin_ = grid.origin;
  cell_ = grid.cell;
  size_ = grid.size;
  samples_ = signedDistances(mesh, grid);
}

bool DistanceField::inTable(const Vector3d& p_O) const {
  const Eigen::Array3d steps = (p_O - origin_).array() / cell_;
  return (steps >= 0.0).all() && (steps < size_.cast<double>().array() - 1.0).all();
}

DistanceField::Corner DistanceField::locate(const Vector3d& p_O) const {
  const Vector3d steps = (p_O - origin_) / cell_;
  const Eigen::Vector3i at = steps.cast<int>();
  const Eigen::Index row = size_.x(), slab = row * size_.y();
  return {&samples_[at.z() * slab + at.y() * row + at.x()], row, slab, steps - at.cast<double>()};
}

double DistanceField::distance(const Vector3d& p_O) const {
  return inTable(p_O) ? valueAndGradient(p_O).distance : bounds_.exteriorDistance(p_O);
}

FieldValue DistanceField::valueAndGradient(const Vector3d& p_O) const {
  if (!inTable(p_O)) return {bounds_.exteriorDistance(p_O), Vector3d::Zero()};
  const Corner c = locate(p_O);
  const auto mix = [](double a, double b, double t) { return a + t * (b - a); };
  const auto& f = c.fraction;
  double along_x[2][2], step_x[2][2];
  for (int z = 0; z < 2; ++z) {
    for (int y = 0; y < 2; ++y) {
      along_x[z][y] = mix(c.at(0, y, z), c.at(1, y, z), f.x());
      step_x[z][y] = c.at(1, y, z) - c.at(0, y, z);
    }
  }
  const double low = mix(along_x[0][0], along_x[0][1], f.y());
  const double high = mix(along_x[1][0], along_x[1][1], f.y());
  const double dx =
      mix(mix(step_x[0][0], step_x[0][1], f.y()), mix(step_x[1][0], step_x[1][1], f.y()), f.z());
  const double dy = mix(along_x[0][1] - along_x[0][0], along_x[1][1] - along_x[1][0], f.z());
  return {mix(low, high, f.z()), Vector3d(dx, dy, high - low).stableNormalized()};
}

}  // namespace boxgrasp
