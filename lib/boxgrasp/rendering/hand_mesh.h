// The hand as triangles, for pictures.
#pragma once

#include "boxgrasp/geometry/triangle_mesh.h"
#include "boxgrasp/hand/kinematics.h"
#include "boxgrasp/rendering/canvas.h"

namespace boxgrasp {

TriangleMesh capsuleMesh(const Vector3d& a, const Vector3d& b, double radius);
TriangleMesh cylinderMesh(const Vector3d& a, const Vector3d& b, double radius);

// The links of the hand and its palm, in the frame of the links. Finger -1: the palm.
struct DrawnPart {
  TriangleMesh mesh;
  int finger = -1;
};
std::vector<DrawnPart> handMesh(const HandDescription& hand, const HandJoints& joints);  // in P
DrawnPart palmMesh(const HandDescription& hand);                                         // in P
DrawnPart linkMesh(const Capsule& link);

// The colour that pictures give to a finger; -1: to the palm.
Colour fingerColour(int finger);

}  // namespace boxgrasp
