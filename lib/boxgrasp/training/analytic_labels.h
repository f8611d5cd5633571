// Labels without a simulator: the success s (Eq. 6) of planned contacts on parametric objects.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/planning/features.h"
#include "boxgrasp/training/levenberg_marquardt.h"

namespace boxgrasp {

// s of each grasp of one object (Eq. 6), (nu / nu_max)^2 + (epsilon / epsilon_max)^2 with the greatest of
// these grasps. Without force closure epsilon counts as 0. Pre: equal sizes, nu >= 0, no NaN.
VectorXd successes(const VectorXd& epsilon, const VectorXd& nu);

struct AnalyticLabelOptions {
  std::vector<std::string> objects;                // names of parametric objects; empty: all
  std::vector<double> scales = {0.75, 1.0, 1.25};  // three sizes of each (paper IV: 14 objects in 3 scales)
  std::size_t points = 30'000;                     // sampled on each surface
  double friction = 0.4;
  std::vector<std::string> features = relativeFeatures();  // what the measures are for
  std::uint64_t seed = 1;
  int threads = 0;  // 0 = all cores; the labels do not depend on it
  void validate() const;
};

// The labelled hypotheses of one object in one size.
struct LabelledObject {
  std::string name;
  double scale = 0.0;
  MatrixXd measures;  // as from graspMeasures(): hypotheses x measures
  VectorXd epsilon,
      nu;            // of the planned contacts, about the volume's centre, torques over the largest radius
  VectorXd success;  // s: (nu / nu_max)^2 + (epsilon / epsilon_max)^2 over this object and size (Eq. 6)
  std::size_t boxes = 0, projections = 0, triplets = 0;
};

// Plans on every object in every size and labels all hypotheses. `progress(done, total)` is called after
// each, from one thread at a time.
std::vector<LabelledObject> analyticLabels(const HandDescription& hand, const PlannerOptions& planner,
                                           const AnalyticLabelOptions& options,
                                           const std::function<void(std::size_t, std::size_t)>& progress = {},
                                           const StopToken& stop = {});

}  // namespace boxgrasp
