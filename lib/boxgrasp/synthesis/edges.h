// Edges of a face image in pixels: the two halves of findContours().
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "boxgrasp/geometry/pose.h"

namespace boxgrasp {

// Ordered points in image coordinates (column, row), the material on the left; a closed line does not repeat
// its first point.
struct PixelLine {
  bool closed = false;
  std::vector<Vector2d> points;
};

// The occupied area (1, elsewhere 0) smoothed by a Gaussian: 0.5 on a straight border. Pre: `gray` is CV_8U.
cv::Mat smoothedCoverage(const cv::Mat& gray, double sigma_px);

// The closed lines where the coverage is one half (marching squares). Pre: the coverage is CV_32F and at most
// one half in the outermost pixels.
std::vector<PixelLine> silhouettes(const cv::Mat& coverage);

struct DepthEdgeOptions {
  double sigma_px, high_quantile, low_fraction;
  double min_step_gray;  // in gray levels
  int min_points;
};

// Linked Canny edges of the depth inside the occupied area, the brighter side on the left.
std::vector<PixelLine> depthEdges(const cv::Mat& gray, const cv::Mat& coverage,
                                  const DepthEdgeOptions& options);

// The line with its points moved so that they are equally far apart along it, as near to 1 px as divides it
// evenly. A line of no length stays as it is.
PixelLine evenlySpaced(const PixelLine& line);

}  // namespace boxgrasp
