#include "boxgrasp/cloud/write_cloud.h"

#include <gtest/gtest.h>

#include "boxgrasp/base/error.h"
#include "boxgrasp/cloud/read_cloud.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

TEST(WritePcd, ReadsBackToTheBit) {
  std::mt19937_64 random(1);
  PointCloud cloud;
  for (int i = 0; i < 1000; ++i) cloud.push({normal(random), normal(random), normal(random)});
  const auto file = std::filesystem::temp_directory_path() / "boxgrasp_write_cloud_test.pcd";
  writePcd(cloud, file);
  EXPECT_EQ(readCloud(file).cloud_C, cloud);
  std::filesystem::remove(file);
}

TEST(WritePcd, NamesTheFileThatCannotBeWritten) {
  try {
    writePcd(PointCloud{}, "/no/such/folder/cloud.pcd");
    FAIL() << "expected InputError";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("/no/such/folder/cloud.pcd"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace boxgrasp
