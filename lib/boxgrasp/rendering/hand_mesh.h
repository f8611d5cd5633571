// The hand as triangles, for pictures.
#pragma once

#include "boxgrasp/geometry/triangle_mesh.h"
#include "boxgrasp/hand/kinematics.h"

namespace boxgrasp {

TriangleMesh capsuleMesh(const Vector3d& a, const Vector3d& b, double radius);
TriangleMesh cylinderMesh(const Vector3d& a, const Vector3d& b, double radius);

// The links of the hand in P, each with the colour that pictures give to its finger (-1: the palm).
struct DrawnPart {
  TriangleMesh mesh_P;
  int finger = -1;
};
std::vector<DrawnPart> handMesh(const HandDescription& hand, const HandJoints& joints);

}  // namespace boxgrasp
