#include "boxgrasp/projection/face_image.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/simd.h"

namespace boxgrasp {
namespace image_passes {

constexpr double kGrayRange = 254.0;  // from 255 at the face to 1 at the far side

// Rounds halves away from zero, so that mirrored coordinates give mirrored pixels.
BOXGRASP_SIMD_PART int nearestInteger(double value) {
  return static_cast<int>(value + std::copysign(0.5, value));
}

// The pixels of n points, counted from the middle of the image along one axis of the face; what lies beyond
// the face's end is drawn at its end. `axis`: the coefficients of the coordinate in F, and its offset.
BOXGRASP_SIMD void placeAlong(const float* x, const float* y, const float* z, std::size_t n,
                              const double* axis, double end_m, double pixel_m, int* pixels) {
  for (std::size_t i = 0; i < n; ++i) {
    const double along_m = axis[0] * x[i] + axis[1] * y[i] + axis[2] * z[i] + axis[3];
    const double on_face_m = std::min(std::max(along_m, -end_m), end_m);
    pixels[i] = nearestInteger(on_face_m / pixel_m);
  }
}

// The gray values of n points: 255 at depth 0, 1 at depth_m and beyond. `axis`: as above, of the depth.
BOXGRASP_SIMD void shade(const float* x, const float* y, const float* z, std::size_t n, const double* axis,
                         double depth_m, int* values) {
  for (std::size_t i = 0; i < n; ++i) {
    const double along_m = axis[0] * x[i] + axis[1] * y[i] + axis[2] * z[i] + axis[3];
    const double depth = std::min(std::max(along_m / depth_m, 0.0), 1.0);
    values[i] = 255 - nearestInteger(kGrayRange * depth);
  }
}

}  // namespace image_passes

namespace {

using image_passes::kGrayRange;

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

// Draws points into an image, some at a time.
class Brush {
 public:
  explicit Brush(FaceImage& image) : image_(image) {
    const Pose X_FC = image.face.X_CF.inverse();
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < 4; ++i) axes_[axis][i] = X_FC.matrix()(axis, i);
    }
  }

  void draw(const PointCloud& cloud_C, std::span<const std::uint32_t> points) {
    for (std::size_t first = 0; first < points.size(); first += kStretch)
      drawStretch(cloud_C, points.subspan(first, std::min(kStretch, points.size() - first)));
  }

 private:
  static constexpr std::size_t kStretch = 256;

  void drawStretch(const PointCloud& cloud_C, std::span<const std::uint32_t> points) {
    const std::size_t n = points.size();
    float x[kStretch] = {}, y[kStretch] = {}, z[kStretch] = {};
    int columns[kStretch], rows[kStretch], values[kStretch];
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = cloud_C.x[points[i]];
      y[i] = cloud_C.y[points[i]];
      z[i] = cloud_C.z[points[i]];
    }
    const Vector2d end = 0.5 * image_.face.size;
    image_passes::placeAlong(x, y, z, n, axes_[0], end.x(), image_.pixel_m, columns);
    image_passes::placeAlong(x, y, z, n, axes_[1], end.y(), image_.pixel_m, rows);
    image_passes::shade(x, y, z, n, axes_[2], image_.face.depth_m, values);
    for (std::size_t i = 0; i < n; ++i)
      drawPoint(image_.width / 2 + columns[i], image_.height / 2 + rows[i],
                static_cast<std::uint8_t>(values[i]));
  }

  void drawPoint(int column, int row, std::uint8_t value) {
    const std::size_t pixel = static_cast<std::size_t>(row) * image_.width + column;
    image_.gray[pixel] = std::max(image_.gray[pixel], value);
    std::uint8_t& farthest = image_.farthest[pixel];
    farthest = farthest == 0 ? value : std::min(farthest, value);
  }

  FaceImage& image_;
  double axes_[3][4];  // rows of X_FC
};

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
  Brush(image).draw(cloud_C, points);
  return image;
}

}  // namespace boxgrasp
