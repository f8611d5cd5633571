#include "boxgrasp/geometry/voxels.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "random_clouds.h"

namespace boxgrasp {
namespace {

using Cell = std::array<int, 3>;

std::set<Cell> occupied(const PointCloud& cloud, double edge_m) {
  std::set<Cell> cells;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] = static_cast<int>(std::floor(cloud.point(i)[axis] / edge_m + 0.5));
    cells.insert(cell);
  }
  return cells;
}

bool touch(const Cell& a, const Cell& b) {
  return std::abs(a[0] - b[0]) <= 1 && std::abs(a[1] - b[1]) <= 1 && std::abs(a[2] - b[2]) <= 1;
}

// One cell after the other is joined to those that it touches.
bool hangTogether(std::set<Cell> cells) {
  std::vector<Cell> reached{*cells.begin()};
  cells.erase(cells.begin());
  for (std::size_t i = 0; i < reached.size(); ++i) {
    for (auto other = cells.begin(); other != cells.end();) {
      if (touch(reached[i], *other)) {
        reached.push_back(*other);
        other = cells.erase(other);
      } else {
        ++other;
      }
    }
  }
  return cells.empty();
}

TEST(Voxels, HangTogetherWhereEachTouchesAnother) {
  std::mt19937_64 random(1);
  int together = 0;
  constexpr int kRounds = 300;
  for (int round = 0; round < kRounds; ++round) {
    const std::size_t points = 5 + uniformIndex(random, 60);
    const PointCloud cloud = test::boxCloud(points, {6.0, 5.0, round % 3 == 0 ? 0.0 : 3.0}, random);
    const bool expected = hangTogether(occupied(cloud, 1.0));
    EXPECT_EQ(voxelsHangTogether(cloud, 1.0), expected) << "cloud " << round << " of " << points << " points";
    together += expected;
  }
  EXPECT_GT(together, kRounds / 10) << "the clouds should hang together now and then";
  EXPECT_LT(together, kRounds * 9 / 10) << "and fall apart now and then";
}

// Rows of voxels that follow each other in memory must not be taken for neighbours.
TEST(Voxels, AtOppositeEndsOfRowsDoNotHangTogether) {
  for (const int width : {2, 3, 4, 7}) {
    PointCloud cloud;
    cloud.push(Vector3d(width, 0, 0));
    cloud.push(Vector3d(0, 1, 0));
    EXPECT_FALSE(voxelsHangTogether(cloud, 1.0)) << "rows of " << width + 1 << " voxels";
  }
}

TEST(Voxels, OfOnePointHangTogether) {
  PointCloud cloud;
  cloud.push(Vector3d(1, -2, 3));
  EXPECT_TRUE(voxelsHangTogether(cloud, 0.1));
}

// The answer costs no more memory than the cloud does.
TEST(Voxels, OfWideCloudsAreNotLookedAt) {
  PointCloud line;
  for (int i = 0; i < 100'000; ++i) line.push(Vector3d(0.01 * i, 0.01 * i, 0.01 * i));
  EXPECT_FALSE(voxelsHangTogether(line, 0.01)) << "a grid of 10^15 voxels";
}

}  // namespace
}  // namespace boxgrasp
