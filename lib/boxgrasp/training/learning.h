// From labelled grasps to the networks that rank: what the trainer's commands and its worker call.
#pragma once

#include <functional>

#include "boxgrasp/ranking/ensemble.h"
#include "boxgrasp/training/cross_validation.h"

namespace boxgrasp {

struct LearningOptions {
  LevenbergMarquardtOptions training;  // of each network; its seed is not used: each network has its own
  // Networks whose outputs are averaged, each with another object to stop by; 1 is the paper's. More steady
  // the ranking, and cost as much more time, in training and in planning.
  int networks = 5;
  // The targets are probabilities in [0, 1], or 0 and 1: calibrate, so that the score is a probability too.
  bool calibrate = false;
  std::uint64_t seed = 1;
  int threads = 0;  // for the networks; 0 = all cores. The result does not depend on it
  void validate() const;
};

// The networks, and how each was trained.
struct Learnt {
  Ensemble ensemble;
  std::vector<std::string> stopped_by;  // the object that each did not learn from
  std::vector<TrainingReport> trainings;
};

// Trains each network on the grasps of all objects but one, which decides when to stop (paper IV.B); the
// objects take turns in an order chosen by the seed. A calibration is Platt's, fitted to what each network
// says of the object that it has not learnt from. `progress(done, total)` is called after each network, from
// one thread at a time. Throws Stopped; InputError for fewer than 2 objects, numbers of names and rows that
// differ, whatever train() refuses, and, with calibrate, targets outside [0, 1] or scores that do not rise
// with the targets on the objects left out.
Learnt learnNetworks(const GroupedSamples& data, const LearningOptions& options,
                     const std::function<void(std::size_t, std::size_t)>& progress = {},
                     const StopToken& stop = {});

// The networks alone.
Ensemble learn(const GroupedSamples& data, const LearningOptions& options,
               const std::function<void(std::size_t, std::size_t)>& progress = {},
               const StopToken& stop = {});

// Platt's calibration: the most likely slope and offset for the outcomes, which are probabilities in [0, 1];
// weights as in Samples. Throws InputError when the slope is not positive or not bounded by the data (e.g.
// all outcomes the same).
Calibration fitCalibration(const VectorXd& scores, const VectorXd& outcomes, const VectorXd& weights = {});

}  // namespace boxgrasp
