// The exit codes of all programs of Boxgrasp.
#pragma once

namespace boxgrasp {

enum ExitCode {
  kDone = 0,
  kNothingFound = 1,  // no grasp; a condition that was asked for does not hold
  kUsage = 2,
  kBadInput = 3,        // or bad configuration
  kNotReachable = 4,    // the server, or LCM's broker
  kDeadlinePassed = 5,  // before there was an answer
  kInternalError = 70,
  kInterrupted = 130,  // by Ctrl-C, as shells say it
};

}  // namespace boxgrasp
