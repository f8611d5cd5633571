// boxgrasp-trainer summary: what an experience store holds.
#pragma once

#include <filesystem>

namespace boxgrasp {

struct SummaryCommand {
  std::filesystem::path store;
  bool json = false;
};

// Prints, for each model and source, what was planned and what came of it, as planned (perturbation 0); s is
// by Eq. 6 over all models of an object and source. The totals stand beside the paper's. Throws InputError.
void runSummary(const SummaryCommand& command);

}  // namespace boxgrasp
