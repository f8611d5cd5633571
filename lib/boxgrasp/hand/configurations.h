// Hand configurations that reach three finger points (paper III.C).
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "boxgrasp/hand/kinematics.h"
#include "boxgrasp/synthesis/triplets.h"

namespace boxgrasp {

struct ConfigurationOptions {
  // Bounds the thumb's angle to the surface and the fingers' to theirs (III.C).
  double friction = 0.4;

  // Steps of the thumb angle over (-atan mu, atan mu) (III.C).
  int thumb_steps = 100;

  // Fingertips aim this far below the surface's upper edge, or at the middle of the side where that is less:
  // at the widest place of round sides, and as far from the edge of tall ones as leaves the links room above
  // the object. Larger holds tall objects nearer to their middle, smaller keeps away from what they stand on.
  double insertion_m = 0.030;

  // Fingertips may end this far above or below the surface that they aim at.
  double depth_tolerance_m = 0.005;

  // The palm stays this far from the plane of the face.
  double palm_clearance_m = 0.005;

  // Configurations of one triplet and thumb whose hands differ by less than this count as one: in the palm's
  // turn, in the spread, and in the palm's shift as seen over the length of a finger. The one whose thumb
  // pushes straightest stays; the others are as good, and each costs a clearance test. 5 degrees; 0 keeps
  // all.
  double min_turn_rad = 0.087;

  // How high the fingertips stand above the palm at an extension, which is what puts the palm at its height:
  // by the hand's kinematics, or by the paper's line g(e), which jaws have not.
  DepthModel depth_model = DepthModel::exact;

  void validate() const;
};

// One way to put the hand on a triplet. Frame F is the face's: the palm looks along +z of F.
struct HandConfiguration {
  int triplet = -1;
  std::array<int, 3> point_of_finger{-1, -1, -1};  // for F1, F2, F3: which of the triplet's points it takes
  double thumb_angle = 0.0;                        // beta, between the thumb's push and its contact normal
  Pose X_FP = Pose::Identity();
  HandJoints joints;
  std::array<double, 3> extension_m{};   // e_i, by finger
  std::array<double, 3> tip_height_m{};  // above the palm, by finger
  std::array<double, 3> depth_m{};       // where the fingertips end below the face, by finger
  std::array<Vector2d, 3> push_F{};      // u_i: unit direction in which each finger pushes
  Vector2d real_focus_F{0, 0};  // where the three lines of push meet; far away when they are parallel
};

enum class ReachRejection { spread_or_side, extension, friction_cone, depth };
std::string_view describe(ReachRejection rejection);

struct Configurations {
  std::vector<HandConfiguration> configurations;
  std::array<std::size_t, 4>
      rejected{};          // steps of the thumb angle, by ReachRejection: the furthest they came
  std::size_t merged = 0;  // left out for min_turn_rad
};

// All configurations for one triplet: every assignment of fingers to points, every step of the thumb angle,
// each solved in closed form (definitions, 2.4), so that the fingertips touch the triplet's points exactly.
// Where F1's and F2's points are mirror images in the thumb's axis to within 0.5 mm, a whole range of spreads
// fits: it is swept as well, in thumb_steps, and there the points of F1 and F2 are met to within 0.4 mm.
// Where they are straight ahead of the spread axes to within 0.5 mm, the fingers stay parallel, with the palm
// midway between them and the thumb; a gripper's jaws always do. Otherwise F1 and F2 reach outwards from
// their spread axes. The palm's height is the one that brings the depths of the three fingertips nearest to
// their aims. Ordered by point of the thumb, then by the size of the thumb angle. O(thumb_steps) a triplet.
// Who asks often passes the reach.
Configurations findConfigurations(const HandDescription& hand, const Triplet& triplet, int triplet_index,
                                  const ConfigurationOptions& options = {});
Configurations findConfigurations(const HandDescription& hand, const Reach& reach, const Triplet& triplet,
                                  int triplet_index, const ConfigurationOptions& options);

}  // namespace boxgrasp
