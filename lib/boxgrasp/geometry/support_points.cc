#include "boxgrasp/geometry/support_points.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <tuple>

#include "boxgrasp/base/simd.h"

namespace boxgrasp {

namespace support_passes {

constexpr std::size_t kLanes = 16;
constexpr std::size_t kBlock = 1024;  // small, since blocks that hold an outermost point are read again

struct Frame {
  float origin[3];
  float axes[3][3];  // one a row
};

// Lowest and highest value along each axis.
struct Ranges {
  float low[3], high[3];
};

inline float valueAlong(const Frame& f, int axis, float x, float y, float z) {
  return f.axes[axis][0] * (x - f.origin[0]) + f.axes[axis][1] * (y - f.origin[1]) +
         f.axes[axis][2] * (z - f.origin[2]);
}

BOXGRASP_SIMD Ranges rangesOf(const float* px, const float* py, const float* pz, std::size_t n,
                              const Frame& frame) {
  const Frame f = frame;
  float low[3][kLanes], high[3][kLanes];
  std::fill_n(&low[0][0], 3 * kLanes, std::numeric_limits<float>::infinity());
  std::fill_n(&high[0][0], 3 * kLanes, -std::numeric_limits<float>::infinity());
  const auto include = [&](std::size_t k, float x, float y, float z) {
    for (int axis = 0; axis < 3; ++axis) {
      const float value = valueAlong(f, axis, x, y, z);
      low[axis][k] = value < low[axis][k] ? value : low[axis][k];
      high[axis][k] = value > high[axis][k] ? value : high[axis][k];
    }
  };
  const std::size_t whole = n - n % kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k) include(k, px[i + k], py[i + k], pz[i + k]);
  }
  for (std::size_t i = whole; i < n; ++i) include(0, px[i], py[i], pz[i]);
  for (std::size_t width = kLanes / 2; width > 0; width /= 2) {
    for (int axis = 0; axis < 3; ++axis) {
      for (std::size_t k = 0; k < width; ++k) {
        low[axis][k] = low[axis][k + width] < low[axis][k] ? low[axis][k + width] : low[axis][k];
        high[axis][k] = high[axis][k + width] > high[axis][k] ? high[axis][k + width] : high[axis][k];
      }
    }
  }
  return {{low[0][0], low[1][0], low[2][0]}, {high[0][0], high[1][0], high[2][0]}};
}

}  // namespace support_passes

namespace {

using support_passes::Frame;
using support_passes::kBlock;
using support_passes::Ranges;

Frame frameOf(const Vector3d& origin, const Matrix3d& directions) {
  Frame frame;
  for (int i = 0; i < 3; ++i) {
    frame.origin[i] = static_cast<float>(origin[i]);
    for (int j = 0; j < 3; ++j) frame.axes[i][j] = static_cast<float>(directions(j, i));
  }
  return frame;
}

std::vector<Ranges> rangesOfBlocks(const PointCloud& cloud, const Frame& frame) {
  std::vector<Ranges> blocks;
  for (std::size_t begin = 0; begin < cloud.size(); begin += kBlock) {
    blocks.push_back(support_passes::rangesOf(cloud.x.data() + begin, cloud.y.data() + begin,
                                              cloud.z.data() + begin, std::min(kBlock, cloud.size() - begin),
                                              frame));
  }
  return blocks;
}

// Remembers the point of smallest coordinates among those shown.
struct Smallest {
  std::tuple<float, float, float> point{std::numeric_limits<float>::infinity(), 0.0f, 0.0f};
  void show(const PointCloud& cloud, std::size_t i) {
    point = std::min(point, std::make_tuple(cloud.x[i], cloud.y[i], cloud.z[i]));
  }
};

void append(const Smallest& smallest, PointCloud& found) {
  const auto& [x, y, z] = smallest.point;
  found.push({x, y, z});
}

void appendAlong(const PointCloud& cloud, const Frame& frame, int axis, const std::vector<Ranges>& blocks,
                 PointCloud& found) {
  float low = blocks[0].low[axis], high = blocks[0].high[axis];
  for (const Ranges& block : blocks) {
    low = std::min(low, block.low[axis]);
    high = std::max(high, block.high[axis]);
  }
  Smallest lowest, highest;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (blocks[b].low[axis] != low && blocks[b].high[axis] != high) continue;
    for (std::size_t i = b * kBlock; i < std::min(cloud.size(), (b + 1) * kBlock); ++i) {
      const float value = support_passes::valueAlong(frame, axis, cloud.x[i], cloud.y[i], cloud.z[i]);
      if (value == low) lowest.show(cloud, i);
      if (value == high) highest.show(cloud, i);
    }
  }
  append(lowest, found);
  append(highest, found);
}

}  // namespace

void appendSupportPoints(const PointCloud& cloud, const Vector3d& origin, const Matrix3d& directions,
                         PointCloud& found) {
  assert(!cloud.empty());
  const Frame frame = frameOf(origin, directions);
  const std::vector<Ranges> blocks = rangesOfBlocks(cloud, frame);
  for (int axis = 0; axis < 3; ++axis) appendAlong(cloud, frame, axis, blocks, found);
}

}  // namespace boxgrasp
