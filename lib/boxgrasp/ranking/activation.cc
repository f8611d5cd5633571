#include "boxgrasp/ranking/activation.h"

#include <bit>
#include <cstdint>
#include <iterator>

#include "boxgrasp/base/simd.h"

namespace boxgrasp {
namespace {

// 1 / n! for n = 13 down to 0.
constexpr double kInverseFactorials[] = {1.0 / 6227020800.0,
                                         1.0 / 479001600.0,
                                         1.0 / 39916800.0,
                                         1.0 / 3628800.0,
                                         1.0 / 362880.0,
                                         1.0 / 40320.0,
                                         1.0 / 5040.0,
                                         1.0 / 720.0,
                                         1.0 / 120.0,
                                         1.0 / 24.0,
                                         1.0 / 6.0,
                                         0.5,
                                         1.0,
                                         1.0};

// exp(y) = 2^k exp(r) with |r| <= ln(2) / 2: Taylor's series to the 13th power is exact to double precision
// there. Adding 1.5 * 2^52 rounds to an integer whose value is in the low bits of the sum. Pre: |y| <= 40.
[[gnu::always_inline]] inline double exponential(double y) {
  constexpr double kRound = 6755399441055744.0, kLog2E = 1.4426950408889634;
  constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;
  const double shifted = y * kLog2E + kRound;
  const double k = shifted - kRound;
  const double r = (y - k * kLn2High) - k * kLn2Low;
  double sum = kInverseFactorials[0];
  for (std::size_t i = 1; i < std::size(kInverseFactorials); ++i) sum = sum * r + kInverseFactorials[i];
  const auto exponent = std::bit_cast<std::uint64_t>(shifted) << 52;
  return sum * std::bit_cast<double>(exponent + std::bit_cast<std::uint64_t>(1.0));
}

}  // namespace

BOXGRASP_SIMD void tanhInPlace(double* values, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) {
    const double x = values[i];
    const double bounded = x > 20.0 ? 20.0 : (x < -20.0 ? -20.0 : x);
    values[i] = 1.0 - 2.0 / (exponential(2.0 * bounded) + 1.0);
  }
}

}  // namespace boxgrasp
