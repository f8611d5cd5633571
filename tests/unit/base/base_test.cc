#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <thread>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/parallel.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/base/stop_token.h"

namespace boxgrasp {
namespace {

TEST(RequireOption, NamesFieldValueAndBound) {
  EXPECT_NO_THROW(requireOption(true, "voxel_m", 0.01, "positive"));
  try {
    requireOption(false, "voxel_m", -0.5, "positive");
    FAIL() << "expected an InputError";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "option 'voxel_m' is -0.5, but must be positive");
  }
}

class ParallelFor : public testing::TestWithParam<int> {};

TEST_P(ParallelFor, CallsEveryIndexOnce) {
  std::vector<int> calls(1000, 0);
  parallelFor(calls.size(), GetParam(), [&](std::size_t i) { ++calls[i]; });
  EXPECT_THAT(calls, testing::Each(1));
}

TEST_P(ParallelFor, RethrowsTheFailureOfTheSmallestIndex) {
  const auto body = [](std::size_t i) {
    if (i >= 7) throw InputError(std::to_string(i));
  };
  try {
    parallelFor(100, GetParam(), body);
    FAIL() << "expected an InputError";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "7");
  }
}

TEST_P(ParallelFor, DoesNothingForNoIndices) {
  parallelFor(0, GetParam(), [](std::size_t) { FAIL() << "called for an empty range"; });
}

INSTANTIATE_TEST_SUITE_P(Threads, ParallelFor, testing::Values(0, 1, 2, 5));

TEST(StopToken, DefaultNeverStops) {
  EXPECT_EQ(StopToken().stopped(), std::nullopt);
  EXPECT_NO_THROW(StopToken().check());
}

TEST(StopToken, ReportsAnExpiredDeadline) {
  const StopToken expired(StopToken::Clock::now() - std::chrono::seconds(1));
  EXPECT_EQ(expired.stopped(), StopReason::deadline);
  EXPECT_THROW(expired.check(), Stopped);
  EXPECT_EQ(StopToken(StopToken::Clock::now() + std::chrono::hours(1)).stopped(), std::nullopt);
}

TEST(StopToken, CopiesShareTheCancellation) {
  const auto cancelled = std::make_shared<std::atomic<bool>>(false);
  const StopToken token(std::nullopt, cancelled), copy = token;
  EXPECT_EQ(copy.stopped(), std::nullopt);
  *cancelled = true;
  EXPECT_EQ(copy.stopped(), StopReason::cancelled);
}

TEST(StopToken, CancellationComesBeforeTheDeadline) {
  const StopToken token(StopToken::Clock::now() - std::chrono::seconds(1),
                        std::make_shared<std::atomic<bool>>(true));
  EXPECT_EQ(token.stopped(), StopReason::cancelled);
}

TEST(Random, SameSeedSameNumbers) {
  std::mt19937_64 a(5), b(5), other(6);
  const double first = uniform(a);
  EXPECT_EQ(first, uniform(b));
  EXPECT_NE(first, uniform(other));
}

TEST(Random, UniformStaysInRangeWithTheRightMoments) {
  std::mt19937_64 random(1);
  double sum = 0.0, squares = 0.0;
  const int n = 100000;
  for (int i = 0; i < n; ++i) {
    const double u = uniform(random, -2.0, 4.0);
    ASSERT_TRUE(u >= -2.0 && u < 4.0) << u;
    sum += u;
    squares += u * u;
  }
  // Mean 1, second moment 3 + 1; five standard errors.
  EXPECT_NEAR(sum / n, 1.0, 5.0 * std::sqrt(3.0 / n));
  EXPECT_NEAR(squares / n, 4.0, 5.0 * std::sqrt(20.0 / n));
}

TEST(Random, NormalHasTheRightMoments) {
  std::mt19937_64 random(2);
  double moments[5] = {};
  const int n = 200000;
  for (int i = 0; i < n; ++i) {
    const double x = normal(random);
    double power = 1.0;
    for (double& moment : moments) {
      moment += power / n;
      power *= x;
    }
  }
  EXPECT_NEAR(moments[1], 0.0, 5.0 * std::sqrt(1.0 / n));
  EXPECT_NEAR(moments[2], 1.0, 5.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(moments[3], 0.0, 5.0 * std::sqrt(15.0 / n));
  EXPECT_NEAR(moments[4], 3.0, 5.0 * std::sqrt(96.0 / n));
}

TEST(Random, IndicesAreEven) {
  std::mt19937_64 random(3);
  std::vector<int> counts(7, 0);
  for (int i = 0; i < 70000; ++i) ++counts.at(uniformIndex(random, 7));
  for (const int count : counts) EXPECT_NEAR(count, 10000, 5 * std::sqrt(10000.0));
}

}  // namespace
}  // namespace boxgrasp
