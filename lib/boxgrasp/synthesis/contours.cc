#include "boxgrasp/synthesis/contours.h"

#include <opencv2/imgproc.hpp>

#include "boxgrasp/geometry/polygon.h"
#include "boxgrasp/synthesis/edges.h"

namespace boxgrasp {
namespace {

constexpr int kMargin_px =
    1;  // around the image, so that silhouettes close even where the object reaches its edge

cv::Mat withMargin(const FaceImage& image) {
  const cv::Mat gray(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.gray.data()));
  cv::Mat wide;
  cv::copyMakeBorder(gray, wide, kMargin_px, kMargin_px, kMargin_px, kMargin_px, cv::BORDER_CONSTANT);
  return wide;
}

Contour contourOf(const PixelLine& line, const FaceImage& image) {
  const PixelLine even = evenlySpaced(line);
  Contour contour;
  contour.closed = even.closed;
  for (const Vector2d& p : even.points) contour.points_F.push_back(image.toFace(p.array() - kMargin_px));
  return contour;
}

double grayStep(const FaceImage& image, double step_m) {
  return (image.depthOf(1.0) > 0.0 ? step_m / image.depthOf(1.0) : 0.0) * 254.0;
}

}  // namespace

std::vector<Contour> findContours(const FaceImage& filled_image, const ContourOptions& options) {
  options.validate();
  if (filled_image.gray.empty()) return {};
  const cv::Mat gray = withMargin(filled_image);
  const cv::Mat coverage = smoothedCoverage(gray, options.canny_sigma_px);
  std::vector<Contour> contours;
  const auto keep = [&](const PixelLine& line, ContourKind kind) {
    Contour contour = contourOf(line, filled_image);
    if (static_cast<int>(contour.points_F.size()) < options.min_points) return;
    contour.kind = kind;
    contours.push_back(std::move(contour));
  };
  for (const PixelLine& line : silhouettes(coverage)) {
    keep(line, signedArea(line.points) > 0.0 ? ContourKind::outer : ContourKind::inner);
  }
  const DepthEdgeOptions depth{options.canny_sigma_px, options.high_quantile, options.low_fraction,
                               grayStep(filled_image, options.min_depth_step_m), options.min_points};
  for (const PixelLine& line : depthEdges(gray, coverage, depth)) keep(line, ContourKind::depth_edge);
  return contours;
}

}  // namespace boxgrasp
