#include "boxgrasp/synthesis/triplets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

constexpr double kBoundsScale = 1e3;  // the bounds of all cones reach this many object sizes: a triplet with
                                      // a larger focus area has no focus inside its triangle
constexpr double kReach_m =
    0.004;  // how far around a finger point the farthest depth is looked for: a third of a fingertip
constexpr int kInside_px =
    2;  // how far inside the contour the depth is read: filling and smoothing blur the first pixel

struct HalfPlane {
  Vector2d point, normal;  // normal.(x - point) >= 0
};

// The points that a finger somewhere on the region can push towards within its friction cone
// (definitions 2.2, T2).
std::array<HalfPlane, 3> coneBounds(const Region& region, double friction) {
  const Vector2d n = region.normal_F, t(n.y(), -n.x());
  return {{{region.a_F, n}, {region.a_F, t + friction * n}, {region.b_F, -t + friction * n}}};
}

Polygon clippedBy(Polygon polygon, const std::array<HalfPlane, 3>& cone) {
  for (const auto& plane : cone) polygon = clip(polygon, plane.point, plane.normal);
  return polygon;
}

// Whether a single bound of the cone has the whole polygon outside: a quick and sure no to their
// intersection.
bool clearlyApart(const Polygon& polygon, const std::array<HalfPlane, 3>& cone) {
  return std::any_of(cone.begin(), cone.end(), [&](const HalfPlane& plane) {
    return std::all_of(polygon.begin(), polygon.end(),
                       [&](const Vector2d& p) { return plane.normal.dot(p - plane.point) < 0.0; });
  });
}

Polygon boundsAround(const std::vector<Region>& regions) {
  Eigen::AlignedBox2d box;
  for (const Region& region : regions) box.extend(region.a_F).extend(region.b_F);
  const double reach = kBoundsScale * box.diagonal().norm();
  const Vector2d low = box.min().array() - reach, high = box.max().array() + reach;
  return {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
}

bool sameSign(double a, double b, double c) { return (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0); }

// The point of the region nearest to the focus, away from the region's ends.
Vector2d footOn(const Region& region, const Vector2d& focus_F, double end_margin_m) {
  const double length = region.length(), margin = std::min(end_margin_m, 0.5 * length);
  const Vector2d t = (region.b_F - region.a_F) / length;
  return region.a_F + std::clamp((focus_F - region.a_F).dot(t), margin, length - margin) * t;
}

bool strictlyInside(const Vector2d& p, const std::array<Vector2d, 3>& corners) {
  return sameSign(cross(corners[1] - corners[0], p - corners[0]),
                  cross(corners[2] - corners[1], p - corners[1]),
                  cross(corners[0] - corners[2], p - corners[2]));
}

class Depths {
 public:
  explicit Depths(const FaceImage& image) : image_(image) {}

  void measure(Triplet& triplet) const {
    for (int finger = 0; finger < 3; ++finger) {
      const Vector2d pixel = image_.toPixel(triplet.points_F[finger]);
      const auto inside = firstInside(pixel, triplet.normals_F[finger]);
      if (!inside) continue;
      triplet.nearest_depth_m[finger] = image_.depthOf(image_.gray[*inside]);
      triplet.farthest_depth_m[finger] =
          image_.depthOf(std::min(image_.farthest[*inside], farthestAround(rounded(pixel))));
    }
  }

 private:
  using Pixel = Eigen::Vector2i;
  static Pixel rounded(const Vector2d& pixel) { return pixel.array().round().cast<int>(); }

  std::optional<std::size_t> occupied(const Pixel& pixel) const {
    const bool inside = (pixel.array() >= 0).all() && pixel.x() < image_.width && pixel.y() < image_.height;
    if (!inside || image_.at(pixel.x(), pixel.y()) == 0) return std::nullopt;
    return static_cast<std::size_t>(pixel.y()) * image_.width + pixel.x();
  }

  // The chord of a region may run outside its contour: the first occupied pixel on the way along the normal.
  std::optional<std::size_t> firstInside(const Vector2d& pixel, const Vector2d& normal) const {
    const int end = image_.width + image_.height;
    for (int step = kInside_px; step < end; ++step) {
      if (const auto found = occupied(rounded(pixel + step * normal))) return found;
    }
    return std::nullopt;
  }

  std::uint8_t farthestAround(const Pixel& pixel) const {
    const int reach = static_cast<int>(std::floor(kReach_m / image_.pixel_m));
    std::uint8_t least = 255;
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        if (dx * dx + dy * dy > reach * reach) continue;
        if (const auto found = occupied(pixel + Pixel(dx, dy)))
          least = std::min(least, image_.farthest[*found]);
      }
    }
    return least;
  }

  const FaceImage& image_;
};

class Search {
 public:
  Search(const std::vector<Region>& regions, const TripletOptions& options)
      : regions_(regions), options_(options), bounds_(boundsAround(regions)) {
    for (const Region& region : regions) cones_.push_back(coneBounds(region, options.friction));
  }

  // All triplets whose first region is i.
  void from(int i, Triplets& found) const {
    const int n = static_cast<int>(regions_.size());
    const auto pairs = meetingsWith(i);
    for (int j = i + 1; j < n; ++j) {
      for (int k = j + 1; k < n; ++k) {
        ++found.counts.considered;
        if (!positivelySpan({regions_[i].normal_F, regions_[j].normal_F, regions_[k].normal_F})) {
          ++found.counts.not_spanning;
        } else {
          intersect({i, j, k}, pairs, found);
        }
      }
    }
  }

 private:
  // For every later region the intersection of its cone with that of region i.
  std::vector<Polygon> meetingsWith(int i) const {
    std::vector<Polygon> meetings(regions_.size());
    const Polygon cone = unionCone(regions_[i], options_.friction, bounds_);
    for (std::size_t j = i + 1; j < regions_.size(); ++j) meetings[j] = clippedBy(cone, cones_[j]);
    return meetings;
  }

  void intersect(const std::array<int, 3>& indices, const std::vector<Polygon>& pairs,
                 Triplets& found) const {
    const Polygon& pair = pairs[indices[1]];
    const auto& cone = cones_[indices[2]];
    Polygon common;
    if (!pair.empty() && !pairs[indices[2]].empty() && !clearlyApart(pair, cone))
      common = clippedBy(pair, cone);
    const double area = signedArea(common);
    if (area <= 0.0) {
      ++found.counts.cones_apart;
      return;
    }
    const Triplet triplet = place(indices, centroid(common), area);
    if (strictlyInside(triplet.focus_F, triplet.points_F)) {
      found.triplets.push_back(triplet);
    } else {
      ++found.counts.focus_outside;
    }
  }

  Triplet place(const std::array<int, 3>& indices, const Vector2d& focus_F, double area) const {
    Triplet triplet;
    triplet.regions = indices;
    triplet.focus_F = focus_F;
    triplet.focus_area_m2 = area;
    for (int finger = 0; finger < 3; ++finger) {
      const Region& region = regions_[indices[finger]];
      triplet.points_F[finger] = footOn(region, focus_F, options_.end_margin_m);
      triplet.normals_F[finger] = region.normal_F;
      triplet.turn_rad[finger] = region.turn_rad;
    }
    return triplet;
  }

  const std::vector<Region>& regions_;
  const TripletOptions& options_;
  Polygon bounds_;
  std::vector<std::array<HalfPlane, 3>> cones_;
};

}  // namespace

std::size_t keepLargest(std::vector<Triplet>& all, std::size_t most) {
  if (all.size() <= most) return 0;
  const auto larger = [](const Triplet& a, const Triplet& b) {
    return a.focus_area_m2 != b.focus_area_m2 ? a.focus_area_m2 > b.focus_area_m2 : a.regions < b.regions;
  };
  const std::size_t over = all.size() - most;
  std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(most), all.end(), larger);
  all.resize(most);
  std::sort(all.begin(), all.end(), [](const Triplet& a, const Triplet& b) { return a.regions < b.regions; });
  return over;
}

void measureDepths(const FaceImage& filled_image, std::vector<Triplet>& triplets) {
  const Depths depths(filled_image);
  for (Triplet& triplet : triplets) depths.measure(triplet);
}

void TripletOptions::validate() const {
  requireOption(friction > 0.0 && friction <= 10.0, "triplets.friction", friction, "in (0, 10]");
  requireOption(end_margin_m >= 0.0, "triplets.end_margin_m", end_margin_m, "at least 0");
  requireOption(max_triplets >= 1, "triplets.max_triplets", max_triplets, "at least 1");
}

bool positivelySpan(const std::array<Vector2d, 3>& normals) {
  return sameSign(cross(normals[0], normals[1]), cross(normals[1], normals[2]),
                  cross(normals[2], normals[0]));
}

Polygon unionCone(const Region& region, double friction, const Polygon& bounds) {
  return clippedBy(bounds, coneBounds(region, friction));
}

Triplets findTriplets(const std::vector<Region>& regions, const FaceImage& filled_image,
                      const TripletOptions& options, const StopToken& stop) {
  options.validate();
  Triplets found;
  if (regions.size() < 3) return found;
  const Search search(regions, options);
  for (int i = 0; i < static_cast<int>(regions.size()); ++i) {
    stop.check();
    search.from(i, found);
  }
  found.counts.over_limit = keepLargest(found.triplets, options.max_triplets);
  measureDepths(filled_image, found.triplets);
  return found;
}

}  // namespace boxgrasp
