#include "boxgrasp/hand/contacts.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/tolerances.h"

namespace boxgrasp {
namespace {

constexpr double kSpacingsForPlane =
    2.5;                            // in the neighbourhood of so many spacings there are about 20 points
constexpr double kWay_rad = 0.2;    // a finger meets the surface so near to where it was planned to, or not
constexpr double kStep_rad = 0.02;  // of a closing finger: its tip moves by less than half its radius

// What one finger touches, or why nothing.
struct Touch {
  SurfaceContact contact;
  std::optional<ContactRejection> rejection;
};

// Whether a point of the cloud is within `radius_m` of p; `likely` is one that probably is.
bool pointWithin(const PointGrid& grid, const Vector3d& p, double radius_m, std::uint32_t likely) {
  return (grid.cloud().point(likely) - p).norm() <= radius_m || grid.nearest(p, radius_m);
}

// `p_C`: where the fingertip was planned to touch; `inward_C`: the normal of its region.
Touch touch(const Vector3d& p_C, const Vector3d& inward_C, TouchedSurface& surface_C) {
  const auto nearest = surface_C.grid_C().nearest(p_C, surface_C.plane_m());
  if (!nearest) return {{}, ContactRejection::no_surface};
  const std::optional<SurfacePlane>& plane = surface_C.planeAround(*nearest);
  if (!plane) return {{}, ContactRejection::no_surface};
  const Vector3d touched_C = plane->project(p_C);
  if (!pointWithin(surface_C.grid_C(), touched_C, surface_C.search_m(), *nearest))
    return {{}, ContactRejection::no_surface};
  const double cosine = plane->normal.dot(inward_C);
  if (std::abs(cosine) < std::cos(surface_C.options().max_normal_tilt_rad))
    return {{}, ContactRejection::facing_away};
  return {{touched_C, std::copysign(1.0, cosine) * plane->normal}, std::nullopt};
}

// The outline stands for a wall that the sensor cannot see, where a point of the cloud is near enough.
Touch touchUnseen(const Vector3d& p_C, const Vector3d& inward_C, const TouchedSurface& surface_C) {
  if (!surface_C.grid_C().nearest(p_C, surface_C.search_m())) return {{}, ContactRejection::no_surface};
  return {{p_C, inward_C, false}, std::nullopt};
}

bool isUnseen(const Vector3d& p_C, const Vector3d& inward_C, const Viewpoints& viewpoints_C) {
  return !viewpoints_C.empty() && !facesASensor(p_C, -inward_C, viewpoints_C);
}

// A finger that closes on the points in its way.
class ClosingFinger {
 public:
  ClosingFinger(const HandDescription& hand, const FingerPlane& plane) : hand_(hand), plane_(plane) {}

  // Points that the tip passes by count for nothing.
  void add(const Vector3d& p_P) {
    const Vector3d p = plane_.coordinates(p_P);
    if (std::abs(p.z()) <= hand_.tip_radius) points_.push_back({p, p_P});
  }

  // The angle at which its tip comes to the first point, on its way past `planned`.
  std::optional<double> meets(double planned) const {
    double open = std::max(hand_.inner_min, planned - kWay_rad);
    const double last = std::min(hand_.inner_max, planned + kWay_rad);
    if (touches(open)) return std::nullopt;
    double closed = open;
    while (!touches(closed)) {
      if (closed >= last) return std::nullopt;
      open = closed;
      closed = std::min(last, closed + kStep_rad);
    }
    for (double mid = 0.5 * (open + closed); closed - open > tolerance::kAngle; mid = 0.5 * (open + closed))
      (touches(mid) ? closed : open) = mid;
    return closed;
  }

  Vector3d nearest(double inner) const {
    const Vector2d tip = fingertipInPlane(hand_, inner);
    return std::min_element(points_.begin(), points_.end(),
                            [&](const Point& a, const Point& b) {
                              return squaredDistance(a, tip) < squaredDistance(b, tip);
                            })
        ->p_P;
  }

 private:
  struct Point {
    Vector3d in_plane, p_P;
  };
  static double squaredDistance(const Point& point, const Vector2d& tip) {
    return (point.in_plane - Vector3d(tip.x(), tip.y(), 0)).squaredNorm();
  }
  bool touches(double inner) const {
    const Vector2d tip = fingertipInPlane(hand_, inner);
    const double r2 = hand_.tip_radius * hand_.tip_radius;
    return std::any_of(points_.begin(), points_.end(),
                       [&](const Point& point) { return squaredDistance(point, tip) <= r2; });
  }

  const HandDescription& hand_;
  const FingerPlane& plane_;
  std::vector<Point> points_;
};

}  // namespace

void ContactOptions::validate() const {
  requireOption(search_m > 0 && search_m <= 1, "contacts.search_m", search_m, "in (0, 1]");
  requireOption(normal_radius_m > 0 && normal_radius_m <= 1, "contacts.normal_radius_m", normal_radius_m,
                "in (0, 1]");
  requireOption(max_normal_tilt_rad > 0 && max_normal_tilt_rad <= std::numbers::pi / 2,
                "contacts.max_normal_tilt_rad", max_normal_tilt_rad, "in (0, pi/2]");
}

std::string_view describe(ContactRejection rejection) {
  switch (rejection) {
    case ContactRejection::no_surface:
      return "no surface where a fingertip ends";
    case ContactRejection::facing_away:
      return "surface at a fingertip faces away";
    case ContactRejection::not_met:
      return "finger does not come to the surface";
  }
  return "unknown";
}

TouchedSurface::TouchedSurface(const PointGrid& object_C, double spacing_m, const ContactOptions& options)
    : grid_C_(object_C), spacing_m_(spacing_m), options_(options) {}

double TouchedSurface::search_m() const { return std::max(options_.search_m, spacing_m_); }

double TouchedSurface::plane_m() const {
  return std::max(options_.normal_radius_m, kSpacingsForPlane * spacing_m_);
}

const std::optional<SurfacePlane>& TouchedSurface::planeAround(std::uint32_t point) {
  const auto [known, added] = planes_.try_emplace(point);
  if (added) known->second = fitSurface(grid_C_, grid_C_.cloud().point(point), plane_m());
  return known->second;
}

Contacts findContacts(const Face& face, const Triplet& triplet, const HandConfiguration& configuration,
                      TouchedSurface& surface_C, const Viewpoints& viewpoints_C) {
  Contacts result;
  for (int finger = 0; finger < 3; ++finger) {
    const int point = configuration.point_of_finger[finger];
    const Vector2d &p_F = triplet.points_F[point], &n_F = triplet.normals_F[point];
    const Vector3d p_C = face.X_CF * Vector3d(p_F.x(), p_F.y(), configuration.depth_m[finger]);
    const Vector3d n_C = face.X_CF.linear() * Vector3d(n_F.x(), n_F.y(), 0.0);
    Touch found = touch(p_C, n_C, surface_C);
    if (found.rejection && isUnseen(p_C, n_C, viewpoints_C)) found = touchUnseen(p_C, n_C, surface_C);
    if (found.rejection) return {{}, found.rejection};
    result.contacts[finger] = found.contact;
  }
  return result;
}

Contacts meetSurface(const HandDescription& hand, const Pose& X_CP, HandJoints& joints, Contacts planned,
                     TouchedSurface& surface_C) {
  assert(!planned.rejection && !hand.prismatic());
  const Pose X_PC = X_CP.inverse();
  const double way_m =
      kWay_rad * (1 + hand.coupling) * (hand.inner_length + hand.tip_length) + 2 * hand.tip_radius;
  for (int finger = 0; finger < 3; ++finger) {
    SurfaceContact& contact = planned.contacts[finger];
    if (!contact.seen) continue;
    const FingerPlane plane(hand, static_cast<Finger>(finger), joints.spread);
    ClosingFinger closing(hand, plane);
    for (const std::uint32_t i : surface_C.grid_C().within(contact.p_C, way_m))
      closing.add(X_PC * surface_C.grid_C().cloud().point(i));
    const auto inner = closing.meets(joints.inner[finger]);
    if (!inner) return {{}, ContactRejection::not_met};
    const Vector3d met_C = X_CP * closing.nearest(*inner);
    const Touch found = touch(met_C, contact.normal_C, surface_C);
    if (found.rejection) return {{}, found.rejection};
    joints.inner[finger] = *inner;
    contact = {met_C, found.contact.normal_C};
  }
  return planned;
}

}  // namespace boxgrasp
