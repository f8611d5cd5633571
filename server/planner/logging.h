// How the daemon's log lines look: as sd-daemon(3) wants them for the journal, plain everywhere else.
#pragma once

#include <spdlog/common.h>

#include <string>

namespace boxgrasp {

// The journal reads stderr: systemd says so in JOURNAL_STREAM, and stderr was not redirected since.
bool isJournalOnStderr();

// Lines of the default logger go to stderr. For the journal they begin with their level, as "<4>", and have
// no time, which the journal knows; else with time and level.
void logToStderr(bool for_journal);

// Throws InputError for a name that is not debug, info, warning or error.
spdlog::level::level_enum logLevel(const std::string& name);

}  // namespace boxgrasp
