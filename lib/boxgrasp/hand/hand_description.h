// A three-finger hand with Barrett kinematics, as its description file says.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "boxgrasp/geometry/pose.h"

namespace boxgrasp {

// Angles and lengths of the Barrett hand (definitions in hand frame P below). All in metres and radians.
//
// Palm frame P: origin on the palm's surface at the hand's axis, z out of the palm (the approach direction),
// y from the thumb F3 towards the fingers F1 and F2, x to F1's side. F1 and F2 turn about axes parallel to z
// at (+w, 0) and (-w, 0); at spread 0 both point along +y, at spread pi along -y beside the thumb. The thumb
// is fixed along -y.
struct HandDescription {
  std::string name;
  double spread_offset;  // A_w: from the hand's axis to the spread axes
  double base_radius;    // A_1: from the spread axis (thumb: from the hand's axis) to the inner joint
  double inner_length;   // A_2: inner joint to outer joint
  double tip_length;     // outer joint to the centre of the fingertip's sphere
  double tip_radius;     // radius of the fingertip; a finger touches with the side of this sphere that leads
  double joint_height;   // z of the inner joints' axes in P
  double inner_rest;     // Phi_2: angle of the inner link above the palm at joint angle 0
  double outer_rest;     // Phi_3: further angle of the outer link at joint angle 0
  double coupling;       // outer joint angle per inner joint angle, until the clutch opens
  double inner_min, inner_max;  // limits of the inner joint
  double outer_max;             // limit of the outer joint
  double spread_min, spread_max;
  double inner_radius, outer_radius;   // of the capsules around inner and outer link
  double knuckle_radius;               // of the capsule from spread axis to inner joint
  double palm_radius, palm_thickness;  // the palm's cylinder, below z = 0
  double depth_slope,
      depth_offset;  // the linear depth approximation g(e) = slope * e + offset (paper, footnote 3), metres
  double max_tip_force;  // newtons a finger presses with at most
};

// Reads a description (TOML, units in the keys: *_mm, *_deg, *_n). Throws InputError with file, line and
// column for unknown or missing keys, wrong types and impossible values.
HandDescription readHandDescription(const std::filesystem::path& file);
HandDescription parseHandDescription(const std::string& toml, const std::string& name_for_errors);

// The built-in description of the real hand: the same text as deploy/hands/barrett.toml.
const HandDescription& barrettHand();

}  // namespace boxgrasp
