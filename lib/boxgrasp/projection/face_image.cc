#include "boxgrasp/projection/face_image.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

constexpr double kGrayRange = 254.0;  // from 255 at the face to 1 at the far side

// Rounds halves away from zero, so that mirrored coordinates give mirrored pixels.
int nearestInteger(double value) { return static_cast<int>(value + std::copysign(0.5, value)); }

int pixelsToEdge(double size_m, double pixel_m) {
  return static_cast<int>(std::ceil(0.5 * size_m / pixel_m - 1e-9));
}

// The pixel that is asked for, or the smallest with which the longer side fits.
double pixelFor(const Face& face, const ImageOptions& options) {
  const int room = (options.max_side_px - 1) / 2 - options.border_px;
  return std::max(options.pixel_m, 0.5 * face.size.maxCoeff() / room);
}

FaceImage emptyImage(const Face& face, double spacing_m, const ImageOptions& options) {
  FaceImage image;
  image.face = face;
  image.pixel_m = pixelFor(face, options);
  image.spacing_m = spacing_m;
  image.width = 2 * (pixelsToEdge(face.size.x(), image.pixel_m) + options.border_px) + 1;
  image.height = 2 * (pixelsToEdge(face.size.y(), image.pixel_m) + options.border_px) + 1;
  const std::size_t pixels = static_cast<std::size_t>(image.width) * image.height;
  image.gray.assign(pixels, 0);
  image.farthest.assign(pixels, 0);
  return image;
}

void draw(FaceImage& image, const Vector3d& p_F) {
  const Vector2d half = 0.5 * image.face.size;
  const Vector2d on_face = p_F.head<2>().cwiseMax(-half).cwiseMin(half) / image.pixel_m;
  const int column = image.width / 2 + nearestInteger(on_face.x());
  const int row = image.height / 2 + nearestInteger(on_face.y());
  const double depth = std::clamp(p_F.z() / image.face.depth_m, 0.0, 1.0);
  const auto value = static_cast<std::uint8_t>(255 - nearestInteger(kGrayRange * depth));
  const std::size_t pixel = static_cast<std::size_t>(row) * image.width + column;
  image.gray[pixel] = std::max(image.gray[pixel], value);
  std::uint8_t& farthest = image.farthest[pixel];
  farthest = farthest == 0 ? value : std::min(farthest, value);
}

}  // namespace

void ImageOptions::validate() const {
  requireOption(pixel_m >= 1e-5 && pixel_m <= 0.1, "image.pixel_m", pixel_m, "in [0.00001, 0.1]");
  requireOption(border_px >= 1 && border_px <= 1000, "image.border_px", border_px, "in [1, 1000]");
  requireOption(max_side_px >= 2 * border_px + 16 && max_side_px <= 16384, "image.max_side_px", max_side_px,
                "in [2 border_px + 16, 16384]");
}

Vector2d FaceImage::toFace(const Vector2d& pixel) const {
  return (pixel - 0.5 * Vector2d(width - 1, height - 1)) * pixel_m;
}

Vector2d FaceImage::toPixel(const Vector2d& p_F) const {
  return p_F / pixel_m + 0.5 * Vector2d(width - 1, height - 1);
}

double FaceImage::depthOf(double gray_value) const {
  return (255.0 - gray_value) / kGrayRange * face.depth_m;
}

FaceImage projectFace(const Face& face, const PointCloud& cloud_C, const std::vector<std::uint32_t>& points,
                      double spacing_m, const ImageOptions& options) {
  options.validate();
  assert(face.size.minCoeff() > 0.0 && face.depth_m > 0.0);
  FaceImage image = emptyImage(face, spacing_m, options);
  const Pose X_FC = face.X_CF.inverse();
  for (const std::uint32_t i : points) draw(image, X_FC * cloud_C.point(i));
  return image;
}

}  // namespace boxgrasp
