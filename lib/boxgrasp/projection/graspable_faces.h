// The faces of boxes from which a hand may approach (paper III, "valid in terms of visibility,
// reachability, and more").
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/decomposition/box_tree.h"
#include "boxgrasp/geometry/point_grid.h"
#include "boxgrasp/geometry/viewpoints.h"
#include "boxgrasp/projection/face.h"

namespace boxgrasp {

enum class FaceRejection {
  none,
  blocked,      // points outside the box stand where the hand would come from
  shared,       // mostly covered by a neighbouring box: an inside of the object
  hidden,       // turned away from the sensor
  supported,    // faces the ground or the table
  too_wide,     // wider than the hand opens
  too_narrow,   // no room for a finger
  too_shallow,  // less deep than a fingertip needs
  not_allowed,  // the robot may not come from there; nothing in this room says so
};
std::string_view describe(FaceRejection rejection);  // e.g. "face blocked by other points"

// never: faces alone, as in the paper. last: where they have no grasp. partial: there, and for objects that
// were seen from some side only. What is not `always` is for the planner to decide.
enum class EdgeUse { never, last, partial, always };

struct FaceOptions {
  // The faces of inner boxes of the tree count too: coarser views of the object, for grasps that span several
  // of its parts. false: leaf boxes alone, as in the paper.
  bool inner_boxes = true;
  // Approaches over the twelve edges of each box: the hand comes in between two faces, and its fingers end on
  // surfaces that belong to several. It takes twice the time, and helps where few faces are seen.
  EdgeUse edges = EdgeUse::partial;
  // The smaller edge of a face may not be longer: twice the Barrett hand's practical reach.
  double max_aperture_m = 0.20;
  // The smaller edge may not be shorter: nothing to press against.
  double min_width_m = 0.005;
  // The box may not be shallower: about the depth of a fingertip.
  double min_depth_m = 0.010;
  // Side of the square that the palm sweeps in front of the face.
  double hand_width_m = 0.090;
  // How far before the face the hand needs room: the length of its fingers.
  double hand_depth_m = 0.110;
  // Blocked beyond this share of the swept square, counted in cells of 5 mm with a point in them. Points
  // within 3 mm of the face's plane belong to the face.
  double max_blocked_fraction = 0.10;
  // Shared beyond this share of the face covered by another leaf box, measured 2 mm outside the face with
  // boxes grown by 2 mm: boxes on both sides of a cut shrink to their points and leave a gap.
  double max_shared_fraction = 0.50;
  // Supported: the outward normal is within acos(this) of gravity.
  double max_support_cosine = 0.70;
  void validate() const;
};

struct FaceDecision {
  Face face;
  FaceRejection rejection = FaceRejection::none;
  bool graspable() const { return rejection == FaceRejection::none; }
};

// What is known about the world around the object.
struct Surroundings {
  std::optional<Vector3d> gravity_C;  // unit, pointing down; unknown: no face is rejected as supported
  Viewpoints viewpoints_C;            // where sensors stood; unknown: no face is rejected as hidden
};

// All faces of every box that counts, in order of node and number, each with the reason for its rejection, if
// any. A face with several reasons tells the first of: its size, hidden, supported, shared, blocked (from the
// cheapest test to the dearest). An edge is shared where one of the two faces is between which it lies.
// `cloud_C` is what the tree was made of; `scene` holds every point that a hand could meet: the object, its
// neighbours, the table.
std::vector<FaceDecision> graspableFaces(const BoxTree& tree, const PointCloud& cloud_C,
                                         const PointGrid& scene, const Surroundings& surroundings,
                                         const FaceOptions& options = {}, const StopToken& stop = {});

}  // namespace boxgrasp
