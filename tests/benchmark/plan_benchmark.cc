// The whole plan, from the bytes of a PCD file to ranked grasps, on one thread, beside qhull's 3D hull of the
// same 100,000 points. Read the counter `hulls`: the plan's time in units of the hull's, both measured in
// turn in one run; `boxes`, `grasps`; and where the time goes, the last plan's stages in ms.
#include <benchmark/benchmark.h>

#include <chrono>
#include <span>

#include "boxgrasp/cloud/read_cloud.h"
#include "boxgrasp/planning/default_model.h"
#include "boxgrasp/planning/grasp_planner.h"
#include "measured_objects.h"
#include "qhull_yardstick.h"

namespace boxgrasp {
namespace {

constexpr std::size_t kPoints = 100'000;

std::string pcdBytes(const PointCloud& cloud) {
  std::string bytes = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " +
                      std::to_string(cloud.size()) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
                      std::to_string(cloud.size()) + "\nDATA binary\n";
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (const float value : {cloud.x[i], cloud.y[i], cloud.z[i]})
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  return bytes;
}

double seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void planBesideHull(benchmark::State& state, const MeasuredObject& object) {
  const PointCloud cloud = sampleSurface(object.mesh(), kPoints, 1);
  const std::string bytes = pcdBytes(cloud);
  std::vector<coordT> coordinates = test::qhullCoordinates(cloud);
  PlannerOptions options;
  options.threads = 1;
  const GraspPlanner planner(barrettHand(), modelOrDefault(std::nullopt), options);
  PlanResult result;
  double plan_s = 0.0, hull_s = 0.0;
  for (auto _ : state) {
    const double this_plan_s = seconds([&] {
      PlanRequest request;
      request.cloud_C = parseCloud(std::span(bytes.data(), bytes.size()), "benchmark").cloud_C;
      result = planner.plan(request);
    });
    state.SetIterationTime(this_plan_s);
    plan_s += this_plan_s;
    hull_s += seconds([&] { test::buildQhull(coordinates); });
  }
  state.counters["hulls"] = plan_s / hull_s;
  state.counters["boxes"] =
      static_cast<double>(result.objects.empty() ? 0 : result.objects.front().tree.leaves().size());
  state.counters["grasps"] = static_cast<double>(result.grasps.size());
  for (const Stage& stage : result.report.stages) state.counters[stage.name + "_ms"] = 1e3 * stage.time_s;
  state.SetLabel(object.name);
}

}  // namespace
}  // namespace boxgrasp

int main(int argc, char** argv) {
  for (const boxgrasp::MeasuredObject& object :
       boxgrasp::measuredObjects({"bunny", "duck", "mug", "teapot"}, argc, argv))
    benchmark::RegisterBenchmark(("planBesideHull/" + object.name).c_str(), boxgrasp::planBesideHull, object)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
