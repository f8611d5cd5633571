#include "boxgrasp/hand/swept_capsule.h"

#include <algorithm>

namespace boxgrasp {
namespace {

double inverse(double value) { return value > 0.0 ? 1.0 / value : 0.0; }

}  // namespace

SweptCapsule::SweptCapsule(const Vector3d& a, const Vector3d& b, double radius, double sweep_m)
    : a_(a),
      along_(b - a),
      per_squared_(inverse(along_.squaredNorm())),
      per_squared_level_(inverse(along_.head<2>().squaredNorm())),
      squared_radius_(radius * radius),
      sweep_m_(sweep_m) {}

bool SweptCapsule::contains(const Vector3d& p) const {
  // The capsule's shadow is a capsule of the plane. Most points that are asked for lie beside it.
  Vector3d from_a = p - a_;
  const Vector2d level = from_a.head<2>();
  const double share = std::clamp(level.dot(along_.head<2>()) * per_squared_level_, 0.0, 1.0);
  if ((level - share * along_.head<2>()).squaredNorm() > squared_radius_) return false;
  // Above p the capsule holds the height of the segment's nearest point in the plane, and being convex all
  // between that and the rest of what it holds there: no other lift brings p nearer.
  from_a.z() += std::clamp(share * along_.z() - from_a.z(), 0.0, sweep_m_);
  const double nearest = std::clamp(from_a.dot(along_) * per_squared_, 0.0, 1.0);
  return (from_a - nearest * along_).squaredNorm() <= squared_radius_;
}

}  // namespace boxgrasp
