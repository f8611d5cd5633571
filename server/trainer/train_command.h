// boxgrasp-trainer train: from labels to a model file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace boxgrasp {

struct TrainCommand {
  std::string labels = "analytic";  // where the labels come from
  std::filesystem::path out;        // the model file
  std::vector<int> hidden = {8};
  std::vector<std::string> objects;  // parametric objects; empty: all
  std::size_t points = 30'000;
  int repeats = 10;  // of the leave-one-object-out validation
  std::uint64_t seed = 1;
  int threads = 0;
  std::optional<std::filesystem::path> hand;  // description file; none: the built-in hand
  std::string features = "relative";          // or "raw", as in the paper
  bool json = false;                          // print the metrics as JSON
};

// Labels, validates, trains on everything, writes the model and prints what it did. Throws InputError.
void runTrain(const TrainCommand& command, const std::string& command_line);

}  // namespace boxgrasp
