// The success of a ranking (paper IV.C, Eq. 7).
#pragma once

#include <Eigen/Core>

namespace boxgrasp {

// S_net of ranking grasps with true success s by the predicted scores: the mean s of the best-ranked tenth
// minus that of the worst-ranked tenth. ceiling: the value for a perfect ranking; floor: for its reverse.
// fraction = (value - floor) / (ceiling - floor), NaN where they are equal. A tenth is at least one grasp.
// Equal scores keep their order. Pre: equal sizes, at least 2 grasps.
struct RankingSuccess {
  double value, ceiling, floor, fraction;
  double mean_best_tenth, mean_worst_tenth;
};
RankingSuccess rankingSuccess(const Eigen::VectorXd& scores, const Eigen::VectorXd& successes);

}  // namespace boxgrasp
