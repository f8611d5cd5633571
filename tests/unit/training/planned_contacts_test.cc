// Whether fingers touch where the plan says that they will: plans against the simulated hand.
#include <gtest/gtest.h>

#include <algorithm>

#include "boxgrasp/objects/parametric.h"
#include "boxgrasp/planning/grasp_planner.h"
#include "boxgrasp/training/baselines.h"
#include "boxgrasp/training/labelling.h"
#include "test_model.h"

namespace boxgrasp {
namespace {

constexpr std::size_t kGrasps = 8;  // of each object

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// From each finger's planned contact to the nearest place where the closed hand's finger touches.
void addErrors(const SimulatedObject& solid, const Grasp& grasp, double approach_m,
               std::vector<double>& errors_m) {
  TrialOptions options;
  options.last_stage = TrialStage::close;
  const HypothesisRecord record = recordsOf({grasp}, approach_m).front();
  const TrialResult closed = runTrial(barrettHand(), solid, trialInput(record), options);
  for (int finger = 0; finger < 3; ++finger) {
    double nearest_m = 1.0;
    for (const TrialContact& contact : closed.contacts) {
      if (contact.finger == finger)
        nearest_m = std::min(nearest_m, (contact.p_O - grasp.contacts[finger].p_C).norm());
    }
    errors_m.push_back(nearest_m);
  }
}

std::vector<double> contactErrors(const PlannerOptions& options) {
  std::vector<double> errors_m;
  for (const char* name : {"goblet", "duck", "bottle"}) {
    const TriangleMesh mesh_O = parametricObject(name);
    PlanRequest request;
    request.cloud_C = sampleSurface(mesh_O, 12'000, 5);
    request.top_k = 0;
    const auto grasps = GraspPlanner(barrettHand(), test::linearModel(), options).plan(request).grasps;
    const SimulatedObject solid = makeSimulatedObject(mesh_O);
    for (std::size_t i = 0; i < kGrasps && !grasps.empty(); ++i)
      addErrors(solid, grasps[i * grasps.size() / kGrasps], options.clearance.approach_m, errors_m);
  }
  return errors_m;
}

TEST(PlannedContacts, AreWhereTheSimulatedFingersTouch) {
  PlannerOptions outline, surface, line;
  outline.scene.whole = surface.scene.whole = line.scene.whole = true;
  surface.contacts.meet_surface = true;
  line.depth_model = DepthModel::linear;
  const double of_outline = median(contactErrors(outline)), of_surface = median(contactErrors(surface)),
               of_line = median(contactErrors(line));
  EXPECT_LT(of_outline, 0.004) << "exact kinematics, dropped onto the surface";
  EXPECT_LT(of_surface, 0.0015) << "fingers that meet the surface";
  EXPECT_LT(of_surface, 0.7 * of_outline) << "the whole inverse kinematics is the nearer";
  EXPECT_GT(of_line, 2 * of_outline) << "the paper's line misses by more";
  RecordProperty("median_error_um_outline", static_cast<int>(1e6 * of_outline));
  RecordProperty("median_error_um_surface", static_cast<int>(1e6 * of_surface));
  RecordProperty("median_error_um_line", static_cast<int>(1e6 * of_line));
}

}  // namespace
}  // namespace boxgrasp
