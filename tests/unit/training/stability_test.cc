#include "boxgrasp/training/stability.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"
#include "error_of.h"

namespace boxgrasp {
namespace {

using ::testing::HasSubstr;

// Two bricks in the shape of an L.
PointCloud letterL(std::size_t n) {
  std::mt19937_64 random(1);
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const double u = uniform(random), v = uniform(random), w = uniform(random);
    const bool upright = i % 2 == 0;
    cloud.push(upright ? Vector3d(0.03 * u, 0.12 * v, 0.03 * w) : Vector3d(0.12 * u, 0.03 * v, 0.03 * w));
  }
  return cloud;
}

TEST(Damaged, WithNoiseMovesEachPointByTheGivenDeviation) {
  const PointCloud cloud = letterL(20'000), noisy = damaged(cloud, Damage::noise, 0.02, 0.5, 3);
  ASSERT_EQ(noisy.size(), cloud.size());
  double squared = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) squared += (noisy.point(i) - cloud.point(i)).squaredNorm();
  EXPECT_NEAR(std::sqrt(squared / (3.0 * 20'000)), 0.02 * 0.5, 2e-4);
}

TEST(Damaged, WithRemovalKeepsTheRestInOrder) {
  const PointCloud cloud = letterL(20'000), thin = damaged(cloud, Damage::removal, 0.3, 1.0, 3);
  EXPECT_NEAR(static_cast<double>(thin.size()), 14'000.0, 300.0);
  std::size_t at = 0;
  for (std::size_t i = 0; i < thin.size(); ++i, ++at) {
    while (at < cloud.size() && cloud.point(at) != thin.point(i)) ++at;
    ASSERT_LT(at, cloud.size()) << "point " << i << " is not of the cloud, or out of order";
  }
}

TEST(Damaged, WithOutliersKeepsAllPoints) {
  const PointCloud cloud = letterL(1000), dirty = damaged(cloud, Damage::outliers, 0.1, 1.0, 3);
  EXPECT_EQ(dirty.size(), 1100u);
  for (std::size_t i = 0; i < cloud.size(); ++i) EXPECT_EQ(dirty.point(i), cloud.point(i));
}

TEST(Damaged, ByFadingThinsOneEndMost) {
  const PointCloud cloud = letterL(20'000), faded = damaged(cloud, Damage::fading, 0.9, 1.0, 3);
  EXPECT_GT(faded.size(), 4000u);
  EXPECT_LT(faded.size(), 18'000u);
}

TEST(Damaged, IsTheSameForTheSameSeedAlone) {
  const PointCloud cloud = letterL(500);
  for (const Damage damage : {Damage::noise, Damage::removal, Damage::outliers, Damage::fading}) {
    EXPECT_EQ(damaged(cloud, damage, 0.1, 1.0, 5), damaged(cloud, damage, 0.1, 1.0, 5));
    EXPECT_NE(damaged(cloud, damage, 0.1, 1.0, 5), damaged(cloud, damage, 0.1, 1.0, 6));
  }
}

StabilityOptions fewLevels() {
  StabilityOptions options;
  options.noise_levels = 3;
  options.removal_levels = 2;
  return options;
}

TEST(MeasureStability, TriesEveryLevelUpToTheGreatest) {
  const StabilityReport report = measureStability(letterL(2000), fewLevels());
  ASSERT_EQ(report.trials.size(), 5u);
  EXPECT_NEAR(report.trials[2].amount, 0.019, 1e-12);
  EXPECT_NEAR(report.trials[4].amount, 0.70, 1e-12);
  EXPECT_EQ(report.trials[2].damage, Damage::noise);
  EXPECT_EQ(report.trials[3].damage, Damage::removal);
}

// Written down anew: similar by Eq. 2 where both differences are within their thresholds.
TEST(MeasureStability, CountsWhatIsSimilar) {
  StabilityOptions options = fewLevels();
  options.similarity.max_distance_difference = 0.005;
  const StabilityReport report = measureStability(letterL(2000), options);
  int similar = 0;
  for (const StabilityTrial& trial : report.trials) {
    EXPECT_EQ(trial.similar, trial.distance_difference <= 0.005 && trial.volume_difference <= 0.9);
    similar += trial.similar;
  }
  EXPECT_NEAR(report.similarShare(), similar / 5.0, 1e-12);
  EXPECT_EQ(report.similarShare(Damage::fading), -1.0) << "nothing was faded";
}

TEST(MeasureStability, DoesNotDependOnTheUnitOfLength) {
  const PointCloud cloud = letterL(2000), twice = transformed(cloud, Pose::Identity());
  PointCloud scaled = twice;
  for (auto* axis : {&scaled.x, &scaled.y, &scaled.z}) {
    for (float& value : *axis) value *= 2.0f;
  }
  const StabilityReport a = measureStability(cloud, fewLevels()), b = measureStability(scaled, fewLevels());
  for (std::size_t i = 0; i < a.trials.size(); ++i)
    EXPECT_NEAR(a.trials[i].distance_difference, b.trials[i].distance_difference, 0.02);
}

TEST(MeasureStability, DoesNotDependOnTheNumberOfThreads) {
  StabilityOptions options = fewLevels();
  const StabilityReport one = measureStability(letterL(1500), options);
  options.threads = 3;
  const StabilityReport many = measureStability(letterL(1500), options);
  for (std::size_t i = 0; i < one.trials.size(); ++i)
    EXPECT_EQ(one.trials[i].distance_difference, many.trials[i].distance_difference);
}

TEST(MeasureStability, RefusesBadOptionsByName) {
  StabilityOptions options;
  options.noise_levels = -1;
  EXPECT_THAT(test::errorOf([&] { measureStability(letterL(100), options); }),
              HasSubstr("option 'noise_levels' is -1"));
  options = {};
  options.max_removal = 1.0;
  EXPECT_THAT(test::errorOf([&] { measureStability(letterL(100), options); }),
              HasSubstr("option 'max_removal' is 1"));
}

TEST(ConstellationsOver, GrowsFromOneBoxAndFillsLessVolume) {
  const std::vector<GainPoint> curve = constellationsOver({0.05, 0.9, 0.9}, letterL(3000), {});
  ASSERT_EQ(curve.size(), 3u);
  EXPECT_EQ(curve[0].boxes, 1u) << "nothing saves 95 %";
  EXPECT_NEAR(curve[0].volume, 1.0, 1e-12);
  EXPECT_EQ(curve[1].boxes, 2u);
  EXPECT_LT(curve[1].volume, 0.7);
  EXPECT_FALSE(curve[1].similar_to_last) << "one box is not two";
  EXPECT_TRUE(curve[2].similar_to_last) << "the same t gives the same constellation";
}

}  // namespace
}  // namespace boxgrasp
