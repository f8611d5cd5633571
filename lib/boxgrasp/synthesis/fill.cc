#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "boxgrasp/base/error.h"
#include "boxgrasp/synthesis/contours.h"

namespace boxgrasp {
namespace {

constexpr int kMaxRadius_px = 200;  // no cloud that still shows a shape has gaps wider than this

int splatRadius(const FaceImage& image, const ContourOptions& options) {
  const double radius = std::ceil(options.splat_spacings * image.spacing_m / image.pixel_m - 1e-9);
  return static_cast<int>(std::clamp(radius, 1.0, static_cast<double>(kMaxRadius_px)));
}

cv::Mat square(int radius) { return {2 * radius + 1, 2 * radius + 1, CV_8U, cv::Scalar(1)}; }

// 255 where at least min_neighbours other pixels within the radius are occupied.
cv::Mat inCompany(const cv::Mat& gray, int radius, int min_neighbours) {
  constexpr double kTrue = 255.0;  // in OpenCV's masks
  cv::Mat occupied, around, enough;
  cv::compare(gray, 0, occupied, cv::CMP_GT);
  const int side = 2 * radius + 1;
  cv::boxFilter(occupied, around, CV_32S, {side, side}, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::compare(around, kTrue * min_neighbours, enough, cv::CMP_GT);
  cv::bitwise_and(occupied, enough, enough);
  return enough;
}

// Expands the kept pixels by the radius, the largest value first, and takes all but one pixel back. The image
// is enlarged meanwhile, so that its edge takes no part.
cv::Mat expanded(const cv::Mat& values, const cv::Mat& kept, int radius) {
  cv::Mat result(values.size(), CV_8U, cv::Scalar(0));
  values.copyTo(result, kept);
  cv::copyMakeBorder(result, result, radius, radius, radius, radius, cv::BORDER_CONSTANT);
  cv::dilate(result, result, square(radius));
  if (radius > 1) cv::erode(result, result, square(radius - 1));
  return result(cv::Rect(radius, radius, values.cols, values.rows));
}

// Exchanges near and far: 1..255 becomes 255..1, and 0 stays 0, which is what negation modulo 256 does.
std::vector<std::uint8_t> flipped(std::vector<std::uint8_t> gray) {
  for (auto& value : gray) value = static_cast<std::uint8_t>(-value);
  return gray;
}

std::vector<std::uint8_t> pixelsOf(const cv::Mat& image) {
  std::vector<std::uint8_t> pixels;
  pixels.reserve(image.total());
  for (int row = 0; row < image.rows; ++row)
    pixels.insert(pixels.end(), image.ptr(row), image.ptr(row) + image.cols);
  return pixels;
}

cv::Mat view(const FaceImage& image, const std::vector<std::uint8_t>& pixels) {
  return {image.height, image.width, CV_8U, const_cast<std::uint8_t*>(pixels.data())};
}

}  // namespace

void ContourOptions::validate() const {
  requireOption(min_neighbours >= 0, "contours.min_neighbours", min_neighbours, "at least 0");
  requireOption(splat_spacings >= 0.0 && splat_spacings <= 100.0, "contours.splat_spacings", splat_spacings,
                "in [0, 100]");
  requireOption(canny_sigma_px >= 0.5 && canny_sigma_px <= 50.0, "contours.canny_sigma_px", canny_sigma_px,
                "in [0.5, 50]");
  requireOption(high_quantile > 0.0 && high_quantile < 1.0, "contours.high_quantile", high_quantile,
                "in (0, 1)");
  requireOption(low_fraction > 0.0 && low_fraction <= 1.0, "contours.low_fraction", low_fraction,
                "in (0, 1]");
  requireOption(min_depth_step_m >= 0.0, "contours.min_depth_step_m", min_depth_step_m, "at least 0");
  requireOption(min_points >= 2, "contours.min_points", min_points, "at least 2");
}

FaceImage filled(const FaceImage& image, const ContourOptions& options) {
  options.validate();
  const int radius = splatRadius(image, options);
  const cv::Mat gray = view(image, image.gray);
  const auto flipped_farthest = flipped(image.farthest);
  const cv::Mat kept = inCompany(gray, radius, options.min_neighbours);
  FaceImage result = image;
  result.gray = pixelsOf(expanded(gray, kept, radius));
  result.farthest = flipped(pixelsOf(expanded(view(image, flipped_farthest), kept, radius)));
  // Taking back mixes depths of neighbours, each image in its own direction.
  std::transform(result.gray.begin(), result.gray.end(), result.farthest.begin(), result.farthest.begin(),
                 [](auto near, auto far) { return std::min(near, far); });
  return result;
}

}  // namespace boxgrasp
