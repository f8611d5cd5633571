#include "plan_json.h"

#include <fmt/format.h>

#include <span>

#include "boxgrasp/messaging/plan_conversion.h"

namespace boxgrasp {
namespace {

Json numbers(std::span<const double> values) {
  return Json(std::vector<double>(values.begin(), values.end()));
}

Json jointsJson(const double (&joints)[4]) {
  return {{"spread", joints[0]}, {"f1", joints[1]}, {"f2", joints[2]}, {"f3", joints[3]}};
}

Json contactJson(const contact_t& contact, int finger) {
  return {{"position_m", numbers(contact.position_m)},
          {"normal", numbers(contact.normal)},
          {"seen", contact.seen != 0},
          {"finger", fmt::format("f{}", finger + 1)}};
}

Json poseJson(const double (&position_m)[3], const double (&quaternion_wxyz)[4]) {
  return {{"position_m", numbers(position_m)}, {"quaternion_wxyz", numbers(quaternion_wxyz)}};
}

Json graspJson(const grasp_t& grasp) {
  Json contacts = Json::array();
  for (int finger = 0; finger < 3; ++finger) contacts.push_back(contactJson(grasp.contacts[finger], finger));
  return {{"score", grasp.score},
          {"palm_pose", poseJson(grasp.palm_position_m, grasp.palm_quaternion_wxyz)},
          {"pregrasp_pose", poseJson(grasp.pregrasp_position_m, grasp.palm_quaternion_wxyz)},
          {"lift_pose", poseJson(grasp.lift_position_m, grasp.palm_quaternion_wxyz)},
          {"tool",
           {{"pose", poseJson(grasp.tool_position_m, grasp.tool_quaternion_wxyz)},
            {"pregrasp_pose", poseJson(grasp.tool_pregrasp_position_m, grasp.tool_quaternion_wxyz)},
            {"lift_pose", poseJson(grasp.tool_lift_position_m, grasp.tool_quaternion_wxyz)}}},
          {"joints_rad", jointsJson(grasp.joints_rad)},
          {"pregrasp_rad", jointsJson(grasp.pregrasp_rad)},
          {"contacts", contacts},
          {"approach", numbers(grasp.approach)},
          {"quality", numbers(grasp.quality)},
          {"object", grasp.object},
          {"box", grasp.box},
          {"face", grasp.face}};
}

Json boxJson(const box_t& box) {
  return {{"center_m", numbers(box.center_m)},
          {"quaternion_wxyz", numbers(box.quaternion_wxyz)},
          {"extents_m", numbers(box.extents_m)},
          {"points", box.points},
          {"parent", box.parent},
          {"leaf", box.leaf != 0},
          {"theta", box.theta},
          {"stop_reason", box.stop_reason},
          {"object", box.object},
          {"shape",
           {{"kind", box.shape},
            {"center_m", numbers(box.shape_center_m)},
            {"axis", numbers(box.shape_axis)},
            {"radius_m", box.shape_radius_m}}}};
}

Json reportJson(const plan_response_t& response) {
  Json stages = Json::array(), rejected = Json::object();
  for (const stage_t& stage : response.stages)
    stages.push_back(
        {{"name", stage.name}, {"in", stage.num_in}, {"out", stage.num_out}, {"time_s", stage.time_s}});
  for (const rejection_t& rejection : response.rejected) rejected[rejection.reason] = rejection.count;
  return {{"stages", stages},
          {"rejected", rejected},
          {"notes", response.notes},
          {"seed", response.seed},
          {"time_s", response.time_s}};
}

template <typename Item, typename Convert>
Json list(const std::vector<Item>& items, Convert convert) {
  Json json = Json::array();
  for (const Item& item : items) json.push_back(convert(item));
  return json;
}

}  // namespace

Json planJson(const plan_response_t& response) {
  return {{"schema", 1},
          {"outcome", outcomeName(response.outcome)},
          {"message", response.message},
          {"model_version", response.model_version},
          {"frame", response.frame},
          {"grasps", list(response.grasps, graspJson)},
          {"boxes", list(response.boxes, boxJson)},
          {"report", reportJson(response)}};
}

std::string jsonText(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace); }

}  // namespace boxgrasp
