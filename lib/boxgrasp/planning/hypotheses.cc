#include "boxgrasp/planning/hypotheses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "boxgrasp/base/error.h"
#include "boxgrasp/planning/object_grasps.h"
#include "boxgrasp/planning/obstacles.h"

namespace boxgrasp {
namespace {

constexpr double kSceneCell_m = 0.010;  // of the grid over all points: about a link's radius
constexpr double kTableReach_m =
    0.20;  // the table is filled in this far around an object: an open hand's span
constexpr double kTableSpacing_m = 0.005;

// What all stages share.
PlannerOptions shared(PlannerOptions options, double friction) {
  requireOption(friction > 0 && friction <= 3, "friction", friction, "in (0, 3]");
  options.triplets.friction = friction;
  options.configurations.friction = friction;
  options.scene.threads = options.clean.threads = options.decomposition.threads = options.threads;
  return options;
}

std::optional<Vector3d> unitGravity(const PlanRequest& request, const Robot& robot,
                                    const std::optional<Plane>& table) {
  if (!request.gravity_C && robot.gravity_C()) return robot.gravity_C();
  if (!request.gravity_C) return table ? std::optional<Vector3d>(-table->normal_C) : std::nullopt;
  const double norm = request.gravity_C->norm();
  requireOption(std::isfinite(norm) && norm > 0, "gravity", norm, "a finite vector that is not zero");
  return *request.gravity_C / norm;
}

// The request's table with a unit normal.
std::optional<Plane> givenTable(const PlanRequest& request) {
  if (!request.table_C) return std::nullopt;
  const double norm = request.table_C->normal_C.norm();
  requireOption(std::isfinite(norm) && norm > 0, "the table's normal", norm,
                "a finite vector that is not zero");
  return Plane{request.table_C->normal_C / norm, request.table_C->offset_m / norm};
}

void checkViewpoints(const Viewpoints& viewpoints_C) {
  requireOption(viewpoints_C.size() <= kMaxViewpoints, "number of viewpoints", viewpoints_C.size(),
                fmt::format("at most {}", kMaxViewpoints));
  for (const Vector3d& viewpoint_C : viewpoints_C) {
    for (const double coordinate_m : viewpoint_C)
      requireOption(std::isfinite(coordinate_m), "viewpoint", coordinate_m, "finite");
  }
}

// The rest of the scene, without the points of any object.
PointCloud background(const PointCloud& cloud_C, const Scene& scene) {
  if (scene.isolated) return {};
  std::vector<bool> taken(cloud_C.size(), false);
  for (const auto& object : scene.objects) {
    for (const auto i : object) taken[i] = true;
  }
  std::vector<std::uint32_t> rest;
  for (std::uint32_t i = 0; i < cloud_C.size(); ++i) {
    if (!taken[i]) rest.push_back(i);
  }
  return select(cloud_C, rest);
}

// One plan, from request to result. Each method is a stage of the paper.
class HypothesisSearch {
 public:
  HypothesisSearch(const HandDescription& hand, const PlannerOptions& options, PlanRequest request,
                   const StopToken& stop, PlanTrace* trace, PlanResult& result, Tally& tally)
      : hand_(hand),
        request_(std::move(request)),
        stop_(stop),
        trace_(trace),
        result_(result),
        tally_(tally),
        options_(shared(options, request_.friction)),
        robot_(options.robot, request_.robot) {}

  void run() {
    checkViewpoints(request_.viewpoints_C);
    FiniteCloud finite = validated(std::exchange(request_.cloud_C, {}), options_.validation);
    noteNonFinite(finite);
    takeSceneApart(finite.cloud_C);
    cleanObjects(std::move(finite.cloud_C));
    completeObjects();
    decomposeObjects();
    graspObjects();
  }

 private:
  void note(std::string text) { result_.report.notes.push_back(std::move(text)); }

  void noteNonFinite(const FiniteCloud& finite) {
    if (finite.non_finite == 0) return;
    note(fmt::format("{} of {} points are not finite and were dropped", finite.non_finite,
                     finite.cloud_C.size() + finite.non_finite));
    tally_.reject("point not finite", finite.non_finite);
  }

  void takeSceneApart(const PointCloud& cloud_C) {
    const StageTimer timer(tally_, StageId::scene);
    scene_ = takeApart(cloud_C, options_.scene, stop_, someViewpoint(), givenTable(request_));
    tally_.count(StageId::scene, cloud_C.size(), scene_.objects.size());
    tally_.reject("point of the background", scene_.background_points);
    tally_.reject("point of a small cluster", scene_.small_cluster_points);
    if (scene_.table)
      note(fmt::format("a table was {} ({} points) and {} objects on it",
                       request_.table_C ? "given" : "found", scene_.table_points, scene_.objects.size()));
    const int objects = static_cast<int>(scene_.objects.size());
    if (request_.object >= objects && objects > 0) {
      throw InputError(
          fmt::format("object {} was asked for, but the scene has {} (numbered from 0, the largest first)",
                      request_.object, objects));
    }
    surroundings_ = {unitGravity(request_, robot_, scene_.table), request_.viewpoints_C};
  }

  // A cloud of one object need not be copied.
  CleanCloud cleanObject(const PointCloud& cloud_C, const std::vector<std::uint32_t>& points) const {
    if (points.size() == cloud_C.size()) return clean(cloud_C, options_.clean, stop_);
    return clean(select(cloud_C, points), options_.clean, stop_);
  }

  // Nothing needs the cloud after this.
  void cleanObjects(PointCloud cloud_C) {
    const StageTimer timer(tally_, StageId::clean);
    for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
      CleanCloud clean_cloud = cleanObject(cloud_C, scene_.objects[i]);
      tally_.count(StageId::clean, scene_.objects[i].size(), clean_cloud.cloud_C.size());
      tally_.reject("point is a duplicate", clean_cloud.duplicates);
      tally_.reject("point is an outlier", clean_cloud.outliers);
      tally_.reject("point shares its voxel", clean_cloud.merged);
      note(fmt::format("object {}: {} points, evened to {} by voxels of {:.2f} mm, spacing {:.2f} mm", i,
                       scene_.objects[i].size(), clean_cloud.cloud_C.size(), 1e3 * clean_cloud.voxel_m,
                       1e3 * clean_cloud.spacing_m));
      scene_C_ = joined(std::move(scene_C_), clean_cloud.cloud_C);
      result_.objects.push_back({std::move(clean_cloud.cloud_C), 0, clean_cloud.spacing_m, {}, {}});
    }
    addObstacles(background(cloud_C, scene_));
  }

  void addObstacles(const PointCloud& rest_C) {
    if (!rest_C.empty()) {
      CleanOptions thinning = options_.clean;
      thinning.outlier_neighbours = 0;
      scene_C_ = joined(std::move(scene_C_), clean(rest_C, thinning, stop_).cloud_C);
    }
    if (!scene_.table) return;
    for (const PlannedObject& object : result_.objects) {
      if (object.cloud_C.empty()) continue;
      scene_C_ = joined(std::move(scene_C_),
                        tablePatch(*scene_.table, object.cloud_C, kTableReach_m, kTableSpacing_m));
    }
  }

  // All sensors look at a table from above it.
  std::optional<Vector3d> someViewpoint() const {
    if (request_.viewpoints_C.empty()) return std::nullopt;
    return request_.viewpoints_C.front();
  }

  // Whatever the sensors saw, the object included: nothing can be where one looked through.
  Observation observationOf(const PointCloud& seen_C) const {
    std::optional<Vector3d> up_C;
    if (surroundings_.gravity_C) up_C = -*surroundings_.gravity_C;
    return {request_.viewpoints_C, up_C, seen_C};
  }

  void completeObjects() {
    if (request_.viewpoints_C.empty() || !options_.completion.enabled) return;
    const StageTimer timer(tally_, StageId::completion);
    const PointCloud seen_C = scene_C_;
    for (std::size_t i = 0; i < result_.objects.size(); ++i) {
      if (!planned(i)) continue;
      PlannedObject& object = result_.objects[i];
      const std::size_t seen = object.cloud_C.size();
      const Completion guess =
          completed(object.cloud_C, object.spacing_m, observationOf(seen_C), options_.completion, stop_);
      object.guessed = guess.guessed_C.size();
      object.cloud_C = joined(std::move(object.cloud_C), guess.guessed_C);
      scene_C_ = joined(std::move(scene_C_), guess.guessed_C);
      tally_.count(StageId::completion, seen, object.cloud_C.size());
      tally_.reject("mirrored point would have been seen", guess.contradicted);
      if (!guess.why_not.empty())
        note(fmt::format("object {}: nothing of its unseen side was guessed: {}", i, guess.why_not));
      else if (object.guessed > 0)
        note(fmt::format("object {}: {} points of its unseen side were guessed, through {} mirror{}", i,
                         object.guessed, guess.mirrors.size(), guess.mirrors.size() == 1 ? "" : "s"));
    }
  }

  bool planned(std::size_t object) const {
    return (request_.object < 0 || object == static_cast<std::size_t>(request_.object)) &&
           !result_.objects[object].cloud_C.empty();
  }

  void decomposeObjects() {
    const StageTimer timer(tally_, StageId::decomposition);
    for (std::size_t i = 0; i < result_.objects.size(); ++i) {
      if (!planned(i)) continue;
      PlannedObject& object = result_.objects[i];
      object.tree = decompose(object.cloud_C, options_.decomposition, stop_);
      object.shapes = shapesOf(object.cloud_C, object.tree, options_.shapes);
      tally_.count(StageId::decomposition, 1, object.tree.leaves().size());
      noteShapes(i);
    }
  }

  void noteShapes(std::size_t object) {
    const PlannedObject& its = result_.objects[object];
    for (std::size_t node = 0; node < its.shapes.size(); ++node) {
      const BoxShape& shape = its.shapes[node];
      if (shape.kind != ShapeKind::box)
        note(fmt::format("object {}: box {} is a {} of radius {:.1f} mm", object, node, describe(shape.kind),
                         1e3 * shape.radius_m));
    }
  }

  void graspObjects() {
    const PointGrid scene_grid_C(scene_C_, kSceneCell_m);
    for (std::size_t i = 0; i < result_.objects.size(); ++i) {
      if (planned(i)) graspObject(static_cast<int>(i), scene_grid_C);
    }
    if (trace_) {
      trace_->scene_C = scene_C_;
      trace_->table = scene_.table;
    }
  }

  void graspObject(int index, const PointGrid& scene_grid_C) {
    const ObjectWork work{hand_, options_, scene_grid_C, surroundings_, robot_, stop_};
    ObjectGrasps found = graspsOnObject(work, result_.objects[index], index, trace_ != nullptr);
    if (!found.note.empty()) note(fmt::format("object {}: {}", index, found.note));
    tally_.add(found.tally);
    std::move(found.grasps.begin(), found.grasps.end(), std::back_inserter(result_.grasps));
    if (trace_) std::move(found.traces.begin(), found.traces.end(), std::back_inserter(trace_->faces));
  }

  const HandDescription& hand_;
  PlanRequest request_;
  const StopToken& stop_;
  PlanTrace* trace_;
  PlanResult& result_;
  Tally& tally_;
  PlannerOptions options_;
  Robot robot_;
  Scene scene_;
  Surroundings surroundings_;
  PointCloud scene_C_;
};

}  // namespace

void findHypotheses(const HandDescription& hand, const PlannerOptions& options, PlanRequest request,
                    const StopToken& stop, PlanTrace* trace, PlanResult& result, Tally& tally) {
  HypothesisSearch(hand, options, std::move(request), stop, trace, result, tally).run();
}

}  // namespace boxgrasp
