// Trials of the planner's hypotheses on parametric objects, on 2 threads. Read the counter `hypotheses/s` of
// `trials`: closing with epsilon and nu alone, then with lift and shake, then with the push as well; `steps`
// is of one trial and `us/step` the processor time of one step on one core. What bounds a step is in the
// other entries: `heldStep` is a whole step with an object in the hand, of which `contactSearch` and
// `linkSearch` look for contacts and the rest is the engine; `handStep` the engine with the hand alone.
// `prepareObject` is paid once an object.
//
//   simulation_benchmark --step-sensitivity N
//
// tries N hypotheses and N / 4 random grasps with the default step and with half of it, and prints how many
// end with another word.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <ctime>
#include <map>
#include <optional>
#include <stdexcept>

#include "boxgrasp/base/parallel.h"
#include "boxgrasp/objects/parametric.h"
#include "boxgrasp/planning/hypotheses.h"
#include "boxgrasp/simulation/grasping.h"
#include "boxgrasp/training/baselines.h"

namespace boxgrasp {
namespace {

constexpr std::array kObjects{"mug",   "bottle", "banana", "duck", "bowl",   "hammer",
                              "radio", "bunny",  "pillow", "car",  "goblet", "teapot"};
constexpr int kThreads = 2;

struct Case {
  const SimulatedObject* object;
  TrialInput input;
  bool random = false;
};

// Of an object, `planned` of the planner's hypotheses, spread over their list, and `random` random grasps.
void addCases(const TriangleMesh& mesh, const SimulatedObject& object, int planned, int random,
              std::vector<Case>& cases) {
  PlanRequest request;
  request.cloud_C = sampleSurface(mesh, 8000, 1);
  PlanResult plan;
  Tally tally;
  findHypotheses(barrettHand(), {}, request, {}, nullptr, plan, tally);
  for (int i = 0; i < planned && !plan.grasps.empty(); ++i) {
    const Grasp& grasp = plan.grasps[i * plan.grasps.size() / planned];
    TrialInput input;
    input.X_OP = grasp.X_CP;
    input.pregrasp = grasp.pregrasp;
    cases.push_back({&object, input});
  }
  for (const HypothesisRecord& hypothesis : randomHypotheses(barrettHand(), mesh, random, 1)) {
    cases.push_back({&object, trialInput(hypothesis), true});
  }
}

class Cases {
 public:
  Cases(int planned, int random) {
    std::vector<std::vector<Case>> of_object(kObjects.size());
    objects_.resize(kObjects.size());
    parallelFor(kObjects.size(), kThreads, [&](std::size_t i) {
      const TriangleMesh mesh = parametricObject(kObjects[i]);
      objects_[i] = makeSimulatedObject(mesh);
      addCases(mesh, *objects_[i], share(planned, i), share(random, i), of_object[i]);
    });
    for (const auto& cases : of_object) all_.insert(all_.end(), cases.begin(), cases.end());
  }
  const std::vector<Case>& all() const { return all_; }

 private:
  static int share(int n, std::size_t i) {
    const int objects = static_cast<int>(kObjects.size());
    return n / objects + (static_cast<int>(i) < n % objects ? 1 : 0);
  }
  std::vector<std::optional<SimulatedObject>> objects_;
  std::vector<Case> all_;
};

std::vector<TrialResult> runAll(const std::vector<Case>& cases, const TrialOptions& options) {
  std::vector<TrialResult> results(cases.size());
  parallelFor(cases.size(), kThreads, [&](std::size_t i) {
    TrialOptions own = options;
    own.back_up_on_touch = cases[i].random;
    results[i] = runTrial(barrettHand(), *cases[i].object, cases[i].input, own);
  });
  return results;
}

const Cases& benchmarkCases() {
  static const Cases cases(96, 0);
  return cases;
}

double processorSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void trials(benchmark::State& state) {
  TrialOptions options;
  options.last_stage = static_cast<TrialStage>(state.range(0));
  const std::vector<Case>& cases = benchmarkCases().all();
  std::size_t steps = 0, tried = 0;
  const double start_s = processorSeconds();
  for (auto _ : state) {
    for (const TrialResult& result : runAll(cases, options)) steps += result.steps;
    tried += cases.size();
  }
  state.counters["hypotheses/s"] =
      benchmark::Counter(static_cast<double>(tried), benchmark::Counter::kIsRate);
  state.counters["steps"] = static_cast<double>(steps) / static_cast<double>(tried);
  state.counters["us/step"] = 1e6 * (processorSeconds() - start_s) / static_cast<double>(steps);
  constexpr std::array kLabels{"close, epsilon, nu", "... lift", "... lift, shake", "... lift, shake, push"};
  state.SetLabel(kLabels[static_cast<std::size_t>(state.range(0))]);
}
BENCHMARK(trials)->Arg(0)->Arg(2)->Arg(3)->ArgName("stage")->UseRealTime()->Unit(benchmark::kMillisecond);

void handStep(benchmark::State& state) {
  PhysicsWorld world(PhysicsOptions{}.step_s);
  DrivenHand hand(barrettHand(), {0.5, {0.5, 0.5, 0.5}}, Pose::Identity(), {}, world);
  for (auto _ : state) {
    hand.drive();
    world.step({});
  }
}
BENCHMARK(handStep);

// A grasp that holds, to look closer at.
struct Held {
  const Case& grasped = benchmarkCases().all().front();
  TrialOptions options;
  Grasping grasping{barrettHand(), *grasped.object, grasped.input, options, {}};
  Held() {
    if (!grasping.grasp()) throw std::runtime_error("the benchmark's grasp does not hold");
  }
};

void heldStep(benchmark::State& state) {
  Held held;
  for (auto _ : state) held.grasping.step(held.grasping.weight_W());
}
BENCHMARK(heldStep);

void contactSearch(benchmark::State& state) {
  Held held;
  const GraspScene& scene = held.grasping.scene();
  const Pose X_OW =
      Eigen::Translation3d(scene.solid().center_O) * scene.world().pose(scene.object()).inverse();
  for (auto _ : state) {
    for (const auto& [part, body] : scene.hand().parts()) {
      benchmark::DoNotOptimize(
          touches(part, X_OW * scene.world().pose(body), scene.solid().field, kTouchesPerLink));
    }
  }
}
BENCHMARK(contactSearch);

void linkSearch(benchmark::State& state) {
  Held held;
  for (auto _ : state) benchmark::DoNotOptimize(held.grasping.scene().hand().selfContacts());
}
BENCHMARK(linkSearch);

void prepareObject(benchmark::State& state) {
  const TriangleMesh mesh = parametricObject(kObjects.front());
  for (auto _ : state) benchmark::DoNotOptimize(makeSimulatedObject(mesh));
}
BENCHMARK(prepareObject)->Unit(benchmark::kMillisecond);

// How many of these cases end otherwise in b than in a, in words.
std::string difference(const std::vector<Case>& cases, const std::vector<TrialResult>& a,
                       const std::vector<TrialResult>& b, bool random) {
  int tried = 0, words = 0, held = 0;
  std::map<std::string, int> kinds;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (cases[i].random != random) continue;
    ++tried;
    if (a[i].outcome == b[i].outcome) continue;
    ++words;
    held += (a[i].outcome == TrialOutcome::held) != (b[i].outcome == TrialOutcome::held);
    ++kinds[fmt::format("{} -> {}", describe(a[i].outcome), describe(b[i].outcome))];
  }
  std::string text =
      fmt::format("{} {}: {} end with another word ({:.1f} %), {} are held in one alone\n", tried,
                  random ? "random grasps" : "hypotheses", words, 100.0 * words / std::max(1, tried), held);
  for (const auto& [kind, n] : kinds) text += fmt::format("  {:3} {}\n", n, kind);
  return text;
}

int printStepSensitivity(int n) {
  const Cases cases(n, n / 4);
  TrialOptions options;
  options.last_stage = TrialStage::shake;
  const std::vector<TrialResult> whole = runAll(cases.all(), options);
  const double step_s = options.physics.step_s;
  options.physics.step_s = 0.5 * step_s;
  const std::vector<TrialResult> half = runAll(cases.all(), options);
  fmt::print("Steps of {} s and of {} s\n", step_s, options.physics.step_s);
  fmt::print("{}", difference(cases.all(), whole, half, false));
  fmt::print("{}", difference(cases.all(), whole, half, true));
  return 0;
}

}  // namespace
}  // namespace boxgrasp

int main(int argc, char** argv) {
  if (argc == 3 && std::string_view(argv[1]) == "--step-sensitivity") {
    const std::string_view text = argv[2];
    int n = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
    if (error == std::errc() && end == text.data() + text.size() && n > 0)
      return boxgrasp::printStepSensitivity(n);
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
