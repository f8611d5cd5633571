#include "boxgrasp/decomposition/cut_lines.h"

#include <algorithm>
#include <cmath>

namespace boxgrasp {
namespace {

double turnAt(const Polygon& hull, std::size_t i) {
  const std::size_t n = hull.size();
  const Vector2d before = hull[i] - hull[(i + n - 1) % n], after = hull[(i + 1) % n] - hull[i];
  return std::atan2(cross(before, after), before.dot(after));
}

// The vertex where the hull turns most: a run never crosses it, so that runs do not depend on where the list
// of vertices starts.
std::size_t sharpestVertex(const Polygon& hull) {
  std::size_t sharpest = 0;
  for (std::size_t i = 1; i < hull.size(); ++i) {
    if (turnAt(hull, i) > turnAt(hull, sharpest)) sharpest = i;
  }
  return sharpest;
}

double lengthOf(const std::vector<Vector2d>& polyline) {
  double length = 0.0;
  for (std::size_t i = 0; i + 1 < polyline.size(); ++i) length += (polyline[i + 1] - polyline[i]).norm();
  return length;
}

Vector2d pointAlong(const std::vector<Vector2d>& polyline, double distance) {
  for (std::size_t i = 0; i + 1 < polyline.size(); ++i) {
    const Vector2d step = polyline[i + 1] - polyline[i];
    if (distance <= step.norm()) return polyline[i] + step.normalized() * distance;
    distance -= step.norm();
  }
  return polyline.back();
}

std::vector<Vector2d> samplesOn(const std::vector<Vector2d>& segment, int count) {
  std::vector<Vector2d> samples;
  const double length = lengthOf(segment);
  for (int i = 0; i < count; ++i) samples.push_back(pointAlong(segment, length * (i + 0.5) / count));
  return samples;
}

Line lineThrough(const Vector2d& a, const Vector2d& b) {
  const Vector2d along = (b - a).normalized();
  const Vector2d normal(-along.y(), along.x());
  return {normal, normal.dot(a)};
}

}  // namespace

std::vector<std::vector<Vector2d>> longSegments(const Polygon& hull, const DecompositionOptions& options) {
  if (hull.size() < 3) return {};
  const std::size_t start = sharpestVertex(hull), n = hull.size();
  std::vector<std::vector<Vector2d>> segments;
  double turned = 0.0, perimeter = 0.0;
  for (std::size_t step = 0; step < n; ++step) {
    const std::size_t i = (start + step) % n;
    turned += turnAt(hull, i);
    if (step == 0 || turned >= options.merge_angle_rad) {
      segments.push_back({hull[i]});
      turned = 0.0;
    }
    segments.back().push_back(hull[(i + 1) % n]);
    perimeter += (hull[(i + 1) % n] - hull[i]).norm();
  }
  std::erase_if(segments, [&](const auto& segment) {
    return lengthOf(segment) <= options.segment_fraction * perimeter;
  });
  return segments;
}

std::vector<CutFan> cutFans(const Polygon& hull, const DecompositionOptions& options) {
  std::vector<std::vector<Vector2d>> samples;
  for (const auto& segment : longSegments(hull, options))
    samples.push_back(samplesOn(segment, options.samples_per_segment));
  std::vector<CutFan> fans;
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    for (const Vector2d& apex : samples[i]) {
      fans.push_back({apex, {}});
      for (std::size_t j = i + 1; j < samples.size(); ++j) {
        for (const Vector2d& b : samples[j]) fans.back().lines.push_back(lineThrough(apex, b));
      }
    }
  }
  return fans;
}

std::vector<Line> cutLines(const std::vector<CutFan>& fans) {
  std::vector<Line> lines;
  for (const CutFan& fan : fans) lines.insert(lines.end(), fan.lines.begin(), fan.lines.end());
  return lines;
}

}  // namespace boxgrasp
