#include "boxgrasp/quality/measures.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "boxgrasp/geometry/polygon.h"

namespace boxgrasp {
namespace {

constexpr double kEvenSpread =
    std::numbers::pi / 3.0;  // at 60 degrees the three fingers stand 120 degrees apart

// The angle between two vectors, exact near 0 and pi; 0 when one of them vanishes.
double angleBetween(const Vector2d& a, const Vector2d& b) {
  return std::atan2(std::abs(cross(a, b)), a.dot(b));
}

double mean(const std::array<double, 3>& values) { return (values[0] + values[1] + values[2]) / 3.0; }

}  // namespace

double graspTriangleSize(const std::array<Vector2d, 3>& points_F) {
  return 0.5 * std::abs(cross(points_F[1] - points_F[0], points_F[2] - points_F[0]));
}

double pointArrangement(const std::array<Vector2d, 3>& points_F) {
  constexpr double kEqual = std::numbers::pi / 3.0, kWorst = 4.0 * std::numbers::pi / 3.0;
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    const Vector2d &p = points_F[i], &q = points_F[(i + 1) % 3], &r = points_F[(i + 2) % 3];
    sum += std::abs(angleBetween(q - p, r - p) - kEqual);
  }
  return sum / kWorst;
}

double forceLine(const std::array<Vector2d, 3>& push_F, const std::array<Vector2d, 3>& normals_F) {
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) sum += angleBetween(push_F[i], normals_F[i]);
  return sum;
}

double fingerExtension(const std::array<double, 3>& extension_m) { return mean(extension_m); }

double fingerSpread(double spread) { return std::abs(spread - kEvenSpread); }

double focusDeviation(const std::array<Vector2d, 3>& points_F, const std::array<Vector2d, 3>& push_F,
                      const Vector2d& focus_F) {
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) sum += std::abs(cross(push_F[i], focus_F - points_F[i]));
  return sum;
}

double forceFocus2d(const Vector2d& focus_F, const Vector2d& shape_centroid_F) {
  return (focus_F - shape_centroid_F).norm();
}

double fingerDepthDifference(const std::array<double, 3>& reached_m, const std::array<double, 3>& surface_m,
                             DepthModel model) {
  std::array<double, 3> difference;
  for (int i = 0; i < 3; ++i) difference[i] = reached_m[i] - surface_m[i];
  const double stand_off = model == DepthModel::exact ? mean(difference) : 0.0;
  double sum = 0.0;
  for (const double d : difference) sum += (d - stand_off) * (d - stand_off);
  return sum;
}

double forceFocus3d(const std::array<Vector3d, 3>& contacts_C, const Vector3d& root_center_C) {
  return ((contacts_C[0] + contacts_C[1] + contacts_C[2]) / 3.0 - root_center_C).norm();
}

QualityMeasures qualityMeasures(const GraspGeometry& grasp, const HandDescription& hand, DepthModel model) {
  std::array<double, 3> reached = grasp.tip_height_m;
  if (model == DepthModel::linear) {
    for (int i = 0; i < 3; ++i) reached[i] = linearDepth(hand, grasp.extension_m[i]);
  }
  return {graspTriangleSize(grasp.points_F),
          pointArrangement(grasp.points_F),
          forceLine(grasp.push_F, grasp.normals_F),
          fingerExtension(grasp.extension_m),
          fingerSpread(grasp.spread),
          focusDeviation(grasp.points_F, grasp.push_F, grasp.focus_F),
          forceFocus2d(grasp.focus_F, grasp.shape_centroid_F),
          fingerDepthDifference(reached, grasp.surface_depth_m, model),
          forceFocus3d(grasp.contacts_C, grasp.root_center_C)};
}

}  // namespace boxgrasp
