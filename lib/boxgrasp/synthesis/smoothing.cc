#include "boxgrasp/synthesis/smoothing.h"

#include <cmath>
#include <vector>

#include "boxgrasp/base/simd.h"

namespace boxgrasp {

// result[i] = weights[0] * at[i] + sum over d > 0 of weights[d] * (at[i - d * stride] + at[i + d * stride])
BOXGRASP_SIMD void addWeighted(const float* at, int n, std::ptrdiff_t stride, const float* weights, int reach,
                               float* result) {
  for (int i = 0; i < n; ++i) result[i] = weights[0] * at[i];
  for (int d = 1; d <= reach; ++d) {
    const float* before = at - d * stride;
    const float* behind = at + d * stride;
    const float weight = weights[d];
    for (int i = 0; i < n; ++i) result[i] += weight * (before[i] + behind[i]);
  }
}

namespace {

// One side of the kernel, its middle first.
std::vector<float> halfKernel(double sigma_px) {
  const int reach = static_cast<int>(std::ceil(4.0 * sigma_px));
  std::vector<double> weights;
  double sum = 0.0;
  for (int d = 0; d <= reach; ++d) {
    weights.push_back(std::exp(-0.5 * d * d / (sigma_px * sigma_px)));
    sum += (d == 0 ? 1.0 : 2.0) * weights.back();
  }
  std::vector<float> kernel;
  for (const double weight : weights) kernel.push_back(static_cast<float>(weight / sum));
  return kernel;
}

}  // namespace

cv::Mat smoothed(const cv::Mat& image, double sigma_px) {
  const std::vector<float> kernel = halfKernel(sigma_px);
  const int reach = static_cast<int>(kernel.size()) - 1;
  cv::Mat wide, along_rows, result(image.size(), CV_32F);
  cv::copyMakeBorder(image, wide, reach, reach, reach, reach, cv::BORDER_CONSTANT, 0.0);
  along_rows.create(wide.rows, image.cols, CV_32F);
  for (int row = 0; row < wide.rows; ++row) {
    addWeighted(wide.ptr<float>(row) + reach, image.cols, 1, kernel.data(), reach,
                along_rows.ptr<float>(row));
  }
  const auto stride = static_cast<std::ptrdiff_t>(along_rows.step1());
  for (int row = 0; row < image.rows; ++row) {
    addWeighted(along_rows.ptr<float>(row + reach), image.cols, stride, kernel.data(), reach,
                result.ptr<float>(row));
  }
  return result;
}

}  // namespace boxgrasp
