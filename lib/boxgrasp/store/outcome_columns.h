// The columns of an outcome store's tables, in their order.
#pragma once

#include "boxgrasp/store/columns.h"
#include "boxgrasp/store/outcome_store.h"

namespace boxgrasp {

void visitColumns(IsA<AnswerOrigin> auto& origin, auto&& visit) {
  visit("model_version", origin.model_version);
  visit("features", origin.features);
  visit("hand", origin.hand);
  visit("object", origin.object);
}

void visitColumns(IsA<RememberedGrasp> auto& grasp, auto&& visit) {
  visit("inputs", grasp.inputs);
  visit("score", grasp.score);
}

void visitColumns(IsA<RememberedAnswer> auto& answer, auto&& visit) {
  visit("request_id", answer.request_id);
  visit("utime", answer.utime);
  visitColumns(answer.origin, visit);
}

void visitColumns(IsA<RobotOutcome> auto& outcome, auto&& visit) {
  visit("request_id", outcome.request_id);
  visit("grasp_index", outcome.grasp_index);
  visit("robot", outcome.robot);
  visit("succeeded", outcome.succeeded);
  visit("what", outcome.what);
  visit("forces_n", outcome.forces_n);
  visit("utime", outcome.utime);
  visit("weight", outcome.weight);
}

// All but the id, which the table gives.
void visitColumns(IsA<StoredOutcome> auto& stored, auto&& visit) {
  visitColumns(stored.outcome, visit);
  visitColumns(stored.origin, visit);
  visitColumns(stored.grasp, visit);
}

}  // namespace boxgrasp
