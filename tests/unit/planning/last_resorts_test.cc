// What the planner does where the faces that were seen have no grasp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "boxgrasp/objects/depth_camera.h"
#include "boxgrasp/objects/parametric.h"
#include "boxgrasp/planning/grasp_planner.h"
#include "test_model.h"

namespace boxgrasp {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;

PlanRequest seenByOneCamera(const char* object, int camera) {
  const TriangleMesh mesh_O = parametricObject(object);
  const Pose X_OS = viewRing(mesh_O, {.views = 4})[camera].X_OS;
  PlanRequest request;
  request.cloud_C = seeFrom({.object_O = mesh_O, .others_O = {}, .table = true}, X_OS).objectCloud_O();
  request.viewpoints_C = {X_OS.translation()};
  request.gravity_C = -Vector3d::UnitZ();
  return request;
}

PlanResult planned(const PlanRequest& request, bool guessed_faces, EdgeUse edges) {
  PlannerOptions options;
  options.force_closure = ForceClosureUse::require;
  options.faces.edges = edges;
  options.guessed_faces = guessed_faces;
  return GraspPlanner(barrettHand(), test::linearModel(), options).plan(request);
}

// Whether each grasp comes over a face that is turned to the camera.
std::vector<bool> facesSeen(const PlanResult& result, const PlanRequest& request) {
  std::vector<bool> seen;
  for (const Grasp& grasp : result.grasps) {
    const OrientedBox& box = result.objects[grasp.object].tree.nodes[grasp.box].box;
    const Pose X_CF = faceOf(box, grasp.box, grasp.face).X_CF;
    seen.push_back(facesASensor(X_CF.translation(), -X_CF.linear().col(2), request.viewpoints_C));
  }
  return seen;
}

TEST(GuessedFaces, AreComeToWhereTheSeenOnesHaveNoGrasp) {
  int rescued = 0, kept = 0;
  for (const char* object : {"mug", "radio", "horse", "bottle"}) {
    for (int camera = 0; camera < 4; ++camera) {
      SCOPED_TRACE(::testing::Message() << object << " seen by camera " << camera);
      const PlanRequest request = seenByOneCamera(object, camera);
      const PlanResult without = planned(request, false, EdgeUse::never);
      const PlanResult with = planned(request, true, EdgeUse::never);
      if (!without.grasps.empty()) {
        EXPECT_EQ(with.grasps.size(), without.grasps.size()) << "nothing was missing";
        EXPECT_THAT(facesSeen(with, request), Each(true));
        ++kept;
      } else if (!with.grasps.empty()) {
        EXPECT_THAT(with.report.notes, Contains(HasSubstr("the one that was guessed")));
        EXPECT_THAT(facesSeen(with, request), Each(false)) << "on a side where there was none before";
        ++rescued;
      } else {
        EXPECT_EQ(with.message, without.message) << "the reason is that of the side that was seen";
      }
    }
  }
  EXPECT_GT(kept, 0);
  EXPECT_GT(rescued, 0) << "every object had a grasp on the side that was seen: nothing was tried";
}

TEST(Edges, AreComeOverWhereNoFaceHasAGrasp) {
  int rescued = 0, kept = 0;
  for (const char* object : {"mug", "horse", "squirrel"}) {
    for (int camera = 0; camera < 4; ++camera) {
      SCOPED_TRACE(::testing::Message() << object << " seen by camera " << camera);
      const PlanRequest request = seenByOneCamera(object, camera);
      const PlanResult without = planned(request, false, EdgeUse::never);
      const PlanResult with = planned(request, false, EdgeUse::last);
      const auto on_edges = std::ranges::count_if(with.grasps, [](const Grasp& g) { return isEdge(g.face); });
      if (!without.grasps.empty()) {
        EXPECT_EQ(with.grasps.size(), without.grasps.size()) << "nothing was missing";
        EXPECT_EQ(on_edges, 0);
        ++kept;
      } else if (!with.grasps.empty()) {
        EXPECT_THAT(with.report.notes, Contains(HasSubstr("these come over edges")));
        EXPECT_EQ(on_edges, static_cast<std::ptrdiff_t>(with.grasps.size()));
        ++rescued;
      } else {
        EXPECT_EQ(with.message, without.message) << "the reason is that of the faces";
      }
    }
  }
  EXPECT_GT(kept, 0);
  EXPECT_GT(rescued, 0) << "every object had a grasp on its faces: nothing was tried";
}

TEST(Edges, CountFromTheStartForPartialClouds) {
  PlanRequest request = seenByOneCamera("mug", 0);
  const auto faces = [&](EdgeUse edges) { return planned(request, false, edges).report.stages; };
  const auto stage = [](const std::vector<Stage>& stages) {
    return *std::ranges::find(stages, "faces", &Stage::name);
  };
  EXPECT_EQ(stage(faces(EdgeUse::partial)).in, stage(faces(EdgeUse::always)).in);
  EXPECT_EQ(stage(faces(EdgeUse::partial)).in, 3 * stage(faces(EdgeUse::never)).in)
      << "six faces, twelve edges";
  request.viewpoints_C.clear();
  EXPECT_EQ(stage(faces(EdgeUse::partial)).in, stage(faces(EdgeUse::never)).in)
      << "nobody says what is hidden";
}

}  // namespace
}  // namespace boxgrasp
