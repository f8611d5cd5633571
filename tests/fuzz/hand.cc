// Descriptions of hands (TOML).
#include "boxgrasp/hand/kinematics.h"
#include "fuzz_target.h"

namespace boxgrasp::fuzz {

void feed(Bytes bytes) {
  accepts([&] {
    const HandDescription hand = parseHandDescription(std::string(text(bytes)), "fuzz.toml");
    const Reach reach = fingerReach(hand);
    promise(reach.inner_min <= reach.inner_max);
    forwardKinematics(hand, {0.0, {reach.inner_min, reach.inner_max, 0.0}});
  });
}

std::vector<std::string> seeds() {
  std::vector<std::string> result;
  for (const char* name : {"barrett.toml", "barrett_graspit.toml", "parallel_gripper.toml"}) {
    std::ifstream stream(std::string(BOXGRASP_SOURCE_DIR "/deploy/hands/") + name);
    result.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
  }
  return result;
}

}  // namespace boxgrasp::fuzz
