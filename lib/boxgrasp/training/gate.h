// Whether a new model may take the place of the one in service.
#pragma once

#include <string>
#include <vector>

#include "boxgrasp/ranking/model_file.h"
#include "boxgrasp/training/grasp_lists.h"
#include "boxgrasp/training/outcome_learning.h"

namespace boxgrasp {

// What neither model is to have learnt from.
struct HeldOut {
  std::vector<GraspList> lists;  // their measures are all of measureNames()
  LearningTarget target = LearningTarget::success;
  std::vector<ReportedGrasp> reports;  // with the inputs of both models' features
};

struct GateOptions {
  // A candidate this much worse is as good: the noise of a hundred labels an object, and what a model that
  // has learnt from the held-out objects, as the shipped one has, knows too much.
  double tolerance = 0.01;
  // Fewer reports than this, or no success or no failure among them, say nothing.
  int min_reports = 10;
  void validate() const;
};

// One of the things by which the two are compared.
struct Comparison {
  std::string by;  // in words
  double candidate = NAN, in_service = NAN;
  int cases = 0;
  bool judged = false;  // false: there was too little to judge by
  bool passed = true;
};

struct GateVerdict {
  bool passed = false;
  std::vector<Comparison> comparisons;
  std::string words;  // one sentence
};

// Passes when the candidate is at least as good on held-out objects, by the fraction of the span from the
// worst ranking to the perfect one, mean over lists; and on held-out reports, by how often a grasp that
// succeeded outscores one that failed with the same robot, mean over robots. Simulated objects anchor the
// verdict: however many reports are wrong, a model that follows them ranks objects worse. Without lists that
// can be judged it does not pass.
GateVerdict judgeCandidate(const Model& candidate, const Model& in_service, const HeldOut& held_out,
                           const GateOptions& options = {});

}  // namespace boxgrasp
