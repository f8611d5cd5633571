// What a network is fed: measures of each grasp, as the model's list of features says.
#pragma once

#include <string>
#include <vector>

#include "boxgrasp/planning/plan.h"

namespace boxgrasp {

// What is measured of a grasp, in the order of the columns of graspMeasures(). Lengths in metres. "cloud's
// centre" is the mean of the object's points, L half the diagonal of its root box.
//   q1 .. q9      the quality measures (paper III.D)
//   size          L
//   epsilon, nu   of the planned contacts, about the cloud's centre, with the plan's friction; torques are
//                 divided by the largest distance of a point from it, and cones have 6 edges;
//                 epsilon is 0 where these are not in force closure
//   balance       length of the sum of the three contact normals; 0 where pushes of one force cancel
//   center        distance of the mean contact from the cloud's centre: the arm of gravity
//   center_off    its part across the approach
//   span_min      the shortest side of the triangle of the contacts; span_max: the longest
//   spread_out    extent of the contacts along the approach
//   depth         height of the mean contact above the palm
//   palm          distance of the palm from the cloud's centre
//   spread        the hand's spread angle, rad
//   finger_bend, thumb_bend   inner joint angles (the mean of F1 and F2), rad: near their limits a finger
//                 neither gives way nor follows
//   thumb_angle   size of the angle between the thumb's push and its contact normal, rad
//   focus_area    of the intersection of the friction cones (III.B), m^2: how far the fingers may miss
//   level         depth in the tree of the box that was grasped; leaf: 1 where it is a leaf, else 0
//   seen          share of the contacts that lie on what the sensor saw
std::vector<std::string> measureNames();

// A feature is a measure's name, or one of
//   NAME/L, NAME/L2   divided by the object's size L or its square: without its unit
//   rank(NAME)        the measure's place among all grasps of the object, 0 for the least, 1 for the
//                     greatest, the mean place where several are equal, 0.5 for a single grasp
//   share(NAME)       the measure, at least 0, over the greatest among all grasps of the object; 0 where none
//                     is above 0
// The paper feeds the nine measures as they are. Relative ones rank objects of sizes that the network has
// never seen, ranks those of shapes on which a measure never reaches what it does elsewhere.
std::vector<std::string> paperFeatures();
std::vector<std::string> relativeFeatures();
std::vector<std::string> allFeatures();

// Throws InputError that names the feature which is none of these.
void checkFeatures(const std::vector<std::string>& features);

// L, metres.
double objectSize(const PlannedObject& object);

// Whether one of them needs epsilon or nu, the measures that take long: some 0.09 ms a grasp. As
// checkFeatures().
bool asksForWrenches(const std::vector<std::string>& features);

// The measures of grasps on one object, a row each; epsilon and nu are 0 where no feature asks for them.
// Throws Stopped. Pre: features that are known.
struct MeasuringOptions {
  std::vector<std::string> features = allFeatures();
  double friction = 0.4;
  int threads = 1;  // 0 = all cores; the measures do not depend on it
};
MatrixXd graspMeasures(const PlannedObject& object, const std::vector<const Grasp*>& grasps,
                       const MeasuringOptions& options, const StopToken& stop = {});

// The inputs of a network with these features, for all grasps of one object, a row each: `measures` as from
// graspMeasures(), of all of them, because places among them count. Throws as checkFeatures().
MatrixXd networkInputs(const std::vector<std::string>& features, const MatrixXd& measures);

}  // namespace boxgrasp
