#include "boxgrasp/objects/depth_camera.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/objects/ray_caster.h"

namespace boxgrasp {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr double kShadowMargin = 5e-4;  // metres: a surface does not shadow itself

Eigen::AlignedBox3d boxOf(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : mesh.vertices) box.extend(p);
  return box;
}

TriangleMesh tableUnder(const TriangleMesh& object) {
  constexpr double kHalfSide = 1.0;
  const Eigen::AlignedBox3d box = boxOf(object);
  TriangleMesh table;
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    table.vertices.push_back(
        {box.center().x() + x * kHalfSide, box.center().y() + y * kHalfSide, box.min().z()});
  }
  table.triangles = {{0, 1, 2}, {0, 2, 3}};
  return table;
}

std::vector<TriangleMesh> meshesOf(const DepthScene& scene) {
  std::vector<TriangleMesh> meshes{scene.object_O};
  meshes.insert(meshes.end(), scene.others_O.begin(), scene.others_O.end());
  if (scene.table) meshes.push_back(tableUnder(scene.object_O));
  return meshes;
}

Vector3d pixelRay(const DepthView& view, double column, double row) {
  return {(column - 0.5 * (view.width_px - 1)) / view.focal_px,
          (row - 0.5 * (view.height_px - 1)) / view.focal_px, 1.0};
}

class Exposure {
 public:
  Exposure(const DepthScene& scene, const Pose& X_OS, const DepthCameraOptions& options)
      : options_(options), rays_(meshesOf(scene)), others_(scene.others_O.size()), random_(options.seed) {
    view_.width_px = options.width_px;
    view_.height_px = options.height_px;
    view_.focal_px = options.focal_px;
    view_.X_OS = X_OS;
    projector_O_ = X_OS * Vector3d(options.baseline_m, 0, 0);
  }

  DepthView run(const StopToken& stop) {
    for (int row = 0; row < view_.height_px; ++row) {
      stop.check();
      for (int column = 0; column < view_.width_px; ++column) measure(column, row);
    }
    loseEdges();
    return std::move(view_);
  }

 private:
  // Takes the same count of random numbers for each pixel, so that what one pixel sees changes no other.
  void measure(int column, int row) {
    const double du = options_.lateral_noise_px * normal(random_),
                 dv = options_.lateral_noise_px * normal(random_), noise = normal(random_);
    const Vector3d direction_O = view_.X_OS.linear() * pixelRay(view_, column + du, row + dv);
    const auto hit = rays_.first(view_.X_OS.translation(), direction_O);
    view_.depth_m.push_back(hit && isLit(*hit, direction_O) ? reading(hit->distance, noise) : kNothing);
    view_.thing.push_back(hit ? thingOf(hit->mesh) : SeenThing::table);
  }

  SeenThing thingOf(std::size_t mesh) const {
    if (mesh == 0) return SeenThing::object;
    return mesh <= others_ ? SeenThing::other : SeenThing::table;
  }

  bool isLit(const RayHit& hit, const Vector3d& direction_O) const {
    const double cosine = std::abs(hit.normal.dot(direction_O.normalized()));
    if (cosine < std::cos(options_.max_incidence_rad)) return false;
    const Vector3d p_O = view_.X_OS.translation() + hit.distance * direction_O;
    return !options_.projector_shadow || !rays_.blocked(p_O, projector_O_, kShadowMargin);
  }

  float reading(double depth, double noise) const {
    const double scale = options_.focal_px * options_.baseline_m;
    if (options_.disparity_noise_px > 0.0)
      depth = scale / (scale / depth + options_.disparity_noise_px * noise);
    if (options_.disparity_step_px > 0.0) {
      depth = scale / (options_.disparity_step_px * std::round(scale / depth / options_.disparity_step_px));
    }
    const bool inRange = depth >= options_.min_depth_m && depth <= options_.max_depth_m;
    return inRange ? static_cast<float>(depth) : kNothing;
  }

  bool isEdge(int column, int row) const {
    const float depth = depthAt(column, row);
    for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      const int x = column + dx, y = row + dy;
      if (x < 0 || y < 0 || x >= view_.width_px || y >= view_.height_px) continue;
      if (!(std::abs(depthAt(x, y) - depth) < options_.edge_jump_m)) return true;
    }
    return false;
  }

  float depthAt(int column, int row) const {
    return view_.depth_m[static_cast<std::size_t>(row) * static_cast<std::size_t>(view_.width_px) +
                         static_cast<std::size_t>(column)];
  }

  void loseEdges() {
    std::vector<float> kept;
    kept.reserve(view_.depth_m.size());
    for (int row = 0; row < view_.height_px; ++row) {
      for (int column = 0; column < view_.width_px; ++column) {
        const bool unlucky = uniform(random_) < options_.edge_loss;
        kept.push_back(unlucky && isEdge(column, row) ? kNothing : depthAt(column, row));
      }
    }
    view_.depth_m = std::move(kept);
  }

  const DepthCameraOptions& options_;
  RayCaster rays_;
  std::size_t others_;
  std::mt19937_64 random_;
  Vector3d projector_O_;
  DepthView view_;
};

PointCloud cloudOf(const DepthView& view, bool object_alone) {
  PointCloud cloud;
  for (std::size_t i = 0; i < view.depth_m.size(); ++i) {
    if (std::isnan(view.depth_m[i]) || (object_alone && view.thing[i] != SeenThing::object)) continue;
    const auto width = static_cast<std::size_t>(view.width_px);
    const Vector3d ray_S = pixelRay(view, static_cast<double>(i % width), static_cast<double>(i / width));
    cloud.push(view.X_OS * (view.depth_m[i] * ray_S));
  }
  return cloud;
}

void requireShare(double value, std::string_view field) {
  requireOption(value >= 0.0 && value <= 1.0, field, value, "in [0, 1]");
}

void requireNotNegative(double value, std::string_view field) {
  requireOption(std::isfinite(value) && value >= 0.0, field, value, "finite and at least 0");
}

}  // namespace

void DepthCameraOptions::validate() const {
  requireOption(width_px >= 1 && width_px <= 8192, "width_px", width_px, "in [1, 8192]");
  requireOption(height_px >= 1 && height_px <= 8192, "height_px", height_px, "in [1, 8192]");
  requireOption(std::isfinite(focal_px) && focal_px > 0.0, "focal_px", focal_px, "finite and above 0");
  requireOption(std::isfinite(baseline_m) && baseline_m > 0.0, "baseline_m", baseline_m,
                "finite and above 0");
  requireNotNegative(disparity_noise_px, "disparity_noise_px");
  requireNotNegative(disparity_step_px, "disparity_step_px");
  requireNotNegative(lateral_noise_px, "lateral_noise_px");
  requireOption(max_incidence_rad > 0.0 && max_incidence_rad <= 0.5 * std::numbers::pi, "max_incidence_rad",
                max_incidence_rad, "in (0, pi/2]");
  requireShare(edge_loss, "edge_loss");
  requireNotNegative(edge_jump_m, "edge_jump_m");
  requireNotNegative(min_depth_m, "min_depth_m");
  requireOption(max_depth_m > min_depth_m, "max_depth_m", max_depth_m, "above min_depth_m");
}

DepthCameraOptions DepthCameraOptions::withoutErrors() const {
  DepthCameraOptions perfect = *this;
  perfect.disparity_noise_px = perfect.disparity_step_px = perfect.lateral_noise_px = perfect.edge_loss = 0.0;
  perfect.max_incidence_rad = 0.5 * std::numbers::pi;
  perfect.projector_shadow = false;
  return perfect;
}

PointCloud DepthView::objectCloud_O() const { return cloudOf(*this, true); }
PointCloud DepthView::fullCloud_O() const { return cloudOf(*this, false); }

DepthView seeFrom(const DepthScene& scene, const Pose& X_OS, const DepthCameraOptions& options,
                  const StopToken& stop) {
  options.validate();
  return Exposure(scene, X_OS, options).run(stop);
}

void ViewRingOptions::validate() const {
  requireOption(views >= 1 && views <= 1000, "views", views, "in [1, 1000]");
  requireOption(std::abs(elevation_rad) < 1.5, "elevation_rad", elevation_rad, "in (-1.5, 1.5)");
  requireOption(std::isfinite(distance_m) && distance_m > 0.0, "distance_m", distance_m,
                "finite and above 0");
}

std::vector<NamedPose> viewRing(const TriangleMesh& object_O, const ViewRingOptions& options) {
  options.validate();
  const Vector3d center_O = boxOf(object_O).center();
  std::vector<NamedPose> views;
  for (int i = 0; i < options.views; ++i) {
    const double azimuth = 2.0 * std::numbers::pi * i / options.views - 0.5 * std::numbers::pi;
    const Vector3d outward(std::cos(options.elevation_rad) * std::cos(azimuth),
                           std::cos(options.elevation_rad) * std::sin(azimuth),
                           std::sin(options.elevation_rad));
    Matrix3d axes;
    axes.col(2) = -outward;
    axes.col(0) = Vector3d::UnitZ().cross(outward).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    views.push_back({fmt::format("view{}", i), makePose(axes, center_O + options.distance_m * outward)});
  }
  return views;
}

}  // namespace boxgrasp
