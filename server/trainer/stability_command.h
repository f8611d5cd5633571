// boxgrasp-trainer stability: Table I and Fig. 3 of the paper, and past them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace boxgrasp {

struct StabilityCommand {
  std::string objects = "builtin";              // or a folder of meshes and clouds
  bool quick = false;                           // fewer levels and points
  bool beyond = false;                          // outliers and uneven density too
  std::optional<std::filesystem::path> csv;     // a row for each object and split; rows that are there stay
  std::optional<std::filesystem::path> curves;  // folder for constellations over t: a CSV and an SVG each
  std::size_t points = 10'000;                  // sampled on each mesh
  std::uint64_t seed = 1;
  int threads = 2;
  bool json = false;
};

// Measures, and prints the table. Throws InputError.
void runStability(const StabilityCommand& command);

}  // namespace boxgrasp
