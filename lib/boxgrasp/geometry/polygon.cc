#include "boxgrasp/geometry/polygon.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace boxgrasp {
namespace {

double magnitude(const std::vector<Vector2d>& points) {
  double largest = 0.0;
  for (const auto& p : points) largest = std::max(largest, p.lpNorm<Eigen::Infinity>());
  return largest;
}

// Appends p to a chain that only turns left. A point counts as on the line of its neighbours when it is off
// by less than the rounding error of its own coordinates.
void extend(Polygon& chain, std::size_t fixed, const Vector2d& p, double rounding) {
  while (chain.size() > fixed) {
    const Vector2d& corner = chain.back();
    const Vector2d in = corner - chain[chain.size() - 2], through = p - chain[chain.size() - 2];
    if (cross(in, through) > rounding * through.lpNorm<1>()) break;
    chain.pop_back();
  }
  chain.push_back(p);
}

// Moves the points beyond the way from a to b to the front, and returns their end.
Vector2d* partitionBeyond(const Vector2d& a, const Vector2d& b, Vector2d* first, Vector2d* last) {
  const Vector2d along = b - a;
  return std::partition(first, last, [&](const Vector2d& p) { return cross(along, p - a) < 0.0; });
}

// Pre: the points are beyond the way from a to b.
void appendBeyond(const Vector2d& a, const Vector2d& b, Vector2d* first, Vector2d* last, Polygon& hull) {
  if (first == last) return;
  const Vector2d along = b - a;
  Vector2d farthest = *first;
  double most = cross(along, farthest - a);
  for (const Vector2d* p = first + 1; p != last; ++p) {
    const double value = cross(along, *p - a);
    if (value < most) most = value, farthest = *p;
  }
  Vector2d* const beyond_first = partitionBeyond(a, farthest, first, last);
  Vector2d* const beyond_second = partitionBeyond(farthest, b, beyond_first, last);
  appendBeyond(a, farthest, first, beyond_first, hull);
  hull.push_back(farthest);
  appendBeyond(farthest, b, beyond_first, beyond_second, hull);
}

struct Extremes {
  std::size_t right = 0, top = 0, left = 0;  // farthest along an edge, square to it, and against it
};

// The vertex where the support in `direction` ends, walking on from `start`.
std::size_t climb(const Polygon& hull, std::size_t start, const Vector2d& direction) {
  const std::size_t n = hull.size();
  std::size_t at = start;
  for (std::size_t steps = 0; steps < n; ++steps) {
    const std::size_t next = (at + 1) % n;
    if (direction.dot(hull[next] - hull[at]) <= 0.0) break;
    at = next;
  }
  return at;
}

Rectangle rectangleOn(const Polygon& hull, std::size_t edge, const Vector2d& axis, const Extremes& extremes) {
  const Vector2d normal(-axis.y(), axis.x());
  const Vector2d& base = hull[edge];
  const double right = axis.dot(hull[extremes.right] - base), left = axis.dot(hull[extremes.left] - base);
  Rectangle rectangle;
  rectangle.axis = axis;
  rectangle.length = right - left;
  rectangle.width = std::max(0.0, normal.dot(hull[extremes.top] - base));
  rectangle.center = base + axis * (0.5 * (right + left)) + normal * (0.5 * rectangle.width);
  return rectangle;
}

Rectangle rectangleAroundSegment(const Vector2d& a, const Vector2d& b) {
  const double length = (b - a).norm();
  return {.center = 0.5 * (a + b), .axis = Vector2d((b - a) / length), .length = length, .width = 0.0};
}

}  // namespace

Polygon convexHull(std::vector<Vector2d> points) {
  const auto before = [](const Vector2d& a, const Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  };
  if (!std::ranges::is_sorted(points, before)) std::ranges::sort(points, before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * magnitude(points);
  Polygon hull;
  for (const auto& p : points) extend(hull, 1, p, rounding);
  const std::size_t lower = hull.size();
  for (auto p = points.rbegin() + 1; p != points.rend(); ++p) extend(hull, lower, *p, rounding);
  hull.pop_back();
  return hull;
}

Polygon hullBeyond(const Vector2d& a, const Vector2d& b, std::vector<Vector2d> points) {
  assert(a != b);
  Polygon hull;
  Vector2d* const first = points.data();
  appendBeyond(a, b, first, partitionBeyond(a, b, first, first + points.size()), hull);
  return hull;
}

double signedArea(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    twice += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  }
  return 0.5 * twice;
}

Vector2d centroid(const Polygon& polygon) {
  assert(!polygon.empty());
  Vector2d weighted = Vector2d::Zero(), sum = Vector2d::Zero();
  double twice = 0.0, reach = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d a = polygon[i] - polygon[0], b = polygon[(i + 1) % polygon.size()] - polygon[0];
    weighted += cross(a, b) * (a + b) / 3.0;
    twice += cross(a, b);
    reach = std::max(reach, a.squaredNorm());
    sum += a;
  }
  // Below this the area is rounding error, and dividing by it could put the centroid anywhere.
  const double rounding = 1e-12 * reach;
  if (std::abs(twice) <= rounding) return polygon[0] + sum / static_cast<double>(polygon.size());
  return polygon[0] + weighted / twice;
}

Polygon clip(const Polygon& convex, const Vector2d& point, const Vector2d& normal) {
  Polygon kept;
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Vector2d& a = convex[i];
    const Vector2d& b = convex[(i + 1) % convex.size()];
    const double height_a = normal.dot(a - point), height_b = normal.dot(b - point);
    if (height_a >= 0.0) kept.push_back(a);
    if ((height_a > 0.0 && height_b < 0.0) || (height_a < 0.0 && height_b > 0.0)) {
      kept.push_back(a + (b - a) * (height_a / (height_a - height_b)));
    }
  }
  return kept;
}

bool containsPoint(const Polygon& convex, const Vector2d& p) {
  if (convex.size() < 3) return false;
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Vector2d& a = convex[i];
    if (cross(convex[(i + 1) % convex.size()] - a, p - a) < 0.0) return false;
  }
  return true;
}

Rectangle minAreaRectangle(const Polygon& hull) {
  assert(!hull.empty());
  if (hull.size() == 1) return {.center = hull[0], .axis = {1, 0}, .length = 0.0, .width = 0.0};
  if (hull.size() == 2) return rectangleAroundSegment(hull[0], hull[1]);
  Rectangle best;
  Extremes extremes;
  for (std::size_t edge = 0; edge < hull.size(); ++edge) {
    const Vector2d axis = (hull[(edge + 1) % hull.size()] - hull[edge]).normalized();
    const Vector2d normal(-axis.y(), axis.x());
    extremes.right = climb(hull, edge == 0 ? 1 : extremes.right, axis);
    extremes.top = climb(hull, edge == 0 ? extremes.right : extremes.top, normal);
    extremes.left = climb(hull, edge == 0 ? extremes.top : extremes.left, -axis);
    const Rectangle rectangle = rectangleOn(hull, edge, axis, extremes);
    if (best.length < 0.0 || rectangle.area() < best.area()) best = rectangle;
  }
  return best;
}

}  // namespace boxgrasp
