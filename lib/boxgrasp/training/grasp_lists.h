// Labelled grasps in the lists that a planner ranks: all hypotheses on one object in one size.
#pragma once

#include <string>
#include <vector>

#include "boxgrasp/training/cross_validation.h"
#include "boxgrasp/training/experience.h"

namespace boxgrasp {

struct GraspList {
  ModelKey key;
  MatrixXd measures;  // graspMeasures() of all hypotheses, because places among all of them count
  std::vector<Eigen::Index> rows;  // of `measures`: those with labels; what follows is parallel to it
  VectorXd success;                // s (Eq. 6), over the greatest of the object in all its sizes and views
  VectorXd held;                   // 1 where the grasp came through lift and shake as planned, else 0
  VectorXd hold;                   // the share of all labels, with all perturbations, that did
};

// What a store and a new plan know of one model.
struct LabelledModel {
  ModelKey key;
  MatrixXd measures;
  std::vector<LabelledHypothesis> labelled;  // of the planner; index is the row of `measures`
};

// Lists in the same order; hypotheses that were not yet tried as planned are left out.
std::vector<GraspList> graspLists(std::vector<LabelledModel> models);

enum class LearningTarget {
  success,  // s, as in the paper
  hold,     // the probability that the grasp is held in lift and shake
  both,     // their product: how good a grasp is, if it is one
};
std::string_view describe(LearningTarget target);

// All labelled grasps, list by list, with the inputs of a network with these features.
GroupedSamples samplesOf(const std::vector<GraspList>& lists, const std::vector<std::string>& features,
                         LearningTarget target);

// BLAKE2b of inputs, targets and names.
std::string dataHash(const GroupedSamples& data);

}  // namespace boxgrasp
