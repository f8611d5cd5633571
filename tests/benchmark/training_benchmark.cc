// Training at the paper's size: 5,951 grasps, 9 measures, 8 hidden nodes, 100 epochs. Time is of one core.
// "epochs" counts the epochs that were run, so that a run stopped early is not taken for a fast one.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>

#include "boxgrasp/base/random.h"
#include "boxgrasp/objects/parametric.h"
#include "boxgrasp/training/cross_validation.h"

namespace boxgrasp {
namespace {

constexpr Eigen::Index kGrasps = 5951, kMeasures = 9;

// A smooth law under noise, so that no run ends before its last epoch.
Samples samples() {
  std::mt19937_64 random(1);
  Samples result{MatrixXd(kGrasps, kMeasures), VectorXd(kGrasps)};
  for (Eigen::Index i = 0; i < kGrasps; ++i) {
    for (Eigen::Index j = 0; j < kMeasures; ++j) result.inputs(i, j) = uniform(random);
    result.targets[i] = std::sin(3.0 * result.inputs(i, 0)) + result.inputs.row(i).sum() + normal(random);
  }
  return result;
}

void trainOneStart(benchmark::State& state) {
  const Samples training = samples(), none{MatrixXd(0, kMeasures), VectorXd(0)};
  LevenbergMarquardtOptions options;
  options.hidden = {static_cast<int>(state.range(0))};
  options.starts = 1;
  options.min_gradient = 0.0;
  for (auto _ : state) {
    const Trained trained = train(training, none, options);
    state.counters["epochs"] = static_cast<double>(trained.report.training_mse.size() - 1);
  }
}
BENCHMARK(trainOneStart)->Arg(1)->Arg(8)->Arg(30)->Unit(benchmark::kMillisecond);

void leaveOneOfFourteenOut(benchmark::State& state) {
  GroupedSamples data{samples(), {}};
  for (Eigen::Index i = 0; i < kGrasps; ++i) data.objects.push_back(fmt::format("object{}", i % 14));
  CrossValidationOptions options;
  options.repeats = 1;
  options.training.starts = 1;
  for (auto _ : state) benchmark::DoNotOptimize(leaveOneObjectOut(data, options));
}
BENCHMARK(leaveOneOfFourteenOut)->Unit(benchmark::kMillisecond)->UseRealTime();

void scoreAll(benchmark::State& state) {
  const Samples data = samples();
  LevenbergMarquardtOptions options;
  options.max_epochs = 0;
  const Network network = train(data, {MatrixXd(0, kMeasures), VectorXd(0)}, options).network;
  for (auto _ : state) benchmark::DoNotOptimize(scores(network, data.inputs));
}
BENCHMARK(scoreAll)->Unit(benchmark::kMicrosecond);

void buildObject(benchmark::State& state, const std::string& name) {
  for (auto _ : state) benchmark::DoNotOptimize(parametricObject(name));
}
BENCHMARK_CAPTURE(buildObject, mug, "mug")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(buildObject, squirrel, "squirrel")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace boxgrasp
