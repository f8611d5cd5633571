#include "boxgrasp/synthesis/smoothing.h"

#include <cmath>
#include <vector>

#include "boxgrasp/base/simd.h"

namespace boxgrasp {

namespace smoothing_passes {

constexpr int kRun = 32;  // pixels whose sums stay in registers

struct Kernel {
  const float* weights;  // the middle one first
  int reach;
};

// result[i] = weights[0] * at[i] + sum over d > 0 of weights[d] * (at[i - d * stride] + at[i + d * stride])
template <int count>
BOXGRASP_SIMD_PART void smoothRun(const float* at, std::ptrdiff_t stride, const Kernel& kernel,
                                  float* result) {
  float sums[count];
  for (int i = 0; i < count; ++i) sums[i] = kernel.weights[0] * at[i];
  for (int d = 1; d <= kernel.reach; ++d) {
    const float *before = at - d * stride, *behind = at + d * stride;
    const float weight = kernel.weights[d];
    for (int i = 0; i < count; ++i) sums[i] += weight * (before[i] + behind[i]);
  }
  for (int i = 0; i < count; ++i) result[i] = sums[i];
}

// The last run of a row begins where it ends with the row.
BOXGRASP_SIMD void smooth(const float* at, int n, std::ptrdiff_t stride, const Kernel& of, float* result) {
  const Kernel kernel = of;
  if (n < kRun) {
    for (int i = 0; i < n; ++i) smoothRun<1>(at + i, stride, kernel, result + i);
    return;
  }
  for (int i = 0; i < n; i += kRun) {
    const int begin = i + kRun <= n ? i : n - kRun;
    smoothRun<kRun>(at + begin, stride, kernel, result + begin);
  }
}

}  // namespace smoothing_passes

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
  const smoothing_passes::Kernel passed{kernel.data(), reach};
  cv::Mat wide, along_rows, result(image.size(), CV_32F);
  cv::copyMakeBorder(image, wide, reach, reach, reach, reach, cv::BORDER_CONSTANT, 0.0);
  along_rows.create(wide.rows, image.cols, CV_32F);
  for (int row = 0; row < wide.rows; ++row) {
    smoothing_passes::smooth(wide.ptr<float>(row) + reach, image.cols, 1, passed, along_rows.ptr<float>(row));
  }
  const auto stride = static_cast<std::ptrdiff_t>(along_rows.step1());
  for (int row = 0; row < image.rows; ++row) {
    smoothing_passes::smooth(along_rows.ptr<float>(row + reach), image.cols, stride, passed,
                             result.ptr<float>(row));
  }
  return result;
}

}  // namespace boxgrasp
