// The distance from any point to the surface of a solid, tabulated, so that a contact costs the same however
// fine the mesh is.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "boxgrasp/geometry/triangle_mesh.h"

namespace boxgrasp {

struct DistanceFieldOptions {
  // Distance of neighbouring samples. What a link of 9 mm radius touches is read 9 mm away from the surface,
  // where the field is smooth: sampling 2 mm apart then errs by less than 0.1 mm.
  double cell_m = 0.002;
  // Around the mesh's bounding box: more than the largest radius of a link and the deepest contact together.
  double margin_m = 0.016;
  // Where the mesh is too large for this many samples of cell_m, cells grow.
  std::size_t max_samples = 4'000'000;
  void validate() const;
};

struct FieldValue {
  double distance = NAN;                   // metres; negative inside
  Vector3d gradient_O = Vector3d::Zero();  // unit where not zero: away from the surface's nearest point
};

// Signed distances to a solid's surface in its frame O. Samples next to the surface are exact to rounding (as
// float); farther ones inherit the nearest triangle of a neighbour and may miss a nearer one by a fraction of
// a cell. Between samples, linear interpolation.
class DistanceField {
 public:
  // Pre: the mesh bounds a solid (topologyOf).
  DistanceField(const TriangleMesh& mesh, const DistanceFieldOptions& options = {});

  // Outside the table: the distance to the mesh's bounding box, a lower bound.
  double distance(const Vector3d& p_O) const;
  FieldValue valueAndGradient(const Vector3d& p_O) const;

  double cell() const { return cell_; }
  const Eigen::AlignedBox3d& bounds() const { return bounds_; }  // of the mesh

 private:
  struct Corner;
  Corner locate(const Vector3d& p_O) const;
  bool inTable(const Vector3d& p_O) const;

  Eigen::AlignedBox3d bounds_;
  Vector3d origin_;
  double cell_;
  Eigen::Vector3i size_;
  std::vector<float> samples_;
};

}  // namespace boxgrasp
