#include "boxgrasp/synthesis/round_outline.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace boxgrasp {
namespace {

constexpr double kOutside_m = 0.003;  // noise, and what filling adds
constexpr double kNearest = 0.6;      // the middle of a chord to the centre, in radii: chords of 106 degrees
constexpr double kNormalCosine = 0.866;  // of the angle between a region's normal and the radius

class Snapper {
 public:
  Snapper(const Circle& circle, double friction)
      : circle_(circle), cone_sine_(std::sin(std::atan(friction))) {}

  std::optional<Triplet> moved(const Triplet& triplet) const {
    for (int i = 0; i < 3; ++i) {
      if (!onOutline(triplet.points_F[i], triplet.normals_F[i])) return std::nullopt;
    }
    return positivelySpan(triplet.normals_F) ? movedOutwards(triplet) : movedPinch(triplet);
  }

 private:
  bool onOutline(const Vector2d& p, const Vector2d& normal) const {
    const Vector2d out = p - circle_.center_F;
    const double distance = out.norm();
    return distance >= kNearest * circle_.radius_m && distance <= circle_.radius_m + kOutside_m &&
           -normal.dot(out) > kNormalCosine * distance;
  }

  void put(Triplet& triplet, int point, const Vector2d& outwards) const {
    triplet.points_F[point] = circle_.center_F + circle_.radius_m * outwards;
    triplet.normals_F[point] = -outwards;
  }

  std::optional<Triplet> movedOutwards(Triplet triplet) const {
    for (int i = 0; i < 3; ++i) put(triplet, i, (triplet.points_F[i] - circle_.center_F).normalized());
    triplet.focus_F = circle_.center_F;
    return positivelySpan(triplet.normals_F) ? std::optional(triplet) : std::nullopt;
  }

  // Points of a pinch: the finger at the thumb's right, the other, the thumb.
  std::optional<Triplet> movedPinch(Triplet triplet) const {
    const double sine = 0.5 * (triplet.points_F[0] - triplet.points_F[1]).norm() / circle_.radius_m;
    if (sine > cone_sine_) return std::nullopt;
    const Vector2d out = (triplet.points_F[2] - circle_.center_F).normalized(), right(-out.y(), out.x());
    const double cosine = std::sqrt(1 - sine * sine);
    put(triplet, 0, -cosine * out + sine * right);
    put(triplet, 1, -cosine * out - sine * right);
    put(triplet, 2, out);
    triplet.focus_F = 0.25 * (triplet.points_F[0] + triplet.points_F[1]) + 0.5 * triplet.points_F[2];
    return triplet;
  }

  const Circle& circle_;
  double cone_sine_;
};

}  // namespace

std::size_t snapToCircle(const Circle& circle, const FaceImage& filled_image, const TripletOptions& options,
                         std::vector<Triplet>& triplets) {
  const Snapper snapper(circle, options.friction);
  std::vector<Triplet> moved;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < triplets.size(); ++i) {
    if (auto triplet = snapper.moved(triplets[i])) {
      moved.push_back(*triplet);
      places.push_back(i);
    }
  }
  measureDepths(filled_image, moved);
  for (std::size_t i = 0; i < moved.size(); ++i) triplets[places[i]] = moved[i];
  return moved.size();
}

}  // namespace boxgrasp
