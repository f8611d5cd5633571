#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "boxgrasp/base/simd.h"
#include "boxgrasp/geometry/block_ranges.h"
#include "boxgrasp/synthesis/edges.h"
#include "boxgrasp/synthesis/smoothing.h"

namespace boxgrasp {
namespace depth_edge_passes {

// Coverages 1 and 2 sigma inside a straight border: from the first on there is a gradient, from the second
// on, with neighbours to compare, there are edges.
constexpr float kKnown = 0.841f, kClear = 0.977f;

BOXGRASP_SIMD void divide(float* values, const float* weights, int n) {
  for (int i = 0; i < n; ++i) values[i] = weights[i] > 0.0f ? values[i] / weights[i] : 0.0f;
}

// Rows of the image, and of its gradient.
struct Rows {
  const float *above, *here, *below, *coverage;
  float *x, *y, *magnitude;
};

// The gradient by central differences in all but the first and the last pixel; zero where it is not known.
BOXGRASP_SIMD void differentiate(const Rows& rows, int n) {
  const float *const above = rows.above, *const here = rows.here, *const below = rows.below;
  const float* const coverage = rows.coverage;
  float* __restrict x = rows.x, * __restrict y = rows.y, * __restrict magnitude = rows.magnitude;
  for (int i = 1; i + 1 < n; ++i) {
    const bool known = coverage[i] >= kKnown;
    const float along = 0.5f * (here[i + 1] - here[i - 1]), down = 0.5f * (below[i] - above[i]);
    x[i] = known ? along : 0.0f;
    y[i] = known ? down : 0.0f;
    magnitude[i] = std::sqrt(x[i] * x[i] + y[i] * y[i]);
  }
}

// Which of equal bins from 0 to `most` each value falls into.
BOXGRASP_SIMD void toBins(const float* values, std::size_t n, double most, int bins, int* result) {
  for (std::size_t i = 0; i < n; ++i)
    result[i] = static_cast<int>(static_cast<double>(values[i]) / most * bins);
}

}  // namespace depth_edge_passes

namespace {

using depth_edge_passes::kClear;

constexpr int kBins = 64;  // of the gradient histogram, as Matlab's edge()
// Gradients that differ by less than this share are equal to rounding.
constexpr double kEqual = 1e-5;
// Sigmas to either side of an edge where its step is measured: 4 px for 2.5.
constexpr double kStepReach = 1.6;

// The depth smoothed over the occupied pixels only (normalised convolution), in gray levels; 0 elsewhere.
cv::Mat smoothedDepth(const cv::Mat& gray, const cv::Mat& coverage, double sigma_px) {
  cv::Mat depth;
  gray.convertTo(depth, CV_32F);
  depth = smoothed(depth, sigma_px);
  for (int row = 0; row < gray.rows; ++row) {
    depth_edge_passes::divide(depth.ptr<float>(row), coverage.ptr<float>(row), gray.cols);
  }
  return depth;
}

// The gradient of the smoothed depth; zero near the silhouettes.
class Gradient {
 public:
  Gradient(const cv::Mat& depth, const cv::Mat& coverage)
      : width_(depth.cols), x_(depth.total()), y_(depth.total()), magnitudes_(depth.total()) {
    for (int row = 1; row + 1 < depth.rows; ++row) {
      const std::size_t at = index(0, row);
      depth_edge_passes::differentiate(
          {depth.ptr<float>(row - 1), depth.ptr<float>(row), depth.ptr<float>(row + 1),
           coverage.ptr<float>(row), &x_[at], &y_[at], &magnitudes_[at]},
          width_);
    }
    findClearPixels(coverage);
  }

  int width() const { return width_; }
  // Those clear of the silhouettes, and the magnitudes there.
  const std::vector<std::uint32_t>& clearPixels() const { return clear_; }
  const std::vector<float>& clearMagnitudes() const { return clear_magnitudes_; }
  double magnitude(std::size_t pixel) const { return magnitudes_[pixel]; }
  Vector2d direction(std::size_t pixel) const { return Vector2d(x_[pixel], y_[pixel]).normalized(); }
  Vector2d position(std::uint32_t pixel) const {
    const auto width = static_cast<std::uint32_t>(width_);
    return {static_cast<double>(pixel % width), static_cast<double>(pixel / width)};
  }
  // Bilinear; pre: at least a pixel inside the image.
  double magnitudeAt(const Vector2d& p) const {
    const int column = static_cast<int>(p.x()), row = static_cast<int>(p.y());
    const double x = p.x() - column, y = p.y() - row;
    const std::size_t at = index(column, row);
    return (1 - y) * ((1 - x) * magnitudes_[at] + x * magnitudes_[at + 1]) +
           y * ((1 - x) * magnitudes_[at + width_] + x * magnitudes_[at + width_ + 1]);
  }

 private:
  std::size_t index(int column, int row) const { return static_cast<std::size_t>(row) * width_ + column; }

  void findClearPixels(const cv::Mat& coverage) {
    clear_.resize(magnitudes_.size());
    std::size_t count = 0;
    for (int row = 1; row + 1 < coverage.rows; ++row) {
      const float* inside = coverage.ptr<float>(row);
      for (int column = 1; column + 1 < width_; ++column) {
        clear_[count] = static_cast<std::uint32_t>(index(column, row));
        count += inside[column] >= kClear;
      }
    }
    clear_.resize(count);
    clear_magnitudes_.reserve(count);
    for (const std::uint32_t pixel : clear_) clear_magnitudes_.push_back(magnitudes_[pixel]);
  }

  int width_;
  std::vector<float> x_, y_, magnitudes_;
  std::vector<std::uint32_t> clear_;
  std::vector<float> clear_magnitudes_;
};

struct Thresholds {
  double low, high;
};

// As Matlab's edge(): the upper bound of the first of 64 bins with which more than the given share of the
// pixels is counted.
Thresholds automaticThresholds(const Gradient& gradient, const DepthEdgeOptions& options) {
  const std::vector<float>& magnitudes = gradient.clearMagnitudes();
  const double most = std::max(0.0f, rangeOf(magnitudes).max);
  std::array<std::size_t, kBins> counts{};
  if (most > 0.0) {
    std::vector<int> bins(magnitudes.size());
    depth_edge_passes::toBins(magnitudes.data(), magnitudes.size(), most, kBins, bins.data());
    for (const int bin : bins) ++counts[std::min(kBins - 1, bin)];
  }
  const double share = options.high_quantile * static_cast<double>(magnitudes.size());
  std::size_t below = 0;
  int bin = 0;
  while (bin < kBins && static_cast<double>(below) <= share) below += counts[bin++];
  const double high = most * bin / kBins;
  return {options.low_fraction * high, high};
}

// How much deeper the surface is behind the edge than before it, in gray levels, beyond what the gentler of
// the slopes on both sides explains (the only one, where the object ends on the other): a steep but steady
// slope has no step.
double stepAcross(const cv::Mat& gray, const Vector2d& p, const Vector2d& towards_near, double reach_px) {
  const auto sample = [&](double reaches) -> std::optional<double> {
    const Vector2d at = p + reaches * reach_px * towards_near;
    const cv::Point pixel(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
    if (!pixel.inside({0, 0, gray.cols, gray.rows}) || gray.at<std::uint8_t>(pixel) == 0) return std::nullopt;
    return gray.at<std::uint8_t>(pixel);
  };
  const auto near = sample(1), far = sample(-1), nearer = sample(2), farther = sample(-2);
  if (!near || !far) return 0.0;
  const double step = *near - *far;
  const double slope_near = nearer ? std::max(0.0, *nearer - *near) : step;
  const double slope_far = farther ? std::max(0.0, *far - *farther) : step;
  return nearer || farther ? step - 2.0 * std::min(slope_near, slope_far) : step;
}

// The place of the greatest gradient across the edge, from the parabola through three samples; nullopt when
// this pixel is not a maximum.
std::optional<Vector2d> maximumAt(const Gradient& gradient, std::uint32_t pixel) {
  const Vector2d p = gradient.position(pixel), u = gradient.direction(pixel);
  const double here = gradient.magnitude(pixel), before = gradient.magnitudeAt(p - u);
  // Of two equal neighbours exactly one is the maximum, rounding or not.
  if (before <= 0.0 || here < (1 - kEqual) * before) return std::nullopt;
  const double behind = gradient.magnitudeAt(p + u);
  if (behind <= 0.0 || here <= (1 + kEqual) * behind) return std::nullopt;
  const double offset = 0.5 * (before - behind) / (before - 2.0 * here + behind);
  return p + std::clamp(offset, -0.5, 0.5) * u;
}

// Edge pixels, and the lines that they form.
class Linker {
 public:
  Linker(const Gradient& gradient, Thresholds thresholds, const cv::Mat& gray,
         const DepthEdgeOptions& options)
      : gradient_(gradient), high_(thresholds.high), free_(gray.total(), -1) {
    const double reach_px = kStepReach * options.sigma_px;
    for (std::size_t i = 0; i < gradient.clearPixels().size(); ++i) {
      const double magnitude = gradient.clearMagnitudes()[i];
      if (magnitude < thresholds.low || magnitude <= 0.0) continue;
      const std::uint32_t pixel = gradient.clearPixels()[i];
      const auto place = maximumAt(gradient, pixel);
      if (!place || stepAcross(gray, *place, gradient.direction(pixel), reach_px) < options.min_step_gray)
        continue;
      free_[pixel] = static_cast<int>(edges_.size());
      edges_.push_back({pixel, *place});
    }
  }

  // Lines with a gradient above the high threshold somewhere (the hysteresis of Canny).
  std::vector<PixelLine> lines(int min_points) {
    std::vector<PixelLine> found;
    for (const Edge& seed : edges_) {
      if (free_[seed.pixel] < 0) continue;
      strong_ = false;
      PixelLine line = lineThrough(seed.pixel);
      if (strong_ && static_cast<int>(line.points.size()) >= min_points) found.push_back(std::move(line));
    }
    return found;
  }

 private:
  struct Edge {
    std::size_t pixel;
    Vector2d place;
  };

  PixelLine lineThrough(std::size_t seed) {
    PixelLine line;
    line.points.push_back(take(seed));
    const auto forward = walk(seed, 1.0);
    line.points.insert(line.points.end(), forward.begin(), forward.end());
    const auto backward = walk(seed, -1.0);
    line.points.insert(line.points.begin(), backward.rbegin(), backward.rend());
    line.closed = line.points.size() > 2 && (line.points.front() - line.points.back()).norm() < 2.0;
    return line;
  }

  Vector2d take(std::size_t pixel) {
    strong_ |= gradient_.magnitude(pixel) >= high_;
    return edges_[std::exchange(free_[pixel], -1)].place;
  }

  // Forward is where the brighter side is on the left.
  std::vector<Vector2d> walk(std::size_t from, double sense) {
    std::vector<Vector2d> points;
    for (auto next = successor(from, sense); next; next = successor(*next, sense))
      points.push_back(take(*next));
    return points;
  }

  // Of the free neighbours the one most nearly straight on, none that turns back or whose gradient points the
  // other way.
  std::optional<std::size_t> successor(std::size_t pixel, double sense) const {
    const Vector2d u = gradient_.direction(pixel), ahead = sense * Vector2d(u.y(), -u.x());
    std::optional<std::size_t> best;
    double best_cosine = 1e-9;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const std::size_t next = pixel + static_cast<std::ptrdiff_t>(dy) * gradient_.width() + dx;
        if (free_[next] < 0 || gradient_.direction(next).dot(u) <= 0.0) continue;
        const double cosine = ahead.dot(Vector2d(dx, dy).normalized());
        if (cosine <= best_cosine) continue;
        best = next;
        best_cosine = cosine;
      }
    }
    return best;
  }

  const Gradient& gradient_;
  double high_;
  std::vector<Edge> edges_;
  std::vector<int> free_;  // for each pixel the number of its edge while it is on no line, else -1
  bool strong_ = false;
};

}  // namespace

std::vector<PixelLine> depthEdges(const cv::Mat& gray, const cv::Mat& coverage,
                                  const DepthEdgeOptions& options) {
  const Gradient gradient(smoothedDepth(gray, coverage, options.sigma_px), coverage);
  const Thresholds thresholds = automaticThresholds(gradient, options);
  return Linker(gradient, thresholds, gray, options).lines(options.min_points);
}

}  // namespace boxgrasp
