// Plans grasps for a file in this process, without a server:  plan_grasps CLOUD.pcd
#include <cstdio>

#include "boxgrasp/base/error.h"
#include "boxgrasp/cloud/read_cloud.h"
#include "boxgrasp/planning/default_model.h"
#include "boxgrasp/planning/grasp_planner.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: plan_grasps CLOUD\n");
    return 2;
  }
  try {
    const boxgrasp::GraspPlanner planner(boxgrasp::barrettHand(), boxgrasp::modelOrDefault({}));
    boxgrasp::PlanRequest request;
    request.cloud_C = boxgrasp::readCloud(argv[1]).cloud_C;
    const boxgrasp::PlanResult result = planner.plan(request);
    std::printf("%s\n", result.message.c_str());
    for (const boxgrasp::Grasp& grasp : result.grasps) {
      const boxgrasp::Vector3d palm_C = grasp.X_CP.translation();
      std::printf("score %.3f, palm at (%.3f, %.3f, %.3f) m\n", grasp.score, palm_C.x(), palm_C.y(),
                  palm_C.z());
    }
    return result.grasps.empty() ? 1 : 0;
  } catch (const boxgrasp::InputError& error) {
    std::fprintf(stderr, "plan_grasps: %s\n", error.what());
    return 3;
  }
}
