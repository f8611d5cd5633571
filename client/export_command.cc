#include "export_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "boxgrasp/base/durable_file.h"
#include "boxgrasp/base/error.h"
#include "boxgrasp/base/exit_code.h"
#include "boxgrasp/geometry/pose.h"
#include "plan_json.h"

namespace boxgrasp {
namespace {

constexpr std::uintmax_t kMaxPlanBytes = 1u << 30;
constexpr double kGripperDepth_m = 0.02, kGripperHeight_m = 0.02;

Vector3d vectorOf(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

std::string row(const Json& numbers, const char* between) {
  std::vector<double> values;
  for (const Json& number : numbers) values.push_back(number.get<double>());
  return fmt::format("{}", fmt::join(values, between));
}

// YAML 1.1 takes 1e-05 for a word: there must be a point.
std::string yamlNumber(double value) {
  std::string text = fmt::format("{}", value);
  const auto exponent = text.find('e');
  if (exponent != std::string::npos && text.find('.') == std::string::npos) text.insert(exponent, ".0");
  return text;
}

std::string yamlRow(const Json& numbers, std::size_t first = 0) {
  std::vector<std::string> values;
  for (std::size_t i = first; i < numbers.size(); ++i) values.push_back(yamlNumber(numbers[i].get<double>()));
  return fmt::format("[{}]", fmt::join(values, ", "));
}

// The three poses of a grasp, of palm or tool.
struct Poses {
  const Json &before, &grasp, &lifted;
};

Poses posesOf(const Json& grasp, bool tool) {
  if (!tool) return {grasp.at("pregrasp_pose"), grasp.at("palm_pose"), grasp.at("lift_pose")};
  const Json& of_tool = grasp.at("tool");
  return {of_tool.at("pregrasp_pose"), of_tool.at("pose"), of_tool.at("lift_pose")};
}

// The joints' names and angles, in the plan's order.
std::vector<std::pair<std::string, double>> jointsOf(const Json& joints, const ExportCommand& command) {
  const std::vector<std::string>& names = command.joint_names;
  if (!names.empty() && names.size() != joints.size())
    throw InputError(
        fmt::format("--joint-names has {} names, but the hand has {} joints", names.size(), joints.size()));
  std::vector<std::pair<std::string, double>> named;
  for (const auto& [name, angle] : joints.items())
    named.emplace_back(names.empty() ? name : names[named.size()], angle.get<double>());
  return named;
}

std::string csvHeader(const Json& grasp, const ExportCommand& command) {
  const char* frame = command.tool ? "tool" : "palm";
  std::string line =
      fmt::format("rank,score,object,box,face,{0}_x_m,{0}_y_m,{0}_z_m,{0}_qw,{0}_qx,{0}_qy,{0}_qz", frame);
  for (const char* when : {"pregrasp", "lift"}) line += fmt::format(",{0}_x_m,{0}_y_m,{0}_z_m", when);
  for (const char* when : {"joint", "pregrasp"}) {
    for (const auto& [name, angle] : jointsOf(grasp.at("joints_rad"), command))
      line += fmt::format(",{}_{}_rad", when, name);
  }
  for (const Json& contact : grasp.at("contacts"))
    line += fmt::format(",contact_{0}_x_m,contact_{0}_y_m,contact_{0}_z_m",
                        contact.at("finger").get<std::string>());
  return line + "\n";
}

std::string csvLine(const Json& grasp, std::size_t rank, const ExportCommand& command) {
  const Poses poses = posesOf(grasp, command.tool);
  std::string line =
      fmt::format("{},{},{},{},{},{},{},{},{}", rank, grasp.at("score").get<double>(),
                  grasp.at("object").get<int>(), grasp.at("box").get<int>(), grasp.at("face").get<int>(),
                  row(poses.grasp.at("position_m"), ","), row(poses.grasp.at("quaternion_wxyz"), ","),
                  row(poses.before.at("position_m"), ","), row(poses.lifted.at("position_m"), ","));
  for (const char* when : {"joints_rad", "pregrasp_rad"})
    line += fmt::format(",{}", row(grasp.at(when), ","));
  for (const Json& contact : grasp.at("contacts"))
    line += fmt::format(",{}", row(contact.at("position_m"), ","));
  return line + "\n";
}

std::string csv(const Json& grasps, const ExportCommand& command) {
  std::string text = grasps.empty() ? "" : csvHeader(grasps.at(0), command);
  for (std::size_t i = 0; i < grasps.size(); ++i) text += csvLine(grasps[i], i + 1, command);
  return text;
}

std::string isaacGrasp(const Json& grasps, const std::string& frame, const ExportCommand& command) {
  std::string text = fmt::format(
      "format: isaac_grasp\nformat_version: 1.0\n\nobject_frame: {}\ngripper_frame: {}\n\ngrasps:{}\n",
      Json(frame).dump(), command.tool ? "tool" : "palm", grasps.empty() ? " {}" : "");
  const auto joints = [&](const char* key, const Json& angles) {
    text += fmt::format("    {}:\n", key);
    for (const auto& [name, angle] : jointsOf(angles, command))
      text += fmt::format("      {}: {}\n", Json(name).dump(), yamlNumber(angle));
  };
  for (std::size_t i = 0; i < grasps.size(); ++i) {
    const Json& pose = posesOf(grasps[i], command.tool).grasp;
    const Json& q = pose.at("quaternion_wxyz");
    text += fmt::format(
        "  \"grasp_{}\":\n    confidence: {}\n    position: {}\n    orientation: {{w: {}, xyz: {}}}\n", i,
        yamlNumber(std::clamp(grasps[i].at("score").get<double>(), 0.0, 1.0)), yamlRow(pose.at("position_m")),
        yamlNumber(q.at(0).get<double>()), yamlRow(q, 1));
    joints("cspace_position", grasps[i].at("joints_rad"));
    joints("pregrasp_cspace_position", grasps[i].at("pregrasp_rad"));
  }
  return text;
}

using GraspNetRow = std::array<double, 17>;

// The thumb is the last finger.
GraspNetRow graspNetRow(const Json& grasp) {
  const Json& contacts = grasp.at("contacts");
  const Vector3d thumb = vectorOf(contacts.at(contacts.size() - 1).at("position_m"));
  Vector3d others = Vector3d::Zero();
  for (std::size_t i = 0; i + 1 < contacts.size(); ++i)
    others += vectorOf(contacts[i].at("position_m")) / static_cast<double>(contacts.size() - 1);
  Matrix3d axes;
  axes.col(0) = vectorOf(grasp.at("approach")).normalized();
  const Vector3d across = (thumb - others) - (thumb - others).dot(axes.col(0)) * axes.col(0);
  axes.col(1) = across.normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  const Vector3d origin = (thumb + others) / 2 - kGripperDepth_m * axes.col(0);
  GraspNetRow row{grasp.at("score").get<double>(), across.norm(), kGripperHeight_m, kGripperDepth_m};
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(row.data() + 4) = axes;
  Eigen::Map<Vector3d>(row.data() + 13) = origin;
  row[16] = grasp.at("object").get<double>();
  return row;
}

// As numpy.save() writes an array of little endian doubles, version 1.0.
std::string npy(const std::vector<GraspNetRow>& rows) {
  std::string head =
      fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, 17), }}", rows.size());
  constexpr std::size_t kFixed = 10, kAlign = 64;
  head.resize((kFixed + head.size() + 1 + kAlign - 1) / kAlign * kAlign - kFixed - 1, ' ');
  head += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += {static_cast<char>(head.size() & 0xff), static_cast<char>(head.size() >> 8)};
  bytes += head;
  for (const GraspNetRow& row : rows) bytes.append(reinterpret_cast<const char*>(row.data()), sizeof row);
  return bytes;
}

std::string graspNet(const Json& grasps, const ExportCommand& command) {
  std::vector<GraspNetRow> rows;
  for (const Json& grasp : grasps) rows.push_back(graspNetRow(grasp));
  if (command.out.extension() == ".npy") return npy(rows);
  std::string text;
  for (const GraspNetRow& row : rows) text += fmt::format("{}\n", fmt::join(row, " "));
  return text;
}

std::string exported(const Json& plan, const ExportCommand& command) {
  const Json& grasps = plan.at("grasps");
  if (command.format == "graspnet") return graspNet(grasps, command);
  if (command.format == "isaac_grasp")
    return isaacGrasp(grasps, plan.at("frame").get<std::string>(), command);
  return csv(grasps, command);
}

void checkSchema(const Json& plan) {
  if (!plan.contains("schema") || plan["schema"] != 1)
    throw InputError(fmt::format("this plan's schema is {}, but this version reads 1; plan again",
                                 plan.contains("schema") ? plan["schema"].dump() : "none"));
}

bool isPlan(const std::filesystem::path& file) {
  char first = 0;
  std::ifstream(file) >> first;
  return first == '{';
}

Json planOf(const ExportCommand& command, int& code) {
  code = kDone;
  if (isPlan(command.plan.file)) return Json::parse(readWhole(command.plan.file, kMaxPlanBytes));
  return plannedJson(command.plan, code);
}

void write(const std::string& text, const std::filesystem::path& file) {
  if (file.empty())
    fmt::print("{}", text);
  else
    writeDurably(file, text);
}

}  // namespace

int runExport(const ExportCommand& command) try {
  int code = kDone;
  const Json plan = planOf(command, code);
  checkSchema(plan);
  write(exported(plan, command), command.out);
  const std::size_t grasps = plan.at("grasps").size();
  fmt::print(stderr, "boxgrasp: {} grasps exported{}\n", grasps,
             command.out.empty() ? "" : fmt::format(" to {}", command.out.string()));
  return code == kDone && grasps == 0 ? kNothingFound : code;
} catch (const Json::exception& error) {
  throw InputError(fmt::format("'{}' is no plan: {}; a plan is what 'boxgrasp plan --json' prints",
                               command.plan.file.string(), error.what()));
}

}  // namespace boxgrasp
