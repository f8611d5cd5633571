#include "plan_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "boxgrasp/messaging/plan_conversion.h"
#include "boxgrasp/planning/tally.h"

namespace boxgrasp {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

std::string vectorText(const double* v) { return fmt::format("({:7.4f} {:7.4f} {:7.4f})", v[0], v[1], v[2]); }

std::string graspText(const grasp_t& grasp, int rank) {
  const double* q = grasp.palm_quaternion_wxyz;
  const double* joints = grasp.joints_rad;
  std::string text =
      fmt::format("#{:<3} score {:.4f}   box {}, face {}{}\n", rank, grasp.score, grasp.box, grasp.face,
                  grasp.object > 0 ? fmt::format(", object {}", grasp.object) : "");
  text +=
      fmt::format("     palm      {} m   quaternion w x y z ({:.4f} {:.4f} {:.4f} {:.4f})   approach {}\n",
                  vectorText(grasp.palm_position_m), q[0], q[1], q[2], q[3], vectorText(grasp.approach));
  text += fmt::format("     from      {} m   lift to {} m\n", vectorText(grasp.pregrasp_position_m),
                      vectorText(grasp.lift_position_m));
  const double* tool = grasp.tool_quaternion_wxyz;
  if (!std::equal(q, q + 4, tool) || !std::ranges::equal(grasp.palm_position_m, grasp.tool_position_m))
    text += fmt::format(
        "     tool      {} m   quaternion w x y z ({:.4f} {:.4f} {:.4f} {:.4f})   from {} m   lift to {} m\n",
        vectorText(grasp.tool_position_m), tool[0], tool[1], tool[2], tool[3],
        vectorText(grasp.tool_pregrasp_position_m), vectorText(grasp.tool_lift_position_m));
  text += fmt::format("     joints    spread {:.1f}, f1 {:.1f}, f2 {:.1f}, f3 {:.1f} degrees\n",
                      joints[0] * kDegrees, joints[1] * kDegrees, joints[2] * kDegrees, joints[3] * kDegrees);
  for (int finger = 0; finger < 3; ++finger)
    text +=
        fmt::format("     contact   f{} {} m   normal {}{}\n", finger + 1,
                    vectorText(grasp.contacts[finger].position_m), vectorText(grasp.contacts[finger].normal),
                    grasp.contacts[finger].seen ? "" : "   behind what was seen");
  text += "     quality  ";
  for (int i = 0; i < 9; ++i) text += fmt::format(" q{} {:.3g}", i + 1, grasp.quality[i]);
  return text + "\n";
}

const StageText* textOf(const std::string& stage) {
  for (std::size_t i = 0; i < kStageCount; ++i) {
    const StageText& text = stageText(static_cast<StageId>(i));
    if (text.name == stage) return &text;
  }
  return nullptr;
}

std::string stageLine(const stage_t& stage) {
  const StageText* text = textOf(stage.name);
  return fmt::format("  {:<15}{:>9} {:<20} -> {:>9} {:<20}{:>9.1f} ms   {}\n", stage.name, stage.num_in,
                     text ? text->takes : "", stage.num_out, text ? text->gives : "", 1e3 * stage.time_s,
                     text ? text->knob : "");
}

}  // namespace

std::string planText(const plan_response_t& response) {
  std::string text;
  int rank = 0;
  for (const grasp_t& grasp : response.grasps) text += graspText(grasp, ++rank);
  const auto leaves =
      std::count_if(response.boxes.begin(), response.boxes.end(), [](const box_t& b) { return b.leaf; });
  return text + fmt::format("{} in frame '{}', {} boxes, model {}, {:.2f} s\n", response.message,
                            response.frame, leaves, response.model_version, response.time_s);
}

std::string explanationText(const plan_response_t& response) {
  std::string text = fmt::format("{}: {}\n\nstages (the last column says what to turn)\n",
                                 outcomeName(response.outcome), response.message);
  for (const stage_t& stage : response.stages) text += stageLine(stage);
  std::vector<rejection_t> rejected = response.rejected;
  std::stable_sort(rejected.begin(), rejected.end(),
                   [](const auto& a, const auto& b) { return a.count > b.count; });
  text += "\nrejected\n";
  for (const rejection_t& rejection : rejected)
    text += fmt::format("  {:>9}  {}\n", rejection.count, rejection.reason);
  if (!response.notes.empty()) text += "\nnotes\n";
  for (const std::string& note : response.notes) text += fmt::format("  {}\n", note);
  return text;
}

std::string statusText(const status_t& status) {
  std::string text = fmt::format(
      "boxgrasp-server {}, up {:.0f} s, model {}, hand {}\n"
      "{} of {} workers busy, {} of {} places in the queue taken{}\n",
      status.version, status.uptime_s, status.model_version, status.hand, status.running, status.workers,
      status.queue_length, status.queue_capacity, status.overloaded ? ": overloaded" : "");
  text += "answers: ";
  for (std::int8_t outcome = 0; outcome < static_cast<int>(std::size(status.outcomes)); ++outcome)
    text += fmt::format("{} {}, ", outcomeName(outcome), status.outcomes[outcome]);
  text += fmt::format("repeated {}; {} clouds superseded, {} messages refused\n", status.repeated,
                      status.superseded, status.refused);
  text += fmt::format("latency: p50 {:.3f} s, p90 {:.3f} s, p99 {:.3f} s\n", status.latency_p50_s,
                      status.latency_p90_s, status.latency_p99_s);
  if (status.receive_buffer_granted < 0) return text;
  return text + fmt::format("receive buffer: {} bytes granted of {} asked (clouds up to {} points)\n",
                            status.receive_buffer_granted, status.receive_buffer_asked,
                            status.receive_buffer_granted / 12);
}

}  // namespace boxgrasp
