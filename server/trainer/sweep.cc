#include "sweep.h"

#include <mutex>

#include "boxgrasp/base/parallel.h"
#include "progress_bar.h"

namespace boxgrasp {
namespace {

std::vector<std::vector<int>> sizes() {
  std::vector<std::vector<int>> all;
  for (int nodes = 1; nodes <= 30; ++nodes) all.push_back({nodes});
  all.push_back({10, 10});
  all.push_back({10, 10, 10});
  return all;
}

SweepPoint pointOf(const StudyCommand& command, const StudyData& data, const std::vector<int>& hidden,
                   const StopToken& stop) {
  CrossValidationOptions options;
  options.training.hidden = hidden;
  options.training.starts = 1;
  options.repeats = 1;
  options.seed = command.seed;
  options.threads = 1;
  const CrossValidation validation = leaveOneObjectOut(data.samples, options, stop);
  return {hidden, validation.s_net, validation.s_net_fraction,
          validation.time_s / static_cast<double>(validation.objects.size())};
}

}  // namespace

std::vector<SweepPoint> sweep(const StudyCommand& command, const StudyData& data, const StopToken& stop) {
  const std::vector<std::vector<int>> all = sizes();
  std::vector<SweepPoint> points(all.size());
  ProgressBar bar("sweeping");
  std::mutex reporting;
  std::size_t done = 0;
  // The largest first, so that no core is left alone with one.
  parallelFor(all.size(), command.threads, [&](std::size_t i) {
    const std::size_t largest = all.size() - 1 - i;
    points[largest] = pointOf(command, data, all[largest], stop);
    const std::lock_guard lock(reporting);
    bar.update(++done, all.size());
  });
  return points;
}

}  // namespace boxgrasp
