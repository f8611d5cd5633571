#include "boxgrasp/geometry/orientation_search.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "boxgrasp/base/ordered_bits.h"
#include "boxgrasp/base/simd.h"
#include "boxgrasp/base/tolerances.h"
#include "boxgrasp/geometry/block_ranges.h"
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

// Unit vectors, one a lane.
struct Axes {
  alignas(64) Lane x, y, z;
};

// Descents side by side: where they are, and the next turn of each.
struct Places {
  Rotations rotations;
  alignas(64) Lane volume, step, sign;
};

// Each rotation r becomes r * (1, x, y, z) as a unit quaternion: a turn about its own axes, by its step.
BOXGRASP_SIMD void turn(const Places& places, const Axes& axes, Rotations& turned) {
  const Rotations& q = places.rotations;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const float half = 0.5f * places.step[k] * places.sign[k];
    const float x = axes.x[k] * half, y = axes.y[k] * half, z = axes.z[k] * half;
    const float w = q.w[k] - (q.x[k] * x + q.y[k] * y + q.z[k] * z);
    const float a = q.x[k] + (q.w[k] * x + q.y[k] * z - q.z[k] * y);
    const float b = q.y[k] + (q.w[k] * y + q.z[k] * x - q.x[k] * z);
    const float c = q.z[k] + (q.w[k] * z + q.x[k] * y - q.y[k] * x);
    const float scale = 1.0f / std::sqrt(w * w + a * a + b * b + c * c);
    turned.w[k] = w * scale;
    turned.x[k] = a * scale;
    turned.y[k] = b * scale;
    turned.z[k] = c * scale;
  }
}

// Keeps what made a box smaller, by more than rounding. Turns that succeed grow; the first of a pair that
// fails is tried the other way round, and those that fail both ways shrink.
BOXGRASP_SIMD void settle(Places& places, const Rotations& next, const float* volumes, bool first_of_pair) {
  const float failed_step = first_of_pair ? 1.0f : 0.7f, failed_sign = first_of_pair ? -1.0f : 1.0f;
  Rotations& q = places.rotations;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const bool better = volumes[k] < places.volume[k] * (1.0f - 1e-6f);
    q.w[k] = better ? next.w[k] : q.w[k];
    q.x[k] = better ? next.x[k] : q.x[k];
    q.y[k] = better ? next.y[k] : q.y[k];
    q.z[k] = better ? next.z[k] : q.z[k];
    places.volume[k] = better ? volumes[k] : places.volume[k];
    places.step[k] *= better ? 1.6f : failed_step;
    places.sign[k] = better ? 1.0f : failed_sign;
  }
}

// The cosine of half the smallest angle that turns a box of the one orientation into one of the other: of the
// 24 turns that map a cube on itself the best is known from the sizes of the components.
BOXGRASP_SIMD_PART float alikeness(float aw, float ax, float ay, float az, float bw, float bx, float by,
                                   float bz) {
  const float w = std::abs(aw * bw + ax * bx + ay * by + az * bz);
  const float x = std::abs(aw * bx - ax * bw - ay * bz + az * by);
  const float y = std::abs(aw * by + ax * bz - ay * bw - az * bx);
  const float z = std::abs(aw * bz - ax * by + ay * bx - az * bw);
  const float high = w > x ? w : x, low = w > x ? x : w;
  const float other_high = y > z ? y : z, other_low = y > z ? z : y;
  const float largest = high > other_high ? high : other_high;
  const float lesser = high > other_high ? other_high : high;
  const float loser = high > other_high ? low : other_low;
  const float second = lesser > loser ? lesser : loser;
  constexpr float kHalfDiagonal = 0.5f * std::numbers::sqrt2_v<float>;
  const float about_edge = (largest + second) * kHalfDiagonal, about_diagonal = 0.5f * (w + x + y + z);
  const float best = about_edge > about_diagonal ? about_edge : about_diagonal;
  return best > largest ? best : largest;
}

// Whether one of the rotations is more like (w, x, y, z) than a limit.
BOXGRASP_SIMD bool anyAlike(const Rotations& q, float w, float x, float y, float z, float limit) {
  int any = 0;
  for (std::size_t k = 0; k < kLanes; ++k)
    any |= alikeness(q.w[k], q.x[k], q.y[k], q.z[k], w, x, y, z) > limit ? 1 : 0;
  return any != 0;
}

BOXGRASP_SIMD std::size_t countUpTo(float limit, const float* values, std::size_t n) {
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < n; ++i) count += values[i] <= limit;
  return count;
}

}  // namespace orientation_batch

namespace {

using Eigen::Quaternionf;
using Eigen::Vector3f;
using orientation_batch::kLanes;
using orientation_batch::Rotations;

void put(const Quaternionf& rotation, std::size_t lane, Rotations& batch) {
  batch.w[lane] = rotation.w();
  batch.x[lane] = rotation.x();
  batch.y[lane] = rotation.y();
  batch.z[lane] = rotation.z();
}

Quaternionf rotationAt(const Rotations& batch, std::size_t lane) {
  return {batch.w[lane], batch.x[lane], batch.y[lane], batch.z[lane]};
}

void measure(const PointCloud& points, const Rotations& rotations, float* volumes) {
  orientation_batch::boxVolumes(points.x.data(), points.y.data(), points.z.data(), points.size(), rotations,
                                volumes);
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

constexpr int kMostTrials = 100;

// The axes of each pair of trials, another one in each lane.
std::vector<orientation_batch::Axes> axesOfTrials() {
  const std::vector<Vector3f> axes = turnAxes();
  std::vector<orientation_batch::Axes> result(kMostTrials / 2);
  for (std::size_t pair = 0; pair < result.size(); ++pair) {
    for (std::size_t k = 0; k < kLanes; ++k) {
      const Vector3f& axis = axes[(pair + 31 * k) % axes.size()];
      result[pair].x[k] = axis.x();
      result[pair].y[k] = axis.y();
      result[pair].z[k] = axis.z();
    }
  }
  return result;
}

constexpr float kNeighbours = 0.9962f;  // 10 degrees, a little more than a step of the lattice
constexpr float kSame = 0.99988f;       // 2 degrees: two descents that ended in the same place

bool smaller(const Orientation& a, const Orientation& b) { return a.volume < b.volume; }

// Orientations that are to differ from each other.
class Kept {
 public:
  // Keeps an orientation if none that was kept is like it.
  void offer(const Orientation& next, float alike) {
    const Quaternionf& q = next.rotation;
    for (const Rotations& batch : batches_) {
      if (orientation_batch::anyAlike(batch, q.w(), q.x(), q.y(), q.z(), alike)) return;
    }
    if (kept_.size() % kLanes == 0) batches_.push_back({});  // rotations of zeros are not like any
    put(q, kept_.size() % kLanes, batches_.back());
    kept_.push_back(next);
  }

  const std::vector<Orientation>& orientations() const { return kept_; }

 private:
  std::vector<Rotations> batches_;
  std::vector<Orientation> kept_;
};

// A limit up to which there are at least so many of the values, and hardly more where that can be. Pre: none
// is NaN.
float limitHolding(std::size_t wanted, const std::vector<float>& values) {
  const ValueRange range = rangeOf(values);
  if (wanted >= values.size()) return range.max;
  std::int64_t below = std::int64_t{orderedBits(range.min)} - 1, within = orderedBits(range.max);
  while (within - below > 1) {
    const std::int64_t middle = (below + within) / 2;
    const float limit = fromOrderedBits(static_cast<std::int32_t>(middle));
    const std::size_t count = orientation_batch::countUpTo(limit, values.data(), values.size());
    (count >= wanted ? within : below) = middle;
    if (count >= wanted && count <= wanted + wanted / 4) break;
  }
  return fromOrderedBits(static_cast<std::int32_t>(within));
}

// Box volumes, and which rotations they belong to.
using Ranked = std::vector<std::pair<float, std::size_t>>;

// Those above one limit and up to another, the least first; of equals the first.
Ranked rankedBetween(float above, float limit, const std::vector<float>& volumes) {
  Ranked ranked;
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    if (volumes[i] > above && volumes[i] <= limit) ranked.emplace_back(volumes[i], i);
  }
  std::sort(ranked.begin(), ranked.end());
  return ranked;
}

// The first `count` orientations, best first, that are not alike; of equals the first. Most are never looked
// at, so a few at a time are put in order.
std::vector<Orientation> distinct(const std::vector<Quaternionf>& rotations,
                                  const std::vector<float>& volumes, std::size_t count, float alike) {
  Kept kept;
  float above = -std::numeric_limits<float>::infinity();
  for (std::size_t taken = 0; taken < volumes.size();) {
    const float limit = limitHolding(taken + 2 * count, volumes);
    for (const auto& [volume, i] : rankedBetween(above, limit, volumes)) {
      kept.offer({rotations[i], volume}, alike);
      if (kept.orientations().size() == count) return kept.orientations();
      ++taken;
    }
    above = limit;
  }
  return kept.orientations();
}

std::vector<Orientation> distinct(const std::vector<Orientation>& orientations, std::size_t count,
                                  float alike) {
  std::vector<Quaternionf> rotations;
  std::vector<float> volumes;
  for (const Orientation& orientation : orientations) {
    rotations.push_back(orientation.rotation);
    volumes.push_back(orientation.volume);
  }
  return distinct(rotations, volumes, count, alike);
}

std::vector<float> volumesOf(const PointCloud& points, const std::vector<Quaternionf>& rotations) {
  std::vector<float> volumes(rotations.size());
  for (std::size_t begin = 0; begin < rotations.size(); begin += kLanes) {
    Rotations batch;
    for (std::size_t k = 0; k < kLanes; ++k)
      put(rotations[std::min(begin + k, rotations.size() - 1)], k, batch);
    alignas(64) orientation_batch::Lane measured;
    measure(points, batch, measured);
    std::copy_n(measured, std::min(kLanes, rotations.size() - begin), &volumes[begin]);
  }
  return volumes;
}

// Descents side by side, one a lane: a random turn is kept when it makes the box smaller, else its opposite
// is tried.
class Descents {
 public:
  Descents(const PointCloud& points, const Rotations& starts, float step) : points_(points) {
    places_.rotations = starts;
    measure(points, starts, places_.volume);
    std::fill_n(places_.step, kLanes, step);
    std::fill_n(places_.sign, kLanes, 1.0f);
  }

  // Pre: trial is below kMostTrials.
  void advance(int trial) {
    static const std::vector<orientation_batch::Axes> axes = axesOfTrials();
    Rotations next;
    orientation_batch::turn(places_, axes[static_cast<std::size_t>(trial / 2)], next);
    alignas(64) orientation_batch::Lane volumes;
    measure(points_, next, volumes);
    orientation_batch::settle(places_, next, volumes, trial % 2 == 0);
  }

  Orientation at(std::size_t k) const { return {rotationAt(places_.rotations, k), places_.volume[k]}; }

 private:
  const PointCloud& points_;
  orientation_batch::Places places_;
};

// Descends from up to kLanes orientations; spare lanes search from the same places by other turns.
void descendFrom(const PointCloud& points, Orientation* first, std::size_t count, float step, int trials) {
  Rotations starts;
  for (std::size_t k = 0; k < kLanes; ++k) put(first[k % count].rotation, k, starts);
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
    const Quaternionf turned = Quaternionf(axes).normalized();
    orientation = std::min(orientation, {turned, volumesOf(points, {turned})[0]}, smaller);
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

std::vector<Orientation> searchOrientations(const PointCloud& points, int trials) {
  assert(trials >= 1 && trials <= kMostTrials);
  static const std::vector<Quaternionf> lattice = orientationLattice();
  std::vector<Orientation> starts = distinct(lattice, volumesOf(points, lattice), 3 * kLanes, kNeighbours);
  descend(points, starts, 0.1f, trials);
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
