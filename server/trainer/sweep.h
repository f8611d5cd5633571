// Networks of all sizes compared (Fig. 7).
#pragma once

#include "study.h"

namespace boxgrasp {

struct SweepPoint {
  std::vector<int> hidden;
  double s_net = NAN, fraction = NAN;  // on objects left out, means over them
  double time_s = NAN;                 // one core's time for one network, mean
};

// One hidden layer of 1 to 30 nodes, then two and three of 10, as in the paper. Each object is left out once,
// with one network of one start: a sweep asks for the trend.
std::vector<SweepPoint> sweep(const StudyCommand& command, const StudyData& data, const StopToken& stop);

}  // namespace boxgrasp
