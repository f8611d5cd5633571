#include "boxgrasp/training/grasp_lists.h"

#include <map>

#include "boxgrasp/planning/features.h"
#include "boxgrasp/training/labelling.h"

namespace boxgrasp {
namespace {

using Eigen::Index;

double heldShare(const std::vector<GraspLabel>& labels) {
  double held = 0.0;
  for (const GraspLabel& label : labels) held += label.outcome == TrialOutcome::held;
  return held / static_cast<double>(labels.size());
}

GraspList listOf(LabelledModel model) {
  std::erase_if(model.labelled, [](const LabelledHypothesis& one) { return !labelAsPlanned(one); });
  const auto n = static_cast<Index>(model.labelled.size());
  GraspList list{model.key, std::move(model.measures), {}, VectorXd(n), VectorXd(n), VectorXd(n)};
  for (Index i = 0; i < n; ++i) {
    const LabelledHypothesis& one = model.labelled[static_cast<std::size_t>(i)];
    list.rows.push_back(one.hypothesis.index);
    list.held[i] = labelAsPlanned(one)->outcome == TrialOutcome::held;
    list.hold[i] = heldShare(one.labels);
  }
  return list;
}

// s of each model's grasps, one model after the other, of an object's models.
VectorXd objectSuccesses(const std::vector<const LabelledModel*>& models) {
  std::vector<LabelledHypothesis> all;
  for (const LabelledModel* model : models) {
    for (const LabelledHypothesis& one : model->labelled) {
      if (labelAsPlanned(one)) all.push_back(one);
    }
  }
  return successes(all);
}

VectorXd targetsOf(const GraspList& list, LearningTarget target) {
  switch (target) {
    case LearningTarget::success:
      return list.success;
    case LearningTarget::hold:
      return list.hold;
    case LearningTarget::both:
      break;
  }
  return list.success.cwiseProduct(list.hold);
}

}  // namespace

std::string_view describe(LearningTarget target) {
  constexpr std::string_view names[] = {"s", "hold", "both"};
  return names[static_cast<std::size_t>(target)];
}

std::vector<GraspList> graspLists(std::vector<LabelledModel> models) {
  std::map<std::string, std::vector<std::size_t>> by_object;
  for (std::size_t i = 0; i < models.size(); ++i) by_object[models[i].key.object].push_back(i);
  std::map<std::string, VectorXd> s;
  for (const auto& [name, indices] : by_object) {
    std::vector<const LabelledModel*> same;
    for (const std::size_t i : indices) same.push_back(&models[i]);
    s[name] = objectSuccesses(same);
  }
  std::map<std::string, Index> taken;
  std::vector<GraspList> lists;
  for (LabelledModel& model : models) {
    GraspList& list = lists.emplace_back(listOf(std::move(model)));
    Index& begin = taken[list.key.object];
    list.success = s[list.key.object].segment(begin, std::ssize(list.rows));
    begin += std::ssize(list.rows);
  }
  return lists;
}

GroupedSamples samplesOf(const std::vector<GraspList>& lists, const std::vector<std::string>& features,
                         LearningTarget target) {
  Index n = 0;
  for (const GraspList& list : lists) n += std::ssize(list.rows);
  GroupedSamples data{{MatrixXd(n, std::ssize(features)), VectorXd(n)}, {}};
  Index begin = 0;
  for (const GraspList& list : lists) {
    const Index rows = std::ssize(list.rows);
    if (rows == 0) continue;
    data.samples.inputs.middleRows(begin, rows) =
        networkInputs(features, list.measures)(list.rows, Eigen::all);
    data.samples.targets.segment(begin, rows) = targetsOf(list, target);
    data.objects.insert(data.objects.end(), list.rows.size(), list.key.object);
    begin += rows;
  }
  return data;
}

std::string dataHash(const GroupedSamples& data) {
  const auto bytesOf = [](const auto& numbers) {
    return std::string_view(reinterpret_cast<const char*>(numbers.data()),
                            static_cast<std::size_t>(numbers.size()) * sizeof(double));
  };
  std::string bytes(bytesOf(data.samples.inputs));
  bytes += bytesOf(data.samples.targets);
  for (const std::string& object : data.objects) bytes += object + "\n";
  return blake2bHex(bytes);
}

}  // namespace boxgrasp
