// Forward and inverse kinematics of the hand.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "boxgrasp/hand/hand_description.h"

namespace boxgrasp {

enum Finger { kF1 = 0, kF2 = 1, kThumb = 2 };

// Joint angles, radians. The outer joints follow the inner ones by the coupling. Of jaws: their motors'
// angles, the same for all three.
struct HandJoints {
  double spread = 0.0;
  std::array<double, 3> inner{0, 0, 0};  // f1, f2, f3 (thumb)
};

// A finger's tip in its own plane: x from the inner joint outwards (prismatic: from where the open pad's face
// is), z above the inner joint's axis, of the fingertip sphere's centre.
Vector2d fingertipInPlane(const HandDescription& hand, double inner);

// e: signed distance from the inner joint to the point where the fingertip touches a wall that stands across
// its plane: the sphere's centre less its radius (paper: finger extension). Strictly falling with the joint
// angle up to maxMonotoneAngle().
double extension(const HandDescription& hand, double inner);
double maxMonotoneAngle(const HandDescription& hand);

// The joint angles over which `extension` falls strictly, and what it is at their ends and in equal steps
// between them.
struct Reach {
  static constexpr int kSteps = 16;

  double inner_min = NAN, inner_max = NAN;
  double extension_min_m = NAN, extension_max_m = NAN;
  std::array<double, kSteps + 1> extensions_m{};  // falling, from inner_min to inner_max

  double inner(double step) const { return std::lerp(inner_min, inner_max, step / kSteps); }
};
Reach fingerReach(const HandDescription& hand);

// The joint angle for an extension; nullopt outside the reach. Inverse of `extension` to 1e-12 m. Who asks
// often passes the reach.
std::optional<double> innerForExtension(const HandDescription& hand, double extension_m);
std::optional<double> innerForExtension(const HandDescription& hand, double extension_m, const Reach& reach);

// z of the fingertip's centre above the palm (frame P), exact; and the paper's linear approximation g(e).
double tipHeight(const HandDescription& hand, double inner);
double linearDepth(const HandDescription& hand, double extension_m);

// Which of the two is believed.
enum class DepthModel { exact, linear };

// A link as a capsule: all points within radius of the segment.
struct Capsule {
  std::string_view name;  // "F1 inner link", ...
  int finger = -1;        // 0, 1, 2
  Vector3d a = Vector3d::Zero(), b = Vector3d::Zero();
  double radius = -1.0;
};

// The hand's links in P. Of jaws: the rail, fixed to the palm, on which the finger slides; its stem; its pad,
// which is a bar across the thumb's jaw, as wide as both virtual fingers of the other together. The palm is a
// cylinder about z from -palm_thickness to 0.
struct HandGeometry {
  std::array<Capsule, 9> links;    // for each finger knuckle (rail), inner link (stem), outer link (pad)
  std::array<Vector3d, 3> tips_P;  // centres of the fingertip spheres
  double palm_radius, palm_thickness;
};
HandGeometry forwardKinematics(const HandDescription& hand, const HandJoints& joints);

// The plane in which a finger moves, upright on the palm: where points of it are in P, and points of P in it.
class FingerPlane {
 public:
  FingerPlane(const HandDescription& hand, Finger finger, double spread);
  Vector3d at(const Vector2d& in_plane) const;      // in P; in_plane: as of fingertipInPlane()
  Vector3d coordinates(const Vector3d& p_P) const;  // x and z of the plane, then the distance from it
  Vector3d base() const { return {base_.x(), base_.y(), height_}; }

 private:
  Vector2d base_, direction_;
  double radius_, height_;
};

// The unit direction in P from the spread axis to the fingertip, in the plane of the palm.
Vector2d fingerDirection(Finger finger, double spread);

}  // namespace boxgrasp
