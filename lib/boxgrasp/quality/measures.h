// The nine quality measures (paper III.D). q1 to q7 are named after Morales et al.; of these the formulas of
// q2 to q6 are our own reconstructions, because the paper gives names alone: measures.cc is the place to swap
// them. q8 and q9 are Eqs. 4 and 5. None is normalised: the network weighs them (paper III.D). Every one but
// q1 is a penalty. Rigid motions of the plane or of space change none of them.
#pragma once

#include <array>

#include "boxgrasp/hand/configurations.h"

namespace boxgrasp {

// What the measures look at; lengths in metres, in the frame of the face except where said.
struct GraspGeometry {
  std::array<Vector2d, 3> points_F;       // contacts by finger: F1, F2, thumb
  std::array<Vector2d, 3> normals_F;      // inward unit normals of their regions
  std::array<Vector2d, 3> push_F;         // unit directions of push
  std::array<double, 3> extension_m;      // e_i
  std::array<double, 3> tip_height_m;     // fingertips above the palm: the depth that a finger reaches at e_i
  std::array<double, 3> surface_depth_m;  // d_i: depth of the surface at the contacts
  double spread = 0.0;                    // rad
  Vector2d focus_F;                       // of the synthesis (III.B)
  Vector2d shape_centroid_F;              // of the filled projection
  std::array<Vector3d, 3> contacts_C;     // contacts in space
  Vector3d root_center_C;                 // centre of the root box
};

// q1, grasp triangle size: the area of the triangle of the contacts. m^2; large is good. Area of the grasp
// polygon, as Chinellato et al. and Mirtich and Canny have it.
double graspTriangleSize(const std::array<Vector2d, 3>& points_F);

// q2, point arrangement: the summed distances of the triangle's angles from 60 degrees, over their worst case
// of 240: 0 for an equilateral triangle, 1 for three points on a line. Reconstruction: the polygon shape
// index of Park and Starr for n = 3.
double pointArrangement(const std::array<Vector2d, 3>& points_F);

// q3, force line: the angles between each finger's push and the normal of its region, summed. rad.
// Reconstruction: the lines from the contacts to the focus meet the regions at right angles by construction,
// so that only the hand's pushes say something.
double forceLine(const std::array<Vector2d, 3>& push_F, const std::array<Vector2d, 3>& normals_F);

// q4, finger extension: the mean of the three. m, signed. Reconstruction: the quantity is the paper's, the
// mean is ours.
double fingerExtension(const std::array<double, 3>& extension_m);

// q5, finger spread: the distance of the spread angle from 60 degrees, at which the three fingers stand 120
// degrees apart. rad. Reconstruction.
double fingerSpread(double spread);

// q6, focus deviation: the distances of the focus from the three lines of push, summed. m. Reconstruction:
// the lines always meet in one point on the thumb's axis, and "deviation" is of this real focus from the
// planned one; their distance is infinite for parallel fingers, while this sum stays finite, and is 0 exactly
// when the real focus is the planned one.
double focusDeviation(const std::array<Vector2d, 3>& points_F, const std::array<Vector2d, 3>& push_F,
                      const Vector2d& focus_F);

// q7, 2D force focus: the distance of the focus from the centroid of the projected shape. m. The plane's
// version of q9.
double forceFocus2d(const Vector2d& focus_F, const Vector2d& shape_centroid_F);

// q8, finger depth difference (Eq. 4): the squared differences between the depths that the fingers reach and
// those of the surface, summed. m^2. The hand's stand-off shifts all three alike: the linear model takes it
// to be part of g, the exact one takes the best there is, the mean difference, off.
double fingerDepthDifference(const std::array<double, 3>& reached_m, const std::array<double, 3>& surface_m,
                             DepthModel model);

// q9, 3D force focus (Eq. 5): the distance of the mean contact from the centre of the root box. m.
double forceFocus3d(const std::array<Vector3d, 3>& contacts_C, const Vector3d& root_center_C);

using QualityMeasures = std::array<double, 9>;  // q1 .. q9

QualityMeasures qualityMeasures(const GraspGeometry& grasp, const HandDescription& hand,
                                DepthModel model = DepthModel::exact);

}  // namespace boxgrasp
