#include "study_plots.h"

#include <algorithm>

namespace boxgrasp {
namespace {

std::vector<std::string> namesOf(const RankingVerdict& verdict) {
  std::vector<std::string> names;
  for (const ObjectVerdict& object : verdict.objects) names.push_back(object.object);
  return names;
}

std::vector<Vector2d> byObject(const RankingVerdict& verdict, double RankingSuccess::*field) {
  std::vector<Vector2d> points;
  for (std::size_t i = 0; i < verdict.objects.size(); ++i)
    points.emplace_back(static_cast<double>(i), verdict.objects[i].success.*field);
  return points;
}

Series curve(const std::vector<double>& values, const std::string& name, int colour, bool dashed) {
  Series series{
      .name = name, .kind = SeriesKind::line, .points = {}, .low = {}, .colour = colour, .dashed = dashed};
  for (std::size_t i = 0; i < values.size(); ++i)
    series.points.emplace_back(static_cast<double>(i), values[i]);
  return series;
}

}  // namespace

Plot reliabilityPlot(const Reliability& reliability) {
  Series said{.name = "grasps on objects left out",
              .kind = SeriesKind::line,
              .points = {},
              .low = {},
              .marker = Marker::circle};
  for (const Reliability::Bin& bin : reliability.bins) {
    if (bin.grasps > 0) said.points.emplace_back(bin.said, bin.happened);
  }
  const Series ideal{
      .name = "as said", .kind = SeriesKind::line, .points = {{0, 0}, {1, 1}}, .low = {}, .dashed = true};
  return {.title = "Reliability",
          .subtitle = "",
          .x = {.label = "probability that was said", .low = 0.0, .high = 1.0, .categories = {}},
          .y = {.label = "share that was held", .low = 0.0, .high = 1.0, .categories = {}},
          .second_y = {},
          .series = {said, ideal}};
}

Plot spanPlot(const RankingVerdict& verdict) {
  Series span{.name = "possible S_net",
              .kind = SeriesKind::spans,
              .points = byObject(verdict, &RankingSuccess::ceiling),
              .low = {}};
  for (const ObjectVerdict& object : verdict.objects) span.low.push_back(object.success.floor);
  const Series value{.name = "S_net",
                     .kind = SeriesKind::points,
                     .points = byObject(verdict, &RankingSuccess::value),
                     .low = {},
                     .marker = Marker::square};
  const Series best{.name = "mean s, best tenth",
                    .kind = SeriesKind::points,
                    .points = byObject(verdict, &RankingSuccess::mean_best_tenth),
                    .low = {},
                    .marker = Marker::triangle_up};
  const Series worst{.name = "mean s, worst tenth",
                     .kind = SeriesKind::points,
                     .points = byObject(verdict, &RankingSuccess::mean_worst_tenth),
                     .low = {},
                     .marker = Marker::triangle_down};
  return {.title = "Success on objects left out",
          .subtitle = "as Fig. 8 of the paper",
          .x = {.label = "", .low = {}, .high = {}, .categories = namesOf(verdict)},
          .y = {.label = "s", .low = {}, .high = {}, .categories = {}},
          .second_y = {},
          .series = {span, value, best, worst}};
}

Plot sweepPlot(const std::vector<SweepPoint>& points) {
  Series success{
      .name = "S_net", .kind = SeriesKind::line, .points = {}, .low = {}, .marker = Marker::circle};
  Series time{.name = "training time",
              .kind = SeriesKind::line,
              .points = {},
              .low = {},
              .dashed = true,
              .second_axis = true};
  for (const SweepPoint& point : points) {
    if (point.hidden.size() != 1) continue;
    success.points.emplace_back(point.hidden[0], point.s_net);
    time.points.emplace_back(point.hidden[0], point.time_s);
  }
  return {.title = "Hidden nodes",
          .subtitle = "as Fig. 7 of the paper: one hidden layer, each object left out once",
          .x = {.label = "nodes", .low = {}, .high = {}, .categories = {}},
          .y = {.label = "S_net", .low = {}, .high = {}, .categories = {}},
          .second_y = {.label = "training time [s]", .low = 0.0, .high = {}, .categories = {}},
          .series = {success, time}};
}

Plot learningCurves(const std::vector<TrainingReport>& trainings) {
  Plot plot{.title = "Learning curves",
            .subtitle = "lines: training; dashed: the object that decides when to stop",
            .x = {.label = "epoch", .low = {}, .high = {}, .categories = {}},
            .y = {.label = "mean squared error, normalised", .low = 0.0, .high = {}, .categories = {}},
            .second_y = {},
            .series = {}};
  for (std::size_t i = 0; i < std::min<std::size_t>(trainings.size(), 5); ++i) {
    const int colour = static_cast<int>(i);
    plot.series.push_back(curve(trainings[i].training_mse, "", colour, false));
    plot.series.push_back(curve(trainings[i].validation_mse, "", colour, true));
  }
  return plot;
}

Plot comparisonPlot(const StudyResult& result) {
  const RankingVerdict& nine = bestOfNine(result.measures);
  const Series network{.name = "network",
                       .kind = SeriesKind::bars,
                       .points = byObject(result.network, &RankingSuccess::fraction),
                       .low = {}};
  const Series single{.name = nine.ranking,
                      .kind = SeriesKind::bars,
                      .points = byObject(nine, &RankingSuccess::fraction),
                      .low = {}};
  return {.title = "Share of the achievable span of S_net",
          .subtitle = "random: a half",
          .x = {.label = "", .low = {}, .high = {}, .categories = namesOf(result.network)},
          .y = {.label = "share", .low = 0.0, .high = 1.0, .categories = {}},
          .second_y = {},
          .series = {network, single}};
}

Plot importancePlot(const std::vector<Importance>& importances) {
  Plot plot{.title = "Which inputs matter",
            .subtitle = "share of the span that is lost without them",
            .x = {.label = "", .low = {}, .high = {}, .categories = {}},
            .y = {.label = "loss", .low = {}, .high = {}, .categories = {}},
            .second_y = {},
            .series = {}};
  Series bars{.name = "", .kind = SeriesKind::bars, .points = {}, .low = {}};
  for (const Importance& importance : importances) {
    bars.points.emplace_back(static_cast<double>(plot.x.categories.size()), importance.loss);
    plot.x.categories.push_back(importance.feature);
  }
  plot.series.push_back(bars);
  return plot;
}

}  // namespace boxgrasp
