// Reach and clearance: what the hand would meet on its way in and in place (paper III.D).
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "boxgrasp/geometry/point_grid.h"
#include "boxgrasp/hand/approach_columns.h"
#include "boxgrasp/hand/configurations.h"

namespace boxgrasp {

struct ClearanceOptions {
  // The hand comes in a straight line along its approach direction over this length.
  double approach_m = 0.15;

  // Links are thinned by this against the scene's points: the noise of the sensor.
  double skin_m = 0.003;

  // In place the outer links, which touch the object, are thinned by this instead: the straight regions that
  // a grasp is planned on run a little inside of curved surfaces, where a finger stops short.
  double contact_m = 0.006;

  // Fingers are tried opened to these joint angles, in this order, but at least min_opening_rad short of
  // closed.
  std::array<double, 4> openings_rad{0.0, 0.35, 0.70, 1.05};
  double min_opening_rad = 0.15;

  // Poses between open and closed that are tested.
  int closing_steps = 4;

  void validate() const;
};

struct Collision {
  std::string_view link;                   // "palm", "F2 outer link", ...
  std::string_view phase;                  // "approaching", "closing", "in place"
  Vector3d p_C = Vector3d::Constant(NAN);  // a point that it meets
};

struct Clearance {
  std::optional<HandJoints> pregrasp;  // the first opening that is clear; nullopt: none
  std::optional<Collision> collision;  // without a pregrasp: what the opening that got furthest met
};

// Tests the hand in pose X_CP with these closed joints against every point of the scene: closed in place,
// then, for each opening, on the whole straight way in (exactly: a point is met if and only if the thinned
// hand contains it anywhere on the way) and in the poses of closing. The spread is set before the approach.
// The hand's own links never meet (HandDescription).
Clearance testClearance(const HandDescription& hand, const Pose& X_CP, const HandJoints& closed,
                        const PointGrid& scene_C, const ClearanceOptions& options = {});

// The same for one of many hands that come along +z of one frame A, such as all those on one face: some 15
// times faster. Pre: z of P is z of A; the columns hold every point that the hand may meet
// (`reachableRegion`).
Clearance testClearance(const HandDescription& hand, const Pose& X_AP, const HandJoints& closed,
                        const ApproachColumns& scene_A, const ClearanceOptions& options = {});

// Everywhere that a hand, with its palm's origin anywhere in `origins_A` and its z along that of A, may be on
// its way in or in place.
Eigen::AlignedBox3d reachableRegion(const HandDescription& hand, const Eigen::AlignedBox3d& origins_A,
                                    const ClearanceOptions& options = {});

}  // namespace boxgrasp
