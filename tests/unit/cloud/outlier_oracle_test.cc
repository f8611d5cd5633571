// The outlier rule against PCL's own filter.
#include <gtest/gtest.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/point_types.h>

#include <random>

#include "boxgrasp/base/random.h"
#include "boxgrasp/cloud/clean.h"

namespace boxgrasp {
namespace {

PointCloud filteredByPcl(const PointCloud& cloud, int neighbours, double deviations) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr input(new pcl::PointCloud<pcl::PointXYZ>);
  for (std::size_t i = 0; i < cloud.size(); ++i) input->emplace_back(cloud.x[i], cloud.y[i], cloud.z[i]);
  pcl::StatisticalOutlierRemoval<pcl::PointXYZ> filter;
  filter.setInputCloud(input);
  filter.setMeanK(neighbours);
  filter.setStddevMulThresh(deviations);
  pcl::PointCloud<pcl::PointXYZ> output;
  filter.filter(output);
  PointCloud kept;
  for (const auto& p : output) kept.push({p.x, p.y, p.z});
  return kept;
}

TEST(Clean, OutliersAreThoseOfPcl) {
  std::mt19937_64 random(11);
  PointCloud cloud;
  for (int i = 0; i < 5'000; ++i)
    cloud.push({0.1 * normal(random), 0.05 * normal(random), 0.02 * normal(random)});
  CleanOptions options;
  for (const auto& [neighbours, deviations] : {std::pair{8, 4.0}, {1, 2.0}, {20, 1.0}, {50, 0.5}}) {
    options.outlier_neighbours = 0;
    const PointCloud evened = clean(cloud, options).cloud_C;
    options.outlier_neighbours = neighbours;
    options.outlier_deviations = deviations;
    const CleanCloud result = clean(cloud, options);
    EXPECT_GT(result.outliers, 0u) << "the test must have outliers";
    EXPECT_EQ(result.cloud_C, filteredByPcl(evened, neighbours, deviations))
        << neighbours << " neighbours, " << deviations << " deviations";
  }
}

}  // namespace
}  // namespace boxgrasp
