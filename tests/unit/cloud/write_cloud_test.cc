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

TEST(WriteCloud, APcdSaysWhereTheSensorStood) {
  PointCloud cloud;
  cloud.push({0.1, 0.2, 0.3});
  const auto file = std::filesystem::temp_directory_path() / "boxgrasp_write_viewpoint.pcd";
  for (const Vector3d& viewpoint_C :
       {Vector3d(0.1, -1.0 / 3.0, 2e-9), Vector3d(0, 0, 0), Vector3d(-1e5, 1e-300, M_PI)}) {
    writeCloud(cloud, file, viewpoint_C);
    const LoadedCloud read = readCloud(file);
    ASSERT_TRUE(read.viewpoint_C) << viewpoint_C.transpose();
    EXPECT_EQ(*read.viewpoint_C, viewpoint_C);
    EXPECT_EQ(read.cloud_C, cloud);
  }
  writeCloud(cloud, file);
  EXPECT_FALSE(readCloud(file).viewpoint_C) << "nobody said where it stood";
  std::filesystem::remove(file);
}

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
