#include "boxgrasp/decomposition/shape.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/simd.h"

namespace boxgrasp {
namespace shape_passes {

constexpr std::size_t kLanes = 8;

struct Sphere {
  double x, y, z, radius;
};

BOXGRASP_SIMD_PART double lengthOf(double x, double y, double z) { return std::sqrt(x * x + y * y + z * z); }

BOXGRASP_SIMD void distancesTo(const Sphere& to, const double* px, const double* py, const double* pz,
                               std::size_t n, double* distances) {
  const Sphere s = to;
  for (std::size_t i = 0; i < n; ++i)
    distances[i] = std::abs(lengthOf(px[i] - s.x, py[i] - s.y, pz[i] - s.z) - s.radius);
}

// Of the weighed products of (direction, 1) with itself, the upper half, and with the signed distance.
struct Sums {
  alignas(64) double xx[kLanes], xy[kLanes], xz[kLanes], x[kLanes], yy[kLanes], yz[kLanes], y[kLanes],
      zz[kLanes], z[kLanes], one[kLanes], right_x[kLanes], right_y[kLanes], right_z[kLanes], right[kLanes];
};

// Tukey's weights: nothing counts that is as far from the sphere as the bound. Pre: n is a multiple of
// kLanes.
BOXGRASP_SIMD void sumWeighed(const Sphere& to, double bound, const double* px, const double* py,
                              const double* pz, std::size_t n, Sums& sums) {
  const Sphere s = to;
  Sums all{};
  for (std::size_t begin = 0; begin < n; begin += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k) {
      const std::size_t i = begin + k;
      const double dx = px[i] - s.x, dy = py[i] - s.y, dz = pz[i] - s.z, length = lengthOf(dx, dy, dz);
      const double far = length - s.radius, ratio = std::abs(far) / bound, share = 1.0 - ratio * ratio;
      const bool counts = (ratio < 1.0) & (length > 0.0);
      const double weight = counts ? share * share : 0.0, per_length = counts ? 1.0 / length : 0.0;
      const double x = dx * per_length, y = dy * per_length, z = dz * per_length;
      all.xx[k] += weight * x * x;
      all.xy[k] += weight * x * y;
      all.xz[k] += weight * x * z;
      all.x[k] += weight * x;
      all.yy[k] += weight * y * y;
      all.yz[k] += weight * y * z;
      all.y[k] += weight * y;
      all.zz[k] += weight * z * z;
      all.z[k] += weight * z;
      all.one[k] += weight;
      all.right_x[k] += weight * far * x;
      all.right_y[k] += weight * far * y;
      all.right_z[k] += weight * far * z;
      all.right[k] += weight * far;
    }
  }
  sums = all;
}

}  // namespace shape_passes

namespace {

constexpr int kCells = 10;        // along each edge of the six sides that the directions are counted on
constexpr double kTrusted = 0.8;  // share of the points that residuals are taken over
constexpr double kMiddle = 0.8;   // share of a cylinder's length that is sure to be its side
constexpr double kTukey = 4.685;  // of the weights, in standard deviations
constexpr double kToDeviation = 1.4826;              // from the median distance
constexpr int kRounds = 20;                          // of the fit at most
constexpr double kSettled_m = 1e-7;                  // a step so small is the last
constexpr double kRounding_m = 1e-6;                 // a scale of distances below this is as good as none
constexpr int kSectors = 36;                         // in which arcs are counted
constexpr double kLeastSize = 0.4, kMostSize = 1.2;  // diameter in shares of the box's widest extent across

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double trimmedRms(std::vector<double> distances) {
  const auto n =
      std::max<std::size_t>(1, static_cast<std::size_t>(kTrusted * static_cast<double>(distances.size())));
  std::sort(distances.begin(), distances.end());
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) sum += distances[i] * distances[i];
  return std::sqrt(sum / static_cast<double>(n));
}

// A circle (2 dimensions) or a sphere (3).
template <int Dim>
struct Ball {
  using Point = Eigen::Matrix<double, Dim, 1>;
  Point center = Point::Zero();
  double radius = 0.0;
  double distance(const Point& p) const { return std::abs((p - center).norm() - radius); }
};

// The coordinates of points, in whole lanes: those that fill the last are far away.
template <int Dim>
class Coordinates {
 public:
  explicit Coordinates(const std::vector<typename Ball<Dim>::Point>& points) : size_(points.size()) {
    constexpr double kFarAway_m = 1e6;
    const std::size_t room = (size_ + shape_passes::kLanes - 1) / shape_passes::kLanes * shape_passes::kLanes;
    for (int axis = 0; axis < 3; ++axis) values_[axis].assign(room, axis < Dim ? kFarAway_m : 0.0);
    for (std::size_t i = 0; i < size_; ++i) {
      for (int axis = 0; axis < Dim; ++axis) values_[axis][i] = points[i][axis];
    }
  }

  double medianDistance(const Ball<Dim>& ball) const {
    std::vector<double> distances(size_);
    shape_passes::distancesTo(sphere(ball), values_[0].data(), values_[1].data(), values_[2].data(), size_,
                              distances.data());
    return median(std::move(distances));
  }

  // Sets up the normal equations of the step that brings a ball nearer to the points.
  void setUp(const Ball<Dim>& ball, double bound, Eigen::Matrix<double, Dim + 1, Dim + 1>& normal,
             Eigen::Matrix<double, Dim + 1, 1>& right) const {
    shape_passes::Sums sums;
    shape_passes::sumWeighed(sphere(ball), bound, values_[0].data(), values_[1].data(), values_[2].data(),
                             values_[0].size(), sums);
    const auto sum = [](const double* lanes) {
      return std::accumulate(lanes, lanes + shape_passes::kLanes, 0.0);
    };
    Eigen::Matrix4d all;
    all << sum(sums.xx), sum(sums.xy), sum(sums.xz), sum(sums.x), 0, sum(sums.yy), sum(sums.yz), sum(sums.y),
        0, 0, sum(sums.zz), sum(sums.z), 0, 0, 0, sum(sums.one);
    const Eigen::Vector4d all_right(sum(sums.right_x), sum(sums.right_y), sum(sums.right_z), sum(sums.right));
    const auto of = [](int i) { return i < Dim ? i : 3; };
    for (int row = 0; row <= Dim; ++row) {
      right[row] = all_right[of(row)];
      for (int column = row; column <= Dim; ++column)
        normal(row, column) = normal(column, row) = all(of(row), of(column));
    }
  }

 private:
  static shape_passes::Sphere sphere(const Ball<Dim>& ball) {
    return {ball.center[0], ball.center[1], Dim == 3 ? ball.center[Dim - 1] : 0.0, ball.radius};
  }

  std::size_t size_;
  std::array<std::vector<double>, 3> values_;
};

// Of least squared distances, weighed by Tukey's function of them; nullopt where points do not determine it.
template <int Dim>
std::optional<Ball<Dim>> fitBall(const std::vector<typename Ball<Dim>::Point>& points, double start_radius) {
  const Coordinates<Dim> coordinates(points);
  Ball<Dim> ball{Ball<Dim>::Point::Zero(), start_radius};
  for (int round = 0; round < kRounds; ++round) {
    const double bound = kTukey * std::max(kRounding_m, kToDeviation * coordinates.medianDistance(ball));
    Eigen::Matrix<double, Dim + 1, Dim + 1> normal;
    Eigen::Matrix<double, Dim + 1, 1> right;
    coordinates.setUp(ball, bound, normal, right);
    const Eigen::LDLT<decltype(normal)> solver(normal);
    if (!solver.isPositive() || solver.rcond() < 1e-6) return std::nullopt;
    const decltype(right) step = solver.solve(right);
    ball.center += step.template head<Dim>();
    ball.radius += step[Dim];
    if (step.norm() < kSettled_m) break;
  }
  return ball.radius > 0 && ball.center.allFinite() ? std::optional(ball) : std::nullopt;
}

// The points that count, in B.
std::vector<Vector3d> outermost(const PointCloud& cloud_C, const std::vector<std::uint32_t>& points,
                                const OrientedBox& box) {
  struct Cell {
    double out = 0.0;
    Vector3d p_B = Vector3d::Zero();
  };
  std::vector<Cell> cells(6 * kCells * kCells);
  const Pose X_BC = box.X_CB.inverse();
  for (const std::uint32_t i : points) {
    const Vector3d p_B = X_BC * cloud_C.point(i), d = 2 * p_B.cwiseQuotient(box.extents);
    int axis = 0;
    const double out = d.cwiseAbs().maxCoeff(&axis);
    if (out <= 0) continue;
    const auto cellAt = [&](double share) {
      return std::clamp(static_cast<int>((share / out + 1) / 2 * kCells), 0, kCells - 1);
    };
    const int side = 2 * axis + (d[axis] > 0);
    Cell& cell = cells[static_cast<std::size_t>((side * kCells + cellAt(d[(axis + 1) % 3])) * kCells +
                                                cellAt(d[(axis + 2) % 3]))];
    if (out > cell.out) cell = {out, p_B};
  }
  std::vector<Vector3d> kept;
  for (const Cell& cell : cells) {
    if (cell.out > 0) kept.push_back(cell.p_B);
  }
  return kept;
}

double boxResidual(const std::vector<Vector3d>& points_B, const OrientedBox& box) {
  std::vector<double> distances;
  for (const Vector3d& p : points_B)
    distances.push_back((0.5 * box.extents - p.cwiseAbs()).cwiseAbs().minCoeff());
  return trimmedRms(std::move(distances));
}

// The angle around the centre that points near the circle cover.
double arcOf(const std::vector<Vector2d>& points, const Ball<2>& circle) {
  std::array<bool, kSectors> covered{};
  for (const Vector2d& p : points) {
    if (circle.distance(p) > 0.1 * circle.radius) continue;
    const Vector2d d = p - circle.center;
    const double turn = (std::atan2(d.y(), d.x()) + std::numbers::pi) / (2 * std::numbers::pi);
    covered[static_cast<std::size_t>(std::clamp(static_cast<int>(turn * kSectors), 0, kSectors - 1))] = true;
  }
  return 2 * std::numbers::pi / kSectors *
         static_cast<double>(std::count(covered.begin(), covered.end(), true));
}

bool fitsInto(double radius, double widest) {
  return 2 * radius >= kLeastSize * widest && 2 * radius <= kMostSize * widest;
}

void tryCylinder(const std::vector<Vector3d>& points_B, const OrientedBox& box, int axis,
                 const ShapeOptions& options, BoxShape& best) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double half = 0.5 * box.extents[axis], widest = std::max(box.extents[u], box.extents[v]);
  std::vector<Vector2d> side;
  for (const Vector3d& p : points_B) {
    if (std::abs(p[axis]) < kMiddle * half) side.emplace_back(p[u], p[v]);
  }
  if (static_cast<int>(side.size()) < options.min_cells / 2) return;
  const auto circle = fitBall<2>(side, 0.5 * widest);
  if (!circle || !fitsInto(circle->radius, widest) || arcOf(side, *circle) < options.min_arc_rad) return;
  std::vector<double> distances;
  for (const Vector3d& p : points_B)
    distances.push_back(std::min(circle->distance({p[u], p[v]}), std::abs(half - std::abs(p[axis]))));
  const double residual = trimmedRms(std::move(distances));
  if (residual >= best.residual_m[1]) return;
  Vector3d center_B = Vector3d::Zero();
  center_B[u] = circle->center.x();
  center_B[v] = circle->center.y();
  best.residual_m[1] = residual;
  best.center_C = box.X_CB * center_B;
  best.axis_C = box.X_CB.linear().col(axis);
  best.radius_m = circle->radius;
}

struct Sphere {
  Ball<3> ball;
  double residual_m;
};

std::optional<Sphere> sphereIn(const std::vector<Vector3d>& points_B, const OrientedBox& box,
                               const ShapeOptions& options) {
  const double widest = box.extents.maxCoeff();
  const auto ball = fitBall<3>(points_B, 0.5 * widest);
  if (!ball || !fitsInto(ball->radius, widest)) return std::nullopt;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Vector2d> belt;
    for (const Vector3d& p : points_B) {
      const Vector3d d = p - ball->center;
      if (std::abs(d[axis]) < 0.5 * ball->radius)
        belt.push_back(Vector2d(d[(axis + 1) % 3], d[(axis + 2) % 3]).normalized());
    }
    if (arcOf(belt, {Vector2d::Zero(), 1.0}) < options.min_arc_rad) return std::nullopt;
  }
  std::vector<double> distances;
  for (const Vector3d& p : points_B) distances.push_back(ball->distance(p));
  return Sphere{*ball, trimmedRms(std::move(distances))};
}

}  // namespace

std::string_view describe(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::box:
      return "box";
    case ShapeKind::cylinder:
      return "cylinder";
    case ShapeKind::sphere:
      return "sphere";
  }
  return "unknown";
}

void ShapeOptions::validate() const {
  requireOption(min_cells >= 10 && min_cells <= 600, "shapes.min_cells", min_cells, "in [10, 600]");
  requireOption(max_residual_share > 0 && max_residual_share <= 1, "shapes.max_residual_share",
                max_residual_share, "in (0, 1]");
  requireOption(min_arc_rad > 0 && min_arc_rad <= 2 * std::numbers::pi, "shapes.min_arc_rad", min_arc_rad,
                "in (0, 2 pi]");
}

BoxShape shapeOf(const PointCloud& cloud_C, const std::vector<std::uint32_t>& points, const OrientedBox& box,
                 const ShapeOptions& options) {
  options.validate();
  BoxShape shape{.center_C = box.X_CB.translation()};
  const std::vector<Vector3d> points_B = outermost(cloud_C, points, box);
  if (static_cast<int>(points_B.size()) < options.min_cells) return shape;
  shape.residual_m[0] = boxResidual(points_B, box);
  for (int axis = 0; axis < 3; ++axis) tryCylinder(points_B, box, axis, options, shape);
  const auto sphere = sphereIn(points_B, box, options);
  if (sphere) shape.residual_m[2] = sphere->residual_m;
  const double most = options.max_residual_share * shape.residual_m[0];
  if (sphere && sphere->residual_m < shape.residual_m[1] && sphere->residual_m < most) {
    shape.kind = ShapeKind::sphere;
    shape.center_C = box.X_CB * sphere->ball.center;
    shape.axis_C.setZero();
    shape.radius_m = sphere->ball.radius;
  } else if (shape.residual_m[1] < most) {
    shape.kind = ShapeKind::cylinder;
  } else {
    shape.center_C = box.X_CB.translation();
    shape.axis_C.setZero();
    shape.radius_m = 0.0;
  }
  return shape;
}

std::vector<BoxShape> shapesOf(const PointCloud& cloud_C, const BoxTree& tree, const ShapeOptions& options) {
  std::vector<BoxShape> shapes;
  for (const BoxNode& node : tree.nodes)
    shapes.push_back(node.leaf() ? shapeOf(cloud_C, node.points, node.box, options)
                                 : BoxShape{.center_C = node.box.X_CB.translation()});
  return shapes;
}

}  // namespace boxgrasp
