// boxgrasp-trainer evaluate: what learning is worth on objects that it has never seen.
#pragma once

#include "study.h"

namespace boxgrasp {

struct EvaluateCommand {
  StudyCommand study;
  bool sweep = false;                         // over sizes of the network, too (Fig. 7)
  std::optional<std::filesystem::path> plot;  // reliability as SVG
  bool json = false;
};

// Prints a table, or JSON. Throws InputError; Stopped.
void runEvaluate(const EvaluateCommand& command);

}  // namespace boxgrasp
