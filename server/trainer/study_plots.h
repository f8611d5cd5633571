// A study's results as plots.
#pragma once

#include "boxgrasp/rendering/svg_plot.h"
#include "study.h"
#include "sweep.h"

namespace boxgrasp {

Plot reliabilityPlot(const Reliability& reliability);
Plot spanPlot(const RankingVerdict& verdict);           // Fig. 8
Plot sweepPlot(const std::vector<SweepPoint>& points);  // Fig. 7
Plot learningCurves(const std::vector<TrainingReport>& trainings);
Plot comparisonPlot(const StudyResult& result);  // share of the span, object by object

// What the ranking loses when one input's values are exchanged among the grasps of all objects.
struct Importance {
  std::string feature;
  double loss = 0.0;  // of `fraction`
};
Plot importancePlot(const std::vector<Importance>& importances);

}  // namespace boxgrasp
