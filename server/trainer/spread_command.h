// boxgrasp-trainer spread: epsilon and nu of the planner's hypotheses among those of random grasps (Fig. 5).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace boxgrasp {

struct SpreadCommand {
  std::string object = "bunny";  // parametric, or a mesh file in metres
  double scale = 1.0;
  int random = 2000;          // grasps
  std::filesystem::path out;  // the plot, SVG
  std::uint64_t seed = 1;     // of the random grasps
  int threads = 0;
  bool json = false;
};

// Closes the hand on every grasp, draws epsilon and nu, and prints how the planner's stand among the random
// ones. Throws InputError, or Stopped on Ctrl-C, when nothing has been written.
void runSpread(const SpreadCommand& command);

}  // namespace boxgrasp
