#include "boxgrasp/wrench/three_cone_hull.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "boxgrasp/base/simd.h"

namespace boxgrasp {
namespace {

// A linear function of wrenches is a twist: u . (f, x_i x f) = v_i . f, where v_i = a + b x x_i is the
// velocity of contact i. Velocities v_1, v_2, v_3 belong to a twist if no pair's distance x_ij = x_i - x_j
// changes: (v_i - v_j) . x_ij = 0. The plane u . w = D of a facet is found in the velocities, where what it
// has of contact i says where v_i is: with a side (f, f') on the line D p + s m, with the whole polygon at D
// n. Scaled as below, D is the determinant of six wrenches of the facet: its simplex with the origin has the
// volume D / 720, and the facet the area |u| / 120.
struct Side {
  Vector3d m;  // f x f'
  Vector3d p;  // in the plane of f and f', with p . f = p . f' = 1
};

constexpr double kDecided = 1e-13;  // of their largest possible value: nearer to 0, signs are rounding's
constexpr double kClosed = 1e-8;    // how far the facets' area vectors may be from adding up to nothing

}  // namespace

// Many candidates at a time: those that differ in the side, or the corner, of one contact only.
namespace three_cone_passes {

constexpr std::size_t kLanes = 8;
using Lane = double[kLanes];

// Where the wrenches of a candidate's contacts that are not on the plane lie: all below, all above, both, or
// too near to it to tell.
enum Sign : std::int64_t { below, above, mixed, undecided };

BOXGRASP_SIMD_PART std::int64_t signOf(double noise, double a, double b, double c) {
  const double less = a < b ? a : b, more = a < b ? b : a;
  const double least = less < c ? less : c, most = more < c ? c : more;
  const std::int64_t unclear = (least > -noise) | (most < noise) ? undecided : mixed;
  return least > noise ? below : (most < -noise ? above : unclear);
}

// Of a polygon in the plane normal . f = 1, alike for all its sides (f, f').
struct Flat {
  double normal_m = 0.0, below_p = 0.0;  // m . normal, and 1 - p . normal
};

// What all candidates with one side of the first and one of the second contact share.
struct Sides {
  double m12, m13, m21, m23;  // x_ij times m_i
  double p13, p23, r12;       // x_ij times p_i; -x_21 p_2 - x_12 p_1
  std::array<Flat, 3> flat;
  double noise;
};

struct SideCandidates {
  alignas(64) Lane d, s1, s2, s3;
  alignas(64) std::int64_t sign[kLanes];
};

// Three lines D p_i + s_i m_i: the pairs' conditions are linear in s_1, s_2, s_3 and D, solved by Cramer's
// rule. Of each side of the third contact: m and p times x_31 and x_32.
BOXGRASP_SIMD void solveSides(const Sides& of, const double* m_31, const double* m_32, const double* p_31,
                              const double* p_32, SideCandidates& found) {
  const Sides f = of;
  const auto [flat_1, flat_2, flat_3] = f.flat;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const double m31 = m_31[i], m32 = -m_32[i], r23 = -p_32[i] - f.p23, r31 = -f.p13 - p_31[i];
    const double d = f.m12 * f.m23 * m31 + f.m21 * m32 * f.m13;
    const double s1 = f.r12 * f.m23 * m31 + r23 * f.m21 * m31 + r31 * f.m21 * m32;
    const double s2 = -f.r12 * m32 * f.m13 + r23 * f.m12 * m31 + r31 * f.m12 * m32;
    const double s3 = -f.r12 * f.m23 * f.m13 - r23 * f.m21 * f.m13 + r31 * f.m12 * f.m23;
    found.d[i] = d;
    found.s1[i] = s1;
    found.s2[i] = s2;
    found.s3[i] = s3;
    found.sign[i] =
        signOf(f.noise, d * flat_1.below_p - s1 * flat_1.normal_m, d * flat_2.below_p - s2 * flat_2.normal_m,
               d * flat_3.below_p - s3 * flat_3.normal_m);
  }
}

// What all candidates with the polygon of contact i and one side of contact j share.
struct PolygonSide {
  double d, c_i, c_j, depth_j;
  double up;  // 1 or -1: x_ik x x_jk is so many times the normal of the contacts' plane
  double noise;
};

// Of each corner of contact k: how high it is along the normal of the contacts' plane, and how much more than
// the corners after and before; m of the sides after and before it times x_ki and x_kj.
struct Corners {
  const double *height, *over_after, *over_before, *after_i, *after_j, *before_i, *before_j;
};

BOXGRASP_SIMD void testCorners(const PolygonSide& of, const Corners& corners, std::int64_t* sign) {
  const PolygonSide f = of;
  const auto [height, over_after, over_before, after_i, after_j, before_i, before_j] = corners;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const double turned_after = f.c_j * after_i[i] - f.c_i * after_j[i];
    const double turned_before = f.c_j * before_i[i] - f.c_i * before_j[i];
    sign[i] = signOf(f.noise, f.up * height[i] * f.depth_j, f.d * f.up * over_after[i] - turned_after,
                     f.d * f.up * over_before[i] + turned_before);
  }
}

}  // namespace three_cone_passes

namespace {

using three_cone_passes::kLanes;

constexpr std::size_t kMostEdges = 64;

// A number for each side or corner, in whole lanes.
struct Row {
  alignas(64) std::array<double, kMostEdges> values;
  double& operator[](std::size_t i) { return values[i]; }
  const double& operator[](std::size_t i) const { return values[i]; }
};

class Facets {
 public:
  explicit Facets(const std::array<ForceCone, 3>& cones)
      : cones_(cones),
        x_12_(between(0, 1)),
        x_13_(between(0, 2)),
        normal_(x_12_.cross(x_13_)),
        squared_(normal_.squaredNorm()) {
    for (int i = 0; i < 3; ++i) prepare(i);
    noise_ = kDecided * largestDepth();
  }

  std::optional<WrenchHull> hull() {
    if (hasFacetThroughOrigin()) return std::nullopt;
    addSideSideSide();
    for (int i = 0; i < 3; ++i) {
      addPolygonSideCorner(i, (i + 1) % 3, (i + 2) % 3, 1.0);
      addPolygonSideCorner(i, (i + 2) % 3, (i + 1) % 3, -1.0);
    }
    const bool closed = area_.cwiseAbs().maxCoeff() <= kClosed * areas_;
    if (!decided_ || !(volume_ > 0.0) || !closed) return std::nullopt;
    return WrenchHull{inradius_, volume_ / 720.0};
  }

 private:
  using Velocities = std::array<Vector3d, 3>;

  // What the candidates share of one contact.
  struct Prepared {
    std::size_t count = 0;  // of sides, and of corners: side k is from corner k to the next
    std::array<Side, kMostEdges> sides;
    std::array<Row, 3> along_m, along_p, before_m;  // [j][side]: m and p times x_ij, and m of the side before
    Row height, over_after, over_before;            // of the corners: see Corners
    double polygon = 0.0;                           // twice its area
    three_cone_passes::Flat flat;
  };

  Vector3d between(int i, int j) const { return cones_[i].arm - cones_[j].arm; }

  void prepare(int i) {
    const auto& [arm, normal, edges] = cones_[i];
    Prepared& its = prepared_[i];
    const std::size_t count = its.count = edges.size();
    const auto after = [&](std::size_t k) { return k + 1 == count ? 0 : k + 1; };
    for (std::size_t k = 0; k < count; ++k) {
      const Vector3d &f = edges[k], &next = edges[after(k)];
      its.sides[k] = {f.cross(next), (f + next) / f.dot(f + next)};
      its.polygon += its.sides[k].m.dot(normal);
      its.height[k] = normal_.dot(f);
      for (int j = 0; j < 3; ++j) {
        its.along_m[j][k] = its.before_m[j][after(k)] = its.sides[k].m.dot(between(i, j));
        its.along_p[j][k] = its.sides[k].p.dot(between(i, j));
      }
    }
    for (std::size_t k = 0; k < count; ++k) {
      its.over_after[k] = its.height[k] - its.height[after(k)];
      its.over_before[after(k)] = its.height[after(k)] - its.height[k];
    }
    its.flat = {its.sides[0].m.dot(normal), 1.0 - its.sides[0].p.dot(normal)};
    fillLanes(its);
  }

  // With what is never looked at.
  static void fillLanes(Prepared& its) {
    for (std::size_t k = its.count; k % kLanes != 0; ++k) {
      for (int j = 0; j < 3; ++j) its.along_m[j][k] = its.along_p[j][k] = its.before_m[j][k] = 0.0;
      its.height[k] = its.over_after[k] = its.over_before[k] = 0.0;
    }
  }

  // No depth below is larger.
  double largestDepth() const {
    double m = 0.0, x = 0.0, polygon = 0.0, f = 0.0;
    for (int i = 0; i < 3; ++i) {
      m = std::max(m, prepared_[i].sides[0].m.norm());
      f = std::max(f, cones_[i].edges.front().norm());
      x = std::max(x, between(i, (i + 1) % 3).norm());
      polygon = std::max(polygon, prepared_[i].polygon);
    }
    return (m + 1.0) * (m + polygon) * (m + f) * f * x * x * x;
  }

  // A plane that holds two polygons turns about the line through their contacts; it is a facet if the third
  // polygon is on one side of it.
  bool hasFacetThroughOrigin() const {
    return std::ranges::any_of(prepared_, [](const Prepared& its) {
      const auto heights = std::span(its.height.values).first(its.count);
      const auto [least, most] = std::ranges::minmax(heights);
      return least >= -kDecided || most <= kDecided;
    });
  }

  void addSideSideSide() {
    const auto& [first, second, third] = prepared_;
    three_cone_passes::Sides sides{};
    sides.flat = {first.flat, second.flat, third.flat};
    sides.noise = noise_;
    for (std::size_t k1 = 0; k1 < first.count; ++k1) {
      sides.m12 = first.along_m[1][k1];
      sides.m13 = first.along_m[2][k1];
      sides.p13 = first.along_p[2][k1];
      for (std::size_t k2 = 0; k2 < second.count; ++k2) {
        sides.m21 = -second.along_m[0][k2];
        sides.m23 = second.along_m[2][k2];
        sides.p23 = second.along_p[2][k2];
        sides.r12 = -second.along_p[0][k2] - first.along_p[1][k1];
        addSides(sides, first.sides[k1], second.sides[k2]);
      }
    }
  }

  void addSides(const three_cone_passes::Sides& shared, const Side& first, const Side& second) {
    const Prepared& third = prepared_[2];
    three_cone_passes::SideCandidates found;
    for (std::size_t begin = 0; begin < third.count; begin += kLanes) {
      three_cone_passes::solveSides(shared, &third.along_m[0][begin], &third.along_m[1][begin],
                                    &third.along_p[0][begin], &third.along_p[1][begin], found);
      for (std::size_t i = 0; i < std::min(kLanes, third.count - begin); ++i) {
        if (found.sign[i] == three_cone_passes::mixed) continue;
        const double d = found.d[i];
        add(found.sign[i], d,
            {on(first, d, found.s1[i]), on(second, d, found.s2[i]),
             on(third.sides[begin + i], d, found.s3[i])});
      }
    }
  }

  static Vector3d on(const Side& side, double d, double s) { return d * side.p + s * side.m; }

  // `up` times the normal of the contacts' plane is x_ik x x_jk.
  void addPolygonSideCorner(int i, int j, int k, double up) {
    const Prepared& its = prepared_[j];
    const double polygon = prepared_[i].polygon, n_ij = cones_[i].normal.dot(between(i, j)),
                 n_ik = cones_[i].normal.dot(between(i, k));
    for (std::size_t side = 0; side < its.count; ++side) {
      const double d = -polygon * its.along_m[i][side], s = polygon * (n_ij + its.along_p[i][side]);
      const double c_i = d * n_ik, c_j = d * its.along_p[k][side] + s * its.along_m[k][side];
      addCorners(i, j, k, {d, c_i, c_j, d * its.flat.below_p - s * its.flat.normal_m, up, noise_},
                 on(its.sides[side], d, s));
    }
  }

  // v_i and the condition on x_ij give v_j; v_k follows from its two conditions and v_k . h = D. All is
  // a multiple of h . N, where N is the normal of the contacts' plane.
  void addCorners(int i, int j, int k, const three_cone_passes::PolygonSide& shared, const Vector3d& v_j) {
    const Vector3d x_ik = between(i, k), x_jk = between(j, k);
    const Prepared& its = prepared_[k];
    for (std::size_t begin = 0; begin < its.count; begin += kLanes) {
      alignas(64) std::int64_t sign[kLanes];
      three_cone_passes::testCorners(shared, cornersFrom(its, i, j, begin), sign);
      for (std::size_t at = 0; at < std::min(kLanes, its.count - begin); ++at) {
        if (sign[at] == three_cone_passes::mixed) continue;
        const Vector3d& h = cones_[k].edges[begin + at];
        const double scale = shared.up * its.height[begin + at];
        Velocities v;
        v[i] = shared.d * scale * cones_[i].normal;
        v[j] = scale * v_j;
        v[k] = shared.d * shared.up * normal_ + shared.c_i * x_jk.cross(h) + shared.c_j * h.cross(x_ik);
        add(sign[at], shared.d * scale, v);
      }
    }
  }

  static three_cone_passes::Corners cornersFrom(const Prepared& its_k, int i, int j, std::size_t begin) {
    return {&its_k.height[begin],     &its_k.over_after[begin], &its_k.over_before[begin],
            &its_k.along_m[i][begin], &its_k.along_m[j][begin], &its_k.before_m[i][begin],
            &its_k.before_m[j][begin]};
  }

  void add(std::int64_t sign, double d, const Velocities& v) {
    if (sign == three_cone_passes::undecided) {
      decided_ = false;
      return;
    }
    const double outward = sign == three_cone_passes::below ? 1.0 : -1.0;
    const Wrench u = outward * twist(v);
    const double norm = u.norm();
    inradius_ = std::min(inradius_, outward * d / norm);
    volume_ += outward * d;
    area_ += u;
    areas_ += norm;
  }

  Wrench twist(const Velocities& v) const {
    const Vector3d v_12 = v[0] - v[1], v_13 = v[0] - v[2];
    const Vector3d b =
        (v_13.dot(normal_) * x_12_ - v_12.dot(normal_) * x_13_ + v_12.dot(x_13_) * normal_) / squared_;
    Wrench result;
    result << v[0] - b.cross(cones_[0].arm), b;
    return result;
  }

  const std::array<ForceCone, 3>& cones_;
  Vector3d x_12_, x_13_, normal_;  // the normal of the contacts' plane, of any length
  double squared_;                 // that of the normal
  std::array<Prepared, 3> prepared_;
  double noise_ = 0.0;
  bool decided_ = true;
  double inradius_ = std::numeric_limits<double>::infinity(), volume_ = 0.0, areas_ = 0.0;
  Wrench area_ = Wrench::Zero();
};

}  // namespace

std::optional<WrenchHull> threeConeHull(const std::array<ForceCone, 3>& cones) {
  return Facets(cones).hull();
}

}  // namespace boxgrasp
