#include "draw_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "boxgrasp/base/error.h"
#include "boxgrasp/cloud/read_cloud.h"
#include "boxgrasp/planning/grasp_planner.h"
#include "boxgrasp/rendering/canvas.h"
#include "boxgrasp/rendering/picture.h"
#include "boxgrasp/training/stability.h"
#include "interruption.h"
#include "left_out.h"
#include "print_json.h"
#include "tried_object.h"

namespace boxgrasp {
namespace {

using nlohmann::json;

constexpr int kPanel_px = 240;
constexpr std::array<std::pair<const char*, SplitRule>, 3> kSplits{
    {{"old", SplitRule::bound}, {"new", SplitRule::hull}, {"robust", SplitRule::robust}}};

TriangleMesh meshOf(const std::string& set, const std::string& name, const StopToken& stop) {
  for (const ObjectSource& source : sourcesOf(set, {1.0})) {
    if (source.name == name) return loadObject(source, stop).mesh_O;
  }
  throw InputError(fmt::format("no object of '{}' is named '{}'; 'objects list' names them", set, name));
}

PlanRequest requestOf(const DrawCommand& command, const StopToken& stop) {
  if (!command.scene)
    return sightOf(meshOf(command.objects, command.object, stop), {command.object, 1.0, wholeName()}, {},
                   stop);
  LoadedCloud loaded = readCloud(*command.scene);
  PlanRequest request;
  request.cloud_C = std::move(loaded.cloud_C);
  if (loaded.viewpoint_C) request.viewpoints_C = {*loaded.viewpoint_C};
  return request;
}

Model modelFor(const DrawCommand& command, const Model& built_in, const StopToken& stop) {
  if (!command.store) return built_in;
  StudyCommand study;
  study.store = command.store;
  study.meshes = command.meshes;
  study.threads = command.threads;
  return LeftOut(study, stop).modelWithout(command.object, stop);
}

json jsonOf(const PlanResult& plan, const std::string& what) {
  json scores = json::array();
  for (const Grasp& grasp : plan.grasps) scores.push_back(grasp.score);
  return {{"schema", 1},
          {"what", what},
          {"objects", plan.objects.size()},
          {"grasps", plan.grasps.size()},
          {"scores", scores},
          {"message", plan.message}};
}

// --- constellations

cv::Mat3b panelOf(const PointCloud& cloud, const BoxTree& tree, const std::string& title) {
  const auto root = tree.nodes.front().box.corners();
  const Vector3d forward = Vector3d(-0.55, 0.75, -0.45).normalized();
  Canvas canvas(kPanel_px, kPanel_px, framing({root.begin(), root.end()}, forward, Vector3d::UnitZ(), 1.0));
  const std::vector<int> leaves = tree.leaves();
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const BoxNode& leaf = tree.nodes[static_cast<std::size_t>(leaves[i])];
    const Colour colour = boxColour(i);
    for (const auto point : leaf.points) canvas.point(cloud.point(point), colour, 1);
    drawBox(canvas, leaf.box, colour);
  }
  cv::Mat3b image = canvas.image().clone();
  label(image, title, 6, 16, 0.4);
  return image;
}

cv::Mat3b rowOf(const PointCloud& cloud, const char* name, DecompositionOptions options,
                const std::vector<double>& gains, const StopToken& stop) {
  std::vector<cv::Mat3b> panels;
  for (const double t : gains) {
    options.gain_t = t;
    const BoxTree tree = decompose(cloud, options, stop);
    panels.push_back(
        panelOf(cloud, tree, fmt::format("{}, t = {:.2f}: {} boxes", name, t, tree.leaves().size())));
  }
  cv::Mat3b row;
  cv::hconcat(panels, row);
  return row;
}

json curveOf(const PointCloud& cloud, const DecompositionOptions& options, const std::vector<double>& gains,
             const StopToken& stop) {
  json curve = json::array();
  for (const GainPoint& point : constellationsOver(gains, cloud, options, {}, stop))
    curve.push_back({{"t", point.t},
                     {"boxes", point.boxes},
                     {"volume", point.volume},
                     {"similar_to_last", point.similar_to_last}});
  return curve;
}

}  // namespace

void runDraw(const DrawCommand& command) {
  requireOption(command.grasps >= 1 && command.grasps <= 20, "--grasps", command.grasps, "in [1, 20]");
  requireOption(command.threads >= 0, "--threads", command.threads, "at least 0");
  if (command.object.empty() == !command.scene)
    throw InputError("name an object to plan, or a cloud with --scene");
  const StopToken stop = stopOnInterrupt();
  const PlanRequest request = requestOf(command, stop);
  Planning planning = planningWith();
  planning.options.scene.whole = !command.scene;
  planning.options.threads = command.threads;
  const Model model = modelFor(command, planning.model, stop);
  PlanTrace trace;
  const PlanResult plan = GraspPlanner(planning.hand, model, planning.options).plan(request, stop, &trace);
  stop.check();
  const std::string what = command.scene ? command.scene->stem().string() : command.object;
  if (plan.objects.empty()) throw InputError(fmt::format("{}: {}", what, plan.message));
  writePlanPicture(plan, trace, planning.hand, command.out,
                   {.panel_px = 320, .grasps = command.grasps, .face_images = 0, .title = what});
  if (command.json)
    printJson(jsonOf(plan, what));
  else
    fmt::print("{}: {}; picture written to {}\n", what, plan.message, command.out.string());
}

void runConstellations(const ConstellationsCommand& command) {
  requireOption(command.points >= 100, "--points", command.points, "at least 100");
  requireOption(command.threads >= 0, "--threads", command.threads, "at least 0");
  const StopToken stop = stopOnInterrupt();
  const PointCloud cloud =
      sampleSurface(meshOf(command.objects, command.object, stop), command.points, command.seed);
  std::vector<cv::Mat3b> rows;
  json report{{"schema", 1}, {"object", command.object}, {"splits", json::object()}};
  for (const auto& [name, split] : kSplits) {
    DecompositionOptions options;
    options.split = split;
    options.threads = command.threads;
    rows.push_back(rowOf(cloud, name, options, command.gains, stop));
    report["splits"][name] = curveOf(cloud, options, command.gains, stop);
  }
  cv::Mat3b all;
  cv::vconcat(rows, all);
  writePng(all, command.out);
  if (command.json)
    printJson(report);
  else
    fmt::print("{} splits, {} values of t; picture written to {}\n", rows.size(), command.gains.size(),
               command.out.string());
}

}  // namespace boxgrasp
