#include "boxgrasp/geometry/orientation_search.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "boxgrasp/base/simd.h"
#include "boxgrasp/base/tolerances.h"
#include "boxgrasp/geometry/polygon.h"

namespace boxgrasp {

namespace orientation_batch {

constexpr std::size_t kLanes = 16;
using Lane = float[kLanes];

// Unit quaternions, one a lane.
struct Rotations {
  alignas(64) Lane w, x, y, z;
};

// The volume of the box around the points in each of the orientations.
BOXGRASP_SIMD void boxVolumes(const float* px, const float* py, const float* pz, std::size_t n,
                              const Rotations& q, float* volumes) {
  constexpr float kFar = std::numeric_limits<float>::max();
  alignas(64) Lane xx, xy, xz, yx, yy, yz, zx, zy, zz;  // the axes of the boxes
  alignas(64) Lane low_x, low_y, low_z, high_x, high_y, high_z;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const float w = q.w[k], a = q.x[k], b = q.y[k], c = q.z[k];
    xx[k] = 1.0f - 2.0f * (b * b + c * c);
    xy[k] = 2.0f * (a * b + w * c);
    xz[k] = 2.0f * (a * c - w * b);
    yx[k] = 2.0f * (a * b - w * c);
    yy[k] = 1.0f - 2.0f * (a * a + c * c);
    yz[k] = 2.0f * (b * c + w * a);
    zx[k] = 2.0f * (a * c + w * b);
    zy[k] = 2.0f * (b * c - w * a);
    zz[k] = 1.0f - 2.0f * (a * a + b * b);
    low_x[k] = low_y[k] = low_z[k] = kFar;
    high_x[k] = high_y[k] = high_z[k] = -kFar;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const float x = px[i], y = py[i], z = pz[i];
    for (std::size_t k = 0; k < kLanes; ++k) {
      const float u = xx[k] * x + xy[k] * y + xz[k] * z;
      const float v = yx[k] * x + yy[k] * y + yz[k] * z;
      const float w = zx[k] * x + zy[k] * y + zz[k] * z;
      low_x[k] = u < low_x[k] ? u : low_x[k];
      low_y[k] = v < low_y[k] ? v : low_y[k];
      low_z[k] = w < low_z[k] ? w : low_z[k];
      high_x[k] = u > high_x[k] ? u : high_x[k];
      high_y[k] = v > high_y[k] ? v : high_y[k];
      high_z[k] = w > high_z[k] ? w : high_z[k];
    }
  }
  constexpr float kFlat = tolerance::kFlatExtent;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const float x = high_x[k] - low_x[k], y = high_y[k] - low_y[k], z = high_z[k] - low_z[k];
    volumes[k] = (x > kFlat ? x : kFlat) * (y > kFlat ? y : kFlat) * (z > kFlat ? z : kFlat);
  }
}

// Each rotation r becomes r * (1, x, y, z) as a unit quaternion: a turn about its own axes.
BOXGRASP_SIMD void turn(const Rotations& q, const float* x, const float* y, const float* z,
                        Rotations& turned) {
  for (std::size_t k = 0; k < kLanes; ++k) {
    const float w = q.w[k] - (q.x[k] * x[k] + q.y[k] * y[k] + q.z[k] * z[k]);
    const float a = q.x[k] + (q.w[k] * x[k] + q.y[k] * z[k] - q.z[k] * y[k]);
    const float b = q.y[k] + (q.w[k] * y[k] + q.z[k] * x[k] - q.x[k] * z[k]);
    const float c = q.z[k] + (q.w[k] * z[k] + q.x[k] * y[k] - q.y[k] * x[k]);
    const float scale = 1.0f / std::sqrt(w * w + a * a + b * b + c * c);
    turned.w[k] = w * scale;
    turned.x[k] = a * scale;
    turned.y[k] = b * scale;
    turned.z[k] = c * scale;
  }
}

}  // namespace orientation_batch

namespace {

using Eigen::Quaternionf;
using Eigen::Vector3f;
using orientation_batch::kLanes;
using orientation_batch::Rotations;

Rotations batchOf(const std::array<Quaternionf, kLanes>& rotations) {
  Rotations batch;
  for (std::size_t k = 0; k < kLanes; ++k) {
    batch.w[k] = rotations[k].w();
    batch.x[k] = rotations[k].x();
    batch.y[k] = rotations[k].y();
    batch.z[k] = rotations[k].z();
  }
  return batch;
}

std::array<float, kLanes> volumes(const PointCloud& points, const Rotations& rotations) {
  std::array<float, kLanes> result;
  orientation_batch::boxVolumes(points.x.data(), points.y.data(), points.z.data(), points.size(), rotations,
                                result.data());
  return result;
}

// A lattice over all orientations of a box, which is the same after quarter turns: in Rodrigues' vectors
// (axis times tangent of half the angle) they fill a cube with its corners cut off. The first is the
// identity.
std::vector<Quaternionf> orientationLattice() {
  constexpr int steps = 6;  // from the middle of the cube to its side, 7.5 degrees each
  std::vector<Quaternionf> lattice{Quaternionf::Identity()};
  const float side = std::tan(std::numbers::pi_v<float> / 8.0f);
  for (int i = -steps; i <= steps; ++i) {
    for (int j = -steps; j <= steps; ++j) {
      for (int k = -steps; k <= steps; ++k) {
        const Vector3f rodrigues = Vector3f(i, j, k) * (side / static_cast<float>(steps));
        if (rodrigues.isZero() || rodrigues.lpNorm<1>() > 1.0f) continue;
        lattice.push_back(Quaternionf(1.0f, rodrigues.x(), rodrigues.y(), rodrigues.z()).normalized());
      }
    }
  }
  return lattice;
}

// Unit vectors in all directions, in an order in which any few in a row are well spread.
std::vector<Vector3f> turnAxes() {
  std::vector<Vector3f> axes;
  for (int i = 0; i < 509; ++i) {
    const float z = 2.0f * std::fmod(0.5f + 0.7548776662f * static_cast<float>(i), 1.0f) - 1.0f;
    const float angle =
        2.0f * std::numbers::pi_v<float> * std::fmod(0.5698402910f * static_cast<float>(i), 1.0f);
    const float radius = std::sqrt(1.0f - z * z);
    axes.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return axes;
}

// The cosine of half the smallest angle that turns a box of the one orientation into one of the other: of the
// 24 turns that map a cube on itself the best is known from the sizes of the components.
float alikeness(const Quaternionf& a, const Quaternionf& b) {
  const float w = a.w() * b.w() + a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
  const float x = std::abs(a.w() * b.x() - a.x() * b.w() - a.y() * b.z() + a.z() * b.y());
  const float y = std::abs(a.w() * b.y() + a.x() * b.z() - a.y() * b.w() - a.z() * b.x());
  const float z = std::abs(a.w() * b.z() - a.x() * b.y() + a.y() * b.x() - a.z() * b.w());
  const float high = std::max(std::abs(w), x), low = std::min(std::abs(w), x);
  const float other_high = std::max(y, z), other_low = std::min(y, z);
  const float largest = std::max(high, other_high);
  const float second = std::max(std::min(high, other_high), high > other_high ? low : other_low);
  constexpr float kHalfDiagonal = 0.5f * std::numbers::sqrt2_v<float>;
  return std::max({largest, (largest + second) * kHalfDiagonal, 0.5f * (std::abs(w) + x + y + z)});
}

constexpr float kNeighbours = 0.9962f;  // 10 degrees, a little more than a step of the lattice
constexpr float kSame = 0.99988f;       // 2 degrees: two descents that ended in the same place

bool smaller(const Orientation& a, const Orientation& b) { return a.volume < b.volume; }

// The first `count` orientations, best first, that are not alike; of equals the first.
std::vector<Orientation> distinct(const std::vector<Orientation>& orientations, std::size_t count,
                                  float alike) {
  std::vector<std::pair<float, std::size_t>> left;
  for (std::size_t i = 0; i < orientations.size(); ++i) left.emplace_back(orientations[i].volume, i);
  std::make_heap(left.begin(), left.end(), std::greater{});
  std::vector<Orientation> kept;
  for (; !left.empty() && kept.size() < count; left.pop_back()) {
    std::pop_heap(left.begin(), left.end(), std::greater{});
    const Orientation& next = orientations[left.back().second];
    const auto same = [&](const Orientation& other) {
      return alikeness(next.rotation, other.rotation) > alike;
    };
    if (std::none_of(kept.begin(), kept.end(), same)) kept.push_back(next);
  }
  return kept;
}

std::vector<Orientation> measured(const PointCloud& points, const std::vector<Quaternionf>& rotations) {
  std::vector<Orientation> result;
  for (std::size_t begin = 0; begin < rotations.size(); begin += kLanes) {
    std::array<Quaternionf, kLanes> batch;
    for (std::size_t k = 0; k < kLanes; ++k) batch[k] = rotations[std::min(begin + k, rotations.size() - 1)];
    const auto volume = volumes(points, batchOf(batch));
    for (std::size_t k = 0; k < kLanes && begin + k < rotations.size(); ++k)
      result.push_back({batch[k], volume[k]});
  }
  return result;
}

// Descents side by side, one a lane: a random turn is kept when it makes the box smaller, else its opposite
// is tried. Turns that succeed grow, those that fail both ways shrink.
class Descents {
 public:
  Descents(const PointCloud& points, const std::array<Quaternionf, kLanes>& starts, float step)
      : points_(points), rotations_(batchOf(starts)), volume_(volumes(points, rotations_)) {
    step_.fill(step);
    sign_.fill(1.0f);
  }

  void advance(int trial) {
    static const std::vector<Vector3f> axes = turnAxes();
    orientation_batch::Lane x, y, z;
    for (std::size_t k = 0; k < kLanes; ++k) {
      const Vector3f& axis = axes[(static_cast<std::size_t>(trial / 2) + 31 * k) % axes.size()];
      const float half = 0.5f * step_[k] * sign_[k];
      x[k] = axis.x() * half;
      y[k] = axis.y() * half;
      z[k] = axis.z() * half;
    }
    Rotations next;
    orientation_batch::turn(rotations_, x, y, z, next);
    const auto volume = volumes(points_, next);
    for (std::size_t k = 0; k < kLanes; ++k) settle(k, next, volume[k], trial % 2 == 0);
  }

  Orientation at(std::size_t k) const {
    return {{rotations_.w[k], rotations_.x[k], rotations_.y[k], rotations_.z[k]}, volume_[k]};
  }

 private:
  void settle(std::size_t k, const Rotations& next, float volume, bool first_of_pair) {
    const bool better = volume < volume_[k] * (1.0f - 1e-6f);  // by more than rounding
    if (better) {
      rotations_.w[k] = next.w[k];
      rotations_.x[k] = next.x[k];
      rotations_.y[k] = next.y[k];
      rotations_.z[k] = next.z[k];
      volume_[k] = volume;
      step_[k] *= 1.6f;
    } else if (!first_of_pair) {
      step_[k] *= 0.7f;
    }
    sign_[k] = first_of_pair && !better ? -1.0f : 1.0f;
  }

  const PointCloud& points_;
  Rotations rotations_;
  std::array<float, kLanes> volume_, step_, sign_;
};

// Descends from up to kLanes orientations; spare lanes search from the same places by other turns.
void descendFrom(const PointCloud& points, Orientation* first, std::size_t count, float step, int trials) {
  std::array<Quaternionf, kLanes> starts;
  for (std::size_t k = 0; k < kLanes; ++k) starts[k] = first[k % count].rotation;
  Descents descents(points, starts, step);
  for (int trial = 0; trial < trials; ++trial) descents.advance(trial);
  for (std::size_t k = 0; k < count; ++k) first[k] = descents.at(k);
  for (std::size_t k = count; k < kLanes; ++k)
    first[k % count] = std::min(first[k % count], descents.at(k), smaller);
}

void descend(const PointCloud& points, std::vector<Orientation>& orientations, float step, int trials) {
  for (std::size_t begin = 0; begin < orientations.size(); begin += kLanes) {
    descendFrom(points, &orientations[begin], std::min(kLanes, orientations.size() - begin), step, trials);
  }
}

// Makes the box the smallest of those that share an edge direction with it, for each edge in turn. Descents
// end near the kinks where faces are flush with the hull's edges; this ends on them.
void snap(const PointCloud& points, Orientation& orientation) {
  for (int edge = 0; edge < 3; ++edge) {
    const Vector3d direction = orientation.rotation.toRotationMatrix().col(edge).cast<double>();
    const Eigen::Matrix3f axes = smallestBoxAxes(points, direction).cast<float>();
    const Orientation turned = measured(points, {Quaternionf(axes).normalized()})[0];
    orientation = std::min(orientation, turned, smaller);
  }
}

}  // namespace

Matrix3d smallestBoxAxes(const PointCloud& points, const Vector3d& edge) {
  assert(!points.empty());
  const Vector3d u = edge.unitOrthogonal(), v = edge.cross(u);
  std::vector<Vector2d> projected;
  projected.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    projected.emplace_back(u.dot(points.point(i)), v.dot(points.point(i)));
  const Vector2d side = minAreaRectangle(convexHull(std::move(projected))).axis;
  Matrix3d axes;
  axes << side.x() * u + side.y() * v, side.x() * v - side.y() * u, edge;
  return axes;
}

std::vector<Orientation> searchOrientations(const PointCloud& points) {
  static const std::vector<Quaternionf> lattice = orientationLattice();
  std::vector<Orientation> starts = distinct(measured(points, lattice), 3 * kLanes, kNeighbours);
  descend(points, starts, 0.1f, 100);
  std::vector<Orientation> best = distinct(starts, kLanes / 2, kSame);
  descend(points, best, 0.01f, 40);
  std::stable_sort(best.begin(), best.end(), smaller);
  return best;
}

void updateOrientations(const PointCloud& points, std::vector<Orientation>& orientations) {
  descend(points, orientations, 0.02f, 32);
  std::stable_sort(orientations.begin(), orientations.end(), smaller);
  for (std::size_t i = 0; i < std::min<std::size_t>(2, orientations.size()); ++i)
    snap(points, orientations[i]);
  std::stable_sort(orientations.begin(), orientations.end(), smaller);
}

}  // namespace boxgrasp
