// Leave-one-object-out validation (paper IV.B).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "boxgrasp/ranking/s_net.h"
#include "boxgrasp/training/levenberg_marquardt.h"

namespace boxgrasp {

// Samples with the object that each row's grasp belongs to. All scales of an object carry the same name, so
// that the network never trains on a copy of the object it is tested on.
struct GroupedSamples {
  Samples samples;
  std::vector<std::string> objects;  // one name a row
};

struct CrossValidationOptions {
  LevenbergMarquardtOptions training;  // its seed is not used: each fold has its own
  // Whose outputs are averaged in each fold, each with a validation object of its own; 1 is the paper's.
  int networks = 1;
  bool calibrate = false;  // each fold's networks, as in LearningOptions
  int repeats =
      10;  // trainings for each test object, with other validation objects and first weights (paper IV.D)
  std::uint64_t seed = 1;
  int threads = 0;  // for the folds; 0 = all cores. The result does not depend on it
  void validate() const;
};

struct ObjectResult {
  std::string object;
  Eigen::Index grasps = -1;
  RankingSuccess mean;        // over the repeats, field by field
  double deviation = -1.0;    // sample standard deviation of S_net over the repeats; 0 for one repeat
  std::vector<double> s_net;  // of each repeat
  std::vector<std::string> validation_objects;  // of each repeat, and of each network in it
};

struct CrossValidation {
  std::vector<ObjectResult> objects;  // by name
  double s_net = 0.0;                 // mean over the objects
  double s_net_fraction =
      0.0;          // mean over the objects whose grasps differ in success; NaN when there is none
  MatrixXd scores;  // of each sample, by networks that have not seen its object: a column a repeat
  double time_s = -1.0;
};

// For each object: trains on all others but one, which, chosen by the seed, decides when to stop; then ranks
// the object's grasps. `progress(done, total)` is called after each, from one thread at a time. Throws
// InputError for fewer than 3 objects, an object with fewer than 2 grasps, and whatever train() refuses.
CrossValidation leaveOneObjectOut(const GroupedSamples& data, const CrossValidationOptions& options = {},
                                  const StopToken& stop = {},
                                  const std::function<void(std::size_t, std::size_t)>& progress = {});

}  // namespace boxgrasp
