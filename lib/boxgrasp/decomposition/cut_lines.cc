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

// The point at a distance along a segment that begins at the hull's vertex `first`.
Sample sampleAt(const std::vector<Vector2d>& segment, std::size_t first, double distance) {
  std::size_t i = 0;
  for (; i + 2 < segment.size() && distance > (segment[i + 1] - segment[i]).norm(); ++i)
    distance -= (segment[i + 1] - segment[i]).norm();
  return {segment[i] + (segment[i + 1] - segment[i]).normalized() * distance, first + i};
}

void appendSamples(const Polygon& hull, const std::vector<Vector2d>& segment, std::size_t count,
                   std::vector<Sample>& samples) {
  const double length = lengthOf(segment);
  const auto first =
      static_cast<std::size_t>(std::find(hull.begin(), hull.end(), segment.front()) - hull.begin());
  for (std::size_t i = 0; i < count; ++i) {
    samples.push_back(
        sampleAt(segment, first, length * (static_cast<double>(i) + 0.5) / static_cast<double>(count)));
    samples.back().before %= hull.size();
  }
}

Line lineThrough(const Vector2d& a, const Vector2d& b) {
  const Vector2d along = (b - a).normalized();
  const Vector2d normal(-along.y(), along.x());
  return {static_cast<float>(normal.x()), static_cast<float>(normal.y()), static_cast<float>(normal.dot(a))};
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

std::size_t CutLines::index(std::size_t from, std::size_t to) const {
  const std::size_t segment = from / per_segment, first_to = (segment + 1) * per_segment;
  // From each sample of an earlier segment a line goes to each sample of all segments behind that.
  const std::size_t before = per_segment * per_segment * (segment * (2 * segments() - segment - 1) / 2);
  return before + (from - segment * per_segment) * (samples.size() - first_to) + (to - first_to);
}

CutLines cutLines(const Polygon& hull, const DecompositionOptions& options) {
  CutLines cuts;
  cuts.per_segment = static_cast<std::size_t>(options.samples_per_segment);
  for (const auto& segment : longSegments(hull, options))
    appendSamples(hull, segment, cuts.per_segment, cuts.samples);
  for (std::size_t from = 0; from < cuts.samples.size(); ++from) {
    for (std::size_t to = (from / cuts.per_segment + 1) * cuts.per_segment; to < cuts.samples.size(); ++to)
      cuts.lines.push_back({lineThrough(cuts.samples[from].point, cuts.samples[to].point), from, to});
  }
  return cuts;
}

}  // namespace boxgrasp
