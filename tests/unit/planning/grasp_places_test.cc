#include "boxgrasp/planning/grasp_places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "boxgrasp/objects/parametric.h"
#include "boxgrasp/planning/grasp_planner.h"
#include "test_model.h"

namespace boxgrasp {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

PlanRequest requestFor(const char* object) {
  PlanRequest request;
  request.cloud_C = sampleSurface(parametricObject(object), 8'000, 1);
  request.top_k = 0;
  return request;
}

PlanResult planned(const Model& model, const PlanRequest& request, const RecallOptions& recall) {
  PlannerOptions options;
  options.recall = recall;
  options.merge_distance_m = 0.0;
  return GraspPlanner(barrettHand(), model, options).plan(request);
}

RecallOptions recalling() {
  RecallOptions options;
  options.enabled = true;
  return options;
}

// An object with these grasps, all of which surprised the networks by so much.
Recollection recollectionOf(const PlannedObject& object, const std::vector<const Grasp*>& grasps,
                            double surprise) {
  return {constellationOf(object.tree), graspPlaces(object.tree, grasps),
          VectorXd::Constant(static_cast<Eigen::Index>(grasps.size()), surprise)};
}

TEST(ConstellationOf, FillsTheCellsOfTheLeaves) {
  BoxTree tree;
  BoxNode root;
  root.box.extents = {0.16, 0.08, 0.04};
  root.box.X_CB.translation() = Vector3d(1, 2, 3);
  tree.nodes = {root};
  const Constellation alone = constellationOf(tree);
  EXPECT_EQ(alone.unit_m, 0.16);
  EXPECT_EQ(alone.cells.count(), 16u * 8u * 4u);
  BoxNode leaf = root;
  leaf.box.extents = {0.08, 0.08, 0.04};
  leaf.box.X_CB.translation() -= Vector3d(0.04, 0, 0);
  tree.nodes[0].first = 1;
  tree.nodes[0].second = 2;
  tree.nodes.push_back(leaf);
  leaf.box.extents = {0.01, 0.01, 0.01};
  tree.nodes.push_back(leaf);
  const Constellation half = constellationOf(tree);
  EXPECT_EQ(half.cells.count(), 8u * 8u * 4u) << "leaves count, not the root";
  EXPECT_EQ((half.cells & alone.cells), half.cells);
}

TEST(GraspPlaces, TurnWithTheObject) {
  const PlanRequest request = requestFor("mug");
  PlanRequest moved = request;
  Pose X = Pose::Identity();
  X.linear() = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  X.translation() = Vector3d(0.3, -0.1, 0.2);
  moved.cloud_C = transformed(request.cloud_C, X);
  const PlanResult a = planned(test::linearModel(), request, {}), b = planned(test::linearModel(), moved, {});
  ASSERT_FALSE(a.grasps.empty());
  const Constellation here = constellationOf(a.objects[0].tree), there = constellationOf(b.objects[0].tree);
  EXPECT_GT(std::ranges::max(overlaps(here, there)), 0.8) << "the same boxes, whichever way the object lies";
}

TEST(Recall, RaisesWhatHeldInTheSamePlace) {
  const PlanRequest request = requestFor("mug");
  Model model = test::linearModel();
  const PlanResult before = planned(model, request, {});
  ASSERT_GT(before.grasps.size(), 20u);
  const Grasp& worst = before.grasps.back();
  model.recollections = {recollectionOf(before.objects[0], {&worst}, 100.0)};
  const PlanResult after = planned(model, request, recalling());
  ASSERT_EQ(after.grasps.size(), before.grasps.size());
  EXPECT_TRUE(after.grasps.front().X_CP.isApprox(worst.X_CP)) << "what surprised most is tried first";
  EXPECT_EQ(planned(model, request, {}).grasps.front().score, before.grasps.front().score)
      << "nothing is recalled unless asked for";
}

TEST(Recall, LeavesStrangeObjectsAlone) {
  Model model = test::linearModel();
  const PlanResult mug = planned(model, requestFor("mug"), {});
  ASSERT_FALSE(mug.grasps.empty());
  model.recollections = {recollectionOf(mug.objects[0], {&mug.grasps.front()}, 100.0)};
  const PlanRequest pen = requestFor("pen");
  const PlanResult with = planned(model, pen, recalling()), without = planned(model, pen, {});
  ASSERT_FALSE(without.grasps.empty());
  for (std::size_t i = 0; i < with.grasps.size(); ++i)
    EXPECT_EQ(with.grasps[i].score, without.grasps[i].score) << "a pen is no mug";
}

TEST(Recall, KeepsProbabilitiesWithinTheirBounds) {
  const PlanRequest request = requestFor("mug");
  Model model = test::linearModel();
  model.ensemble.calibration = {1.0, 0.0};
  const PlanResult before = planned(model, request, {});
  std::vector<const Grasp*> all;
  for (const Grasp& grasp : before.grasps) all.push_back(&grasp);
  all.resize(std::min(all.size(), Recollection::kMaxGrasps));
  for (const double surprise : {-50.0, 50.0}) {
    model.recollections = {recollectionOf(before.objects[0], all, surprise)};
    for (const Grasp& grasp : planned(model, request, recalling()).grasps)
      ASSERT_TRUE(grasp.score >= 0 && grasp.score <= 1) << grasp.score << " is no probability";
  }
}

TEST(Recall, SaysWhenThereIsNothingToRecall) {
  EXPECT_THAT(planned(test::linearModel(), requestFor("mug"), recalling()).report.notes,
              Contains(HasSubstr("train it with --recollections")));
}

}  // namespace
}  // namespace boxgrasp
