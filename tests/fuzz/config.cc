// The configuration of planner and server (TOML).
#include "boxgrasp/planning/planner_config.h"
#include "fuzz_target.h"
#include "server_options.h"

namespace boxgrasp::fuzz {

void feed(Bytes bytes) {
  accepts([&] {
    ConfigFile file(std::string(text(bytes)), "fuzz.toml");
    readPlannerOptions(file);
    readServerOptions(file);
    file.finish();
  });
}

std::vector<std::string> seeds() {
  std::ifstream stream(BOXGRASP_SOURCE_DIR "/deploy/boxgrasp.toml");
  const std::string shipped{std::istreambuf_iterator<char>(stream), {}};
  return {shipped, "[server]\nworkers = 3\n[clean]\nvoxel_m = 0.0\n",
          "[clearance]\nopenings_rad = [0, 0.1, 0.2, 0.3]\n"};
}

}  // namespace boxgrasp::fuzz
