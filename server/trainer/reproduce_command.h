// boxgrasp-trainer reproduce: the paper's evaluation, and what goes past it, as one report.
#pragma once

#include "reproduction_steps.h"

namespace boxgrasp {

// Runs all steps (reproduction_steps.h) whose output is not there yet, and writes report.html. In the folder
// stand, beside it, <step>.json with what each step printed, <step>.log with what it said, and steps.json
// with their commands. A step that fails is named in the report, and the others go on.
//
// Returns kDone, kNothingFound when steps failed, kInterrupted when told to stop. Throws InputError for bad
// options, a folder that holds something else or is in use, and files that cannot be written.
int runReproduce(const ReproduceCommand& command);

}  // namespace boxgrasp
