// boxgrasp-trainer rates: how often the simulated hand holds what the planner proposes, and what chance does.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace boxgrasp {

struct RatesCommand {
  std::string objects = "builtin";  // or "paper", or a folder of meshes in metres
  std::vector<double> scales{1.0};
  std::string seen = "whole";           // or "view", one camera; "pair", two
  int views = 4;                        // cameras around the object: as many plans, unless it is seen whole
  std::string protocol = "lift_shake";  // or "lift", "six_pushes", "six_gravities"
  std::optional<std::filesystem::path> store;   // rank by networks learnt from it without the object at hand
  std::string meshes = "builtin";               // the store's objects
  std::optional<std::filesystem::path> config;  // the planner's options
  std::optional<std::filesystem::path> hand;
  int random = 200;           // random grasps of each object
  int limit = 200;            // hypotheses tried of each plan, evenly chosen from all; 0: all
  bool answers_only = false;  // neither of these
  int seeds = 1;              // clouds of each sight, for the spread
  std::uint64_t seed = 1;     // of the first cloud, and of the random grasps
  int threads = 0;
  bool json = false;
};

// Tries grasps of every object, and prints the shares that were held and how the others failed. An object
// that cannot be simulated is named and skipped. Throws InputError, or Stopped on Ctrl-C.
void runRates(const RatesCommand& command);

}  // namespace boxgrasp
