#include "boxgrasp/decomposition/line_bounds.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace boxgrasp {
namespace {

constexpr float kNextToLine = 1e-3f;    // in units of the angle below: well above the rounding error of Line
constexpr double kNextToSample = 1e-3;  // in units of the points' reach: there angles say nothing
constexpr double kBoundSlack = 1e-6;    // in units of the reach squared, for the
                                        // rounding error of what is seen

// A point seen from a sample, x along the hull's edge and y into the hull.
struct Seen {
  float angle;  // rises with the angle from x, from 0 to 2
  float x, y;
};

Seen seenFrom(const Sample& sample, const Vector2d& p) {
  const Vector2d to = p - sample.point;
  const auto x = static_cast<float>(sample.edge.dot(to)),
             y = std::max(0.0f, static_cast<float>(cross(sample.edge, to)));
  const float share = y / std::max(std::abs(x) + y, 1e-30f);
  return {x >= 0 ? share : 2.0f - share, x, y};
}

// The hull areas of all points with an angle below any given one, and of all above it.
class Fan {
 public:
  Fan(const Sample& sample, const std::vector<Vector2d>& few, double nearest) : sample_(sample) {
    for (const Vector2d& p : few) {
      if ((p - sample.point).squaredNorm() > nearest * nearest) seen_.push_back(seenFrom(sample, p));
    }
    std::sort(seen_.begin(), seen_.end(), [](const Seen& a, const Seen& b) { return a.angle < b.angle; });
    std::vector<Vector2d> sorted;
    for (const Seen& p : seen_) sorted.emplace_back(p.x, p.y);
    below_ = areasOfGrowingHull(sorted);
    std::reverse(sorted.begin(), sorted.end());
    for (Vector2d& p : sorted) p.x() = -p.x();
    above_ = areasOfGrowingHull(sorted);
  }

  double areaBesides(const Vector2d& to) const {
    const float angle = seenFrom(sample_, to).angle;
    if (std::min(angle, 2.0f - angle) < kNextToLine)
      return 0.0;  // points behind the sample are next to it too
    const auto place = [&](float limit) {
      const auto found =
          std::partition_point(seen_.begin(), seen_.end(), [&](const Seen& p) { return p.angle < limit; });
      return static_cast<std::size_t>(found - seen_.begin());
    };
    return below_[place(angle - kNextToLine)] + above_[seen_.size() - place(angle + kNextToLine)];
  }

 private:
  const Sample& sample_;
  std::vector<Seen> seen_;
  std::vector<double> below_, above_;
};

// A chain of the hull from its first point to its last.
class Chain {
 public:
  // `turn` is 1 for the chain that turns left, -1 for the one that turns right.
  Chain(std::size_t most, double turn) : points_(most), turn_(turn) {}

  // Drops what p sees and adds p; gives twice the area that is gained.
  double extend(const Vector2d& p) {
    double gained = 0.0;
    while (size_ >= 2) {
      const Vector2d &last = points_[size_ - 1], &before = points_[size_ - 2];
      const double twice = turn_ * cross(last - before, p - last);
      if (twice > 0) break;
      gained -= twice;
      --size_;
    }
    points_[size_++] = p;
    return gained;
  }

 private:
  std::vector<Vector2d> points_;
  std::size_t size_ = 0;
  double turn_;
};

}  // namespace

std::vector<double> areasOfGrowingHull(const std::vector<Vector2d>& sorted) {
  std::vector<double> areas{0.0};
  areas.reserve(sorted.size() + 1);
  Chain far(sorted.size(), 1.0), near(sorted.size(), -1.0);  // as seen from the origin
  for (const Vector2d& p : sorted) areas.push_back(areas.back() + 0.5 * (far.extend(p) + near.extend(p)));
  return areas;
}

void raiseThetaBounds(const FaceProjection& face, const std::vector<Vector2d>& few, const CutLines& cuts,
                      const std::function<bool(double)>& wanted, std::vector<double>& bounds) {
  double reach = 0.0;
  for (const Vector2d& p : few) reach = std::max(reach, p.norm());
  const double slack = kBoundSlack * reach * reach;
  std::optional<Fan> fan;
  for (std::size_t i = 0; i < cuts.lines.size(); ++i) {
    const CutLine& line = cuts.lines[i];
    if (i > 0 && line.from != cuts.lines[i - 1].from) fan.reset();
    if (!wanted(bounds[i])) continue;
    if (!fan) fan.emplace(cuts.samples[line.from], few, kNextToSample * reach);
    const double area = fan->areaBesides(cuts.samples[line.to].point);
    bounds[i] = std::max(bounds[i], (area - slack) / face.area);
  }
}

}  // namespace boxgrasp
