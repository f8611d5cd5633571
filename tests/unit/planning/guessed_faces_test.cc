// What the planner does where the side that was seen has no grasp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

PlanResult planned(const PlanRequest& request, bool guessed_faces) {
  PlannerOptions options;
  options.force_closure = ForceClosureUse::require;
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
      const PlanResult without = planned(request, false), with = planned(request, true);
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

}  // namespace
}  // namespace boxgrasp
