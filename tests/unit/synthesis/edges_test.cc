#include "boxgrasp/synthesis/edges.h"

#include <gtest/gtest.h>

#include "boxgrasp/base/random.h"
#include "boxgrasp/geometry/polygon.h"
#include "boxgrasp/synthesis/smoothing.h"

namespace boxgrasp {
namespace {

TEST(Silhouettes, DiagonalNeighboursAreJoinedWhenTheirMeanIsInside) {
  const auto linesWith = [](float corner) {
    cv::Mat coverage = cv::Mat::zeros(4, 4, CV_32F);
    coverage.at<float>(1, 1) = coverage.at<float>(2, 2) = corner;
    coverage.at<float>(1, 2) = coverage.at<float>(2, 1) = 0.3f;
    return silhouettes(coverage).size();
  };
  EXPECT_EQ(linesWith(0.6f), 2u) << "mean 0.45: two spots";
  EXPECT_EQ(linesWith(0.9f), 1u) << "mean 0.6: one";
}

TEST(Silhouettes, EveryCrossingOfTheGridIsOnOneClosedLine) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 20; ++trial) {
    cv::Mat coverage = cv::Mat::zeros(30, 40, CV_32F);
    for (int row = 1; row < 29; ++row) {
      for (int column = 1; column < 39; ++column)
        coverage.at<float>(row, column) = static_cast<float>(uniform(random));
    }
    std::size_t crossings = 0, points = 0;
    for (int row = 0; row < 30; ++row) {
      for (int column = 0; column < 40; ++column) {
        const bool in = coverage.at<float>(row, column) > 0.5f;
        crossings += column < 39 && in != (coverage.at<float>(row, column + 1) > 0.5f);
        crossings += row < 29 && in != (coverage.at<float>(row + 1, column) > 0.5f);
      }
    }
    for (const auto& line : silhouettes(coverage)) {
      points += line.points.size();
      for (std::size_t i = 0; i < line.points.size(); ++i) {
        EXPECT_LT((line.points[(i + 1) % line.points.size()] - line.points[i]).norm(), 1.5)
            << "within a cell";
      }
    }
    EXPECT_EQ(points, crossings);
  }
}

TEST(Smoothed, AgreesWithTheGaussianSumAndIsMirroredBitForBit) {
  std::mt19937_64 random(2);
  cv::Mat image(21, 27, CV_32F), mirrored;
  for (int i = 0; i < 21 * 27; ++i) image.at<float>(i / 27, i % 27) = static_cast<float>(uniform(random));
  const double sigma = 1.7;
  const cv::Mat result = smoothed(image, sigma);
  double total = 0.0;
  for (int d = -7; d <= 7; ++d) total += std::exp(-0.5 * d * d / (sigma * sigma));
  for (int row = 0; row < 21; ++row) {
    for (int column = 0; column < 27; ++column) {
      double sum = 0.0;
      for (int y = std::max(0, row - 7); y <= std::min(20, row + 7); ++y) {
        for (int x = std::max(0, column - 7); x <= std::min(26, column + 7); ++x) {
          const double square = (x - column) * (x - column) + (y - row) * (y - row);
          sum += image.at<float>(y, x) * std::exp(-0.5 * square / (sigma * sigma));
        }
      }
      EXPECT_NEAR(result.at<float>(row, column), sum / (total * total), 1e-5);
    }
  }
  cv::flip(image, mirrored, 1);
  cv::Mat back;
  cv::flip(smoothed(mirrored, sigma), back, 1);
  EXPECT_EQ(cv::countNonZero(back != result), 0);
}

TEST(EvenlySpaced, KeepsTheEndsAndTheLengthOfALine) {
  const PixelLine line{false, {{0, 0}, {0.3, 0}, {7, 0}, {7, 5.2}}};
  const auto even = evenlySpaced(line).points;
  ASSERT_EQ(even.size(), 13u) << "12.2 px: 12 steps";
  EXPECT_LT((even.front() - line.points.front()).norm(), 1e-12);
  EXPECT_LT((even.back() - line.points.back()).norm(), 1e-9);
  EXPECT_EQ(evenlySpaced({true, {{1, 1}}}).points.size(), 1u);
  EXPECT_TRUE(evenlySpaced({}).points.empty());
}

}  // namespace
}  // namespace boxgrasp
