#include "boxgrasp/training/cross_validation.h"

#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/parallel.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/training/learning.h"

namespace boxgrasp {
namespace {

using Eigen::Index;

struct Object {
  std::string name;
  std::vector<Index> rows;
};

void checkObjects(const std::vector<Object>& objects) {
  if (objects.size() < 3) {
    throw InputError(fmt::format(
        "cross validation: {} objects; give at least 3: one to test, one to validate, one to train",
        objects.size()));
  }
  for (const Object& object : objects) {
    if (object.rows.size() >= 2) continue;
    throw InputError(fmt::format(
        "cross validation: object '{}' has a single grasp, which cannot be ranked; leave it out or "
        "give at least 2",
        object.name));
  }
}

std::vector<Object> objectsOf(const GroupedSamples& data) {
  checkSamples(data.samples, "cross validation");
  if (static_cast<Index>(data.objects.size()) != data.samples.targets.size()) {
    throw InputError(fmt::format("cross validation: {} targets and {} object names; give one name a grasp",
                                 data.samples.targets.size(), data.objects.size()));
  }
  std::map<std::string, std::vector<Index>> rows;
  for (std::size_t i = 0; i < data.objects.size(); ++i)
    rows[data.objects[i]].push_back(static_cast<Index>(i));
  std::vector<Object> objects;
  for (auto& [name, indices] : rows) objects.push_back({name, std::move(indices)});
  checkObjects(objects);
  return objects;
}

GroupedSamples allBut(const GroupedSamples& data, const std::vector<Object>& objects, std::size_t test) {
  std::vector<Index> rows;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (i != test) rows.insert(rows.end(), objects[i].rows.begin(), objects[i].rows.end());
  }
  GroupedSamples others{selectRows(data.samples, rows), {}};
  for (const Index row : rows) others.objects.push_back(data.objects[static_cast<std::size_t>(row)]);
  return others;
}

struct Fold {
  RankingSuccess success;
  VectorXd scores;  // of the test object's rows
  std::vector<std::string> validation;
};

Fold runFold(const GroupedSamples& data, const std::vector<Object>& objects, std::size_t test, int repeat,
             const CrossValidationOptions& options, const StopToken& stop) {
  std::seed_seq sequence{static_cast<std::uint32_t>(options.seed),
                         static_cast<std::uint32_t>(options.seed >> 32), static_cast<std::uint32_t>(test),
                         static_cast<std::uint32_t>(repeat)};
  std::mt19937_64 random(sequence);
  const LearningOptions learning{.training = options.training,
                                 .networks = options.networks,
                                 .calibrate = options.calibrate,
                                 .seed = random(),
                                 .threads = 1};
  const Learnt learnt = learnNetworks(allBut(data, objects, test), learning, {}, stop);
  const Samples unknown = selectRows(data.samples, objects[test].rows);
  const VectorXd said = scores(learnt.ensemble, unknown.inputs);
  return {rankingSuccess(said, unknown.targets), said, learnt.stopped_by};
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(values.size());
}

double sampleDeviation(const std::vector<double>& values) {
  if (values.size() < 2) return 0.0;
  const double center = mean(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - center) * (value - center);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

RankingSuccess meanSuccess(const std::vector<Fold>& folds) {
  const auto meanOf = [&](double RankingSuccess::*field) {
    std::vector<double> values;
    for (const Fold& fold : folds) values.push_back(fold.success.*field);
    return mean(values);
  };
  return {.value = meanOf(&RankingSuccess::value),
          .ceiling = meanOf(&RankingSuccess::ceiling),
          .floor = meanOf(&RankingSuccess::floor),
          .fraction = meanOf(&RankingSuccess::fraction),
          .mean_best_tenth = meanOf(&RankingSuccess::mean_best_tenth),
          .mean_worst_tenth = meanOf(&RankingSuccess::mean_worst_tenth)};
}

ObjectResult summarise(const std::vector<Object>& objects, std::size_t test, const std::vector<Fold>& folds) {
  ObjectResult result;
  result.object = objects[test].name;
  result.grasps = static_cast<Index>(objects[test].rows.size());
  result.mean = meanSuccess(folds);
  for (const Fold& fold : folds) {
    result.s_net.push_back(fold.success.value);
    result.validation_objects.insert(result.validation_objects.end(), fold.validation.begin(),
                                     fold.validation.end());
  }
  result.deviation = sampleDeviation(result.s_net);
  return result;
}

MatrixXd scoresOf(const GroupedSamples& data, const std::vector<Object>& objects,
                  const std::vector<std::vector<Fold>>& folds) {
  MatrixXd scores(data.samples.targets.size(), static_cast<Index>(folds.front().size()));
  for (std::size_t test = 0; test < objects.size(); ++test) {
    for (Index repeat = 0; repeat < scores.cols(); ++repeat)
      scores(objects[test].rows, repeat) = folds[test][static_cast<std::size_t>(repeat)].scores;
  }
  return scores;
}

void addMeans(CrossValidation& result) {
  std::vector<double> values, fractions;
  for (const ObjectResult& object : result.objects) {
    values.push_back(object.mean.value);
    if (!std::isnan(object.mean.fraction)) fractions.push_back(object.mean.fraction);
  }
  result.s_net = mean(values);
  result.s_net_fraction = mean(fractions);
}

}  // namespace

void CrossValidationOptions::validate() const {
  training.validate();
  requireOption(repeats >= 1 && repeats <= 10000, "repeats", repeats, "1 to 10000");
  requireOption(networks >= 1 && networks <= Ensemble::kMaxNetworks, "networks", networks, "1 to 64");
  requireOption(threads >= 0 && threads <= 1024, "threads", threads, "0 to 1024");
}

CrossValidation leaveOneObjectOut(const GroupedSamples& data, const CrossValidationOptions& options,
                                  const StopToken& stop,
                                  const std::function<void(std::size_t, std::size_t)>& progress) {
  const auto begin = std::chrono::steady_clock::now();
  options.validate();
  const std::vector<Object> objects = objectsOf(data);
  const auto repeats = static_cast<std::size_t>(options.repeats);
  std::vector<std::vector<Fold>> folds(objects.size(), std::vector<Fold>(repeats));
  std::mutex reporting;
  std::size_t done = 0;
  parallelFor(objects.size() * repeats, options.threads, [&](std::size_t i) {
    const std::size_t test = i / repeats, repeat = i % repeats;
    folds[test][repeat] = runFold(data, objects, test, static_cast<int>(repeat), options, stop);
    const std::lock_guard lock(reporting);
    if (progress) progress(++done, objects.size() * repeats);
  });
  CrossValidation result;
  result.scores = scoresOf(data, objects, folds);
  for (std::size_t test = 0; test < objects.size(); ++test) {
    result.objects.push_back(summarise(objects, test, folds[test]));
  }
  addMeans(result);
  result.time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace boxgrasp
