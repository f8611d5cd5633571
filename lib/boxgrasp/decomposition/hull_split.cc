#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <queue>
#include <span>
#include <tuple>

#include "boxgrasp/base/parallel.h"
#include "boxgrasp/decomposition/angular_sweep.h"
#include "boxgrasp/decomposition/cut_lines.h"
#include "boxgrasp/decomposition/splits.h"

namespace boxgrasp {
namespace {

constexpr double kBoundSlack = 1e-11;  // a bound may exceed Theta by this rounding error

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

// The points of a face sorted into the cells of a grid, so that a line or a hull's edge meets few of them.
class CellGrid {
 public:
  explicit CellGrid(const FaceProjection& face) {
    const auto [x_low, x_high] = std::minmax_element(face.x.begin(), face.x.end());
    const auto [y_low, y_high] = std::minmax_element(face.y.begin(), face.y.end());
    origin_ = {*x_low, *y_low};
    cell_ = {std::max(*x_high - *x_low, kLeastSide) / kCells,
             std::max(*y_high - *y_low, kLeastSide) / kCells};
    sortIn(face);
  }

  static constexpr std::size_t kCells = 32;  // along each side of the face
  static constexpr std::size_t count() { return kCells * kCells; }
  std::span<const Vector2d> points(std::size_t cell) const {
    return {points_.data() + begin_[cell], begin_[cell + 1] - begin_[cell]};
  }
  Vector2d center(std::size_t cell) const {
    return origin_ + cell_.cwiseProduct(Vector2d(static_cast<double>(cell % kCells) + 0.5,
                                                 static_cast<double>(cell / kCells) + 0.5));
  }
  // No point of a cell is farther from its centre than this.
  double reach() const { return kReachSlack * cell_.norm() / 2; }

 private:
  static constexpr double kLeastSide = 1e-9;  // metres: a face of no extent still has cells
  static constexpr double kReachSlack =
      1.0 + 1e-6;  // points on the edge of a cell may round into its neighbour

  std::size_t cellOf(const Vector2d& p) const {
    const Vector2d place = (p - origin_).cwiseQuotient(cell_);
    return std::min(static_cast<std::size_t>(place.y()), kCells - 1) * kCells +
           std::min(static_cast<std::size_t>(place.x()), kCells - 1);
  }

  void sortIn(const FaceProjection& face) {
    std::vector<std::uint32_t> cells(face.size());
    for (std::size_t i = 0; i < face.size(); ++i)
      ++begin_[(cells[i] = static_cast<std::uint32_t>(cellOf(face.point(i)))) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    auto next = begin_;
    points_.resize(face.size());
    for (std::size_t i = 0; i < face.size(); ++i) points_[next[cells[i]]++] = face.point(i);
  }

  Vector2d origin_, cell_;
  std::array<std::uint32_t, kCells * kCells + 1> begin_{};
  std::vector<Vector2d> points_;
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

  const std::vector<Vector2d>& points() const { return points_; }

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

// The extreme points of a set in eight directions.
class Extremes {
 public:
  void add(const Vector2d& p) {
    const std::array<double, 4> values{p.x(), p.y(), p.x() + p.y(), p.x() - p.y()};
    for (std::size_t d = 0; d < values.size(); ++d) {
      if (values[d] < low_[d].value) low_[d] = {values[d], p};
      if (values[d] > high_[d].value) high_[d] = {values[d], p};
    }
  }
  void appendTo(std::vector<Vector2d>& points) const {
    if (low_[0].value > high_[0].value) return;
    for (std::size_t d = 0; d < low_.size(); ++d)
      points.insert(points.end(), {low_[d].point, high_[d].point});
  }

 private:
  struct Extreme {
    double value;
    Vector2d point{0, 0};
  };
  static std::array<Extreme, 4> allAt(double value) { return {{{value}, {value}, {value}, {value}}}; }

  std::array<Extreme, 4> low_ = allAt(std::numeric_limits<double>::infinity()),
                         high_ = allAt(-std::numeric_limits<double>::infinity());
};

// The extreme points of square blocks of cells.
std::vector<Vector2d> blockExtremes(const CellGrid& grid) {
  constexpr std::size_t kBlock = 8, kBlocks = CellGrid::kCells / kBlock;
  std::vector<Extremes> blocks(kBlocks * kBlocks);
  for (std::size_t cell = 0; cell < CellGrid::count(); ++cell) {
    const std::size_t row = cell / CellGrid::kCells / kBlock, column = cell % CellGrid::kCells / kBlock;
    for (const Vector2d& p : grid.points(cell)) blocks[row * kBlocks + column].add(p);
  }
  std::vector<Vector2d> points;
  for (const Extremes& block : blocks) block.appendTo(points);
  return points;
}

// The hull of known points on one side of a line, or of all of them.
class KnownSide {
 public:
  // Edges of `whole`, the hull of all points on both sides, have nothing beyond them.
  explicit KnownSide(const std::vector<Vector2d>& points, const Polygon& whole = {})
      : hull_(convexHull(points)) {
    if (hull_.size() < 3) {
      open_.push_back({Vector2d::Zero(), -1.0});  // every point is beyond it
      return;
    }
    std::size_t at = 0;
    for (std::size_t i = 0; i < hull_.size(); ++i) {
      const Vector2d &a = hull_[i], &b = hull_[(i + 1) % hull_.size()];
      if (isEdge(whole, a, b, at)) continue;
      const Vector2d outward = Vector2d(b.y() - a.y(), a.x() - b.x()).normalized();
      open_.push_back({outward, outward.dot(a)});
    }
  }

  const Polygon& hull() const { return hull_; }
  // The edges that points within `reach` of `center` can be beyond.
  void edgesNear(const Vector2d& center, double reach, std::vector<Line>& edges) const {
    edges.clear();
    for (const Line& edge : open_) {
      const double height = edge.normal.dot(center) - edge.offset;
      if (height > -reach) edges.push_back(edge);
    }
  }

 private:
  // Both hulls run the same way, so the search goes on from where the last vertex was found.
  static bool isEdge(const Polygon& whole, const Vector2d& a, const Vector2d& b, std::size_t& at) {
    const std::size_t n = whole.size();
    for (std::size_t step = 0; step < n; ++step) {
      if (whole[(at + step) % n] != a) continue;
      at = (at + step) % n;
      return whole[(at + 1) % n] == b;
    }
    return false;
  }

  Polygon hull_;
  std::vector<Line> open_;
};

bool beyondAny(const std::vector<Line>& edges, const Vector2d& p) {
  return std::any_of(edges.begin(), edges.end(),
                     [&p](const Line& edge) { return edge.normal.dot(p) > edge.offset; });
}

// The hull of all points: of those that the hull of the extremes does not contain.
Polygon hullOf(const CellGrid& grid, const std::vector<Vector2d>& extremes) {
  const KnownSide known(extremes);
  std::vector<Vector2d> candidates = extremes;
  std::vector<Line> edges;
  for (std::size_t cell = 0; cell < CellGrid::count(); ++cell) {
    known.edgesNear(grid.center(cell), grid.reach(), edges);
    if (edges.empty()) continue;
    for (const Vector2d& p : grid.points(cell)) {
      if (beyondAny(edges, p)) candidates.push_back(p);
    }
  }
  return convexHull(std::move(candidates));
}

// One face of the search: its lines, and Theta of any of them bounded or exact.
class FaceSearch {
 public:
  FaceSearch(const FaceProjection& face, const DecompositionOptions& options)
      : face_(face), grid_(face), least_(leastPoints(face.size(), options.min_point_fraction)) {
    const std::vector<Vector2d> extremes = blockExtremes(grid_);
    hull_ = hullOf(grid_, extremes);
    subset_.add(extremes);
    subset_.add(hull_);
    fans_ = cutFans(hull_, options);
    lines_ = cutLines(fans_);
  }

  const std::vector<Line>& lines() const { return lines_; }
  int version() const { return version_; }

  // The first bounds of all lines.
  std::vector<double> bounds() const {
    std::vector<double> bounds;
    AngularSweep sweep;
    for (const CutFan& fan : fans_) {
      sweep.sweep(subset_.points(), fan.apex, centroid(hull_));
      for (const Line& line : fan.lines)
        bounds.push_back(sweep.area({line.normal.y(), -line.normal.x()}) / face_.area);
    }
    return bounds;
  }

  // The bound of one line, on all that exact() has added to the subset since.
  double bound(std::size_t line) { return subset_.boundArea(lines_[line]) / face_.area; }

  // Theta on all points. Those that the subset's hulls did not contain join the subset.
  std::optional<double> exact(std::size_t index) {
    const Line& line = lines_[index];
    const Sides known = subset_.sides(line);
    const KnownSide first(known.first, hull_), second(known.second, hull_);
    Sides outside;
    const std::size_t on_first = gatherOutside(line, first, second, outside);
    const double area = grownArea(first.hull(), outside.first) + grownArea(second.hull(), outside.second);
    if (on_first < least_ || face_.size() - on_first < least_) return std::nullopt;
    return area / face_.area;
  }

 private:
  // The area of the hull of a known hull and points outside of it. Its new vertices join the subset.
  double grownArea(const Polygon& known, const std::vector<Vector2d>& outside) {
    if (outside.empty()) return signedArea(known);
    std::vector<Vector2d> points = known;
    points.insert(points.end(), outside.begin(), outside.end());
    const Polygon grown = convexHull(std::move(points));
    version_ += subset_.add(grown);
    return signedArea(grown);
  }

  // Adds the points outside the known hulls to `outside`; returns how many points are on the first side.
  std::size_t gatherOutside(const Line& line, const KnownSide& first, const KnownSide& second,
                            Sides& outside) const {
    std::size_t on_first = 0;
    std::vector<Line> first_edges, second_edges;
    for (std::size_t cell = 0; cell < CellGrid::count(); ++cell) {
      const std::span<const Vector2d> points = grid_.points(cell);
      if (points.empty()) continue;
      const Vector2d center = grid_.center(cell);
      const double distance = line.normal.dot(center) - line.offset;
      const bool parted = std::abs(distance) <= grid_.reach();
      if (parted || distance < 0) first.edgesNear(center, grid_.reach(), first_edges);
      if (parted || distance > 0) second.edgesNear(center, grid_.reach(), second_edges);
      if (!parted && (distance < 0 ? first_edges : second_edges).empty()) {
        if (distance < 0) on_first += points.size();
        continue;
      }
      for (const Vector2d& p : points) {
        const bool is_first = line.normal.dot(p) <= line.offset;
        on_first += is_first;
        if (beyondAny(is_first ? first_edges : second_edges, p))
          (is_first ? outside.first : outside.second).push_back(p);
      }
    }
    return on_first;
  }

  const FaceProjection& face_;
  CellGrid grid_;
  std::size_t least_;
  Polygon hull_;  // of all points
  Subset subset_;
  std::vector<CutFan> fans_;
  std::vector<Line> lines_;  // of all fans
  int version_ = 0;          // of the subset
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
  while (!queue.empty() && (!best || queue.top().bound <= best->theta + kBoundSlack)) {
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
  parallelFor(faces.size(), options.threads, [&](std::size_t f) { bounds[f] = searches[f].bounds(); });
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
    for (const Line& line : cutLines(cutFans(convexHull(std::move(points)), options))) {
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
