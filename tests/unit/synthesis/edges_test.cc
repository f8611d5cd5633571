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

double gaussianSum(const cv::Mat& image, double sigma, int reach, int row, int column) {
  double sum = 0.0;
  for (int y = std::max(0, row - reach); y <= std::min(image.rows - 1, row + reach); ++y) {
    for (int x = std::max(0, column - reach); x <= std::min(image.cols - 1, column + reach); ++x) {
      const double square = (x - column) * (x - column) + (y - row) * (y - row);
      sum += image.at<float>(y, x) * std::exp(-0.5 * square / (sigma * sigma));
    }
  }
  return sum;
}

// Widths below, at and above those of the runs in which rows are smoothed.
TEST(Smoothed, AgreesWithTheGaussianSumAndIsMirroredBitForBit) {
  std::mt19937_64 random(2);
  const double sigma = 1.7;
  double total = 0.0;
  for (int d = -7; d <= 7; ++d) total += std::exp(-0.5 * d * d / (sigma * sigma));
  for (const cv::Size size :
       {cv::Size(1, 1), cv::Size(27, 21), cv::Size(32, 9), cv::Size(33, 2), cv::Size(75, 11)}) {
    cv::Mat image(size, CV_32F), mirrored, back;
    for (int row = 0; row < size.height; ++row) {
      for (int column = 0; column < size.width; ++column)
        image.at<float>(row, column) = static_cast<float>(uniform(random));
    }
    const cv::Mat result = smoothed(image, sigma);
    for (int row = 0; row < size.height; ++row) {
      for (int column = 0; column < size.width; ++column) {
        EXPECT_NEAR(result.at<float>(row, column),
                    gaussianSum(image, sigma, 7, row, column) / (total * total), 1e-5)
            << size << ", row " << row << ", column " << column;
      }
    }
    cv::flip(image, mirrored, 1);
    cv::flip(smoothed(mirrored, sigma), back, 1);
    EXPECT_EQ(cv::countNonZero(back != result), 0) << size;
  }
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
