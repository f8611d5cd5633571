// Labelled grasps in the lists that a planner ranks: all hypotheses on one object in one size.
#pragma once

#include <string>
#include <vector>

#include "boxgrasp/training/cross_validation.h"
#include "boxgrasp/training/experience.h"
#include "boxgrasp/training/labelling.h"

namespace boxgrasp {

struct GraspList {
  ModelKey key;
  MatrixXd measures;  // graspMeasures() of all hypotheses, because places among all of them count
  std::vector<Eigen::Index> rows;  // of `measures`: those with labels; what follows is parallel to it
  VectorXd success;                // s (Eq. 6), over the greatest of the object in all its sizes and views
  VectorXd held;                   // 1 where the grasp came through lift and shake as planned, else 0
  VectorXd hold;                   // the share of all labels, with all perturbations, that did
  Constellation constellation;     // of the object as it was planned on
  std::vector<GraspPlace> places;  // of `rows`; empty where they are not known
};

// What a store and a new plan know of one model.
struct LabelledModel {
  ModelKey key;
  HypothesisMeasures measured;
  std::vector<LabelledHypothesis> labelled;  // of the planner; index is the row of `measured`
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

// What a model may remember of each list whose places are known (at most Recollection::kMaxGrasps, evenly
// chosen), rounded to four decimals: surprises are targets less `foretold`, a row for each row of
// samplesOf(lists), by networks that had not seen the object.
struct RememberedList {
  std::string object;
  Recollection recollection;
};
std::vector<RememberedList> remembered(const std::vector<GraspList>& lists, const VectorXd& targets,
                                       const VectorXd& foretold);

// Those of other objects than this one.
std::vector<Recollection> recollectionsWithout(const std::string& object,
                                               const std::vector<RememberedList>& lists);

// BLAKE2b of inputs, targets and names.
std::string dataHash(const GroupedSamples& data);

}  // namespace boxgrasp
