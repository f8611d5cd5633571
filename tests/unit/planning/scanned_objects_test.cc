// The planner on real scans, where the folder of test data stands beside the project.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "boxgrasp/cloud/read_cloud.h"
#include "boxgrasp/planning/default_model.h"
#include "boxgrasp/planning/distinct.h"
#include "boxgrasp/planning/grasp_planner.h"
#include "boxgrasp/wrench/grasp_wrench_space.h"

namespace boxgrasp {
namespace {

std::vector<std::filesystem::path> filesIn(const char* folder) {
  const std::filesystem::path data =
      std::filesystem::path(BOXGRASP_SOURCE_DIR) / ".." / "shared" / "data" / folder;
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::is_directory(data)) return files;
  for (const auto& entry : std::filesystem::directory_iterator(data)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

PlanResult planFor(const std::filesystem::path& file) {
  const LoadedCloud loaded = readCloud(file);
  PlanRequest request;
  request.cloud_C = loaded.cloud_C;
  if (loaded.viewpoint_C) request.viewpoints_C = {*loaded.viewpoint_C};
  return GraspPlanner(barrettHand(), modelOrDefault(std::nullopt)).plan(request);
}

void expectSound(const Grasp& grasp, const PointGrid& object_C) {
  std::vector<Contact> contacts;
  for (const SurfaceContact& contact : grasp.contacts) {
    EXPECT_TRUE(object_C.nearest(contact.p_C, 0.005)) << "a contact is more than 5 mm from the cloud";
    contacts.push_back({contact.p_C, contact.normal_C});
  }
  EXPECT_TRUE(forceClosure(contacts)) << "the contacts are not in force closure";
  EXPECT_TRUE(testClearance(barrettHand(), grasp.X_CP, grasp.joints, object_C).pregrasp)
      << "the hand meets the object";
}

TEST(ScannedObjects, HaveTenDifferentSoundGraspsEach) {
  const auto files = filesIn("objects/ycb");
  if (files.empty()) GTEST_SKIP() << "no scanned objects in ../shared/data/objects/ycb";
  for (const auto& file : files) {
    SCOPED_TRACE(file.filename());
    const PlanResult result = planFor(file);
    ASSERT_EQ(result.grasps.size(), 10u) << result.message;
    const PointGrid object_C(result.objects[0].cloud_C, 0.006);
    for (std::size_t i = 0; i < result.grasps.size(); ++i) {
      expectSound(result.grasps[i], object_C);
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_FALSE(nearlyIdentical(result.grasps[i], result.grasps[j], 0.010, 0.26))
            << "grasps " << i << " and " << j;
      }
    }
  }
}

TEST(Scenes, AreAnsweredByGraspsOrByAReason) {
  const auto files = filesIn("scenes");
  if (files.empty()) GTEST_SKIP() << "no scenes in ../shared/data/scenes";
  std::size_t with_grasps = 0;
  for (const auto& file : files) {
    SCOPED_TRACE(file.filename());
    const PlanResult result = planFor(file);
    if (result.outcome == Outcome::grasps) {
      ++with_grasps;
      continue;
    }
    EXPECT_EQ(result.outcome, Outcome::no_grasp);
    EXPECT_NE(result.message.find("no grasp: stage '"), std::string::npos) << result.message;
  }
  EXPECT_GE(with_grasps, 5u) << "of " << files.size() << " scenes";
}

}  // namespace
}  // namespace boxgrasp
