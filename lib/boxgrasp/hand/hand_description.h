// A three-finger hand with Barrett kinematics, as its description file says.
#pragma once

#include <cmath>
#include <filesystem>
#include <string>

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
  double spread_offset = NAN;  // A_w: from the hand's axis to the spread axes
  double base_radius = NAN;    // A_1: from the spread axis (thumb: from the hand's axis) to the inner joint
  double inner_length = NAN;   // A_2: inner joint to outer joint
  double tip_length = NAN;     // outer joint to the centre of the fingertip's sphere
  double tip_radius = NAN;     // of the fingertip's sphere; a finger touches with its leading side
  double joint_height = NAN;   // z of the inner joints' axes in P
  double inner_rest = NAN;     // Phi_2: angle of the inner link above the palm at joint angle 0
  double outer_rest = NAN;     // Phi_3: further angle of the outer link at joint angle 0
  double coupling = NAN;       // outer joint angle per inner joint angle, until the clutch opens
  double inner_min = NAN;      // limits of the inner joint
  double inner_max = NAN;
  double outer_max = NAN;  // limit of the outer joint
  double spread_min = NAN;
  double spread_max = NAN;
  double knuckle_radius = NAN;  // of the capsule from spread axis (thumb: hand's axis) to inner joint
  double inner_radius = NAN;    // of the capsules around the inner and the outer link: at most half of
  double outer_radius = NAN;    // spread_offset, so that links of different fingers never meet
  double palm_radius = NAN;     // the palm's cylinder, below z = 0
  double palm_thickness = NAN;
  double depth_slope = NAN;  // the linear depth approximation g(e) = slope * e + offset (paper, footnote 3)
  double depth_offset = NAN;
  double max_tip_force = NAN;  // newtons that a finger presses with at most
};

// Reads a description (TOML, units in the keys: *_mm, *_deg, *_n). Throws InputError with file, line and
// column for unknown or missing keys, wrong types and impossible values.
HandDescription readHandDescription(const std::filesystem::path& file);
HandDescription parseHandDescription(const std::string& toml, const std::string& name_for_errors);

// The built-in description of the real hand: the same text as deploy/hands/barrett.toml.
const HandDescription& barrettHand();

}  // namespace boxgrasp
