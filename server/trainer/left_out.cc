#include "left_out.h"

#include <vector>

namespace boxgrasp {
namespace {

using Eigen::Index;

GroupedSamples without(const GroupedSamples& all, const std::string& object) {
  std::vector<Index> kept;
  for (std::size_t i = 0; i < all.objects.size(); ++i) {
    if (all.objects[i] != object) kept.push_back(static_cast<Index>(i));
  }
  GroupedSamples rest;
  rest.samples.inputs = all.samples.inputs(kept, Eigen::all);
  rest.samples.targets = all.samples.targets(kept);
  if (all.samples.weights.size() > 0) rest.samples.weights = all.samples.weights(kept);
  for (const Index i : kept) rest.objects.push_back(all.objects[static_cast<std::size_t>(i)]);
  return rest;
}

}  // namespace

LeftOut::LeftOut(const StudyCommand& command, const StopToken& stop)
    : command_(command), data_(studyData(command, stop)) {}

// The surprises are those of networks that know neither the object left out nor the one remembered.
std::vector<Recollection> LeftOut::recollectionsOf(const GroupedSamples& rest, const std::string& object,
                                                   const StopToken& stop) const {
  const VectorXd foretold =
      leaveOneObjectOut(rest, validationOptions(command_, data_.target, 1), stop).scores.col(0);
  std::vector<GraspList> lists;
  for (const GraspList& list : data_.lists) {
    if (list.key.object != object) lists.push_back(list);
  }
  return recollectionsWithout(object, remembered(lists, rest.samples.targets, foretold));
}

const Model& LeftOut::modelWithout(const std::string& object, const StopToken& stop) {
  const auto known = models_.find(object);
  if (known != models_.end()) return known->second;
  Model model;
  model.name = "without " + object;
  model.features = data_.features;
  const GroupedSamples rest = without(data_.samples, object);
  model.ensemble = learn(rest, learningOptions(command_, data_.target), {}, stop);
  if (command_.recollections) model.recollections = recollectionsOf(rest, object, stop);
  model.version = modelVersion(model);
  return models_.emplace(object, std::move(model)).first->second;
}

}  // namespace boxgrasp
