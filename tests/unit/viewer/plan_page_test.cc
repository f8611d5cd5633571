#include "boxgrasp/viewer/plan_page.h"

#include <gtest/gtest.h>

#include <fstream>

#include "boxgrasp/objects/parametric.h"
#include "boxgrasp/planning/default_model.h"
#include "boxgrasp/planning/grasp_planner.h"
#include "error_of.h"

namespace boxgrasp {
namespace {

using Json = nlohmann::ordered_json;

struct Planned {
  GraspPlanner planner{barrettHand(), modelOrDefault({})};
  PlanTrace trace;
  PlanResult result;
};

const Planned& mug() {
  static const Planned planned = [] {
    Planned made;
    PlanRequest request;
    request.cloud_C = sampleSurface(parametricObject("mug", 1.0), 5000, 1);
    made.result = made.planner.plan(request, {}, &made.trace);
    return made;
  }();
  return planned;
}

ViewerOptions with(int ViewerOptions::*field, int value) {
  ViewerOptions options;
  options.*field = value;
  return options;
}

ViewerOptions titled(const std::string& title) {
  ViewerOptions options;
  options.title = title;
  return options;
}

Json sceneOf(const ViewerOptions& options = {}) {
  return planScene(mug().result, mug().trace, mug().planner.hand(), options);
}

std::string base64Decoded(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text.substr(0, text.find('='))) {
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    if ((count += 6) < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 255);
  }
  return bytes;
}

TEST(PlanScene, HoldsEveryGraspBoxAndStageOfThePlan) {
  const Json scene = sceneOf();
  ASSERT_FALSE(mug().result.grasps.empty());
  EXPECT_EQ(scene["grasps"].size(), mug().result.grasps.size());
  EXPECT_EQ(scene["objects"][0]["boxes"].size(), mug().result.objects[0].tree.nodes.size());
  EXPECT_EQ(scene["report"]["stages"].size(), mug().result.report.stages.size());
  EXPECT_EQ(scene["grasps"][0]["score"].get<double>(), mug().result.grasps[0].score);
}

TEST(PlanScene, CarriesTheCloudToTheBit) {
  const PointCloud& cloud = mug().result.objects[0].cloud_C;
  const Json json = sceneOf()["objects"][0]["cloud"];
  const std::string bytes = base64Decoded(json["xyz_float32"]);
  ASSERT_EQ(bytes.size(), 12 * cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    float xyz[3];
    std::memcpy(xyz, bytes.data() + 12 * i, sizeof xyz);
    ASSERT_TRUE(xyz[0] == cloud.x[i] && xyz[1] == cloud.y[i] && xyz[2] == cloud.z[i]) << "point " << i;
  }
  EXPECT_EQ(base64Decoded(json["leaf_uint8"]).size(), cloud.size());
}

TEST(PlanScene, SaysHowManyPointsWereGuessed) {
  PlanResult result = mug().result;
  result.objects[0].guessed = 7;
  EXPECT_EQ(planScene(result, mug().trace, mug().planner.hand())["objects"][0]["guessed"], 7);
  EXPECT_EQ(sceneOf()["objects"][0]["guessed"], 0) << "a whole surface leaves nothing to guess";
}

TEST(PlanScene, ThinsLargeClouds) {
  const Json json = sceneOf(with(&ViewerOptions::max_points, 100))["objects"][0]["cloud"];
  EXPECT_LE(json["drawn"].get<int>(), 100);
  EXPECT_EQ(json["points"].get<std::size_t>(), mug().result.objects[0].cloud_C.size());
}

TEST(PlanScene, ClosesTheHandFromPregraspToTheGrasp) {
  const Grasp& grasp = mug().result.grasps[0];
  const Json closing = sceneOf()["grasps"][0]["closing"];
  const auto tip = [](const Json& step) {
    const Json& end = step[2][2];
    return Vector3d(end[0], end[1], end[2]);
  };
  const HandDescription& hand = mug().planner.hand();
  EXPECT_LT((tip(closing.back()) - forwardKinematics(hand, grasp.joints).links[2].b).norm(), 1e-12);
  EXPECT_LT((tip(closing.front()) - forwardKinematics(hand, grasp.pregrasp).links[2].b).norm(), 1e-12);
}

TEST(PlanScene, ExplainsAPlanWithoutGrasps) {
  PlanTrace trace;
  const PlanResult result = mug().planner.plan({}, {}, &trace);
  const Json scene = planScene(result, trace, mug().planner.hand());
  EXPECT_EQ(scene["grasps"].size(), 0u);
  EXPECT_FALSE(scene["message"].get<std::string>().empty());
}

TEST(PlanPage, LetsNoTextEndTheScriptThatItStandsIn) {
  const std::string page = planPage(sceneOf(titled("</script><img src=x onerror=alert(1)>")));
  EXPECT_EQ(page.find("</script><img"), std::string::npos);
  EXPECT_NE(page.find("\\u003c/script>\\u003cimg"), std::string::npos);
}

TEST(PlanPage, StandsUpToTextThatIsNotUtf8) { EXPECT_NO_THROW(planPage(sceneOf(titled("\xff\xfe")))); }

TEST(PlanPage, RefersToNoOtherPlace) {
  const std::string page = livePage();
  for (const char* reference : {"src=\"http", "href=\"http", "@import", "url(http"})
    EXPECT_EQ(page.find(reference), std::string::npos) << reference;
  EXPECT_EQ(page.find("{{viewer}}"), std::string::npos);
}

TEST(PlanPage, NamesTheFileThatItCannotWrite) {
  const std::string error = test::errorOf([] { writePlanPage(Json::object(), "/no/such/folder/out.html"); });
  EXPECT_NE(error.find("/no/such/folder/out.html"), std::string::npos) << error;
}

TEST(ViewerOptions, AreChecked) {
  EXPECT_NE(test::errorOf([] { sceneOf(with(&ViewerOptions::max_points, 0)); }).find("max_points"),
            std::string::npos);
  EXPECT_NE(test::errorOf([] { sceneOf(with(&ViewerOptions::closing_steps, 0)); }).find("closing_steps"),
            std::string::npos);
}

}  // namespace
}  // namespace boxgrasp
