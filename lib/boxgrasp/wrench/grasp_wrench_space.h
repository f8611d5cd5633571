// The grasp wrench space and its measures epsilon and nu (paper IV.A, refs. [18], [19]).
#pragma once

#include <vector>

#include "boxgrasp/wrench/contact.h"

namespace boxgrasp {

enum class WrenchNorm {
  l1,    // the sum of all normal forces is 1: hull of the union of the contacts' edge wrenches
  linf,  // every contact's normal force is at most 1: hull of their Minkowski sum
};

struct WrenchOptions {
  double friction = 0.4;            // Coulomb coefficient, for contacts that bring none
  int cone_edges = 8;               // edges of the linearised friction cone, inscribed in the circular one; 3 to 64
  WrenchNorm norm = WrenchNorm::l1;
  Vector3d p_CG = Vector3d::Zero(); // centre of gravity: torques are taken about it, metres
  double torque_scale_m = 1.0;      // torques are divided by this: the largest distance from the centre of gravity to the surface
  void validate() const;
};

using Wrench = Eigen::Matrix<double, 6, 1>;  // force, then torque / scale

// The edge wrenches of one contact: normal component 1, tangents tx = normalize(n x xhat) (n x zhat where n is along
// x), ty = normalize(n x tx), edge j of m at 2 pi j / m. Friction 0 gives one edge.
// Pre: the normal is of unit length.
std::vector<Wrench> edgeWrenches(const Contact& contact, const WrenchOptions& options);

struct GraspQuality {
  double epsilon = -1.0;       // radius of the largest ball about the origin within the hull; -1: not in force closure
  double volume = -1.0;        // nu: volume of the hull; 0 where the wrenches span fewer than six dimensions
  bool force_closure = false;  // the origin is strictly inside the hull
};

// epsilon and nu; epsilon is exact for the linearised cones up to a few 1e-9 of the largest wrench. No contacts are no
// force closure. Throws InputError for bad options, non-finite contacts, normals that are not of unit length, a
// Minkowski sum (linf) of more than 10,000 points: four contacts of eight edges fit, and take seconds; or cones (l1) of
// more than 128 edges together that are not three in general position: sixteen contacts of eight edges fit.
GraspQuality graspQuality(const std::vector<Contact>& contacts, const WrenchOptions& options = {});

// Only whether the grasp is in force closure, which is the same under both norms; many times faster than
// graspQuality, without a hull. The two answers can differ only where epsilon, over the largest wrench, is below
// about 1e-7: there this one may already say no. The same errors, but for the limit of the sum.
bool forceClosure(const std::vector<Contact>& contacts, const WrenchOptions& options = {});

}  // namespace boxgrasp
