#include "boxgrasp/planning/obstacles.h"

#include <gtest/gtest.h>

#include "boxgrasp/geometry/point_grid.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

TEST(TablePatch, CoversTheTableUnderAndAroundTheObjectInAnyFrame) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 20; ++trial) {
    const Pose X_CT = test::randomPose(random);
    PointCloud object_C;
    for (int i = 0; i < 100; ++i)
      object_C.push(X_CT * Vector3d(uniform(random, -0.05, 0.05), uniform(random, -0.02, 0.02), 0.1));
    const Plane table{X_CT.linear().col(2), X_CT.linear().col(2).dot(X_CT.translation())};
    const PointCloud patch_C = tablePatch(table, object_C, 0.1, 0.005);
    const PointGrid grid(patch_C, 0.01);
    for (std::size_t i = 0; i < patch_C.size(); ++i)
      EXPECT_NEAR(table.normal_C.dot(patch_C.point(i)), table.offset_m, 1e-5);
    for (int i = 0; i < 100; ++i) {
      const Vector3d on_table = X_CT * Vector3d(uniform(random, -0.1, 0.1), uniform(random, -0.1, 0.1), 0);
      EXPECT_TRUE(grid.nearest(on_table, 0.004))
          << "no point of the patch within 4 mm of a place near the object";
    }
  }
}

TEST(Joined, KeepsAllPointsInOrder) {
  const PointCloud a{{1, 2}, {3, 4}, {5, 6}}, b{{7}, {8}, {9}};
  EXPECT_EQ(joined(a, b), (PointCloud{{1, 2, 7}, {3, 4, 8}, {5, 6, 9}}));
}

}  // namespace
}  // namespace boxgrasp
