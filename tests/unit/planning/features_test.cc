// What networks are fed: names, places among an object's grasps, and measures that depend on the object
// alone.
#include "boxgrasp/planning/features.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "boxgrasp/base/random.h"
#include "boxgrasp/objects/parametric.h"
#include "boxgrasp/planning/hypotheses.h"
#include "boxgrasp/wrench/grasp_wrench_space.h"
#include "error_of.h"

namespace boxgrasp {
namespace {

using Eigen::Index;
using testing::HasSubstr;

Index columnOf(const std::string& name) {
  const std::vector<std::string> names = measureNames();
  return std::ranges::find(names, name) - names.begin();
}

MatrixXd randomMeasures(Index n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  MatrixXd measures(n, std::ssize(measureNames()));
  for (double& value : measures.reshaped()) value = uniform(random, 0.1, 1.0);
  return measures;
}

PlanResult hypothesesOn(const std::string& object) {
  PlannerOptions options;
  options.scene.whole = true;
  PlanRequest request;
  request.cloud_C = sampleSurface(parametricObject(object), 12'000, 7);
  PlanResult result;
  Tally tally;
  findHypotheses(barrettHand(), options, request, {}, nullptr, result, tally);
  return result;
}

std::vector<const Grasp*> pointersTo(const std::vector<Grasp>& grasps) {
  std::vector<const Grasp*> pointers;
  for (const Grasp& grasp : grasps) pointers.push_back(&grasp);
  return pointers;
}

TEST(Features, AreMeasuresAsTheyAreOrWithoutTheirUnit) {
  const MatrixXd measures = randomMeasures(20, 1);
  const MatrixXd inputs = networkInputs({"q4", "q4/L", "q1/L2"}, measures);
  const auto size = measures.col(columnOf("size")).array();
  EXPECT_TRUE(inputs.col(0).isApprox(measures.col(3), 1e-15));
  EXPECT_TRUE(inputs.col(1).isApprox((measures.col(3).array() / size).matrix(), 1e-15));
  EXPECT_TRUE(inputs.col(2).isApprox((measures.col(0).array() / size.square()).matrix(), 1e-15));
}

TEST(Features, RanksCountTheGraspsBelow) {
  const MatrixXd measures = randomMeasures(31, 2);
  const VectorXd rank = networkInputs({"rank(nu)"}, measures).col(0);
  for (Index i = 0; i < rank.size(); ++i) {
    const auto below = (measures.col(columnOf("nu")).array() < measures(i, columnOf("nu"))).count();
    EXPECT_DOUBLE_EQ(rank[i], static_cast<double>(below) / 30.0) << "grasp " << i;
  }
}

TEST(Features, EqualValuesShareTheMeanOfTheirPlaces) {
  MatrixXd measures = randomMeasures(4, 3);
  measures.col(1) = VectorXd{{0.5, 0.2, 0.5, 0.9}};
  EXPECT_TRUE(networkInputs({"rank(q2)"}, measures).isApprox(VectorXd{{0.5, 0.0, 0.5, 1.0}}, 1e-15));
  measures.col(1).setConstant(7.0);
  EXPECT_TRUE(networkInputs({"rank(q2)"}, measures).isApproxToConstant(0.5, 1e-15));
  EXPECT_EQ(networkInputs({"rank(q2)"}, randomMeasures(1, 3))(0, 0), 0.5) << "a single grasp";
}

TEST(Features, SharesAreOfTheGreatestAndNeverNegative) {
  MatrixXd measures = randomMeasures(3, 4);
  measures.col(columnOf("epsilon")) = VectorXd{{-1.0, 0.1, 0.4}};
  EXPECT_TRUE(networkInputs({"share(epsilon)"}, measures).isApprox(VectorXd{{0.0, 0.25, 1.0}}, 1e-15));
  measures.col(columnOf("epsilon")).setConstant(-1.0);
  EXPECT_TRUE(networkInputs({"share(epsilon)"}, measures).isZero()) << "none holds";
}

TEST(Features, OfAListDoNotDependOnItsOrder) {
  const MatrixXd measures = randomMeasures(25, 5);
  const MatrixXd inputs = networkInputs(allFeatures(), measures),
                 reversed = networkInputs(allFeatures(), measures.colwise().reverse());
  EXPECT_EQ(inputs, MatrixXd(reversed.colwise().reverse()));
}

TEST(Features, OfTheFullSetAreAllDifferentAndKnown) {
  for (const auto& features : {allFeatures(), relativeFeatures(), paperFeatures()}) {
    EXPECT_NO_THROW(checkFeatures(features));
    EXPECT_EQ(std::set<std::string>(features.begin(), features.end()).size(), features.size());
  }
}

TEST(Features, UnknownOnesAreNamed) {
  for (const std::string feature : {"q10", "q1/L3", "rank(q0)", "rank()", "rank(q1", "share(", "", "q1 "}) {
    EXPECT_THAT(test::errorOf([&] {
                  checkFeatures({"q1", feature});
                }),
                HasSubstr("feature '" + feature + "' is unknown"));
  }
}

TEST(GraspMeasures, SayWhatThePlanKnows) {
  const PlanResult result = hypothesesOn("mug");
  ASSERT_GT(result.grasps.size(), 20u);
  const PlannedObject& object = result.objects.front();
  const MatrixXd measures = graspMeasures(object, pointersTo(result.grasps), {});
  for (Index i = 0; i < measures.rows(); ++i) {
    const Grasp& grasp = result.grasps[static_cast<std::size_t>(i)];
    EXPECT_EQ(measures(i, 8), grasp.quality[8]);
    EXPECT_EQ(measures(i, columnOf("size")), objectSize(object));
    EXPECT_GE(measures(i, columnOf("epsilon")), 0.0);
    EXPECT_LE(measures(i, columnOf("span_min")), measures(i, columnOf("span_max")));
    EXPECT_LE(measures(i, columnOf("center_off")), measures(i, columnOf("center")));
    EXPECT_EQ(measures(i, columnOf("seen")), 1.0) << "no sensor, so all is seen";
  }
  EXPECT_TRUE(measures.allFinite());
  EXPECT_GT((measures.col(columnOf("epsilon")).array() > 0.0).cast<double>().mean(), 0.8)
      << "hypotheses are in force closure, but for the coarser cones";
}

TEST(GraspMeasures, DoNotDependOnThreads) {
  const PlanResult result = hypothesesOn("cup");
  MeasuringOptions two;
  two.threads = 2;
  EXPECT_EQ(graspMeasures(result.objects.front(), pointersTo(result.grasps), {}),
            graspMeasures(result.objects.front(), pointersTo(result.grasps), two));
}

TEST(GraspMeasures, TakeNoTimeForWrenchesThatNobodyAsksFor) {
  const PlanResult result = hypothesesOn("cup");
  MeasuringOptions options;
  options.features = paperFeatures();
  const MatrixXd measures = graspMeasures(result.objects.front(), pointersTo(result.grasps), options);
  EXPECT_TRUE(measures.col(columnOf("epsilon")).isZero());
  EXPECT_TRUE(measures.col(columnOf("nu")).isZero());
  EXPECT_TRUE(asksForWrenches({"q1", "share(nu)"}));
  EXPECT_FALSE(asksForWrenches(relativeFeatures()));
}

// The measures tell grasps apart as the exact cones do.
TEST(GraspMeasures, FewConeEdgesOrderGraspsAsManyDo) {
  const PlanResult result = hypothesesOn("mug");
  const PlannedObject& object = result.objects.front();
  const VectorXd few = graspMeasures(object, pointersTo(result.grasps), {}).col(columnOf("epsilon"));
  VectorXd many(few.size());
  for (Index i = 0; i < many.size(); ++i) {
    std::vector<Contact> contacts;
    for (const SurfaceContact& c : result.grasps[static_cast<std::size_t>(i)].contacts)
      contacts.push_back({c.p_C, c.normal_C});
    WrenchOptions options;
    options.cone_edges = 12;
    options.p_CG = object.tree.nodes.front().box.X_CB.translation();
    options.torque_scale_m = objectSize(object);
    many[i] = std::max(graspQuality(contacts, options).epsilon, 0.0);
  }
  const VectorXd a = few.array() - few.mean(), b = many.array() - many.mean();
  EXPECT_GT(a.dot(b) / (a.norm() * b.norm()), 0.8);
}

}  // namespace
}  // namespace boxgrasp
