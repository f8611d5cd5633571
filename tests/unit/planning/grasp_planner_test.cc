// Laws of the whole planner on clouds of parametric objects.
#include "boxgrasp/planning/grasp_planner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "boxgrasp/base/random.h"
#include "boxgrasp/objects/parametric.h"
#include "boxgrasp/wrench/grasp_wrench_space.h"
#include "random_pose.h"
#include "test_model.h"

namespace boxgrasp {
namespace {

constexpr double kFriction = 0.4;

PlanRequest requestFor(PointCloud cloud_C, int top_k = 10) {
  PlanRequest request;
  request.cloud_C = std::move(cloud_C);
  request.top_k = top_k;
  request.friction = kFriction;
  return request;
}

GraspPlanner planner(int threads = 1) {
  PlannerOptions options;
  options.threads = threads;
  return GraspPlanner(barrettHand(), test::linearModel(), options);
}

PointCloud cloudOf(const std::string& object, std::size_t points = 12'000) {
  return sampleSurface(parametricObject(object), points, 7);
}

PointCloud shuffled(const PointCloud& cloud, std::uint64_t seed) {
  std::vector<std::uint32_t> order(cloud.size());
  std::iota(order.begin(), order.end(), 0u);
  std::mt19937_64 random(seed);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[uniformIndex(random, i)]);
  return select(cloud, order);
}

// The contacts of a grasp, sorted, so that grasps with F1 and F2 exchanged compare equal.
std::array<Vector3d, 3> contactPoints(const Grasp& grasp) {
  std::array<Vector3d, 3> points{grasp.contacts[0].p_C, grasp.contacts[1].p_C, grasp.contacts[2].p_C};
  return points;
}

bool sameContacts(const std::array<Vector3d, 3>& a, const std::array<Vector3d, 3>& b, double tolerance_m) {
  const auto near = [&](int i, int j, int k) {
    return (a[0] - b[i]).norm() < tolerance_m && (a[1] - b[j]).norm() < tolerance_m &&
           (a[2] - b[k]).norm() < tolerance_m;
  };
  return near(0, 1, 2) || near(1, 0, 2);
}

// How many of the grasps of `expected`, after `map`, have a counterpart in `found`.
template <typename Map>
std::size_t counterparts(const std::vector<Grasp>& expected, const std::vector<Grasp>& found,
                         double tolerance_m, Map&& map) {
  std::size_t n = 0;
  for (const Grasp& grasp : expected) {
    std::array<Vector3d, 3> points = contactPoints(grasp);
    for (Vector3d& p : points) p = map(p);
    n += std::any_of(found.begin(), found.end(), [&](const Grasp& other) {
      return sameContacts(points, contactPoints(other), tolerance_m);
    });
  }
  return n;
}

class PlannerOnObjects : public ::testing::TestWithParam<const char*> {};

TEST_P(PlannerOnObjects, EveryGraspTouchesHoldsReachesAndIsClear) {
  const PlanResult result = planner().plan(requestFor(cloudOf(GetParam())));
  ASSERT_EQ(result.outcome, Outcome::grasps) << result.message;
  const PointGrid grid(result.objects[0].cloud_C, 0.006);
  for (const Grasp& grasp : result.grasps) {
    std::vector<Contact> contacts;
    for (const SurfaceContact& contact : grasp.contacts) {
      EXPECT_TRUE(grid.nearest(contact.p_C, 0.005)) << "a contact lies more than 5 mm from the cloud";
      EXPECT_NEAR(contact.normal_C.norm(), 1.0, 1e-9);
      contacts.push_back({contact.p_C, contact.normal_C, kFriction});
    }
    EXPECT_TRUE(forceClosure(contacts)) << "the contacts are not in force closure";
    EXPECT_TRUE(testClearance(barrettHand(), grasp.X_CP, grasp.joints, grid).pregrasp)
        << "the hand meets the object";
    const HandGeometry hand = forwardKinematics(barrettHand(), grasp.joints);
    for (int finger = 0; finger < 3; ++finger) {
      const double gap =
          (grasp.X_CP * hand.tips_P[finger] - grasp.contacts[finger].p_C).norm() - barrettHand().tip_radius;
      EXPECT_LT(std::abs(gap), 0.010) << "the fingertip of F" << finger + 1 << " is not at its contact";
    }
  }
}

TEST_P(PlannerOnObjects, FingersThatMeetTheSurfaceEndAtTheirContacts) {
  PlannerOptions options;
  options.contacts.meet_surface = true;
  const PlanResult result =
      GraspPlanner(barrettHand(), test::linearModel(), options).plan(requestFor(cloudOf(GetParam()), 0));
  ASSERT_EQ(result.outcome, Outcome::grasps) << result.message;
  const PointGrid grid(result.objects[0].cloud_C, 0.006);
  for (const Grasp& grasp : result.grasps) {
    const HandGeometry hand = forwardKinematics(barrettHand(), grasp.joints);
    for (int finger = 0; finger < 3; ++finger) {
      const Vector3d& p_C = grasp.contacts[finger].p_C;
      EXPECT_NEAR((grasp.X_CP * hand.tips_P[finger] - p_C).norm(), barrettHand().tip_radius, 1e-6)
          << "the fingertip of F" << finger + 1 << " is not at its contact";
      EXPECT_TRUE(grid.nearest(p_C, 0.006)) << "no point of the cloud where F" << finger + 1 << " touches";
      EXPECT_NEAR(extension(barrettHand(), grasp.joints.inner[finger]),
                  grasp.configuration.extension_m[finger], 1e-12);
    }
  }
}

TEST_P(PlannerOnObjects, EdgesAddGraspsAndTakeNoneAway) {
  const PlanRequest request = requestFor(cloudOf(GetParam()), 0);
  PlannerOptions options;
  options.merge_distance_m = 0.0;  // all of them
  options.faces.edges = EdgeUse::never;
  const PlanResult faces = GraspPlanner(barrettHand(), test::linearModel(), options).plan(request);
  options.faces.edges = EdgeUse::always;
  const PlanResult both = GraspPlanner(barrettHand(), test::linearModel(), options).plan(request);
  std::size_t on_faces = 0;
  for (const Grasp& grasp : both.grasps) {
    on_faces += !isEdge(grasp.face);
    const OrientedBox& box = both.objects[0].tree.nodes[static_cast<std::size_t>(grasp.box)].box;
    const std::array<int, 3> sides = sidesOf(grasp.face);
    const Vector3d outward_C = box.X_CB.linear() * Vector3d(sides[0], sides[1], sides[2]).normalized();
    EXPECT_NEAR(grasp.approach_C.dot(outward_C), -1.0, 1e-9)
        << "the hand comes straight at " << faceName(grasp.face);
  }
  EXPECT_EQ(on_faces, faces.grasps.size()) << "what is on the faces is the same with edges as without";
  EXPECT_LT(on_faces, both.grasps.size()) << "no grasp over an edge";
}

// Where two boxes, two cuts or the pixels at a contour are too nearly equal, rounding decides, and other
// grasps are found in some poses: so the law is one about the median pose.
TEST_P(PlannerOnObjects, GraspsMoveWithTheCloud) {
  constexpr int kPoses = 8;
  const PointCloud cloud_C = cloudOf(GetParam());
  const PlanResult still = planner().plan(requestFor(cloud_C, 0));
  const std::size_t top = std::min<std::size_t>(10, still.grasps.size());
  ASSERT_GT(top, 0u) << still.message;
  const std::vector<Grasp> best(still.grasps.begin(),
                                still.grasps.begin() + static_cast<std::ptrdiff_t>(top));
  std::mt19937_64 random(3);
  std::vector<std::size_t> found;
  for (int i = 0; i < kPoses; ++i) {
    const Pose X_DC = test::randomPose(random);
    const PlanResult moved = planner().plan(requestFor(transformed(cloud_C, X_DC), 0));
    found.push_back(counterparts(best, moved.grasps, 0.003, [&](const Vector3d& p) { return X_DC * p; }));
  }
  std::ranges::sort(found);
  EXPECT_GE(found[kPoses / 2], top - 2 * (top / 5))
      << "of the best " << top
      << " grasps this many moved with the cloud in the median pose; the fewest: " << found.front();
}

TEST_P(PlannerOnObjects, MirroredCloudGivesMirroredContacts) {
  PointCloud cloud_C = cloudOf(GetParam());
  const PlanResult original = planner().plan(requestFor(cloud_C, 0));
  for (float& x : cloud_C.x) x = -x;
  const PlanResult mirrored = planner().plan(requestFor(cloud_C, 0));
  const std::size_t top = std::min<std::size_t>(10, original.grasps.size());
  ASSERT_GT(top, 0u) << original.message;
  const std::vector<Grasp> best(original.grasps.begin(),
                                original.grasps.begin() + static_cast<std::ptrdiff_t>(top));
  const std::size_t found = counterparts(best, mirrored.grasps, 0.006,
                                         [](const Vector3d& p) { return Vector3d(-p.x(), p.y(), p.z()); });
  EXPECT_GE(found, top - 2 * (top / 5)) << "of the best " << top << " grasps this many have a mirror image";
}

INSTANTIATE_TEST_SUITE_P(Objects, PlannerOnObjects, ::testing::Values("mug", "radio", "car", "pen", "hammer"),
                         [](const auto& object) { return std::string(object.param); });

void expectSameBytes(const PlanResult& a, const PlanResult& b) {
  ASSERT_EQ(a.grasps.size(), b.grasps.size());
  for (std::size_t i = 0; i < a.grasps.size(); ++i) {
    EXPECT_EQ(a.grasps[i].score, b.grasps[i].score) << "grasp " << i;
    EXPECT_EQ(a.grasps[i].X_CP.matrix(), b.grasps[i].X_CP.matrix()) << "grasp " << i;
    EXPECT_EQ(a.grasps[i].quality, b.grasps[i].quality) << "grasp " << i;
  }
  EXPECT_EQ(a.report.rejected, b.report.rejected);
}

TEST(GraspPlanner, TheOrderOfPointsDoesNotMatter) {
  const PointCloud cloud = cloudOf("mug");
  expectSameBytes(planner().plan(requestFor(cloud)), planner().plan(requestFor(shuffled(cloud, 1))));
}

TEST(GraspPlanner, TheNumberOfThreadsDoesNotMatter) {
  const PointCloud cloud = cloudOf("car");
  expectSameBytes(planner(1).plan(requestFor(cloud)), planner(4).plan(requestFor(cloud)));
}

TEST(GraspPlanner, TheTopGraspsAreDifferentAndInOrder) {
  const PlanResult result = planner().plan(requestFor(cloudOf("mug"), 10));
  ASSERT_EQ(result.grasps.size(), 10u) << result.message;
  for (std::size_t i = 0; i < result.grasps.size(); ++i) {
    for (std::size_t j = i + 1; j < result.grasps.size(); ++j) {
      EXPECT_GE(result.grasps[i].score, result.grasps[j].score);
      const bool near =
          (result.grasps[i].X_CP.translation() - result.grasps[j].X_CP.translation()).norm() < 1e-3;
      const bool same =
          near && sameContacts(contactPoints(result.grasps[i]), contactPoints(result.grasps[j]), 1e-3);
      EXPECT_FALSE(same) << "grasps " << i << " and " << j << " are one";
    }
  }
}

// Counts come from each stage to the next, and the reasons account for what fell between configurations and
// clear grasps.
TEST(GraspPlanner, TheReportAccountsForEveryCandidate) {
  const PlanResult result = planner().plan(requestFor(cloudOf("mug"), 0));
  std::map<std::string, Stage> stages;
  for (const Stage& stage : result.report.stages) stages[stage.name] = stage;
  EXPECT_EQ(stages["contacts"].in, stages["configurations"].out);
  EXPECT_EQ(stages["force closure"].in, stages["contacts"].out);
  EXPECT_EQ(stages["clearance"].in, stages["force closure"].out);
  EXPECT_EQ(stages["ranking"].in, stages["clearance"].out);
  EXPECT_EQ(stages["distinct"].out, result.grasps.size());
  const auto fell = result.report.rejected.find("contacts not in force closure");
  EXPECT_EQ(fell == result.report.rejected.end() ? 0 : fell->second,
            stages["force closure"].in - stages["force closure"].out);
}

TEST(GraspPlanner, GraspsWithoutForceClosureAreTheLastResort) {
  const auto planned = [](const PlanRequest& request, ForceClosureUse use) {
    PlannerOptions options;
    options.faces.edges = EdgeUse::never;
    options.force_closure = use;
    return GraspPlanner(barrettHand(), test::linearModel(), options).plan(request);
  };
  int kept = 0, rescued = 0;
  for (const char* object : {"mug", "bunny", "horse", "squirrel"}) {
    for (const double friction : {0.4, 0.12, 0.06}) {
      SCOPED_TRACE(fmt::format("{}, friction {}", object, friction));
      PlanRequest request = requestFor(cloudOf(object, 6000), 0);
      request.friction = friction;
      const PlanResult strict = planned(request, ForceClosureUse::require);
      const PlanResult preferred = planned(request, ForceClosureUse::prefer);
      const PlanResult free = planned(request, ForceClosureUse::ignore);
      const PlanResult& expected = strict.grasps.empty() ? free : strict;
      EXPECT_EQ(preferred.grasps.size(), expected.grasps.size());
      kept += !strict.grasps.empty();
      rescued += strict.grasps.empty() && !free.grasps.empty();
      if (strict.grasps.empty() && !free.grasps.empty()) {
        EXPECT_THAT(preferred.report.notes,
                    testing::Contains(testing::HasSubstr("no grasp's contacts are in force closure")));
      }
    }
  }
  EXPECT_GT(kept, 0) << "no object had a grasp in force closure: nothing was tried";
  EXPECT_GT(rescued, 0) << "no object lacked grasps in force closure: nothing was tried";
}

TEST(GraspPlanner, NoGraspNamesTheStageTheCountsAndTheKnob) {
  PointCloud wall;  // too wide for the hand from its broad sides, too shallow from its narrow ones
  std::mt19937_64 random(5);
  for (int i = 0; i < 20'000; ++i)
    wall.push({uniform(random, 0, 0.4), uniform(random, 0, 0.4), uniform(random, 0, 0.002)});
  GraspPlanner whole = [] {
    PlannerOptions options;
    options.scene.whole = true;
    return GraspPlanner(barrettHand(), test::linearModel(), options);
  }();
  const PlanResult result = whole.plan(requestFor(wall));
  EXPECT_EQ(result.outcome, Outcome::no_grasp);
  EXPECT_NE(result.message.find("no grasp: stage '"), std::string::npos) << result.message;
  EXPECT_NE(result.message.find("knobs: "), std::string::npos) << result.message;
}

TEST(GraspPlanner, BadInputIsAnOutcomeNotACrash) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::pair<const char*, PointCloud>> clouds{
      {"empty", {}},
      {"one point", {{0.1f}, {0.2f}, {0.3f}}},
      {"all NaN", {{nan, nan}, {nan, nan}, {nan, nan}}}};
  for (const auto& [name, cloud] : clouds) {
    const PlanResult result = planner().plan(requestFor(cloud));
    EXPECT_EQ(result.outcome, Outcome::bad_input) << name;
    EXPECT_FALSE(result.message.empty()) << name;
  }
}

TEST(GraspPlanner, LinesAndPlanesAreAnswered) {
  PointCloud line, plane;
  for (int i = 0; i < 2000; ++i) {
    line.push({1e-4 * i, 0, 0});
    plane.push({1e-3 * (i % 50), 1e-3 * (i / 50), 0});
  }
  for (const PointCloud& cloud : {line, plane}) {
    const PlanResult result = planner().plan(requestFor(cloud));
    EXPECT_TRUE(result.outcome == Outcome::no_grasp || result.outcome == Outcome::grasps) << result.message;
    EXPECT_FALSE(result.message.empty());
  }
}

double meanTurn(const Grasp& grasp) {
  const auto& turn = grasp.triplet.turn_rad;
  return (turn[0] + turn[1] + turn[2]) / 3;
}

// Scores differ from those without by so many of their standard deviations a radian, and grasps are the same.
TEST(GraspPlanner, ConcavityIsWeighedInDeviationsOfTheScores) {
  PlannerOptions options;
  const auto planWith = [&](double weight) {
    options.concavity_weight = weight;
    return GraspPlanner(barrettHand(), test::linearModel(), options).plan(requestFor(cloudOf("bottle"), 0));
  };
  options.merge_distance_m = 0.0;  // all grasps are in the answer
  const std::vector<Grasp> without = planWith(0.0).grasps, with = planWith(2.0).grasps;
  ASSERT_FALSE(without.empty());
  ASSERT_EQ(without.size(), with.size());
  double mean = 0.0, variance = 0.0;
  for (const Grasp& grasp : without) mean += grasp.score / static_cast<double>(without.size());
  for (const Grasp& grasp : without)
    variance += (grasp.score - mean) * (grasp.score - mean) / static_cast<double>(without.size());
  for (const Grasp& grasp : with) {
    const auto same = std::find_if(without.begin(), without.end(), [&](const Grasp& other) {
      return other.X_CP.isApprox(grasp.X_CP, 1e-12) && other.quality == grasp.quality;
    });
    ASSERT_NE(same, without.end());
    EXPECT_NEAR(grasp.score, same->score - 2.0 * std::sqrt(variance) * meanTurn(grasp), 1e-9);
  }
}

TEST(GraspPlanner, LeavesAreToldApartByShape) {
  const auto shapesIn = [](const char* object) {
    const PlanResult result = planner().plan(requestFor(cloudOf(object)));
    std::vector<ShapeKind> kinds;
    for (const BoxShape& shape : result.objects.at(0).shapes) kinds.push_back(shape.kind);
    EXPECT_EQ(kinds.size(), result.objects[0].tree.nodes.size());
    return kinds;
  };
  const auto mug = shapesIn("mug");
  EXPECT_TRUE(std::count(mug.begin(), mug.end(), ShapeKind::cylinder)) << "no cylinder in a mug";
  const auto radio = shapesIn("radio");
  EXPECT_FALSE(std::count(radio.begin(), radio.end(), ShapeKind::sphere)) << "a sphere in a radio";
}

// Two jaws by virtual fingers: F1 and F2 on the one, the thumb on the other, one opening of the jaws.
TEST(GraspPlanner, AParallelGripperPlansPinchesItCanClose) {
  const HandDescription hand = readHandDescription(BOXGRASP_SOURCE_DIR "/deploy/hands/parallel_gripper.toml");
  const double tolerance_m = 2 * ContactOptions{}.search_m;
  for (const char* object : {"mug", "hammer"}) {
    const PlanResult result = GraspPlanner(hand, test::linearModel(), {}).plan(requestFor(cloudOf(object)));
    ASSERT_EQ(result.outcome, Outcome::grasps) << object << ": " << result.message;
    for (const Grasp& grasp : result.grasps) {
      const auto& joints = grasp.joints.inner;
      EXPECT_EQ(joints[kF1], joints[kF2]);
      EXPECT_EQ(joints[kF1], joints[kThumb]);
      EXPECT_LT(grasp.pregrasp.inner[kF1], joints[kF1]);
      const double opening = 2 * (hand.base_radius - hand.slide_per_rad * joints[kF1]);
      const Vector3d jaw = 0.5 * (grasp.contacts[kF1].p_C + grasp.contacts[kF2].p_C);
      EXPECT_NEAR((jaw - grasp.contacts[kThumb].p_C).dot(grasp.X_CP.linear().col(1)), opening, tolerance_m)
          << "each contact was looked for so near the jaw";
      EXPECT_TRUE(
          testClearance(hand, grasp.X_CP, grasp.joints, PointGrid(result.objects[0].cloud_C, 0.01)).pregrasp);
    }
  }
}

TEST(GraspPlanner, MillimetresMistakenForMetresAreRefusedWithTheRemedy) {
  PointCloud cloud = cloudOf("mug");
  for (auto* axis : {&cloud.x, &cloud.y, &cloud.z}) {
    for (float& value : *axis) value *= 1000.0f;
  }
  const PlanResult result = planner().plan(requestFor(cloud));
  EXPECT_EQ(result.outcome, Outcome::bad_input);
  EXPECT_NE(result.message.find("scale"), std::string::npos) << result.message;
}

TEST(GraspPlanner, RequestsThatAskForTheImpossibleAreRefused) {
  PlanRequest no_such_object = requestFor(cloudOf("mug"));
  no_such_object.object = 3;
  PlanRequest no_gravity = requestFor(cloudOf("mug"));
  no_gravity.gravity_C = Vector3d::Zero();
  PlanRequest no_friction = requestFor(cloudOf("mug"));
  no_friction.friction = -1.0;
  for (const PlanRequest& request : {no_such_object, no_gravity, no_friction}) {
    EXPECT_EQ(planner().plan(request).outcome, Outcome::bad_input);
  }
}

TEST(GraspPlanner, AnExpiredDeadlineIsAnOutcome) {
  const StopToken expired(StopToken::Clock::now() - std::chrono::seconds(1));
  const PlanResult result = planner().plan(requestFor(cloudOf("mug")), expired);
  EXPECT_EQ(result.outcome, Outcome::deadline);
  EXPECT_TRUE(result.grasps.empty());
}

TEST(GraspPlanner, CancellationStopsAPlanThatIsRunning) {
  const auto cancelled = std::make_shared<std::atomic<bool>>(true);
  const PlanResult result = planner().plan(requestFor(cloudOf("mug")), StopToken(std::nullopt, cancelled));
  EXPECT_EQ(result.outcome, Outcome::cancelled);
}

// A box on a table: grasps come from above or the side, never through the table, even where the box hides it.
TEST(GraspPlanner, NoGraspReachesThroughTheTable) {
  PointCloud scene;
  std::mt19937_64 random(11);
  for (int i = 0; i < 40'000; ++i) {
    const double x = uniform(random, -0.4, 0.4), y = uniform(random, -0.3, 0.3);
    const bool hidden = std::abs(x) < 0.03 && std::abs(y) < 0.04;
    if (!hidden) scene.push({x, y, 0});
  }
  for (int i = 0; i < 15'000; ++i) {
    Vector3d p(uniform(random, -0.03, 0.03), uniform(random, -0.04, 0.04), uniform(random, 0.0, 0.12));
    const int side = static_cast<int>(uniformIndex(random, 5));
    if (side < 2)
      p.x() = side ? 0.03 : -0.03;
    else if (side < 4)
      p.y() = side == 2 ? 0.04 : -0.04;
    else
      p.z() = 0.12;
    scene.push(p);
  }
  const PlanResult result = planner().plan(requestFor(scene));
  ASSERT_EQ(result.outcome, Outcome::grasps) << result.message;
  for (const Grasp& grasp : result.grasps) {
    const HandGeometry hand = forwardKinematics(barrettHand(), grasp.joints);
    for (const Capsule& link : hand.links) {
      const double lowest = std::min((grasp.X_CP * link.a).z(), (grasp.X_CP * link.b).z()) - link.radius;
      EXPECT_GT(lowest, -0.006) << link.name << " is below the table";
    }
  }
}

}  // namespace
}  // namespace boxgrasp
