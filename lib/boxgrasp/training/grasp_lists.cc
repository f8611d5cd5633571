#include "boxgrasp/training/grasp_lists.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "boxgrasp/planning/features.h"

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
  GraspList list{.key = model.key,
                 .measures = std::move(model.measured.values),
                 .rows = {},
                 .success = VectorXd(n),
                 .held = VectorXd(n),
                 .hold = VectorXd(n),
                 .constellation = model.measured.constellation,
                 .places = {}};
  for (Index i = 0; i < n; ++i) {
    const LabelledHypothesis& one = model.labelled[static_cast<std::size_t>(i)];
    list.rows.push_back(one.hypothesis.index);
    list.places.push_back(model.measured.places[static_cast<std::size_t>(one.hypothesis.index)]);
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

double rounded(double value) { return std::round(value * 1e4) / 1e4; }

Vector3d rounded(const Vector3d& v) {
  return v.unaryExpr([](double value) { return rounded(value); });
}

Recollection recollectionOf(const GraspList& list, const VectorXd& surprises) {
  const std::size_t all = list.places.size(), count = std::min(all, Recollection::kMaxGrasps);
  Recollection recollection{
      {rounded(list.constellation.unit_m), list.constellation.cells}, {}, VectorXd(count)};
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t row = i * all / count;
    const GraspPlace& place = list.places[row];
    recollection.places.push_back({rounded(place.contacts), rounded(place.approach), rounded(place.thumb)});
    recollection.surprises[static_cast<Index>(i)] = rounded(surprises[static_cast<Index>(row)]);
  }
  return recollection;
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

std::vector<RememberedList> remembered(const std::vector<GraspList>& lists, const VectorXd& targets,
                                       const VectorXd& foretold) {
  std::vector<RememberedList> result;
  Index begin = 0;
  for (const GraspList& list : lists) {
    const Index n = std::ssize(list.rows);
    const VectorXd surprises = targets.segment(begin, n) - foretold.segment(begin, n);
    begin += n;
    if (!list.places.empty() && n > 0) result.push_back({list.key.object, recollectionOf(list, surprises)});
  }
  return result;
}

std::vector<Recollection> recollectionsWithout(const std::string& object,
                                               const std::vector<RememberedList>& lists) {
  std::vector<Recollection> result;
  for (const RememberedList& list : lists) {
    if (list.object != object) result.push_back(list.recollection);
  }
  return result;
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
