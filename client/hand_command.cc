#include "hand_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "boxgrasp/base/exit_code.h"
#include "boxgrasp/planning/plan.h"
#include "boxgrasp/rendering/hand_picture.h"
#include "plan_json.h"

namespace boxgrasp {
namespace {

// Between the thumb's side and that of the other fingers, along y of the palm's frame, with spread 0.
double opening(const HandDescription& hand, double inner) {
  const HandGeometry geometry = forwardKinematics(hand, {0.0, {inner, inner, inner}});
  return geometry.tips_P[kF1].y() - geometry.tips_P[kThumb].y() - 2 * hand.tip_radius;
}

struct Abilities {
  double open_m, closed_m;  // between the fingers' sides; closed may be below 0: they pass each other
  double low_m, high_m;     // of the fingertips over the palm
  std::vector<std::string> hints;
};

Abilities abilitiesOf(const HandDescription& hand) {
  const Reach reach = fingerReach(hand);
  Abilities can{opening(hand, reach.inner_min), opening(hand, reach.inner_max), INFINITY, -INFINITY, {}};
  constexpr int kSteps = 64;
  for (int step = 0; step <= kSteps; ++step) {
    const double height_m =
        tipHeight(hand, std::lerp(reach.inner_min, reach.inner_max, step / double(kSteps)));
    can.low_m = std::min(can.low_m, height_m);
    can.high_m = std::max(can.high_m, height_m);
  }
  const double aperture_m = FaceOptions{}.max_aperture_m;
  if (can.open_m < 0.75 * aperture_m || can.open_m > 2 * aperture_m)
    can.hints.push_back(fmt::format(
        "faces up to faces.max_aperture_m = {:.3f} m are planned on; for this hand set it to about {:.3f}",
        aperture_m, can.open_m));
  if (can.closed_m > 0.02)
    can.hints.push_back(fmt::format("things thinner than {:.0f} mm cannot be held", 1e3 * can.closed_m));
  if (can.low_m < 0)
    can.hints.push_back("the fingertips can go below the palm's surface; is joint_height_mm right?");
  return can;
}

std::string textOf(const HandDescription& hand, const Abilities& can, const HandCommand& command) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  std::string text = fmt::format(
      "{}: {}: this hand can be planned with\n"
      "  opens to {:.0f} mm, closes to {:.0f} mm between the fingers\n"
      "  fingertips {:.0f} to {:.0f} mm over the palm, radius {:.1f} mm\n"
      "  spread {:.0f} to {:.0f} degrees\n"
      "  presses with {:.1f} N at most\n",
      command.file.string(), hand.name, 1e3 * can.open_m, 1e3 * std::max(0.0, can.closed_m), 1e3 * can.low_m,
      1e3 * can.high_m, 1e3 * hand.tip_radius, kDegrees * hand.spread_min, kDegrees * hand.spread_max,
      hand.max_tip_force);
  for (const std::string& hint : can.hints) text += fmt::format("  note: {}\n", hint);
  return text;
}

Json jsonOf(const HandDescription& hand, const Abilities& can) {
  return {{"schema", 1},
          {"name", hand.name},
          {"opening_m", {{"open", can.open_m}, {"closed", can.closed_m}}},
          {"tip_height_m", {{"low", can.low_m}, {"high", can.high_m}}},
          {"tip_radius_m", hand.tip_radius},
          {"spread_rad", {{"min", hand.spread_min}, {"max", hand.spread_max}}},
          {"max_tip_force_n", hand.max_tip_force},
          {"hints", can.hints}};
}

}  // namespace

int runHandCheck(const HandCommand& command) {
  const HandDescription hand = readHandDescription(command.file);
  const Abilities can = abilitiesOf(hand);
  if (command.picture) {
    writeHandPicture(hand, *command.picture);
    fmt::print(stderr, "boxgrasp: drawn into {}\n", command.picture->string());
  }
  fmt::print("{}", command.json ? jsonText(jsonOf(hand, can)) + "\n" : textOf(hand, can, command));
  return kDone;
}

}  // namespace boxgrasp
