// Face images drawn from shapes, and contours of shapes.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "boxgrasp/base/random.h"
#include "boxgrasp/synthesis/contours.h"

namespace boxgrasp::test {

inline constexpr double kDepth_m = 0.1;  // of every face drawn here
inline constexpr double kPixel_m = 0.001;

inline FaceImage blankImage(int width, int height, double pixel_m = kPixel_m) {
  FaceImage image;
  image.face.size = Vector2d(width, height) * pixel_m;
  image.face.depth_m = kDepth_m;
  image.width = width;
  image.height = height;
  image.pixel_m = pixel_m;
  image.gray.assign(static_cast<std::size_t>(width) * height, 0);
  image.farthest = image.gray;
  return image;
}

// An image of odd side whose pixels have the depth that depth_m(p_F) gives them, or nothing where it gives
// none.
template <typename Depth>
FaceImage drawn(int side, Depth&& depth_m) {
  FaceImage image = blankImage(side, side);
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const std::optional<double> depth = depth_m(image.toFace(Vector2d(column, row)));
      if (!depth) continue;
      const auto gray = static_cast<std::uint8_t>(std::lround(255 - 254 * *depth / kDepth_m));
      image.gray[static_cast<std::size_t>(row) * side + column] = gray;
    }
  }
  image.farthest = image.gray;
  return image;
}

// The flat shape where inside(p_F) holds, at 20 mm depth.
template <typename Inside>
FaceImage drawnFlat(int side, Inside&& inside) {
  return drawn(side, [&](const Vector2d& p) { return inside(p) ? std::optional(0.02) : std::nullopt; });
}

// A smooth random closed curve around the origin: radius as a function of the direction.
class Blob {
 public:
  Blob(double radius_m, double roughness, std::mt19937_64& random) : radius_m_(radius_m) {
    for (int i = 0; i < 4; ++i) {
      sines_.push_back(roughness * normal(random) / (i + 1));
      cosines_.push_back(roughness * normal(random) / (i + 1));
    }
  }
  double radius(double angle) const {
    double r = 1.0;
    for (int i = 0; i < 4; ++i)
      r += sines_[i] * std::sin((i + 1) * angle) + cosines_[i] * std::cos((i + 1) * angle);
    return radius_m_ * std::max(0.2, r);
  }
  bool contains(const Vector2d& p) const { return p.norm() <= radius(std::atan2(p.y(), p.x())); }
  Contour contour() const;

 private:
  double radius_m_;
  std::vector<double> sines_, cosines_;
};

// A closed contour through the points, made equidistant, one pixel apart; the given order.
inline Contour closedContour(const std::vector<Vector2d>& corners) {
  Contour contour;
  contour.closed = true;
  double length = 0.0;
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i) length += (corners[(i + 1) % n] - corners[i]).norm();
  const double step = length / std::round(length / kPixel_m);
  double next = 0.0, done = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vector2d way = corners[(i + 1) % n] - corners[i];
    for (; next < done + way.norm() - 1e-9; next += step) {
      contour.points_F.push_back(corners[i] + (next - done) / way.norm() * way);
    }
    done += way.norm();
  }
  return contour;
}

// Counter-clockwise in F: the material is inside.
inline Contour circleContour(double radius_m) {
  std::vector<Vector2d> points;
  for (int i = 0; i < 2000; ++i) {
    const double angle = 2 * std::numbers::pi * i / 2000;
    points.push_back(radius_m * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return closedContour(points);
}

inline Contour squareContour(double side_m) {
  const double h = 0.5 * side_m;
  return closedContour({{-h, -h}, {h, -h}, {h, h}, {-h, h}});
}

inline Contour Blob::contour() const {
  std::vector<Vector2d> points;
  for (int i = 0; i < 3000; ++i) {
    const double angle = 2 * std::numbers::pi * i / 3000;
    points.push_back(radius(angle) * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return closedContour(points);
}

inline Contour reversed(Contour contour) {
  std::reverse(contour.points_F.begin(), contour.points_F.end());
  return contour;
}

inline double lengthOf(const Contour& contour) {
  double length = 0.0;
  const std::size_t n = contour.points_F.size();
  for (std::size_t i = 0; i + !contour.closed < n; ++i) {
    length += (contour.points_F[(i + 1) % n] - contour.points_F[i]).norm();
  }
  return length;
}

}  // namespace boxgrasp::test
