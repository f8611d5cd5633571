// The grasp wrench space of three contacts with eight cone edges each, the size of one grasp of the Barrett hand.
// "closed" is the share of the sets that are in force closure: both must report the same, but for an incomplete last
// round through the sets.
#include <benchmark/benchmark.h>

#include "boxgrasp/wrench/grasp_wrench_space.h"
#include "random_contacts.h"

namespace boxgrasp {
namespace {

constexpr std::size_t kSets = 64;

std::vector<std::vector<Contact>> sets() {
  std::mt19937_64 random(1);
  std::vector<std::vector<Contact>> result(kSets);
  for (auto& contacts : result) contacts = test::randomGrasp(random, 3);
  return result;
}

WrenchOptions options() {
  WrenchOptions result;
  result.friction = 0.8;
  result.torque_scale_m = test::kGraspRadius;
  return result;
}

template <typename Closed>
void measure(benchmark::State& state, Closed closed) {
  const auto grasps = sets();
  std::size_t runs = 0, closures = 0;
  for (auto _ : state) closures += closed(grasps[runs++ % kSets]);
  state.counters["closed"] = static_cast<double>(closures) / static_cast<double>(runs);
}

void qualityOfThreeContacts(benchmark::State& state) {
  measure(state, [](const auto& contacts) { return graspQuality(contacts, options()).force_closure; });
}
BENCHMARK(qualityOfThreeContacts)->Unit(benchmark::kMicrosecond);

void forceClosureOfThreeContacts(benchmark::State& state) {
  measure(state, [](const auto& contacts) { return forceClosure(contacts, options()); });
}
BENCHMARK(forceClosureOfThreeContacts)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace boxgrasp
