// A hand as its description file says: three fingers that turn, or two jaws that slide.
#pragma once

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include "boxgrasp/geometry/pose.h"

namespace boxgrasp {

// What a finger's motor does: turn two coupled links (Barrett), or slide the finger towards the hand's axis.
enum class FingerJoint { revolute, prismatic };

// Angles and lengths of a hand (definitions in hand frame P below). All in metres and radians.
//
// Palm frame P: origin on the palm's surface at the hand's axis, z out of the palm (the approach direction),
// y from the thumb F3 towards the fingers F1 and F2, x to F1's side. F1 and F2 turn about axes parallel to z
// at (+w, 0) and (-w, 0); at spread 0 both point along +y, at spread pi along -y beside the thumb. The thumb
// is fixed along -y.
//
// A parallel gripper is the same hand by virtual fingers: two that always stand at spread 0 and slide as one
// are one jaw, the thumb is the other. Each jaw stands along z, at the distance from the hand's axis that its
// motor leaves it; both jaws keep the same. A joint angle is the motor's, 0 at the widest opening, and the
// jaw's way is slide_per_rad times that. What only turning fingers have is 0.
struct HandDescription {
  std::string name;
  FingerJoint joint = FingerJoint::revolute;
  double spread_offset =
      NAN;  // A_w: from the hand's axis to the spread axes; prismatic: to the virtual fingers
  double base_radius = NAN;   // A_1: from the spread axis (thumb: from the hand's axis) to the inner joint;
                              // prismatic: to the pad of a jaw that is wide open
  double inner_length = NAN;  // A_2: inner joint to outer joint; prismatic: of the stem below the pad
  double tip_length = NAN;    // outer joint to the centre of the fingertip's sphere; prismatic: of the pad
  double tip_radius = NAN;    // of the fingertip's sphere; a finger touches with its leading side
  double joint_height = NAN;  // z of the inner joints' axes, or of the jaws' feet, in P
  double inner_rest = NAN;    // Phi_2: angle of the inner link above the palm at joint angle 0
  double outer_rest = NAN;    // Phi_3: further angle of the outer link at joint angle 0
  double coupling = NAN;      // outer joint angle per inner joint angle, until the clutch opens
  double inner_min = NAN;     // limits of the inner joint
  double inner_max = NAN;
  double outer_max = NAN;  // limit of the outer joint
  double spread_min = NAN;
  double spread_max = NAN;
  double knuckle_radius = NAN;  // of the capsule from spread axis (thumb: hand's axis) to inner joint
  double inner_radius = NAN;    // of the capsules around the inner and the outer link: at most half of
  double outer_radius = NAN;    // spread_offset, so that links of different fingers never meet
  double palm_radius = NAN;     // the palm's cylinder, below z = 0
  double palm_thickness = NAN;
  double slide_per_rad = 0.0;  // prismatic: metres that a jaw slides for each radian of its motor
  double depth_slope = NAN;    // the linear depth approximation g(e) = slope * e + offset (paper, footnote 3)
  double depth_offset = NAN;
  double max_tip_force = NAN;  // newtons that a finger, or a jaw, presses with at most

  bool prismatic() const { return joint == FingerJoint::prismatic; }
};

// Reads a description (TOML, units in the keys: *_mm, *_deg, *_n). Throws InputError with file, line and
// column for unknown or missing keys, wrong types and impossible values.
HandDescription readHandDescription(const std::filesystem::path& file);
HandDescription parseHandDescription(const std::string& toml, const std::string& name_for_errors);

// The built-in description of the real hand: the same text as deploy/hands/barrett.toml.
const HandDescription& barrettHand();

// The file's hand; without a file the Barrett hand.
HandDescription handOrBarrett(const std::optional<std::filesystem::path>& file);

}  // namespace boxgrasp
