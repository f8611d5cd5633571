// Gaussian smoothing of images.
#pragma once

#include <opencv2/core.hpp>

namespace boxgrasp {

// The image smoothed by a Gaussian cut off at 4 sigma; outside of the image there is nothing (0). Sums pairs
// of pixels at equal distance, in a fixed order: a mirrored image gives a mirrored result, and every machine
// the same bits, which OpenCV's own filters do not promise. Pre: `image` is CV_32F, sigma > 0.
cv::Mat smoothed(const cv::Mat& image, double sigma_px);

}  // namespace boxgrasp
