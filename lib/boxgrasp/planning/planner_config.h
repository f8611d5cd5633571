// The planner's options from a configuration file.
#pragma once

#include "boxgrasp/planning/config_file.h"
#include "boxgrasp/planning/plan.h"

namespace boxgrasp {

// The defaults, changed by what the file says. Every option has the section of its stage ([scene], [clean],
// [faces], ...) and its name in PlannerOptions as its key; those of no stage stand in [planner]. Throws
// InputError with file, line and column. Does not call file.finish(): the file may hold more.
PlannerOptions readPlannerOptions(ConfigFile& file);

// A whole file for a program that only plans; what stands in [server] is not for it.
PlannerOptions readPlannerOptions(const std::filesystem::path& file);

}  // namespace boxgrasp
