#include "boxgrasp/decomposition/angular_sweep.h"

#include <algorithm>
#include <cmath>

#include "boxgrasp/base/tolerances.h"

namespace boxgrasp {

void AngularSweep::sweep(const std::vector<Vector2d>& points, const Vector2d& apex, const Vector2d& inside) {
  axis_ = inside - apex;
  sortRays(points, apex);
  thinRays();
  const std::size_t n = rays_.size();
  first_.assign(n + 1, 0.0);
  last_.assign(n + 1, 0.0);
  if (n == 0) return;
  start(0);
  for (std::size_t k = 1; k < n; ++k) take(k), first_[k + 1] = ring_.twice_area;
  start(n - 1);
  for (std::size_t k = n - 1; k-- > 0;) take(k), last_[k] = ring_.twice_area;
}

double AngularSweep::area(const Vector2d& direction) const {
  constexpr double kMargin = 2 * tolerance::kAngle;  // rays of the same angle to kAngle count as one
  const double angle = angleOf(direction), opposite = angle < 0 ? angle + 2 : angle - 2;
  if (rays_.empty() || (opposite > rays_.front().angle - kMargin && opposite < rays_.back().angle + kMargin))
    return 0.0;
  const auto byAngle = [](const Ray& ray, double value) { return ray.angle < value; };
  const auto before = std::lower_bound(rays_.begin(), rays_.end(), angle - kMargin, byAngle);
  const auto behind = std::lower_bound(before, rays_.end(), angle + kMargin, byAngle);
  return (first_[static_cast<std::size_t>(before - rays_.begin())] +
          last_[static_cast<std::size_t>(behind - rays_.begin())]) /
         2;
}

// Grows with the angle from the axis, from -2 to 2; cheaper than the angle.
double AngularSweep::angleOf(const Vector2d& direction) const {
  const double along = axis_.dot(direction), across = cross(axis_, direction);
  const double ratio = across / (std::abs(along) + std::abs(across));
  return along >= 0 ? ratio : std::copysign(2.0, across) - ratio;
}

void AngularSweep::sortRays(const std::vector<Vector2d>& points, const Vector2d& apex) {
  rays_.clear();
  for (const Vector2d& p : points) {
    const Vector2d direction = p - apex;
    const double reach = direction.squaredNorm();
    if (reach > tolerance::kCoincident * tolerance::kCoincident)
      rays_.push_back({angleOf(direction), reach, p});
  }
  std::sort(rays_.begin(), rays_.end(), [](const Ray& a, const Ray& b) { return a.angle < b.angle; });
}

// Keeps the nearest and the farthest of points on the same ray: a ring of points that are collinear but for
// their rounding errors, in no order, would not be a hull.
void AngularSweep::thinRays() {
  std::size_t kept = 0;
  for (std::size_t begin = 0, end = 0; begin < rays_.size(); begin = end) {
    Ray nearest = rays_[begin], farthest = nearest;
    for (end = begin + 1; end < rays_.size() && rays_[end].angle < rays_[begin].angle + tolerance::kAngle;
         ++end) {
      if (rays_[end].reach < nearest.reach) nearest = rays_[end];
      if (rays_[end].reach > farthest.reach) farthest = rays_[end];
    }
    farthest.angle = nearest.angle = rays_[begin].angle;
    rays_[kept++] = nearest;
    if (farthest.reach > nearest.reach) rays_[kept++] = farthest;
  }
  rays_.resize(kept);
}

void AngularSweep::start(std::size_t ray) {
  ring_.next.resize(rays_.size());
  ring_.previous.resize(rays_.size());
  ring_.next[ray] = ring_.previous[ray] = ring_.top = ray;
  ring_.twice_area = 0.0;
}

// The new point sees the one before it, and from there on the edges that it hides.
void AngularSweep::take(std::size_t ray) {
  auto& [next, previous, twice_area, top] = ring_;
  std::size_t ahead = top, back = top;
  while (next[ahead] != top) {
    const double hidden = -twiceArea(ahead, next[ahead], ray);
    if (hidden < 0) break;
    twice_area += hidden;
    ahead = next[ahead];
  }
  while (previous[back] != ahead) {
    const double hidden = -twiceArea(previous[back], back, ray);
    if (hidden < 0) break;
    twice_area += hidden;
    back = previous[back];
  }
  if (ahead == back && next[top] != top) return;
  next[back] = previous[ahead] = ray;
  next[ray] = ahead;
  previous[ray] = back;
  top = ray;
}

double AngularSweep::twiceArea(std::size_t a, std::size_t b, std::size_t c) const {
  return cross(rays_[b].point - rays_[a].point, rays_[c].point - rays_[a].point);
}

}  // namespace boxgrasp
