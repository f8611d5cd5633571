// The nine quality measures (paper III.D). q1 to q7 are named after Morales et al.; of these the formulas of
// q2 to q6 are our own reconstructions, because the paper gives names alone: this file is the place to swap
// them. q8 and q9 are Eqs. 4 and 5.
#pragma once

#include <array>

#include "boxgrasp/hand/configurations.h"

namespace boxgrasp {

// What the measures look at; lengths in metres, in the frame of the face except where said.
struct GraspGeometry {
  std::array<Vector2d, 3> points_F;   // contacts by finger: F1, F2, thumb
  std::array<Vector2d, 3> normals_F;  // inward unit normals of their regions
  std::array<Vector2d, 3> push_F;     // unit directions of push
  std::array<double, 3> extension_m;  // e_i
  std::array<double, 3>
      tip_height_m;  // fingertips above the palm: the exact depth that the finger reaches at e_i
  std::array<double, 3> surface_depth_m;  // d_i: depth of the surface at the contacts
  double spread = 0.0;                    // rad
  Vector2d focus_F;                       // of the synthesis (III.B)
  Vector2d real_focus_F;                  // of the hand
  Vector2d shape_centroid_F;              // of the filled projection
  std::array<Vector3d, 3> contacts_C;     // contacts in space
  Vector3d root_center_C;                 // centre of the root box
};

enum class DepthModel {
  exact,   // the finger's own kinematics, free of the hand's stand-off: sum of (delta_i - mean delta)^2
  linear,  // the paper's g(e) = 0.953 e + 128.8 mm, Eq. 4 to the letter
};

double graspTriangleSize(const std::array<Vector2d, 3>& points_F);  // q1, m^2, large is good
double pointArrangement(const std::array<Vector2d, 3>& points_F);   // q2, [0, 1], small
double forceLine(const std::array<Vector2d, 3>& push_F,
                 const std::array<Vector2d, 3>& normals_F);        // q3, rad, small
double fingerExtension(const std::array<double, 3>& extension_m);  // q4, m, small
double fingerSpread(double spread);                                // q5, rad, small
double focusDeviation(const std::array<Vector2d, 3>& points_F, const std::array<Vector2d, 3>& push_F,
                      const Vector2d& focus_F);                                  // q6, m, small
double forceFocus2d(const Vector2d& focus_F, const Vector2d& shape_centroid_F);  // q7, m, small
double fingerDepthDifference(const std::array<double, 3>& reached_m, const std::array<double, 3>& surface_m,
                             DepthModel model);  // q8, m^2, small (Eq. 4)
double forceFocus3d(const std::array<Vector3d, 3>& contacts_C,
                    const Vector3d& root_center_C);  // q9, m, small (Eq. 5)

using QualityMeasures = std::array<double, 9>;  // q1 .. q9

QualityMeasures qualityMeasures(const GraspGeometry& grasp, const HandDescription& hand,
                                DepthModel model = DepthModel::exact);

}  // namespace boxgrasp
