#include <algorithm>
#include <cmath>

#include "boxgrasp/synthesis/edges.h"

namespace boxgrasp {
namespace {

// For each point its distance from the first along the line; for a closed line also the way back to the
// first.
std::vector<double> arcLengths(const PixelLine& line) {
  std::vector<double> arc{0.0};
  const std::size_t n = line.points.size();
  for (std::size_t i = 1; i < n + line.closed; ++i) {
    arc.push_back(arc.back() + (line.points[i % n] - line.points[i - 1]).norm());
  }
  return arc;
}

}  // namespace

PixelLine evenlySpaced(const PixelLine& line) {
  if (line.points.empty()) return line;
  const std::vector<double> arc = arcLengths(line);
  if (arc.back() <= 0.0) return line;
  const int steps = std::max(1, static_cast<int>(std::lround(arc.back())));
  PixelLine even;
  even.closed = line.closed;
  std::size_t i = 0;
  for (int step = 0; step < steps + !line.closed; ++step) {
    const double at = arc.back() * step / steps;
    while (i + 2 < arc.size() && arc[i + 1] <= at) ++i;
    const double length = arc[i + 1] - arc[i];
    const double share = length > 0.0 ? std::min(1.0, (at - arc[i]) / length) : 0.0;
    const Vector2d& a = line.points[i];
    even.points.push_back(a + share * (line.points[(i + 1) % line.points.size()] - a));
  }
  return even;
}

}  // namespace boxgrasp
