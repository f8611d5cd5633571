// boxgrasp-trainer train: from labels to a model file.
#pragma once

#include "study.h"

namespace boxgrasp {

struct TrainCommand {
  StudyCommand study;
  std::string labels = "analytic";              // where the labels come from without a store
  std::filesystem::path out;                    // the model file
  std::optional<std::filesystem::path> report;  // what was learnt as a page, HTML
  bool sweep = false;                           // Fig. 7 in the report
  bool json = false;                            // print the metrics as JSON
};

// Reads or makes labels, validates, trains on everything, writes the model and prints what it did. Throws
// InputError; Stopped, with nothing written.
void runTrain(const TrainCommand& command, const std::string& command_line);

}  // namespace boxgrasp
