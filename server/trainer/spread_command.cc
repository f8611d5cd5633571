#include "spread_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "boxgrasp/base/error.h"
#include "boxgrasp/rendering/svg_plot.h"
#include "boxgrasp/training/baselines.h"
#include "interruption.h"
#include "print_json.h"
#include "progress_bar.h"
#include "tried_object.h"

namespace boxgrasp {
namespace {

using nlohmann::json;

// Grasps of one source, closed.
struct Cloud {
  std::string name;
  Series look;
  std::vector<HypothesisRecord> grasps;
  std::vector<TrialResult> results;

  std::size_t closed() const {
    return static_cast<std::size_t>(std::count_if(
        results.begin(), results.end(), [](const TrialResult& r) { return r.quality.force_closure; }));
  }
};

Series markers(Marker marker, double size_px, double opacity) {
  Series series;
  series.kind = SeriesKind::points;
  series.marker = marker;
  series.size_px = size_px;
  series.opacity = opacity;
  return series;
}

std::vector<Cloud> cloudsOf(const SpreadCommand& command, const TriedObject& object, const Planning& planning,
                            const StopToken& stop) {
  FoundGrasps found = findGrasps(planning, object, wholeName(), {}, stop);
  const Series dots = markers(Marker::circle, 4.0, 0.45), crosses = markers(Marker::cross, 7.0, 1.0),
               diamonds = markers(Marker::diamond, 7.0, 0.7);
  return {{"random", dots, randomHypotheses(planning.hand, object.mesh_O, command.random, command.seed), {}},
          {"approach and close", crosses, std::move(found.approach), {}},
          {"hypotheses", diamonds, std::move(found.hypotheses), {}}};
}

void closeAll(std::vector<Cloud>& clouds, const TriedObject& object, const HandDescription& hand, int threads,
              const StopToken& stop) {
  std::size_t total = 0, before = 0;
  for (const Cloud& cloud : clouds) total += cloud.grasps.size();
  ProgressBar bar("closing");
  for (Cloud& cloud : clouds) {
    if (cloud.grasps.empty()) continue;
    const TrialOptions options = trialOptions(cloud.grasps.front().source, TrialStage::close);
    cloud.results = tryAll(hand, object.solid, cloud.grasps, options, threads, stop,
                           [&](std::size_t done) { bar.update(before + done, total); });
    before += cloud.grasps.size();
  }
}

// Grasps without force closure have no epsilon, and are counted in the legend alone.
Plot plotOf(const TriedObject& object, const std::vector<Cloud>& clouds) {
  Plot plot;
  plot.title = fmt::format("Grasps of {} at scale {:.2f}", object.name, object.scale);
  plot.subtitle = "force closures alone; torques about the centre of mass over its largest distance";
  plot.x.label = "epsilon";
  plot.y.label = "nu";
  plot.x.low = plot.y.low = 0.0;
  for (const Cloud& cloud : clouds) {
    Series series = cloud.look;
    series.name = fmt::format("{}: {} of {}", cloud.name, cloud.closed(), cloud.results.size());
    for (const TrialResult& result : cloud.results) {
      if (result.quality.force_closure)
        series.points.emplace_back(result.quality.epsilon, result.quality.volume);
    }
    plot.series.push_back(series);
  }
  return plot;
}

// The percentage of the values that are below this one; equal ones count half.
double percentile(const std::vector<double>& values, double value) {
  double below = 0.0;
  for (const double v : values) below += v < value ? 1.0 : v == value ? 0.5 : 0.0;
  return values.empty() ? NAN : 100 * below / static_cast<double>(values.size());
}

// s of all clouds' grasps on one scale, each cloud's own.
std::vector<std::vector<double>> successesOf(const std::vector<Cloud>& clouds) {
  std::vector<TrialResult> all;
  for (const Cloud& cloud : clouds) all.insert(all.end(), cloud.results.begin(), cloud.results.end());
  const VectorXd s = successesOf(all);
  std::vector<std::vector<double>> parts;
  const double* next = s.data();
  for (const Cloud& cloud : clouds) {
    parts.emplace_back(next, next + cloud.results.size());
    next += cloud.results.size();
  }
  return parts;
}

template <typename Value>
std::vector<double> valuesOf(const Cloud& cloud, const Value& value) {
  std::vector<double> values;
  for (const TrialResult& result : cloud.results) values.push_back(value(result.quality));
  return values;
}

double epsilonOf(const GraspQuality& quality) { return std::max(0.0, quality.epsilon); }
double nuOf(const GraspQuality& quality) { return std::max(0.0, quality.volume); }

// What is said of one cloud; percentiles are among the random grasps.
json summaryOf(const Cloud& cloud, const std::vector<double>& s, const Cloud& random,
               const std::vector<double>& random_s) {
  json summary{{"source", cloud.name}, {"grasps", cloud.results.size()}, {"force_closures", cloud.closed()}};
  if (s.empty()) return summary;
  std::vector<double> sorted = s;
  std::sort(sorted.begin(), sorted.end());
  const auto best = static_cast<std::size_t>(std::max_element(s.begin(), s.end()) - s.begin());
  const GraspQuality& quality = cloud.results[best].quality;
  summary["best"] = {{"index", cloud.grasps[best].index},
                     {"epsilon", quality.epsilon},
                     {"nu", quality.volume},
                     {"s", s[best]},
                     {"percentile_epsilon", percentile(valuesOf(random, epsilonOf), epsilonOf(quality))},
                     {"percentile_nu", percentile(valuesOf(random, nuOf), nuOf(quality))},
                     {"percentile_s", percentile(random_s, s[best])}};
  summary["median_percentile_s"] = percentile(random_s, sorted[sorted.size() / 2]);
  return summary;
}

void printSummary(const json& summary) {
  fmt::print("{:<20} {:>6} grasps, {:>5} force closures", summary["source"].get<std::string>(),
             summary["grasps"].get<int>(), summary["force_closures"].get<int>());
  if (summary.contains("best")) {
    const auto best = [&](const char* key) { return summary["best"][key].get<double>(); };
    fmt::print(
        "; best: epsilon {:.4f} (percentile {:.2f}), nu {:.4f} ({:.2f}), s {:.3f} ({:.2f}); median of s: "
        "{:.1f}",
        best("epsilon"), best("percentile_epsilon"), best("nu"), best("percentile_nu"), best("s"),
        best("percentile_s"), summary["median_percentile_s"].get<double>());
  }
  fmt::print("\n");
}

}  // namespace

void runSpread(const SpreadCommand& command) {
  requireOption(command.random >= 1 && command.random <= 1'000'000, "--random", command.random,
                "in [1, 1000000]");
  requireOption(command.threads >= 0, "--threads", command.threads, "at least 0");
  const StopToken stop = stopOnInterrupt();
  const TriedObject object = triedObject(sourceOf(command.object, command.scale), stop);
  Planning planning = planningWith();
  planning.options.threads = command.threads;
  std::vector<Cloud> clouds = cloudsOf(command, object, planning, stop);
  closeAll(clouds, object, planning.hand, command.threads, stop);
  writeSvg(plotOf(object, clouds), command.out);
  const std::vector<std::vector<double>> s = successesOf(clouds);
  json report{
      {"schema", 1}, {"object", object.name}, {"scale", object.scale}, {"plot", command.out.string()}};
  for (std::size_t i = 0; i < clouds.size(); ++i)
    report["sources"].push_back(summaryOf(clouds[i], s[i], clouds.front(), s.front()));
  if (command.json) {
    printJson(report);
    return;
  }
  for (const json& summary : report["sources"]) printSummary(summary);
  fmt::print("percentiles are among the random grasps; plot written to {}\n", command.out.string());
}

}  // namespace boxgrasp
