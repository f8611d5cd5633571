#include "boxgrasp/wrench/three_cone_hull.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

// Where the wrenches of a candidate's contacts that are not on the plane lie: all below, all above, both, or
// too near to it to tell.
enum class Sign { below, above, mixed, undecided };

template <typename... Depth>
Sign signOf(double noise, Depth... depths) {
  const double least = std::min({depths...}), most = std::max({depths...});
  if (least > noise) return Sign::below;
  if (most < -noise) return Sign::above;
  return least > -noise || most < noise ? Sign::undecided : Sign::mixed;
}

class Facets {
 public:
  explicit Facets(const std::array<ForceCone, 3>& cones) : cones_(cones) {
    for (int i = 0; i < 3; ++i) prepare(i);
    noise_ = kDecided * largestDepth();
  }

  std::optional<WrenchHull> hull() {
    if (hasFacetThroughOrigin()) return std::nullopt;
    addSideSideSide();
    for (int i = 0; i < 3; ++i) {
      addPolygonSideCorner(i, (i + 1) % 3, (i + 2) % 3);
      addPolygonSideCorner(i, (i + 2) % 3, (i + 1) % 3);
    }
    const bool closed = area_.cwiseAbs().maxCoeff() <= kClosed * areas_;
    if (!decided_ || !(volume_ > 0.0) || !closed) return std::nullopt;
    return WrenchHull{inradius_, volume_ / 720.0};
  }

 private:
  using Velocities = std::array<Vector3d, 3>;

  // What the candidates share of one contact.
  struct Prepared {
    std::vector<Side> sides;
    std::array<std::vector<double>, 3> along_m, along_p;  // [j][side]: m and p times x_ij
    double polygon = 0.0;                                 // twice its area
    double normal_m = 0.0, below_p = 0.0;                 // m . n, and 1 - p . n: alike for all its sides
  };

  Vector3d between(int i, int j) const { return cones_[i].arm - cones_[j].arm; }

  void prepare(int i) {
    const auto& [arm, normal, edges] = cones_[i];
    Prepared& its = prepared_[i];
    const std::size_t count = edges.size();
    for (std::size_t k = 0; k < count; ++k) {
      const Vector3d &f = edges[k], &next = edges[(k + 1) % count];
      its.sides.push_back({f.cross(next), (f + next) / f.dot(f + next)});
      its.polygon += its.sides.back().m.dot(normal);
    }
    its.normal_m = its.sides.front().m.dot(normal);
    its.below_p = 1.0 - its.sides.front().p.dot(normal);
    for (int j = 0; j < 3; ++j) {
      for (const Side& side : its.sides) {
        its.along_m[j].push_back(side.m.dot(between(i, j)));
        its.along_p[j].push_back(side.p.dot(between(i, j)));
      }
    }
  }

  // No depth below is larger.
  double largestDepth() const {
    double m = 0.0, x = 0.0, polygon = 0.0, f = 0.0;
    for (int i = 0; i < 3; ++i) {
      m = std::max(m, prepared_[i].sides.front().m.norm());
      f = std::max(f, cones_[i].edges.front().norm());
      x = std::max(x, between(i, (i + 1) % 3).norm());
      polygon = std::max(polygon, prepared_[i].polygon);
    }
    return (m + 1.0) * (m + polygon) * (m + f) * f * x * x * x;
  }

  // A plane that holds two polygons turns about the line through their contacts; it is a facet if the third
  // polygon is on one side of it.
  bool hasFacetThroughOrigin() const {
    const Vector3d normal = between(0, 1).cross(between(0, 2));
    return std::any_of(cones_.begin(), cones_.end(), [&](const ForceCone& cone) {
      const auto [least, most] =
          std::ranges::minmax(cone.edges, {}, [&](const Vector3d& f) { return normal.dot(f); });
      return normal.dot(least) >= -kDecided || normal.dot(most) <= kDecided;
    });
  }

  // Three lines D p_i + s_i m_i: the pairs' conditions are linear in s_1, s_2, s_3 and D, solved by Cramer's
  // rule.
  void addSideSideSide() {
    const auto& [first, second, third] = prepared_;
    for (std::size_t k1 = 0; k1 < first.sides.size(); ++k1) {
      const double m12 = first.along_m[1][k1], m13 = first.along_m[2][k1];
      for (std::size_t k2 = 0; k2 < second.sides.size(); ++k2) {
        const double m21 = -second.along_m[0][k2], m23 = second.along_m[2][k2];
        const double r12 = -second.along_p[0][k2] - first.along_p[1][k1];
        for (std::size_t k3 = 0; k3 < third.sides.size(); ++k3) {
          const double m31 = third.along_m[0][k3], m32 = -third.along_m[1][k3];
          const double r23 = -third.along_p[1][k3] - second.along_p[2][k2];
          const double r31 = -first.along_p[2][k1] - third.along_p[0][k3];
          const double d = m12 * m23 * m31 + m21 * m32 * m13;
          const double s1 = r12 * m23 * m31 + r23 * m21 * m31 + r31 * m21 * m32;
          const double s2 = -r12 * m32 * m13 + r23 * m12 * m31 + r31 * m12 * m32;
          const double s3 = -r12 * m23 * m13 - r23 * m21 * m13 + r31 * m12 * m23;
          const Sign sign =
              signOf(noise_, d * first.below_p - s1 * first.normal_m,
                     d * second.below_p - s2 * second.normal_m, d * third.below_p - s3 * third.normal_m);
          if (sign == Sign::mixed) continue;
          add(sign, d, {on(first.sides[k1], d, s1), on(second.sides[k2], d, s2), on(third.sides[k3], d, s3)});
        }
      }
    }
  }

  static Vector3d on(const Side& side, double d, double s) { return d * side.p + s * side.m; }

  // v_i and the condition on x_ij give v_j; v_k follows from its two conditions and v_k . h = D. All is
  // a multiple of h . N, where N is the normal of the contacts' plane.
  void addPolygonSideCorner(int i, int j, int k) {
    const Vector3d x_ik = between(i, k), x_jk = between(j, k), normal = x_ik.cross(x_jk);
    const Prepared &its_j = prepared_[j], &its_k = prepared_[k];
    const auto& corners = cones_[k].edges;
    const double polygon = prepared_[i].polygon, n_ij = cones_[i].normal.dot(between(i, j)),
                 n_ik = cones_[i].normal.dot(x_ik);
    for (std::size_t side = 0; side < its_j.sides.size(); ++side) {
      const double d = -polygon * its_j.along_m[i][side], s = polygon * (n_ij + its_j.along_p[i][side]);
      const double c_i = d * n_ik, c_j = d * its_j.along_p[k][side] + s * its_j.along_m[k][side];
      const double depth_j = d * its_j.below_p - s * its_j.normal_m;
      for (std::size_t corner = 0; corner < corners.size(); ++corner) {
        const std::size_t before = (corner + corners.size() - 1) % corners.size(),
                          after = (corner + 1) % corners.size();
        const double scale = corners[corner].dot(normal);
        // x_ki and x_kj are what is tabled.
        const auto turned = [&](std::size_t m) {
          return c_j * its_k.along_m[i][m] - c_i * its_k.along_m[j][m];
        };
        const Sign sign =
            signOf(noise_, scale * depth_j, d * (scale - normal.dot(corners[after])) - turned(corner),
                   d * (scale - normal.dot(corners[before])) + turned(before));
        if (sign == Sign::mixed) continue;
        const Vector3d& h = corners[corner];
        Velocities v;
        v[i] = d * scale * cones_[i].normal;
        v[j] = scale * on(its_j.sides[side], d, s);
        v[k] = d * normal + c_i * x_jk.cross(h) + c_j * h.cross(x_ik);
        add(sign, d * scale, v);
      }
    }
  }

  void add(Sign sign, double d, const Velocities& v) {
    if (sign == Sign::undecided) {
      decided_ = false;
      return;
    }
    const double outward = sign == Sign::below ? 1.0 : -1.0;
    const Wrench u = outward * twist(v);
    const double norm = u.norm();
    inradius_ = std::min(inradius_, outward * d / norm);
    volume_ += outward * d;
    area_ += u;
    areas_ += norm;
  }

  Wrench twist(const Velocities& v) const {
    const Vector3d x_12 = between(0, 1), x_13 = between(0, 2), normal = x_12.cross(x_13);
    const Vector3d v_12 = v[0] - v[1], v_13 = v[0] - v[2];
    const Vector3d b =
        (v_13.dot(normal) * x_12 - v_12.dot(normal) * x_13 + v_12.dot(x_13) * normal) / normal.squaredNorm();
    Wrench result;
    result << v[0] - b.cross(cones_[0].arm), b;
    return result;
  }

  const std::array<ForceCone, 3>& cones_;
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
