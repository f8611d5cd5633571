#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "boxgrasp/base/marks.h"
#include "boxgrasp/base/simd.h"
#include "boxgrasp/synthesis/edges.h"
#include "boxgrasp/synthesis/smoothing.h"

namespace boxgrasp {
namespace silhouette_passes {

constexpr float kHalf = 0.5f;
constexpr std::size_t kRun = 64;

// Which of the cells between two rows of pixels have some corners inside and some not.
BOXGRASP_SIMD void mixedCells(const float* here, const float* below, int columns, std::uint8_t* mixed) {
  for (int i = 0; i + 1 < columns; ++i) {
    const int corners =
        (here[i] > kHalf) + (here[i + 1] > kHalf) + (below[i] > kHalf) + (below[i + 1] > kHalf);
    mixed[i] = corners % 4 != 0;
  }
}

// The first of the runs of numbers, from this one on, that holds one of at least 0, or how many runs there
// are.
BOXGRASP_SIMD std::size_t firstLinkedRun(const int* next, std::size_t run, std::size_t runs) {
  for (; run < runs; ++run) {
    int largest = -1;
    for (std::size_t i = 0; i < kRun; ++i)
      largest = next[run * kRun + i] > largest ? next[run * kRun + i] : largest;
    if (largest >= 0) break;
  }
  return run;
}

}  // namespace silhouette_passes

namespace {

using silhouette_passes::kHalf;
using silhouette_passes::kRun;

// The half-level line crosses edges of the pixel grid, numbered 2 * pixel for the edge to the next column and
// 2 * pixel + 1 for the edge to the next row. Each crossing has one successor along the line.
class HalfLevel {
 public:
  explicit HalfLevel(const cv::Mat& coverage)
      : coverage_(coverage), next_((2 * coverage.total() + kRun - 1) / kRun * kRun, -1) {
    std::vector<std::uint8_t> mixed(static_cast<std::size_t>(coverage.cols - 1));
    for (int row = 0; row + 1 < coverage.rows; ++row) {
      silhouette_passes::mixedCells(coverage.ptr<float>(row), coverage.ptr<float>(row + 1), coverage.cols,
                                    mixed.data());
      forEachMarked(mixed, [&](std::size_t column) { linkCell(static_cast<int>(column), row); });
    }
  }

  // Takes out the lines one by one; an empty line at the end.
  PixelLine takeLine() {
    const std::size_t runs = next_.size() / kRun,
                      run = silhouette_passes::firstLinkedRun(next_.data(), from_ / kRun, runs);
    from_ = std::max(from_, run * kRun);
    while (from_ < next_.size() && next_[from_] < 0) ++from_;
    PixelLine line;
    line.closed = true;
    for (int at = static_cast<int>(from_); from_ < next_.size() && next_[at] >= 0;) {
      line.points.push_back(crossing(at));
      at = std::exchange(next_[at], -1);
    }
    return line;
  }

 private:
  bool inside(int column, int row) const { return coverage_.at<float>(row, column) > kHalf; }
  int edgeRight(int column, int row) const { return 2 * (row * coverage_.cols + column); }
  int edgeDown(int column, int row) const { return edgeRight(column, row) + 1; }

  // Links the crossings of one cell of four pixels, of which some are inside and some not. Along its border
  // from column to row, the line starts where the border leaves the material and ends where it enters it:
  // then the material is on the line's left. Of two lines in a cell, each keeps to the corner that the cell's
  // mean does not join with its opposite.
  void linkCell(int column, int row) {
    const std::array<bool, 4> in{inside(column, row), inside(column + 1, row), inside(column + 1, row + 1),
                                 inside(column, row + 1)};
    const std::array<int, 4> edges{edgeRight(column, row), edgeDown(column + 1, row),
                                   edgeRight(column, row + 1), edgeDown(column, row)};
    const bool saddle = in[0] == in[2] && in[1] == in[3];
    const int step = saddle && !meanInside(column, row) ? 3 : 1;
    for (int start = 0; start < 4; ++start) {
      if (!in[start] || in[(start + 1) % 4]) continue;
      int end = (start + step) % 4;
      while (in[end] || !in[(end + 1) % 4]) end = (end + step) % 4;
      next_[edges[start]] = edges[end];
    }
  }

  bool meanInside(int column, int row) const {
    return cv::sum(coverage_(cv::Rect(column, row, 2, 2)))[0] > 4.0 * kHalf;
  }

  Vector2d crossing(int edge) const {
    const int pixel = edge / 2, column = pixel % coverage_.cols, row = pixel / coverage_.cols;
    const bool down = edge % 2 == 1;
    const double a = coverage_.at<float>(row, column);
    const double b = coverage_.at<float>(row + down, column + !down);
    const double share = (kHalf - a) / (b - a);
    return {column + (down ? 0.0 : share), row + (down ? share : 0.0)};
  }

  cv::Mat coverage_;
  std::vector<int> next_;
  std::size_t from_ = 0;
};

}  // namespace

cv::Mat smoothedCoverage(const cv::Mat& gray, double sigma_px) {
  cv::Mat occupied;
  cv::compare(gray, 0, occupied, cv::CMP_GT);
  occupied.convertTo(occupied, CV_32F, 1.0 / 255.0);
  return smoothed(occupied, sigma_px);
}

std::vector<PixelLine> silhouettes(const cv::Mat& coverage) {
  std::vector<PixelLine> lines;
  HalfLevel level(coverage);
  for (PixelLine line = level.takeLine(); !line.points.empty(); line = level.takeLine()) {
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace boxgrasp
