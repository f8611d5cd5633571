#include "boxgrasp/synthesis/pinches.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace boxgrasp {
namespace {

constexpr double kJoined_m = 0.002;      // regions of a contour that end and begin this near ...
constexpr double kJoinedCosine = 0.966;  // ... and turn by less than 15 degrees continue each other

struct Interval {
  double low, high;
};

Interval shifted(const Interval& interval, double by) { return {interval.low + by, interval.high + by}; }

Interval common(const Interval& x, const Interval& y) {
  return {std::max(x.low, y.low), std::min(x.high, y.high)};
}

// The part of a region's chord on which a finger may press.
struct Usable {
  Vector2d a, b;
};

// A usable chord as seen by a thumb: across its normal, and how far ahead.
class Seen {
 public:
  Seen(const Usable& chord, const Region& thumb) : across_(thumb.normal_F.y(), -thumb.normal_F.x()) {
    from_ = chord.a;
    way_ = chord.b - chord.a;
  }
  Interval interval() const {
    const double a = from_.dot(across_), b = (from_ + way_).dot(across_);
    return {std::min(a, b), std::max(a, b)};
  }
  // Pre: the chord is a point, or not parallel to the thumb's normal.
  Vector2d pointAt(double t) const {
    const double width = way_.dot(across_);
    if (width == 0.0) return from_;
    return from_ + std::clamp((t - from_.dot(across_)) / width, 0.0, 1.0) * way_;
  }

 private:
  Vector2d across_, from_, way_;
};

class PinchSearch {
 public:
  PinchSearch(const std::vector<Region>& regions, double spacing_m, const TripletOptions& options)
      : regions_(regions), half_m_(0.5 * spacing_m), cone_cosine_(std::cos(std::atan(options.friction))) {
    for (std::size_t i = 0; i < regions.size(); ++i) usable_.push_back(usableOf(i, options.end_margin_m));
  }

  // All pinches with the thumb on one region.
  void against(int thumb, std::vector<Triplet>& found) const {
    std::vector<int> opposite;
    for (int i = 0; i < static_cast<int>(regions_.size()); ++i) {
      if (i != thumb && facing(regions_[i], regions_[thumb])) opposite.push_back(i);
    }
    for (std::size_t i = 0; i < opposite.size(); ++i) {
      place(opposite[i], opposite[i], thumb, found);
      for (std::size_t j = i + 1; j < opposite.size(); ++j) {
        place(opposite[i], opposite[j], thumb, found);
        place(opposite[j], opposite[i], thumb, found);
      }
    }
  }

 private:
  bool facing(const Region& finger, const Region& thumb) const {
    return finger.normal_F.dot(-thumb.normal_F) >= cone_cosine_;
  }

  bool continues(const Region& region, const Vector2d& end, std::size_t except) const {
    for (std::size_t i = 0; i < regions_.size(); ++i) {
      const Region& other = regions_[i];
      if (i != except && other.contour == region.contour &&
          std::min((other.a_F - end).norm(), (other.b_F - end).norm()) < kJoined_m &&
          other.normal_F.dot(region.normal_F) > kJoinedCosine)
        return true;
    }
    return false;
  }

  Usable usableOf(std::size_t i, double end_margin_m) const {
    const Region& region = regions_[i];
    const Vector2d way = (region.b_F - region.a_F) / region.length();
    const double margin = std::min(end_margin_m, 0.5 * region.length());
    const auto kept = [&](const Vector2d& end) { return continues(region, end, i) ? 0.0 : margin; };
    return {region.a_F + kept(region.a_F) * way, region.b_F - kept(region.b_F) * way};
  }

  // `right` is the finger's region at the thumb's right, seen along its push.
  void place(int right, int left, int thumb, std::vector<Triplet>& found) const {
    const Region& against = regions_[thumb];
    const Seen p1(usable_[right], against), p2(usable_[left], against), p3(usable_[thumb], against);
    const Interval room =
        common(common(shifted(p1.interval(), -half_m_), shifted(p2.interval(), half_m_)), p3.interval());
    if (room.low > room.high) return;
    const double t = 0.5 * (room.low + room.high);
    Triplet pinch;
    pinch.regions = {right, left, thumb};
    pinch.points_F = {p1.pointAt(t + half_m_), p2.pointAt(t - half_m_), p3.pointAt(t)};
    for (int i = 0; i < 3; ++i) {
      pinch.normals_F[i] = regions_[pinch.regions[i]].normal_F;
      pinch.turn_rad[i] = regions_[pinch.regions[i]].turn_rad;
    }
    const Vector2d between = 0.5 * (pinch.points_F[0] + pinch.points_F[1]);
    const double width = (between - pinch.points_F[2]).dot(against.normal_F);
    if (width <= 0.0) return;
    pinch.focus_F = 0.5 * (between + pinch.points_F[2]);
    pinch.focus_area_m2 = width * (room.high - room.low);
    found.push_back(pinch);
  }

  const std::vector<Region>& regions_;
  double half_m_, cone_cosine_;
  std::vector<Usable> usable_;
};

}  // namespace

std::vector<Triplet> findPinches(const std::vector<Region>& regions, const FaceImage& filled_image,
                                 double spacing_m, const TripletOptions& options, const StopToken& stop) {
  options.validate();
  assert(spacing_m > 0.0);
  const PinchSearch search(regions, spacing_m, options);
  std::vector<Triplet> found;
  for (int thumb = 0; thumb < static_cast<int>(regions.size()); ++thumb) {
    stop.check();
    search.against(thumb, found);
  }
  std::sort(found.begin(), found.end(), [](const auto& x, const auto& y) { return x.regions < y.regions; });
  keepLargest(found, options.max_triplets);
  measureDepths(filled_image, found);
  return found;
}

}  // namespace boxgrasp
