// Where the fingertips meet the cloud.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <unordered_map>

#include "boxgrasp/geometry/point_grid.h"
#include "boxgrasp/geometry/surface_normal.h"
#include "boxgrasp/geometry/viewpoints.h"
#include "boxgrasp/hand/configurations.h"
#include "boxgrasp/projection/graspable_faces.h"

namespace boxgrasp {

struct ContactOptions {
  // A contact lies within this of a point of the cloud. Grows to one spacing where the cloud is sparse.
  double search_m = 0.005;

  // The surface normal is that of the plane through the points within this. Grows to 2.5 spacings.
  double normal_radius_m = 0.008;

  // The surface normal may lean this far from the region's normal (60 degrees).
  double max_normal_tilt_rad = 1.05;

  // Each finger is closed until its tip meets the surface in space, at the depth at which it ends: the whole
  // inverse kinematics, instead of that of the outline. Where an object narrows below its outline the finger
  // closes farther, and its contact is where it will be. false: the outline's points dropped onto the
  // surface.
  bool meet_surface = false;

  void validate() const;
};

// The surface of an object as fingertips find it: its points, and the plane around each that was asked for,
// fitted once, since many grasps touch the same places. Not to be shared between threads. The grid must
// outlive it.
class TouchedSurface {
 public:
  TouchedSurface(const PointGrid& object_C, double spacing_m, const ContactOptions& options = {});

  const PointGrid& grid_C() const { return grid_C_; }
  const ContactOptions& options() const { return options_; }
  double search_m() const;  // a contact has a point of the cloud so near
  double plane_m() const;   // from a point to the farthest of those that its plane goes through

  // The plane through the points around one; nullopt where they span none.
  const std::optional<SurfacePlane>& planeAround(std::uint32_t point);

 private:
  const PointGrid& grid_C_;
  double spacing_m_;
  ContactOptions options_;
  std::unordered_map<std::uint32_t, std::optional<SurfacePlane>> planes_;
};

struct SurfaceContact {
  Vector3d p_C = Vector3d::Constant(NAN);       // on the surface
  Vector3d normal_C = Vector3d::Constant(NAN);  // unit, into the object
  bool seen = true;  // false: the wall under the finger is turned away from all sensors; the normal is that
                     // of the outline
};

enum class ContactRejection { no_surface, facing_away, not_met };
std::string_view describe(ContactRejection rejection);

// The contacts by finger (F1, F2, F3), or why there are none. A contact is the planned point of a fingertip,
// dropped onto the plane through the cloud near it; its normal points to the side that the normal of the
// region points to. Where sensors stood at `viewpoints_C`, walls that are turned away from all of them are
// not in the cloud: there the outline of what was seen stands for the wall, as long as a point of the cloud
// is near.
struct Contacts {
  std::array<SurfaceContact, 3> contacts;
  std::optional<ContactRejection> rejection;
};
Contacts findContacts(const Face& face, const Triplet& triplet, const HandConfiguration& configuration,
                      TouchedSurface& surface_C, const Viewpoints& viewpoints_C);

// Full inverse kinematics: closes each finger of the hand at X_CP until its tip comes to the first point of
// the cloud, and puts contact and joint angle there, each finger at its own depth. The angle is the least,
// from 0.2 rad before the planned one to as much beyond it; where the tip touches nothing on that way, or
// something before it, the rejection says so. Contacts that are not seen stay as they are. Pre: the hand's
// fingers turn; `planned` has no rejection.
Contacts meetSurface(const HandDescription& hand, const Pose& X_CP, HandJoints& joints, Contacts planned,
                     TouchedSurface& surface_C);

}  // namespace boxgrasp
