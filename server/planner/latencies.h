// How long the last plans took.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "boxgrasp/live/server_state.h"

namespace boxgrasp {

// The last 1000 times, in seconds, and how all were distributed.
class Latencies {
 public:
  void add(double time_s) {
    times_s_[count_++ % times_s_.size()] = time_s;
    counts_.add(time_s);
  }
  const LatencyCounts& counts() const { return counts_; }

  // The smallest time that this share of the times does not exceed; NaN without any.
  double quantile(double share) const {
    std::vector<double> sorted(times_s_.begin(), times_s_.begin() + std::min(count_, times_s_.size()));
    if (sorted.empty()) return NAN;
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
    const auto at = sorted.begin() + std::max<std::size_t>(rank, 1) - 1;
    std::nth_element(sorted.begin(), at, sorted.end());
    return *at;
  }

 private:
  std::array<double, 1000> times_s_{};
  std::size_t count_ = 0;
  LatencyCounts counts_;
};

}  // namespace boxgrasp
