// Learning from what robots report, beside what the simulator says.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "boxgrasp/training/cross_validation.h"

namespace boxgrasp {

// A robot's report on one grasp, with what the network was fed for it.
struct ReportedGrasp {
  std::string robot;
  std::string request_id;
  VectorXd inputs;
  bool succeeded = false;
  double weight = 1.0;
};

struct OutcomeWeighing {
  // A report counts as much as this many simulated labels: it is the real thing, but one trial.
  double report_weight = 4.0;
  // No robot has more than this share of the weight of all reports: a broken gripper, or a liar, is outvoted
  // by the others.
  double max_robot_share = 0.34;
  // All reports together have at most this share of the training weight: the simulated labels, of which many
  // more objects are known, keep the rest.
  double max_share = 0.5;
  void validate() const;
};

// The simulated samples with the reports after them, weighted. A success has the upper quartile of the
// simulated targets as its target, a failure their least. The reports of one robot count as one object, so
// that stopping by another object never splits them. Throws InputError for reports with another number of
// inputs.
GroupedSamples joined(const GroupedSamples& simulated, const std::vector<ReportedGrasp>& reports,
                      const OutcomeWeighing& weighing = {});

// Whether something of this name is kept out of training, to judge by: about one in `one_in`, the same names
// always.
bool heldOut(const std::string& name, int one_in);

}  // namespace boxgrasp
