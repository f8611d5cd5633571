// boxgrasp-trainer work: retrains in the background with what robots report, and publishes what is better.
#pragma once

#include "study.h"

namespace boxgrasp {

struct WorkCommand {
  StudyCommand study;                              // labels and networks; `store` is needed
  std::filesystem::path outcomes;                  // of the server: FOLDER/outcomes.db
  std::filesystem::path keep = "models";           // every candidate and its comparison
  std::optional<std::filesystem::path> state_dir;  // of the server, for the weights of its models
  std::optional<std::filesystem::path> key;        // to publish with; none: nothing is published
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  int after = 0;            // train after this many new outcomes; 0: not for outcomes
  double every_h = 0.0;     // train at least this often, hours; 0: not by the clock
  int held_out_one_in = 5;  // objects and requests are kept out of training, to judge by
  bool once = false;        // train now, and end
};

// Runs until Ctrl-C, which stops what it is at; the next start goes on with it. Returns the program's exit
// code. Throws InputError, StoreError, TransportError.
int runWork(const WorkCommand& command);

}  // namespace boxgrasp
