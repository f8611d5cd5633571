#include "boxgrasp/synthesis/regions.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/simd.h"
#include "boxgrasp/geometry/polygon.h"

namespace boxgrasp {
namespace region_passes {

BOXGRASP_SIMD void addWeighted(const double* values, const double* there, std::size_t n, double weight,
                               double* __restrict sums, double* __restrict totals) {
  for (std::size_t i = 0; i < n; ++i) {
    sums[i] += weight * values[i];
    totals[i] += weight * there[i];
  }
}

}  // namespace region_passes

namespace {

int wrapped(int i, int n) { return ((i % n) + n) % n; }

// Pre: k is below the number of points.
double bendingAt(const std::vector<Vector2d>& points, int i, int k) {
  const int n = static_cast<int>(points.size());
  const int before = i >= k ? i - k : i - k + n, after = i + k < n ? i + k : i + k - n;
  const Vector2d ahead = points[after] - points[i], from_behind = points[i] - points[before];
  return std::atan2(cross(from_behind, ahead), from_behind.dot(ahead));
}

std::vector<double> bending(const Contour& contour, int k) {
  const int n = static_cast<int>(contour.points_F.size());
  std::vector<double> kappa(n, 0.0);
  k = std::min(k, (n - 1) / 2);
  if (k < 1) return kappa;
  for (int i = 0; i < n; ++i) {
    kappa[i] = bendingAt(contour.points_F, contour.closed ? i : std::clamp(i, k, n - 1 - k), k);
  }
  return kappa;
}

// The values from `reach` before the first to `reach` after the last: those of a closed contour come again,
// beyond the ends of an open one there are zeros.
std::vector<double> extended(const std::vector<double>& values, bool closed, int reach) {
  const int n = static_cast<int>(values.size());
  std::vector<double> result(values.size() + 2 * static_cast<std::size_t>(reach));
  std::copy(values.begin(), values.end(), result.begin() + reach);
  for (int i = 0; closed && i < reach; ++i) {
    result[reach - 1 - i] = values[wrapped(-1 - i, n)];
    result[reach + n + i] = values[wrapped(i, n)];
  }
  return result;
}

// Circular for closed contours, normalised at the ends of open ones.
std::vector<double> smoothed(const std::vector<double>& values, bool closed, double sigma) {
  const int reach = static_cast<int>(std::ceil(3.0 * sigma));
  std::vector<double> weights;
  for (int d = -reach; d <= reach; ++d)
    weights.push_back(sigma > 0.0 ? std::exp(-0.5 * d * d / (sigma * sigma)) : 1.0);
  const std::vector<double> all = extended(values, closed, reach);
  const std::vector<double> there = extended(std::vector<double>(values.size(), 1.0), closed, reach);
  std::vector<double> sums(values.size()), totals(values.size());
  for (std::size_t d = 0; d < weights.size(); ++d)
    region_passes::addWeighted(&all[d], &there[d], values.size(), weights[d], sums.data(), totals.data());
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= totals[i];
  return sums;
}

// A run of successive points of one contour, unrolled: a closed contour may have its first point again at the
// end.
struct Run {
  std::vector<Vector2d> points;
  std::vector<double> kappa;
};

Run runOf(const Contour& contour, const std::vector<double>& kappa, int first, int count) {
  const int n = static_cast<int>(kappa.size());
  Run run;
  for (int i = first; i < first + count; ++i) {
    run.points.push_back(contour.points_F[wrapped(i, n)]);
    run.kappa.push_back(kappa[wrapped(i, n)]);
  }
  return run;
}

int farthestFromMean(const std::vector<Vector2d>& points) {
  Vector2d mean = Vector2d::Zero();
  for (const auto& p : points) mean += p / static_cast<double>(points.size());
  const auto farther = [&](const auto& p, const auto& q) {
    return (p - mean).squaredNorm() < (q - mean).squaredNorm();
  };
  return static_cast<int>(std::max_element(points.begin(), points.end(), farther) - points.begin());
}

std::vector<Run> lowRuns(const Contour& contour, const std::vector<double>& kappa, double bound) {
  const int n = static_cast<int>(kappa.size());
  const auto low = [&](int i) { return std::abs(kappa[wrapped(i, n)]) <= bound; };
  int first = 0;
  if (contour.closed) {
    while (first < n && low(first)) ++first;
    if (first == n) return {runOf(contour, kappa, farthestFromMean(contour.points_F), n + 1)};
  }
  std::vector<Run> runs;
  for (int i = first; i < first + n;) {
    int end = i;
    while (end < first + n && low(end)) ++end;
    if (end > i) runs.push_back(runOf(contour, kappa, i, end - i));
    i = end + 1;
  }
  return runs;
}

// The mean of the curvature over about a shortest region around each point: what waves shorter than that
// leave.
std::vector<double> meanOver(const std::vector<double>& kappa, int window) {
  const int n = static_cast<int>(kappa.size()), half = window / 2;
  std::vector<double> sums{0.0};
  for (const double value : kappa) sums.push_back(sums.back() + value);
  std::vector<double> means(n);
  for (int i = 0; i < n; ++i) {
    const int from = std::max(0, i - half), to = std::min(n, i + half + 1);
    means[i] = (sums[to] - sums[from]) / (to - from);
  }
  return means;
}

class Breaker {
 public:
  Breaker(const Run& run, const RegionOptions& options) : run_(run), options_(options) {
    arc_.push_back(0.0);
    for (std::size_t i = 1; i < run.points.size(); ++i) {
      arc_.push_back(arc_.back() + (run.points[i] - run.points[i - 1]).norm());
    }
    fillLoad();
  }

  // Index pairs of the pieces' first and last points, both included.
  std::vector<std::pair<int, int>> pieces() const {
    const int fewest = std::max(1, static_cast<int>(std::ceil(load_.back() - 1e-9)));
    std::vector<std::pair<int, int>> found;
    for (int n = fewest; n <= 2 * fewest + 1; ++n) {
      found = evenPieces(n);
      if (std::all_of(found.begin(), found.end(), [&](const auto& piece) { return withinBounds(piece); }))
        break;
    }
    std::erase_if(found, [&](const auto& piece) {
      return !withinBounds(piece) || length(piece) < options_.min_length_m;
    });
    return found;
  }

 private:
  // The load of a stretch is its share of the longest length or of the largest total bending, whichever is
  // greater, added up along the run: pieces of load 1 or less satisfy both bounds.
  void fillLoad() {
    const int n = static_cast<int>(run_.points.size());
    const double step = arc_.back() / std::max(1, n - 1);
    const int window = options_.sum == CurvatureSum::absolute || step <= 0.0
                           ? 1
                           : static_cast<int>(std::min<double>(n, options_.min_length_m / step));
    const auto mean = meanOver(run_.kappa, window);
    load_.push_back(0.0);
    for (int i = 1; i < n; ++i) {
      const double bend =
          0.5 * (std::abs(mean[i]) + std::abs(mean[i - 1])) / options_.max_total_curvature_rad;
      load_.push_back(load_.back() + std::max((arc_[i] - arc_[i - 1]) / options_.max_length_m, bend));
    }
  }

  std::vector<std::pair<int, int>> evenPieces(int n) const {
    std::vector<std::pair<int, int>> found;
    int begin = 0;
    for (int piece = 1; piece <= n; ++piece) {
      const int end = pointAtLoad(load_.back() * piece / n);
      if (end > begin) found.emplace_back(begin, end);
      begin = end;
    }
    return found;
  }

  int pointAtLoad(double load) const {
    const auto after = std::lower_bound(load_.begin(), load_.end(), load);
    if (after == load_.begin()) return 0;
    if (after == load_.end()) return static_cast<int>(load_.size()) - 1;
    return static_cast<int>(after - load_.begin()) - (load - *(after - 1) < *after - load);
  }

  double length(const std::pair<int, int>& piece) const { return arc_[piece.second] - arc_[piece.first]; }

  bool withinBounds(const std::pair<int, int>& piece) const {
    double sum = 0.0;
    for (int i = piece.first; i <= piece.second; ++i) {
      sum += options_.sum == CurvatureSum::absolute ? std::abs(run_.kappa[i]) : run_.kappa[i];
    }
    return std::abs(sum) <= options_.max_total_curvature_rad && length(piece) <= options_.max_length_m;
  }

  const Run& run_;
  const RegionOptions& options_;
  std::vector<double> arc_, load_;
};

// Each point's bending is that over k steps to either side, so that every step counts k times.
double turnAlong(const Run& run, int first, int last, int k) {
  const auto at = [&](int i) { return run.kappa.begin() + i; };
  return std::accumulate(at(first), at(last), 0.0) / k;
}

// The chord as a region; nullopt for a chord of no length, which has no direction.
std::optional<Region> regionBetween(const Vector2d& a_F, const Vector2d& b_F) {
  const double length = (b_F - a_F).norm();
  if (length <= 0.0) return std::nullopt;
  const Vector2d t = (b_F - a_F) / length;
  Region region;
  region.a_F = a_F;
  region.b_F = b_F;
  region.normal_F = {-t.y(), t.x()};
  return region;
}

}  // namespace

void RegionOptions::validate() const {
  requireOption(k >= 1 && k <= 1000, "regions.k", k, "in [1, 1000]");
  requireOption(smoothing_sigma >= 0.0 && smoothing_sigma <= 1000.0, "regions.smoothing_sigma",
                smoothing_sigma, "in [0, 1000]");
  requireOption(max_curvature_rad > 0.0, "regions.max_curvature_rad", max_curvature_rad, "above 0");
  requireOption(max_total_curvature_rad > 0.0, "regions.max_total_curvature_rad", max_total_curvature_rad,
                "above 0");
  requireOption(min_length_m > 0.0, "regions.min_length_m", min_length_m, "above 0");
  requireOption(max_length_m >= min_length_m, "regions.max_length_m", max_length_m, "at least min_length_m");
}

std::vector<double> curvature(const Contour& contour, const RegionOptions& options) {
  return smoothed(bending(contour, options.k), contour.closed, options.smoothing_sigma);
}

std::vector<Region> findRegions(const std::vector<Contour>& contours, const RegionOptions& options) {
  options.validate();
  std::vector<Region> regions;
  for (std::size_t c = 0; c < contours.size(); ++c) {
    for (const Run& run : lowRuns(contours[c], curvature(contours[c], options), options.max_curvature_rad)) {
      for (const auto& [first, last] : Breaker(run, options).pieces()) {
        auto region = regionBetween(run.points[first], run.points[last]);
        if (!region) continue;
        region->kind = contours[c].kind;
        region->contour = static_cast<int>(c);
        region->turn_rad = turnAlong(run, first, last, options.k);
        regions.push_back(*region);
      }
    }
  }
  return regions;
}

}  // namespace boxgrasp
