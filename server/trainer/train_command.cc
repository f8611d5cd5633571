#include "train_command.h"

#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>

#include "boxgrasp/base/error.h"
#include "boxgrasp/planning/features.h"
#include "boxgrasp/training/analytic_labels.h"
#include "boxgrasp/training/cross_validation.h"
#include "progress_bar.h"

namespace boxgrasp {
namespace {

constexpr Eigen::Index kLeastHypotheses = 10;  // of a model: with fewer, a tenth is not one grasp

std::vector<std::string> featuresOf(const TrainCommand& command) {
  if (command.features == "relative") return relativeFeatures();
  if (command.features == "raw") return rawFeatures();
  throw InputError(fmt::format("--features is '{}', but must be 'relative' or 'raw'", command.features));
}

MatrixXd inputsOf(const LabelledObject& object, const std::vector<std::string>& features) {
  MatrixXd inputs(object.measures.rows(), static_cast<Eigen::Index>(features.size()));
  for (Eigen::Index row = 0; row < inputs.rows(); ++row) {
    QualityMeasures quality;
    Eigen::Map<Eigen::RowVectorXd>(quality.data(), 9) = object.measures.row(row);
    inputs.row(row) = networkInputs(features, quality, object.size_m).transpose();
  }
  return inputs;
}

// All objects' rows, one under the other.
GroupedSamples stacked(const std::vector<LabelledObject>& labels, const TrainCommand& command) {
  const std::vector<std::string> features = featuresOf(command);
  Eigen::Index rows = 0;
  for (const LabelledObject& object : labels) rows += object.success.size();
  GroupedSamples data{{MatrixXd(rows, static_cast<Eigen::Index>(features.size())), VectorXd(rows)}, {}};
  Eigen::Index row = 0;
  for (const LabelledObject& object : labels) {
    data.samples.inputs.middleRows(row, object.success.size()) = inputsOf(object, features);
    data.samples.targets.segment(row, object.success.size()) = object.success;
    data.objects.insert(data.objects.end(), object.success.size(), object.name);
    row += object.success.size();
  }
  return data;
}

std::string dataHash(const GroupedSamples& data) {
  std::string bytes(reinterpret_cast<const char*>(data.samples.inputs.data()),
                    data.samples.inputs.size() * sizeof(double));
  bytes.append(reinterpret_cast<const char*>(data.samples.targets.data()),
               data.samples.targets.size() * sizeof(double));
  for (const std::string& object : data.objects) bytes += object + "\n";
  return blake2bHex(bytes);
}

// Rows chosen by the seed become the validation set that stops the final training: all hypotheses of one
// object.
std::pair<Samples, Samples> heldOut(const GroupedSamples& data, const std::string& object) {
  std::vector<Eigen::Index> training, validation;
  for (std::size_t i = 0; i < data.objects.size(); ++i) {
    (data.objects[i] == object ? validation : training).push_back(static_cast<Eigen::Index>(i));
  }
  return {selectRows(data.samples, training), selectRows(data.samples, validation)};
}

std::string utcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

// A ranking by one feature alone, in its better direction: what the network has to beat.
struct SingleFeature {
  Eigen::Index feature = -1;
  double fraction = 0.0;  // of the span, mean over the objects
};

double meanFraction(const GroupedSamples& data, const VectorXd& scores) {
  double sum = 0.0;
  int counted = 0;
  for (std::size_t begin = 0, end = 0; begin < data.objects.size(); begin = end) {
    while (end < data.objects.size() && data.objects[end] == data.objects[begin]) ++end;
    const auto first = static_cast<Eigen::Index>(begin), n = static_cast<Eigen::Index>(end - begin);
    const double fraction =
        rankingSuccess(scores.segment(first, n), data.samples.targets.segment(first, n)).fraction;
    if (std::isnan(fraction)) continue;
    sum += fraction;
    ++counted;
  }
  return counted ? sum / counted : 0.0;
}

SingleFeature bestSingleFeature(const GroupedSamples& data) {
  SingleFeature best;
  for (Eigen::Index i = 0; i < data.samples.inputs.cols(); ++i) {
    for (const double direction : {1.0, -1.0}) {
      const double fraction = meanFraction(data, direction * data.samples.inputs.col(i));
      if (fraction > best.fraction) best = {i, fraction};
    }
  }
  return best;
}

void printCounts(const std::vector<LabelledObject>& labels) {
  std::size_t projections = 0, triplets = 0;
  fmt::print("{:<14} {:>5} {:>6} {:>6} {:>8} {:>11} {:>8}\n", "object", "scale", "boxes", "faces", "triplets",
             "hypotheses", "max eps");
  for (const LabelledObject& object : labels) {
    const double max_epsilon = object.epsilon.size() ? object.epsilon.maxCoeff() : 0.0;
    fmt::print("{:<14} {:>5.2f} {:>6} {:>6} {:>8} {:>11} {:>8.4f}\n", object.name, object.scale, object.boxes,
               object.projections, object.triplets, object.success.size(), max_epsilon);
    projections += object.projections;
    triplets += object.triplets;
  }
  fmt::print("{} models, {} projections, {} triplets (the paper: 42, 570, 5951)\n", labels.size(),
             projections, triplets);
}

void printValidation(const CrossValidation& validation) {
  fmt::print("{:<14} {:>10} {:>8} {:>8} {:>8} {:>8}\n", "left out", "hypotheses", "S_net", "floor", "ceiling",
             "fraction");
  for (const ObjectResult& object : validation.objects) {
    fmt::print("{:<14} {:>10} {:>8.3f} {:>8.3f} {:>8.3f} {:>8.3f}\n", object.object, object.grasps,
               object.mean.value, object.mean.floor, object.mean.ceiling, object.mean.fraction);
  }
}

Model modelOf(const TrainCommand& command, const std::string& command_line, const GroupedSamples& data,
              const CrossValidation& validation) {
  Model model;
  model.name = "analytic-s";
  model.trained_on = fmt::format(
      "{} planned grasps on {} parametric objects in 3 sizes, labelled with s (Eq. 6) computed from the "
      "planned contacts by the "
      "six-dimensional grasp wrench space; no simulated or real grasp was executed",
      data.samples.targets.size(), validation.objects.size());
  model.command = command_line;
  model.data_hash = dataHash(data);
  model.seed = command.seed;
  model.created = utcNow();
  model.features = featuresOf(command);
  const SingleFeature single = bestSingleFeature(data);
  model.metrics = {{"s_net", validation.s_net},
                   {"s_net_fraction", validation.s_net_fraction},
                   {"best_single_measure", static_cast<double>(single.feature + 1)},
                   {"best_single_measure_fraction", single.fraction},
                   {"samples", static_cast<double>(data.samples.targets.size())}};
  return model;
}

}  // namespace

void runTrain(const TrainCommand& command, const std::string& command_line) {
  if (command.labels != "analytic") {
    throw InputError(fmt::format(
        "--labels is '{}', but this build knows only 'analytic': s computed from planned contacts",
        command.labels));
  }
  const HandDescription hand = command.hand ? readHandDescription(*command.hand) : barrettHand();
  AnalyticLabelOptions label_options;
  label_options.objects = command.objects;
  label_options.points = command.points;
  label_options.seed = command.seed;
  label_options.threads = command.threads;
  std::vector<LabelledObject> labels;
  {
    ProgressBar bar("labelling");
    labels = analyticLabels(hand, {}, label_options,
                            [&](std::size_t done, std::size_t total) { bar.update(done, total); });
  }
  std::erase_if(labels,
                [](const LabelledObject& object) { return object.success.size() < kLeastHypotheses; });
  const GroupedSamples data = stacked(labels, command);
  if (!command.json) printCounts(labels);

  CrossValidationOptions validation_options;
  validation_options.training.hidden = command.hidden;
  validation_options.repeats = command.repeats;
  validation_options.seed = command.seed;
  validation_options.threads = command.threads;
  fmt::print(stderr, "validating: leaving out one object at a time, {} times\n", command.repeats);
  const CrossValidation validation = leaveOneObjectOut(data, validation_options);
  if (!command.json) printValidation(validation);

  LevenbergMarquardtOptions training = validation_options.training;
  training.seed = command.seed;
  const auto [kept, held] =
      heldOut(data, validation.objects[command.seed % validation.objects.size()].object);
  Model model = modelOf(command, command_line, data, validation);
  model.ensemble.networks = {train(kept, held, training).network};
  model = writeModel(model, command.out);
  if (command.json) {
    fmt::print(
        "{}\n",
        nlohmann::json{{"version", model.version}, {"file", command.out.string()}, {"metrics", model.metrics}}
            .dump(2));
    return;
  }
  fmt::print(
      "S_net {:.3f}, {:.1f} % of the span between the worst and the perfect ranking (random: 50 %; best "
      "single measure, q{:.0f}: {:.1f} %)\n",
      validation.s_net, 100 * validation.s_net_fraction, model.metrics.at("best_single_measure"),
      100 * model.metrics.at("best_single_measure_fraction"));
  fmt::print("model {} written to {}\n", model.version, command.out.string());
}

}  // namespace boxgrasp
