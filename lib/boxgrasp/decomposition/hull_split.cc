#include <algorithm>
#include <limits>
#include <queue>

#include "boxgrasp/base/parallel.h"
#include "boxgrasp/base/simd.h"
#include "boxgrasp/decomposition/cut_lines.h"
#include "boxgrasp/decomposition/splits.h"

namespace boxgrasp {
namespace {

constexpr int kGridCells = 10;  // the first subset has the extreme points of the cells of this grid
constexpr double kBoundSlack = 1.0 + 1e-12;  // a bound may exceed the exact value by this rounding error

struct Sides {
  std::vector<Vector2d> first, second;
};

Sides sidesOf(const FaceProjection& face, const Line& line) {
  Sides sides;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Vector2d p = face.point(i);
    (line.normal.dot(p) <= line.offset ? sides.first : sides.second).push_back(p);
  }
  return sides;
}

// The largest signed distance of each point from the edges of a counter-clockwise polygon: positive for
// points outside.
BOXGRASP_SIMD void raiseByEdge(const double* x, const double* y, std::size_t n, double nx, double ny,
                               double offset, double* excess) {
  for (std::size_t i = 0; i < n; ++i) {
    const double distance = nx * x[i] + ny * y[i] - offset;
    excess[i] = distance > excess[i] ? distance : excess[i];
  }
}

BOXGRASP_SIMD void distancesFromLine(const double* x, const double* y, std::size_t n, double nx, double ny,
                                     double offset, double* distance) {
  for (std::size_t i = 0; i < n; ++i) distance[i] = nx * x[i] + ny * y[i] - offset;
}

// Points outside the polygon have positive excess; a polygon without area has every point outside.
void excessOver(const Polygon& polygon, const FaceProjection& face, std::vector<double>& excess) {
  excess.assign(face.size(), polygon.size() < 3 ? 1.0 : -std::numeric_limits<double>::infinity());
  if (polygon.size() < 3) return;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d along = polygon[(i + 1) % polygon.size()] - polygon[i];
    const Vector2d outward(along.y(), -along.x());
    raiseByEdge(face.x.data(), face.y.data(), face.size(), outward.x(), outward.y(), outward.dot(polygon[i]),
                excess.data());
  }
}

// The few points of one face on which lines are bounded: sorted by x, then y, none twice.
class Subset {
 public:
  explicit Subset(std::vector<Vector2d> points) : points_(std::move(points)) { sort(); }

  void add(const std::vector<Vector2d>& points) {
    points_.insert(points_.end(), points.begin(), points.end());
    sort();
  }

  // The summed area of the hulls of both sides: at most that of all points.
  double boundArea(const Line& line) {
    first_.clear();
    second_.clear();
    for (const Vector2d& p : points_) (line.normal.dot(p) <= line.offset ? first_ : second_).push_back(p);
    return chainArea(first_) + chainArea(second_);
  }

  Sides sides(const Line& line) const {
    Sides sides;
    for (const Vector2d& p : points_)
      (line.normal.dot(p) <= line.offset ? sides.first : sides.second).push_back(p);
    return sides;
  }

 private:
  static bool before(const Vector2d& a, const Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  }

  void sort() {
    std::sort(points_.begin(), points_.end(), before);
    points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
  }

  // Twice the area between the x axis and one chain of the hull of sorted points: the lower one for side +1,
  // the upper for -1.
  double areaUnder(const std::vector<Vector2d>& sorted, double side) {
    chain_.clear();
    for (const Vector2d& p : sorted) {
      while (chain_.size() >= 2 &&
             side * cross(chain_.back() - chain_[chain_.size() - 2], p - chain_.back()) <= 0)
        chain_.pop_back();
      chain_.push_back(p);
    }
    double area = 0.0;
    for (std::size_t i = 0; i + 1 < chain_.size(); ++i)
      area += (chain_[i + 1].x() - chain_[i].x()) * (chain_[i].y() + chain_[i + 1].y());
    return area;
  }

  double chainArea(const std::vector<Vector2d>& sorted) {
    return (areaUnder(sorted, -1.0) - areaUnder(sorted, 1.0)) / 2;
  }

  std::vector<Vector2d> points_, first_, second_, chain_;
};

// The extreme points of every cell of a coarse grid, along its edges and diagonals.
std::vector<Vector2d> cellExtremes(const FaceProjection& face) {
  constexpr std::array<std::array<double, 2>, 4> kDirections{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
  const auto [x_low, x_high] = std::minmax_element(face.x.begin(), face.x.end());
  const auto [y_low, y_high] = std::minmax_element(face.y.begin(), face.y.end());
  const double x_scale = kGridCells / std::max(*x_high - *x_low, 1e-12),
               y_scale = kGridCells / std::max(*y_high - *y_low, 1e-12);
  struct Extreme {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    std::size_t low_point = 0, high_point = 0;
  };
  std::vector<std::array<Extreme, 4>> cells(kGridCells * kGridCells);
  for (std::size_t i = 0; i < face.size(); ++i) {
    const int column = std::min(kGridCells - 1, static_cast<int>((face.x[i] - *x_low) * x_scale));
    const int row = std::min(kGridCells - 1, static_cast<int>((face.y[i] - *y_low) * y_scale));
    for (std::size_t d = 0; d < kDirections.size(); ++d) {
      Extreme& extreme = cells[static_cast<std::size_t>(row * kGridCells + column)][d];
      const double value = kDirections[d][0] * face.x[i] + kDirections[d][1] * face.y[i];
      if (value < extreme.low) extreme.low = value, extreme.low_point = i;
      if (value > extreme.high) extreme.high = value, extreme.high_point = i;
    }
  }
  std::vector<Vector2d> points;
  for (const auto& cell : cells) {
    for (const Extreme& extreme : cell) {
      if (extreme.high < extreme.low) continue;
      points.push_back(face.point(extreme.low_point));
      points.push_back(face.point(extreme.high_point));
    }
  }
  return points;
}

// The hull of all projected points: from the hull of the cells' extremes and the points outside it.
Polygon hullOf(const FaceProjection& face, const std::vector<Vector2d>& extremes) {
  const Polygon inner = convexHull(extremes);
  std::vector<double> excess;
  excessOver(inner, face, excess);
  std::vector<Vector2d> candidates = inner;
  for (std::size_t i = 0; i < face.size(); ++i) {
    if (excess[i] > 0) candidates.push_back(face.point(i));
  }
  return convexHull(candidates);
}

// One face of the search: its lines, and Theta of any of them bounded or exact.
class FaceSearch {
 public:
  FaceSearch(const FaceProjection& face, const DecompositionOptions& options)
      : face_(face),
        least_(leastPoints(face.size(), options.min_point_fraction)),
        subset_(cellExtremes(face)) {
    const Polygon hull =
        hullOf(face, subset_.sides({Vector2d::UnitX(), std::numeric_limits<double>::infinity()}).first);
    subset_.add(hull);
    lines_ = cutLines(hull, options);
  }

  const std::vector<Line>& lines() const { return lines_; }
  int version() const { return version_; }
  double bound(std::size_t line) { return subset_.boundArea(lines_[line]) / face_.area; }

  // Theta on all points; only those outside the subset's hulls can change its areas. They join the subset.
  std::optional<double> exact(std::size_t index) {
    const Line& line = lines_[index];
    const Sides known = subset_.sides(line);
    const Polygon first = convexHull(known.first), second = convexHull(known.second);
    excessOver(first, face_, excess_first_);
    excessOver(second, face_, excess_second_);
    distance_.resize(face_.size());
    distancesFromLine(face_.x.data(), face_.y.data(), face_.size(), line.normal.x(), line.normal.y(),
                      line.offset, distance_.data());
    Sides outer{first, second};
    std::size_t on_first = 0;
    for (std::size_t i = 0; i < face_.size(); ++i) {
      const bool is_first = distance_[i] <= 0;
      on_first += is_first;
      if (is_first ? excess_first_[i] > 0 : excess_second_[i] > 0)
        (is_first ? outer.first : outer.second).push_back(face_.point(i));
    }
    const Polygon whole_first = convexHull(outer.first), whole_second = convexHull(outer.second);
    subset_.add(whole_first);
    subset_.add(whole_second);
    ++version_;
    if (on_first < least_ || face_.size() - on_first < least_) return std::nullopt;
    return (signedArea(whole_first) + signedArea(whole_second)) / face_.area;
  }

 private:
  const FaceProjection& face_;
  std::size_t least_;
  Subset subset_;
  std::vector<Line> lines_;
  std::vector<double> excess_first_, excess_second_, distance_;
  int version_ = 0;  // of the subset
};

// A line with a lower bound of its Theta; the least comes first, of equals the first line.
struct Bounded {
  double bound;
  int face;
  std::size_t line;
  int version;  // of the subset that gave the bound
  bool operator>(const Bounded& other) const {
    return std::tie(bound, face, line) > std::tie(other.bound, other.face, other.line);
  }
};
using Queue = std::priority_queue<Bounded, std::vector<Bounded>, std::greater<>>;

// The least exact Theta: lines come in order of their bounds, which are renewed when the subset has grown
// since.
std::optional<BestLine> searchByBounds(std::vector<FaceSearch>& searches, Queue queue,
                                       const StopToken& stop) {
  std::optional<BestLine> best;
  std::size_t best_line = 0;
  while (!queue.empty() && (!best || queue.top().bound <= best->theta * kBoundSlack)) {
    stop.check();
    Bounded top = queue.top();
    queue.pop();
    FaceSearch& search = searches[top.face];
    if (top.version != search.version()) {
      queue.push({std::max(top.bound, search.bound(top.line)), top.face, top.line, search.version()});
      continue;
    }
    const std::optional<double> theta = search.exact(top.line);
    if (!theta) continue;
    if (best && std::tie(best->theta, best->face, best_line) < std::tie(*theta, top.face, top.line)) continue;
    best = BestLine{*theta, top.face, search.lines()[top.line]};
    best_line = top.line;
  }
  return best;
}

std::optional<BestLine> bestByBounds(const FaceProjections& faces, const DecompositionOptions& options,
                                     const StopToken& stop) {
  std::vector<FaceSearch> searches;
  for (const FaceProjection& face : faces) searches.emplace_back(face, options);
  std::array<std::vector<double>, 3> bounds;
  parallelFor(faces.size(), options.threads, [&](std::size_t f) {
    for (std::size_t i = 0; i < searches[f].lines().size(); ++i) bounds[f].push_back(searches[f].bound(i));
  });
  std::vector<Bounded> lines;
  for (int f = 0; f < 3; ++f) {
    for (std::size_t i = 0; i < bounds[f].size(); ++i) lines.push_back({bounds[f][i], f, i, 0});
  }
  return searchByBounds(searches, Queue(std::greater<>(), std::move(lines)), stop);
}

std::optional<BestLine> bestByTryingAll(const FaceProjections& faces, const DecompositionOptions& options,
                                        const StopToken& stop) {
  const std::size_t least = leastPoints(faces[0].size(), options.min_point_fraction);
  std::optional<BestLine> best;
  for (int f = 0; f < 3; ++f) {
    std::vector<Vector2d> points;
    for (std::size_t i = 0; i < faces[f].size(); ++i) points.push_back(faces[f].point(i));
    for (const Line& line : cutLines(convexHull(std::move(points)), options)) {
      stop.check();
      const std::optional<double> theta = plainTheta(faces[f], line, least);
      if (theta && (!best || *theta < best->theta)) best = BestLine{*theta, f, line};
    }
  }
  return best;
}

}  // namespace

std::optional<double> plainTheta(const FaceProjection& face, const Line& line, std::size_t least) {
  const Sides sides = sidesOf(face, line);
  if (sides.first.size() < least || sides.second.size() < least) return std::nullopt;
  return (signedArea(convexHull(sides.first)) + signedArea(convexHull(sides.second))) / face.area;
}

std::optional<BestLine> bestHullLine(const FaceProjections& faces, const DecompositionOptions& options,
                                     const StopToken& stop) {
  return options.exhaustive ? bestByTryingAll(faces, options, stop) : bestByBounds(faces, options, stop);
}

}  // namespace boxgrasp
