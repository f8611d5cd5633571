// Trying a model out before anybody plans with it.
#pragma once

#include <limits>

#include "boxgrasp/ranking/model_file.h"

namespace boxgrasp {

// The measures of the built-in grasps as networkInputs() takes them, a row each: plausible ones on objects
// from 2 to 30 cm, always the same, and some that lie far outside of what any model was trained on.
MatrixXd canaryMeasures();

// The time that the model takes to score one grasp, as the planner does, seconds: the least over the canary
// grasps, so that other programs on the machine count little. Pre: the model fits its features.
double graspSeconds(const Model& model);

// Scores the canary grasps. Throws InputError that says what is wrong: a feature that does not exist or does
// not fit the networks, a score that is not finite, a calibrated one outside [0, 1], the same score for all,
// or more than most_s for a grasp. A model of any legal size is refused within a few grasps once it is too
// slow.
void runCanary(const Model& model, double most_s = std::numeric_limits<double>::infinity());

// What a new model may take for a grasp beside one that takes old_s: ten times as long, or as much as does
// not matter beside the other stages of a plan.
double slowestAllowed(double old_s);

}  // namespace boxgrasp
