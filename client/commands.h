// What the client does: one function for each of its commands.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "boxgrasp/cloud/read_cloud.h"
#include "boxgrasp/planning/robot.h"
#include "plan_json.h"

namespace boxgrasp {

// What a request says of its robot. Boxes are six numbers: one corner and the opposite one.
struct RobotFlags {
  std::optional<std::array<double, 6>> table;  // point and normal, in the cloud's frame
  std::optional<AnswerFrame> answer_frame;
  std::optional<std::array<double, 7>> camera_pose;  // position and quaternion w x y z
  std::optional<std::array<double, 3>> approach;
  double approach_cone_rad = 0.52;
  std::optional<std::array<double, 6>> workspace;
  std::vector<std::array<double, 6>> forbidden;
};

struct PlanCommand {
  std::filesystem::path file;  // cloud or mesh
  ReadOptions read;
  std::string frame = "cloud";
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  bool local = false;                                        // plan in this process
  std::optional<std::filesystem::path> config, model, hand;  // of the plan in this process
  std::optional<std::filesystem::path> picture, html;
  bool draws() const { return picture || html; }
  bool json = false;
  int top = 10;             // 0: all
  double deadline_s = 0.0;  // 0: none
  double friction = 0.4;
  std::optional<std::array<double, 3>> gravity;
  std::vector<std::array<double, 3>> viewpoints;  // else the file's, if it has one
  RobotFlags robot;
  int object = -1;
  std::string request_id;  // of a plan made by the server; empty: a new one
};

// All return an exit code and print results to stdout, messages to stderr. They throw what reading, planning
// and the server throw.
int runPlan(const PlanCommand& command);                       // the ranked grasps
Json plannedJson(const PlanCommand& command, int& exit_code);  // the same as JSON, not printed
int runExplain(const PlanCommand& command);                    // where candidates were lost
int runShow(const PlanCommand& command);                       // the picture or the page alone
int runStatus(const std::string& lcm_url, bool json);

}  // namespace boxgrasp
