#include "boxgrasp/cloud/write_cloud.h"

#include <gtest/gtest.h>

#include "boxgrasp/cloud/read_cloud.h"
#include "error_of.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

class WriteCloud : public testing::TestWithParam<const char*> {};

TEST_P(WriteCloud, ReadsBackToTheBit) {
  std::mt19937_64 random(1);
  PointCloud cloud;
  for (int i = 0; i < 1000; ++i) cloud.push({normal(random), normal(random), normal(random)});
  const auto file =
      std::filesystem::temp_directory_path() / (std::string("boxgrasp_write_cloud") + GetParam());
  writeCloud(cloud, file);
  EXPECT_EQ(readCloud(file).cloud_C, cloud);
  std::filesystem::remove(file);
}

INSTANTIATE_TEST_SUITE_P(Formats, WriteCloud, testing::Values(".pcd", ".ply", ".xyz"));

TEST(WriteCloud, NamesTheFileThatItCannotWrite) {
  const std::string error = test::errorOf([] { writeCloud(PointCloud{}, "/no/such/folder/cloud.pcd"); });
  EXPECT_NE(error.find("/no/such/folder/cloud.pcd"), std::string::npos) << error;
}

TEST(WriteCloud, RefusesAnEndingThatItDoesNotKnow) {
  const std::string error = test::errorOf([] { writeCloud(PointCloud{}, "cloud.las"); });
  EXPECT_NE(error.find(".pcd, .ply or .xyz"), std::string::npos) << error;
}

}  // namespace
}  // namespace boxgrasp
