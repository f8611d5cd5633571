#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <queue>
#include <span>
#include <tuple>

#include "boxgrasp/base/parallel.h"
#include "boxgrasp/decomposition/cut_lines.h"
#include "boxgrasp/decomposition/splits.h"

namespace boxgrasp {
namespace {

constexpr int kBlocks =
    10;  // the first subset has the extreme points of this many blocks along each side of a face
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

// The points of a face sorted into the cells of a grid, so that a line meets few of them.
class CellGrid {
 public:
  explicit CellGrid(const FaceProjection& face) : face_(face) {
    const auto [x_low, x_high] = std::minmax_element(face.x.begin(), face.x.end());
    const auto [y_low, y_high] = std::minmax_element(face.y.begin(), face.y.end());
    origin_ = {*x_low, *y_low};
    cell_ = {std::max(*x_high - *x_low, kLeastSide) / kCells,
             std::max(*y_high - *y_low, kLeastSide) / kCells};
    sortIn();
  }

  static constexpr std::size_t count() { return kCells * kCells; }
  // Indices of the points in a cell.
  std::span<const std::uint32_t> points(std::size_t cell) const {
    return {order_.data() + begin_[cell], begin_[cell + 1] - begin_[cell]};
  }
  Vector2d center(std::size_t cell) const {
    return origin_ + cell_.cwiseProduct(Vector2d(static_cast<double>(cell % kCells) + 0.5,
                                                 static_cast<double>(cell / kCells) + 0.5));
  }
  // No point of a cell is farther from its centre than this.
  double reach() const { return kReachSlack * cell_.norm() / 2; }

 private:
  static constexpr std::size_t kCells = 32;
  static constexpr double kLeastSide = 1e-9;  // metres: a face of no extent still has cells
  static constexpr double kReachSlack =
      1.0 + 1e-6;  // points on the edge of a cell may round into its neighbour

  std::size_t cellOf(std::size_t i) const {
    const auto column = static_cast<std::size_t>((face_.x[i] - origin_.x()) / cell_.x());
    const auto row = static_cast<std::size_t>((face_.y[i] - origin_.y()) / cell_.y());
    return std::min(row, kCells - 1) * kCells + std::min(column, kCells - 1);
  }

  void sortIn() {
    std::vector<std::uint32_t> cells(face_.size());
    for (std::size_t i = 0; i < face_.size(); ++i)
      ++begin_[(cells[i] = static_cast<std::uint32_t>(cellOf(i))) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    auto next = begin_;
    order_.resize(face_.size());
    for (std::size_t i = 0; i < face_.size(); ++i) order_[next[cells[i]]++] = static_cast<std::uint32_t>(i);
  }

  const FaceProjection& face_;
  Vector2d origin_, cell_;
  std::array<std::uint32_t, kCells * kCells + 1> begin_{};
  std::vector<std::uint32_t> order_;
};

// The few points of one face on which lines are bounded: sorted by x, then y, none twice.
class Subset {
 public:
  // Whether any of the points was new.
  bool add(std::vector<Vector2d> points) {
    std::sort(points.begin(), points.end(), before);
    std::vector<Vector2d> merged;
    merged.reserve(points_.size() + points.size());
    std::set_union(points_.begin(), points_.end(), points.begin(), points.end(), std::back_inserter(merged),
                   before);
    const bool grown = merged.size() > points_.size();
    points_ = std::move(merged);
    return grown;
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

// The extreme points, in eight directions, of every block of the grid's cells.
std::vector<Vector2d> blockExtremes(const FaceProjection& face) {
  constexpr std::array<std::array<double, 2>, 4> kDirections{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
  struct Extreme {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    std::size_t low_point = 0, high_point = 0;
  };
  const auto [x_low, x_high] = std::minmax_element(face.x.begin(), face.x.end());
  const auto [y_low, y_high] = std::minmax_element(face.y.begin(), face.y.end());
  const double x_scale = kBlocks / std::max(*x_high - *x_low, 1e-12),
               y_scale = kBlocks / std::max(*y_high - *y_low, 1e-12);
  std::vector<std::array<Extreme, 4>> blocks(kBlocks * kBlocks);
  for (std::size_t i = 0; i < face.size(); ++i) {
    const int column = std::min(kBlocks - 1, static_cast<int>((face.x[i] - *x_low) * x_scale));
    const int row = std::min(kBlocks - 1, static_cast<int>((face.y[i] - *y_low) * y_scale));
    for (std::size_t d = 0; d < kDirections.size(); ++d) {
      Extreme& extreme = blocks[static_cast<std::size_t>(row * kBlocks + column)][d];
      const double value = kDirections[d][0] * face.x[i] + kDirections[d][1] * face.y[i];
      if (value < extreme.low) extreme.low = value, extreme.low_point = i;
      if (value > extreme.high) extreme.high = value, extreme.high_point = i;
    }
  }
  std::vector<Vector2d> points;
  for (const auto& block : blocks) {
    for (const Extreme& extreme : block) {
      if (extreme.high < extreme.low) continue;
      points.push_back(face.point(extreme.low_point));
      points.push_back(face.point(extreme.high_point));
    }
  }
  return points;
}

// The hull of all points: of those that the hull of the extremes does not contain.
Polygon hullOf(const FaceProjection& face, const std::vector<Vector2d>& extremes) {
  const Polygon inner = convexHull(extremes);
  std::vector<Vector2d> candidates = extremes;
  for (std::size_t i = 0; i < face.size(); ++i) {
    if (!containsPoint(inner, face.point(i))) candidates.push_back(face.point(i));
  }
  return convexHull(candidates);
}

// One side of a line: the hull of the subset's points there. The subset has all vertices of the whole hull,
// so a point of this side can be outside only beyond an `open` edge: one that is not an edge of the whole
// hull.
class KnownSide {
 public:
  KnownSide(const std::vector<Vector2d>& points, const Polygon& whole) : hull_(convexHull(points)) {
    if (hull_.size() < 3) return;
    for (std::size_t i = 0; i < hull_.size(); ++i) {
      const Vector2d &a = hull_[i], &b = hull_[(i + 1) % hull_.size()];
      if (isEdge(whole, a, b)) continue;
      const Vector2d outward = Vector2d(b.y() - a.y(), a.x() - b.x()).normalized();
      open_.push_back({outward, outward.dot(a)});
    }
  }

  const Polygon& hull() const { return hull_; }
  // How far p is beyond the open edges: not positive inside.
  double excess(const Vector2d& p) const {
    if (hull_.size() < 3) return std::numeric_limits<double>::infinity();
    double excess = -std::numeric_limits<double>::infinity();
    for (const Line& edge : open_) excess = std::max(excess, edge.normal.dot(p) - edge.offset);
    return excess;
  }

 private:
  static bool isEdge(const Polygon& whole, const Vector2d& a, const Vector2d& b) {
    for (std::size_t i = 0; i < whole.size(); ++i) {
      if (whole[i] == a) return whole[(i + 1) % whole.size()] == b;
    }
    return false;
  }

  Polygon hull_;
  std::vector<Line> open_;
};

// One face of the search: its lines, and Theta of any of them bounded or exact.
class FaceSearch {
 public:
  FaceSearch(const FaceProjection& face, const DecompositionOptions& options)
      : face_(face), grid_(face), least_(leastPoints(face.size(), options.min_point_fraction)) {
    const std::vector<Vector2d> extremes = blockExtremes(face);
    hull_ = hullOf(face, extremes);
    subset_.add(extremes);
    subset_.add(hull_);
    lines_ = cutLines(hull_, options);
  }

  const std::vector<Line>& lines() const { return lines_; }
  int version() const { return version_; }
  double bound(std::size_t line) { return subset_.boundArea(lines_[line]) / face_.area; }

  // Theta on all points. Those that the subset's hulls did not contain join the subset.
  std::optional<double> exact(std::size_t index) {
    const Line& line = lines_[index];
    const Sides known = subset_.sides(line);
    const KnownSide first(known.first, hull_), second(known.second, hull_);
    Sides outer{first.hull(), second.hull()};
    const std::size_t on_first = gatherOutside(line, first, second, outer);
    const Polygon whole_first = convexHull(outer.first), whole_second = convexHull(outer.second);
    const bool first_grown = subset_.add(whole_first), second_grown = subset_.add(whole_second);
    version_ += first_grown || second_grown;
    if (on_first < least_ || face_.size() - on_first < least_) return std::nullopt;
    return (signedArea(whole_first) + signedArea(whole_second)) / face_.area;
  }

 private:
  // Adds the points outside the known hulls to `outer`; returns how many points are on the first side.
  std::size_t gatherOutside(const Line& line, const KnownSide& first, const KnownSide& second,
                            Sides& outer) const {
    std::size_t on_first = 0;
    for (std::size_t cell = 0; cell < CellGrid::count(); ++cell) {
      const std::span<const std::uint32_t> points = grid_.points(cell);
      if (points.empty()) continue;
      const Vector2d center = grid_.center(cell);
      const double distance = line.normal.dot(center) - line.offset;
      const bool parted = std::abs(distance) <= grid_.reach();
      if (!parted && (distance < 0 ? first : second).excess(center) < -grid_.reach()) {
        if (distance < 0) on_first += points.size();
        continue;
      }
      for (const std::uint32_t i : points) {
        const Vector2d p = face_.point(i);
        const bool is_first = line.normal.dot(p) <= line.offset;
        on_first += is_first;
        if ((is_first ? first : second).excess(p) > 0) (is_first ? outer.first : outer.second).push_back(p);
      }
    }
    return on_first;
  }

  const FaceProjection& face_;
  CellGrid grid_;
  std::size_t least_;
  Polygon hull_;  // of all points
  Subset subset_;
  std::vector<Line> lines_;
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
