// How good a ranking is, whoever made it: a network, a single measure, or chance.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "boxgrasp/training/grasp_lists.h"

namespace boxgrasp {

struct ObjectVerdict {
  std::string object;
  std::int64_t grasps = 0;
  RankingSuccess success;  // of all sizes and views together, by s (Eq. 7)
};

// Means are over the objects, or lists, that can be ranked: whose grasps differ in what is judged.
struct RankingVerdict {
  std::string ranking;                         // what made it
  std::vector<ObjectVerdict> objects;          // by name
  double s_net = NAN;                          // mean over the objects
  double fraction = NAN;                       // of the span from the worst ranking to the perfect one
  double deviation = 0.0;                      // of `fraction` over the repeats
  double best_tenth = NAN, worst_tenth = NAN;  // mean s in them
  double list_fraction =
      NAN;  // as `fraction`, of the lists: those of one object in one size, as ranked in a plan
  double hold_fraction = NAN;     // as list_fraction, by the share of perturbed trials that are held
  double top_held = NAN;          // share of the lists whose first grasp is held as planned
  double top_hold = NAN;          // mean share of perturbed trials in which the first grasp is held
  double any_of_five_held = NAN;  // share of the lists with a grasp that is held among the first five
};

// `scores`: a row for each row of samplesOf(lists), a column for each repeat; figures are means over the
// repeats. Lists of fewer than 10 grasps count in none of the means over lists. Pre: at least one column.
RankingVerdict judge(const std::string& ranking, const std::vector<GraspList>& lists, const MatrixXd& scores);

// Random scores, `repeats` times.
RankingVerdict judgeChance(const std::vector<GraspList>& lists, int repeats, std::uint64_t seed);

// Every measure alone, in the direction that ranks better by `fraction`, the best first. What a user could do
// without learning; choosing the direction after the fact flatters it.
std::vector<RankingVerdict> judgeMeasures(const std::vector<GraspList>& lists);

// What probabilities are worth.
struct Reliability {
  struct Bin {
    double said = NAN, happened = NAN;  // means
    std::int64_t grasps = 0;
  };
  std::vector<Bin> bins;    // of equal width over [0, 1]
  double brier = NAN;       // mean squared difference between what was said and what happened
  double base_brier = NAN;  // of saying the mean for every grasp
};

// Pre: as many outcomes (in [0, 1]) as probabilities.
Reliability reliabilityOf(const VectorXd& probabilities, const VectorXd& outcomes, int bins = 10);

}  // namespace boxgrasp
