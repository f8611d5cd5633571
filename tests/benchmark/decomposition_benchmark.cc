// Whole decompositions of points sampled on objects, on one thread, beside qhull's 3D hull of the
// same points. Read the counter `hulls`: the decomposition's time in units of the hull's, both measured in
// turn in one run; "leaves" counts the boxes found, so that a tree that stops early is not taken for a fast
// one. plainTreeOf is the same algorithm with every cut tried on all points: the ratio to treeOf at the same
// size is what the search saves.
#include <benchmark/benchmark.h>

#include <chrono>
#include <functional>
#include <string>

#include "boxgrasp/decomposition/decompose.h"
#include "measured_objects.h"
#include "qhull_yardstick.h"

namespace boxgrasp {
namespace {

double seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void decomposeObject(benchmark::State& state, const MeasuredObject& object,
                     const DecompositionOptions& options) {
  const PointCloud cloud = sampleSurface(object.mesh(), static_cast<std::size_t>(state.range(0)), 1);
  std::vector<coordT> coordinates = test::qhullCoordinates(cloud);
  std::size_t leaves = 0;
  double tree_s = 0.0, hull_s = 0.0;
  for (auto _ : state) {
    const double this_tree_s = seconds([&] { leaves = decompose(cloud, options).leaves().size(); });
    state.SetIterationTime(this_tree_s);
    tree_s += this_tree_s;
    hull_s += seconds([&] { test::buildQhull(coordinates); });
  }
  state.counters["leaves"] = static_cast<double>(leaves);
  state.counters["hulls"] = tree_s / hull_s;
}

void treeOf(benchmark::State& state, const MeasuredObject& object, GainMeasure gain) {
  DecompositionOptions options;
  options.gain = gain;
  decomposeObject(state, object, options);
}

void plainTreeOf(benchmark::State& state, const MeasuredObject& object) {
  DecompositionOptions options;
  options.exhaustive = true;
  decomposeObject(state, object, options);
}

void measured(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("points")->UseManualTime()->Unit(benchmark::kMillisecond);
}

void registerTrees(const std::vector<MeasuredObject>& objects) {
  for (const MeasuredObject& object : objects) {
    for (const auto& [gain, word] :
         {std::pair{GainMeasure::sum, "sum"}, std::pair{GainMeasure::local, "local"}}) {
      benchmark::RegisterBenchmark(("treeOf/" + object.name + "/" + word).c_str(), treeOf, object, gain)
          ->Arg(3'000)
          ->Arg(20'000)
          ->Arg(100'000)
          ->Apply(measured);
    }
  }
}

void registerPlainTrees(const std::vector<MeasuredObject>& objects) {
  for (const MeasuredObject& object : objects)
    benchmark::RegisterBenchmark(("plainTreeOf/" + object.name).c_str(), plainTreeOf, object)
        ->Arg(3'000)
        ->Apply(measured);
}

}  // namespace
}  // namespace boxgrasp

int main(int argc, char** argv) {
  boxgrasp::registerTrees(
      boxgrasp::measuredObjects({"bunny", "duck", "mug", "teapot", "toy_dog", "horse", "human"}, argc, argv));
  boxgrasp::registerPlainTrees(boxgrasp::parametricObjects({"mug", "toy_dog", "horse"}));
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
