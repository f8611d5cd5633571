// How a server is, as its pages and its metrics say it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "boxgrasp/status_t.hpp"

namespace boxgrasp {

// How many plans took at most so long.
class LatencyCounts {
 public:
  static constexpr std::array<double, 10> kBounds_s{0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 60.0};

  void add(double time_s) {
    const auto bound = std::lower_bound(kBounds_s.begin(), kBounds_s.end(), time_s);
    ++counts_[static_cast<std::size_t>(bound - kBounds_s.begin())];
    sum_s_ += time_s;
  }
  // Of the times up to kBounds_s[i], above those of the bound before; the last: above all bounds.
  const std::array<std::int64_t, kBounds_s.size() + 1>& counts() const { return counts_; }
  double sum_s() const { return sum_s_; }

 private:
  std::array<std::int64_t, kBounds_s.size() + 1> counts_{};
  double sum_s_ = 0.0;
};

struct ServerState {
  status_t status{};
  LatencyCounts latencies;
  std::int64_t receiver_restarts = 0;
  std::int64_t resident_bytes = -1;  // of the server's memory; -1: unknown
};

}  // namespace boxgrasp
