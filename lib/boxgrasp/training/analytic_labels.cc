#include "boxgrasp/training/analytic_labels.h"

#include <mutex>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/parallel.h"
#include "boxgrasp/objects/mesh_properties.h"
#include "boxgrasp/objects/parametric.h"
#include "boxgrasp/planning/features.h"
#include "boxgrasp/planning/hypotheses.h"
#include "boxgrasp/wrench/grasp_wrench_space.h"

namespace boxgrasp {
namespace {

WrenchOptions wrenchOptions(const TriangleMesh& mesh, double friction) {
  WrenchOptions options;
  options.friction = friction;
  options.p_CG = massPropertiesOf(mesh).center_M;
  options.torque_scale_m = largestDistance(mesh, options.p_CG);
  return options;
}

GraspQuality qualityOf(const Grasp& grasp, const WrenchOptions& options) {
  std::vector<Contact> contacts;
  for (const SurfaceContact& contact : grasp.contacts) contacts.push_back({contact.p_C, contact.normal_C});
  return graspQuality(contacts, options);
}

LabelledObject labelled(const HandDescription& hand, const PlannerOptions& planner,
                        const AnalyticLabelOptions& options, const std::string& name, double scale,
                        const StopToken& stop) {
  const TriangleMesh mesh = parametricObject(name, scale);
  PlanRequest request;
  request.cloud_C = sampleSurface(mesh, options.points, options.seed);
  request.friction = options.friction;
  PlanResult result;
  Tally tally;
  findHypotheses(hand, planner, request, stop, nullptr, result, tally);

  LabelledObject labels{name,
                        scale,
                        {},
                        VectorXd(result.grasps.size()),
                        VectorXd(result.grasps.size()),
                        {},
                        tally[StageId::decomposition].out,
                        tally[StageId::faces].out,
                        tally[StageId::triplets].out};
  const WrenchOptions wrench = wrenchOptions(mesh, options.friction);
  for (std::size_t i = 0; i < result.grasps.size(); ++i) {
    stop.check();
    const auto row = static_cast<Eigen::Index>(i);
    const GraspQuality quality = qualityOf(result.grasps[i], wrench);
    labels.epsilon[row] = quality.epsilon;
    labels.nu[row] = quality.volume;
  }
  std::vector<const Grasp*> grasps;
  for (const Grasp& grasp : result.grasps) grasps.push_back(&grasp);
  labels.measures = graspMeasures(result.objects.front(), grasps, {options.features, options.friction}, stop);
  labels.success = successes(labels.epsilon, labels.nu);
  return labels;
}

}  // namespace

VectorXd successes(const VectorXd& epsilon, const VectorXd& nu) {
  const VectorXd positive = epsilon.cwiseMax(0.0);
  const double epsilon_max = positive.size() ? positive.maxCoeff() : 0.0,
               nu_max = nu.size() ? nu.maxCoeff() : 0.0;
  VectorXd s = VectorXd::Zero(nu.size());
  if (nu_max > 0) s += (nu / nu_max).array().square().matrix();
  if (epsilon_max > 0) s += (positive / epsilon_max).array().square().matrix();
  return s;
}

void AnalyticLabelOptions::validate() const {
  for (const double scale : scales) requireOption(scale > 0 && scale <= 10, "scales", scale, "in (0, 10]");
  requireOption(!scales.empty(), "scales", "an empty list", "at least one");
  requireOption(points >= 1000, "points", points, "at least 1000");
  requireOption(threads >= 0, "threads", threads, "at least 0");
}

std::vector<LabelledObject> analyticLabels(const HandDescription& hand, const PlannerOptions& planner,
                                           const AnalyticLabelOptions& options,
                                           const std::function<void(std::size_t, std::size_t)>& progress,
                                           const StopToken& stop) {
  options.validate();
  const std::vector<std::string> names = options.objects.empty() ? parametricNames() : options.objects;
  PlannerOptions single = planner;
  single.scene.whole = true;
  single.threads = 1;
  std::vector<LabelledObject> labels(names.size() * options.scales.size());
  std::mutex reporting;
  std::size_t done = 0;
  parallelFor(labels.size(), options.threads, [&](std::size_t i) {
    labels[i] = labelled(hand, single, options, names[i / options.scales.size()],
                         options.scales[i % options.scales.size()], stop);
    const std::lock_guard lock(reporting);
    if (progress) progress(++done, labels.size());
  });
  return labels;
}

}  // namespace boxgrasp
