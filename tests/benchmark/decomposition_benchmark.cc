// Whole decompositions of points sampled on parametric objects, on one thread. "leaves" counts the boxes
// found, so that a tree that stops early is not taken for a fast one. plainTreeOf is the same algorithm with
// every cut tried on all points: the ratio to treeOf at the same size is what the bounds save.
#include <benchmark/benchmark.h>

#include <string>

#include "boxgrasp/decomposition/decompose.h"
#include "boxgrasp/objects/parametric.h"

namespace boxgrasp {
namespace {

void decomposeObject(benchmark::State& state, const std::string& name, const DecompositionOptions& options) {
  const PointCloud cloud = sampleSurface(parametricObject(name), static_cast<std::size_t>(state.range(0)), 1);
  std::size_t leaves = 0;
  for (auto _ : state) leaves = decompose(cloud, options).leaves().size();
  state.counters["leaves"] = static_cast<double>(leaves);
}

void treeOf(benchmark::State& state, const std::string& name, GainMeasure gain) {
  DecompositionOptions options;
  options.gain = gain;
  decomposeObject(state, name, options);
}

void plainTreeOf(benchmark::State& state, const std::string& name) {
  DecompositionOptions options;
  options.exhaustive = true;
  decomposeObject(state, name, options);
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->Arg(3'000)->Arg(20'000)->Arg(100'000)->ArgName("points")->Unit(benchmark::kMillisecond);
}

BENCHMARK_CAPTURE(treeOf, mug_sum, "mug", GainMeasure::sum)->Apply(sizes);
BENCHMARK_CAPTURE(treeOf, mug_local, "mug", GainMeasure::local)->Apply(sizes);
BENCHMARK_CAPTURE(treeOf, toy_dog_sum, "toy_dog", GainMeasure::sum)->Apply(sizes);
BENCHMARK_CAPTURE(treeOf, toy_dog_local, "toy_dog", GainMeasure::local)->Apply(sizes);
BENCHMARK_CAPTURE(treeOf, horse_sum, "horse", GainMeasure::sum)->Apply(sizes);
BENCHMARK_CAPTURE(treeOf, horse_local, "horse", GainMeasure::local)->Apply(sizes);
BENCHMARK_CAPTURE(plainTreeOf, mug, "mug")->Arg(3'000)->ArgName("points")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(plainTreeOf, toy_dog, "toy_dog")
    ->Arg(3'000)
    ->ArgName("points")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(plainTreeOf, horse, "horse")->Arg(3'000)->ArgName("points")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace boxgrasp
