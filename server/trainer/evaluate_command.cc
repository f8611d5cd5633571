#include "evaluate_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "boxgrasp/base/error.h"
#include "interruption.h"
#include "study_json.h"
#include "study_plots.h"
#include "sweep.h"

namespace boxgrasp {
namespace {

void printObjects(const StudyResult& result) {
  fmt::print("{:<16} {:>6} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7}\n", "left out", "grasps", "S_net", "floor",
             "ceiling", "span %", "best", "worst");
  for (const ObjectVerdict& object : result.network.objects) {
    fmt::print("{:<16} {:>6} {:>7.3f} {:>7.3f} {:>7.3f} {:>7.1f} {:>7.3f} {:>7.3f}\n", object.object,
               object.grasps, object.success.value, object.success.floor, object.success.ceiling,
               100 * object.success.fraction, object.success.mean_best_tenth,
               object.success.mean_worst_tenth);
  }
}

void printReliability(const Reliability& reliability) {
  fmt::print("{:>6} {:>6} {:>9} {:>6}\n", "grasps", "said", "happened", "");
  for (const Reliability::Bin& bin : reliability.bins) {
    if (bin.grasps > 0) fmt::print("{:>6} {:>6.2f} {:>9.2f}\n", bin.grasps, bin.said, bin.happened);
  }
  fmt::print("Brier score {:.4f}; of the mean alone {:.4f}\n", reliability.brier, reliability.base_brier);
}

void printSweep(const std::vector<SweepPoint>& sweep) {
  fmt::print("{:<14} {:>7} {:>7} {:>10}\n", "hidden", "S_net", "span %", "time s");
  for (const SweepPoint& point : sweep)
    fmt::print("{:<14} {:>7.3f} {:>7.1f} {:>10.3f}\n", fmt::format("{}", fmt::join(point.hidden, " x ")),
               point.s_net, 100 * point.fraction, point.time_s);
}

}  // namespace

void runEvaluate(const EvaluateCommand& command) {
  const StopToken stop = stopOnInterrupt();
  const StudyData data = studyData(command.study, stop);
  const StudyResult result = evaluated(command.study, data, stop);
  const std::vector<SweepPoint> points =
      command.sweep ? sweep(command.study, data, stop) : std::vector<SweepPoint>();
  if (command.plot) {
    if (!result.reliability)
      throw InputError("--plot needs --target hold: other scores are no probabilities");
    writeSvg(reliabilityPlot(*result.reliability), *command.plot);
  }
  if (command.json) {
    nlohmann::json json = studyJson(data, result);
    if (command.sweep) json["sweep"] = sweepJson(points);
    fmt::print("{}\n", json.dump(2));
    return;
  }
  printObjects(result);
  fmt::print("{} grasps, {} lists, {} inputs; {} repeats, span over them +- {:.1f} %\n",
             data.samples.samples.targets.size(), data.lists.size(), data.features.size(),
             command.study.repeats, 100 * result.network.deviation);
  fmt::print("{}", verdictTable(result));
  if (result.reliability) printReliability(*result.reliability);
  if (command.sweep) printSweep(points);
}

}  // namespace boxgrasp
