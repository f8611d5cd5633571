// boxgrasp-trainer rates: how often the simulated hand holds what the planner proposes, and what chance does.
#pragma once

#include <cstdint>
#include <string>

namespace boxgrasp {

struct RatesCommand {
  std::string objects = "builtin";  // or a folder of meshes in metres
  double scale = 1.0;
  int random = 200;        // random grasps of each object
  int limit = 200;         // hypotheses tried of each object, evenly chosen from all; 0: all
  std::uint64_t seed = 1;  // of the random grasps
  int threads = 0;
  bool json = false;
};

// Tries grasps of every object in lift and shake, and prints the shares that were held. An object that cannot
// be simulated is named and skipped. Throws InputError, or Stopped on Ctrl-C.
void runRates(const RatesCommand& command);

}  // namespace boxgrasp
