// Reach and clearance: what the hand would meet on its way in and in place (paper III.D).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "boxgrasp/geometry/point_grid.h"
#include "boxgrasp/hand/configurations.h"

namespace boxgrasp {

struct ClearanceOptions {
  double approach_m = 0.15;                  // the hand comes in a straight line along its approach direction over this length
  double skin_m = 0.003;                     // links are thinned by this against the object's points: sensor noise and contact itself
  std::array<double, 4> openings_rad{0.0, 0.35, 0.70, 1.05};   // fingers are tried opened to these joint angles, widest first, but at least
  double min_opening_rad = 0.15;             // ... this far short of their closed angle
  int closing_steps = 4;                     // poses between open and closed that are tested
  void validate() const;
};

struct Collision {
  std::string_view link;       // "palm", "F2 outer link", ...
  std::string_view phase;      // "approaching", "closing", "in place"
  Vector3d p_C = Vector3d::Constant(NAN);   // a point that it meets
};

struct Clearance {
  std::optional<HandJoints> pregrasp;      // the widest opening that is clear; nullopt: none
  std::optional<Collision> collision;      // what the hand met, with the opening that got furthest
};

// Tests the hand in pose X_CP with these closed joints against every point of the scene.
Clearance testClearance(const HandDescription& hand, const Pose& X_CP, const HandJoints& closed, const PointGrid& scene_C,
                        const ClearanceOptions& options = {});

}  // namespace boxgrasp
