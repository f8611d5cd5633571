#include "boxgrasp/ranking/activation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace boxgrasp {
namespace {

double ownTanh(double x) {
  tanhInPlace(&x, 1);
  return x;
}

TEST(Activation, IsTanhToDoublePrecision) {
  for (double x = -25.0; x <= 25.0; x += 0.00137) {
    EXPECT_NEAR(ownTanh(x), std::tanh(x), 4e-16) << "at x = " << x;
  }
}

TEST(Activation, SaturatesForHugeAndInfiniteArguments) {
  for (const double x : {20.0, 21.0, 1e6, 1e308, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(ownTanh(x), 1.0) << "at x = " << x;
    EXPECT_EQ(ownTanh(-x), -1.0) << "at x = " << -x;
  }
}

TEST(Activation, IsZeroAtZeroAndKeepsNan) {
  EXPECT_EQ(ownTanh(0.0), 0.0);
  EXPECT_TRUE(std::isnan(ownTanh(std::nan(""))));
  EXPECT_TRUE(std::isnan(ownTanh(std::nan("0xfff"))));
}

// The vectorised body and the scalar rest of the loop must round alike.
TEST(Activation, GivesEachValueTheSameBitsWhereverItStands) {
  std::vector<double> together;
  for (int i = 0; i < 1003; ++i) together.push_back(std::sin(0.1 * i) * 6.0);
  std::vector<double> alone = together;
  for (double& x : alone) x = ownTanh(x);
  for (std::size_t offset = 0; offset < 9; ++offset) {
    std::vector<double> tail(together.begin() + static_cast<std::ptrdiff_t>(offset), together.end());
    tanhInPlace(tail.data(), tail.size());
    for (std::size_t i = 0; i < tail.size(); ++i)
      ASSERT_EQ(tail[i], alone[i + offset]) << "offset " << offset << ", value " << i;
  }
}

}  // namespace
}  // namespace boxgrasp
