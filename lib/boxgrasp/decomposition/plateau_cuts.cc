#include "boxgrasp/decomposition/plateau_cuts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "boxgrasp/geometry/polygon.h"

namespace boxgrasp {
namespace {

constexpr int kAngles = 24;           // 7.5 degrees apart
constexpr int kOffsets = 48;          // along the box's longest edge
constexpr double kPlateau = 0.02;     // height of a plateau, in units of Theta
constexpr double kNearCosine = 0.8;   // lines that turn by less than 37 degrees ...
constexpr double kNearOffset = 0.12;  // ... and lie nearer, in units of the longest edge, are neighbours

struct GridLine {
  int face;
  Vector2d normal;
  double offset, theta;
};

// The hull of points that come in order of x: two chains from its first point to its last.
class GrowingHull {
 public:
  void add(const Vector2d& p) {
    extend(lower_, p, 1.0);
    extend(upper_, p, -1.0);
  }
  double area() const { return 0.5 * (upper_.twice_area - lower_.twice_area); }

 private:
  struct Chain {
    std::vector<Vector2d> points;
    double twice_area = 0.0;  // between the chain and the x axis
  };

  static double twiceArea(const Vector2d& a, const Vector2d& b) { return (b.x() - a.x()) * (a.y() + b.y()); }

  static void extend(Chain& chain, const Vector2d& p, double turn) {
    auto& points = chain.points;
    while (points.size() >= 2) {
      const Vector2d &before = points[points.size() - 2], &last = points.back();
      if (turn * cross(last - before, p - last) > 0) break;
      chain.twice_area -= twiceArea(before, last);
      points.pop_back();
    }
    if (!points.empty()) chain.twice_area += twiceArea(points.back(), p);
    points.push_back(p);
  }

  Chain lower_, upper_;
};

// areas[k] is the hull area of the first k points.
std::vector<double> hullAreas(const std::vector<Vector2d>& sorted) {
  GrowingHull hull;
  std::vector<double> areas{0.0};
  areas.reserve(sorted.size() + 1);
  for (const Vector2d& p : sorted) {
    hull.add(p);
    areas.push_back(hull.area());
  }
  return areas;
}

// Seen along the normal, sorted.
std::vector<Vector2d> turned(const std::vector<Vector2d>& points, const Vector2d& normal) {
  const Vector2d across(-normal.y(), normal.x());
  std::vector<Vector2d> result;
  result.reserve(points.size());
  for (const Vector2d& p : points) result.emplace_back(normal.dot(p), across.dot(p));
  std::sort(result.begin(), result.end(), [](const Vector2d& a, const Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  return result;
}

// The lines of one angle: sweeps to and fro give the hulls on both sides of them all.
void appendLines(const std::vector<Vector2d>& points, int face, const Vector2d& normal, double step,
                 double area, std::size_t least, std::vector<GridLine>& lines) {
  std::vector<Vector2d> sorted = turned(points, normal);
  const std::vector<double> before = hullAreas(sorted);
  std::vector<Vector2d> backwards(sorted.rbegin(), sorted.rend());
  for (Vector2d& p : backwards) p.x() = -p.x();
  const std::vector<double> behind = hullAreas(backwards);
  std::size_t first = 0;
  for (double offset = std::ceil(sorted.front().x() / step) * step; offset < sorted.back().x();
       offset += step) {
    while (sorted[first].x() <= offset) ++first;
    const std::size_t second = sorted.size() - first;
    if (first < least || second < least) continue;
    lines.push_back({face, normal, offset, (before[first] + behind[second]) / area});
  }
}

std::vector<GridLine> gridLines(const PointCloud& points_B, const Vector3d& extents, std::size_t least) {
  const double step = extents.maxCoeff() / kOffsets;
  std::vector<GridLine> lines;
  for (int face = 0; face < 3; ++face) {
    const int i = (face + 1) % 3, j = (face + 2) % 3;
    std::vector<Vector2d> projected;
    for (std::size_t p = 0; p < points_B.size(); ++p)
      projected.emplace_back(points_B.point(p)[i], points_B.point(p)[j]);
    for (int k = 0; k < kAngles; ++k) {
      const double angle = std::numbers::pi * k / kAngles;
      appendLines(projected, face, {std::cos(angle), std::sin(angle)}, step, extents[i] * extents[j], least,
                  lines);
    }
  }
  return lines;
}

// 1 or -1 where `line` is a neighbour of `lowest`, seen the same way round or the other; else 0.
int neighbourSign(const GridLine& line, const GridLine& lowest, double near_offset) {
  if (line.face != lowest.face) return 0;
  const double cosine = line.normal.dot(lowest.normal);
  const int sign = cosine < 0 ? -1 : 1;
  return sign * cosine > kNearCosine && std::abs(sign * line.offset - lowest.offset) < near_offset ? sign : 0;
}

// The mean line of the plateau around a minimum.
GridLine plateauMiddle(const std::vector<GridLine>& lines, const GridLine& lowest, double near_offset) {
  GridLine middle{lowest.face, Vector2d::Zero(), 0.0, lowest.theta};
  for (const GridLine& line : lines) {
    const double weight = lowest.theta + kPlateau - line.theta;
    if (weight <= 0 || weight > kPlateau) continue;
    const int sign = neighbourSign(line, lowest, near_offset);
    middle.normal += weight * sign * line.normal;
    middle.offset += weight * sign * line.offset;
  }
  middle.offset /= middle.normal.norm();
  middle.normal.normalize();
  return middle;
}

PlateauCut cutOf(const GridLine& line, const OrientedBox& box) {
  const Matrix3d axes_C = box.X_CB.linear();
  PlateauCut cut;
  cut.along_C = axes_C.col(line.face);
  cut.normal_C =
      line.normal.x() * axes_C.col((line.face + 1) % 3) + line.normal.y() * axes_C.col((line.face + 2) % 3);
  cut.offset_m = line.offset + cut.normal_C.dot(box.X_CB.translation());
  cut.theta = line.theta;
  return cut;
}

}  // namespace

std::vector<PlateauCut> plateauCuts(const PointCloud& points_C, const OrientedBox& box, std::size_t least,
                                    std::size_t most) {
  std::vector<GridLine> lines = gridLines(transformed(points_C, box.X_CB.inverse()), box.extents, least);
  std::stable_sort(lines.begin(), lines.end(),
                   [](const GridLine& a, const GridLine& b) { return a.theta < b.theta; });
  const double near_offset = kNearOffset * box.extents.maxCoeff();
  std::vector<GridLine> minima;
  std::vector<PlateauCut> cuts;
  for (const GridLine& line : lines) {
    const auto near = [&](const GridLine& other) { return neighbourSign(line, other, near_offset) != 0; };
    if (std::any_of(minima.begin(), minima.end(), near)) continue;
    minima.push_back(line);
    cuts.push_back(cutOf(plateauMiddle(lines, line, near_offset), box));
    if (cuts.size() == most) break;
  }
  return cuts;
}

}  // namespace boxgrasp
