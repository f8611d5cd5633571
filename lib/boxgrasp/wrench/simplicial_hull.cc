#include "boxgrasp/wrench/simplicial_hull.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace boxgrasp {
namespace {

// Distances from a plane, over that of the farthest point and over the noise.
constexpr double kOnPlane = 1e-13;    // nearer points are on it
constexpr double kCertain = 1e-11;    // the largest error that passes the check at the end
constexpr double kSameVolume = 1e-8;  // how much volumes may differ that were added up from different apexes

constexpr int kUsualFacets = 1024;  // room for three contacts with eight edges, which leave some 530
constexpr int kMostFacets = 32768;  // bounds time and memory; sixteen contacts stay well below

using Six = std::array<int, 6>;

// 6 if there is none. Looks at all six: faster than a branch that is taken at random.
int indexOf(const Six& values, int value) {
  int result = 6;
  for (int i = 0; i < 6; ++i) result = values[i] == value ? i : result;
  return result;
}

struct Facet {
  enum class State { kept, visible, unused };

  Six vertices{};
  Six neighbours{};  // neighbours[i] has all vertices but vertices[i]
  Six successors{};  // of a visible facet: successors[i] takes its place at the ridge to a kept neighbours[i]
  State state = State::kept;
};

class Hull {
 public:
  explicit Hull(const WrenchMatrix& points)
      : points_(points),
        centre_(points.leftCols<7>().rowwise().mean()),
        planes_(kValues + points.cols(), kUsualFacets) {
    startWithSimplex();
    for (int point = 7; point < points.cols() && consistent_; ++point) add(point);
  }

  // Nothing where rounding has spoilt the hull. The facets' simplices fill it, each once, from whichever
  // apex: so the volumes from the first seven points must be equal.
  std::optional<WrenchHull> measure() const {
    bool supporting = consistent_;
    double inradius = std::numeric_limits<double>::infinity();
    Corners volumes = Corners::Zero();
    eachKept([&](int facet) {
      supporting = supporting && isSupporting(facet);
      inradius = std::min(inradius, -planes_(kOffset, facet) / normal(facet).norm());
      const Corners heights = values(facet).head<7>();
      volumes += volumeUnder(facets_[facet]) / heights.mean() * heights;
    });
    const double volume = volumes.mean();
    if (!supporting || !((volumes.array() - volume).abs() <= kSameVolume * volume).all()) return std::nullopt;
    return WrenchHull{inradius, volume};
  }

 private:
  using Corners = Eigen::Matrix<double, 7, 1>;  // one number for each of the first seven points

  // A facet's column of planes_ is its function normal . x + offset: the outward normal, the offset, then the
  // value at every point, scaled to -1 at the farthest. All are linear in the function: the plane through a
  // ridge and a point is a combination of the columns of the two facets that meet in the ridge. So scaled,
  // flat hulls are as good as round ones.
  static constexpr int kOffset = 6, kValues = 7;

  Wrench normal(int facet) const { return planes_.col(facet).head<6>(); }
  Eigen::Map<const Eigen::VectorXd> values(int facet) const {
    return {planes_.col(facet).data() + kValues, points_.cols()};
  }
  double value(int facet, int point) const { return planes_(kValues + point, facet); }
  void normalise(int facet) { planes_.col(facet) *= 1.0 / values(facet).cwiseAbs().maxCoeff(); }

  bool isVisible(int facet) const { return facets_[facet].state == Facet::State::visible; }

  template <typename Visit>
  void eachKept(Visit visit) const {
    for (int facet = 0; facet < static_cast<int>(facets_.size()); ++facet) {
      if (facets_[facet].state == Facet::State::kept) visit(facet);
    }
  }

  template <typename Visit>
  void eachHorizonRidge(Visit visit) const {
    for (const int facet : visible_) {
      for (int i = 0; i < 6; ++i) {
        if (!isVisible(facets_[facet].neighbours[i])) visit(facet, i);
      }
    }
  }

  // The functions are the barycentric coordinates of the first seven points, negated.
  void startWithSimplex() {
    Eigen::Matrix<double, 7, Eigen::Dynamic> homogeneous(7, points_.cols());
    homogeneous << points_, Eigen::RowVectorXd::Ones(points_.cols());
    const Eigen::Matrix<double, 7, 7> barycentric = homogeneous.leftCols<7>().inverse();
    facets_.resize(7);
    for (int i = 0; i < 7; ++i) {
      for (int k = 0; k < 6; ++k) facets_[i].vertices[k] = facets_[i].neighbours[k] = k < i ? k : k + 1;
      planes_.col(i) << -barycentric.row(i).transpose(), -(barycentric.row(i) * homogeneous).transpose();
      normalise(i);
      noise_ = std::max(noise_, normal(i).norm() * points_.cwiseAbs().maxCoeff());
    }
  }

  // Puts facets through the point in the place of those that it sees. Those whose plane it lies on stay, so
  // that no simplex is flat.
  void add(int point) {
    visible_.clear();
    eachKept([&](int facet) {
      if (value(facet, point) > kOnPlane * noise_) visible_.push_back(facet);
    });
    for (const int facet : visible_) facets_[facet].state = Facet::State::visible;
    eachHorizonRidge([&](int facet, int i) { succeed(facet, i, point); });
    eachHorizonRidge([&](int facet, int i) { linkSuccessor(facet, i); });
    for (const int facet : visible_) facets_[facet].state = Facet::State::unused;
    unused_.insert(unused_.end(), visible_.begin(), visible_.end());
    consistent_ = consistent_ && facets_.size() <= kMostFacets;
  }

  void succeed(int facet, int i, int point) {
    const int successor = newFacet(), neighbour = facets_[facet].neighbours[i];
    Six& back = facets_[neighbour].neighbours;
    back[indexOf(back, facet)] = successor;
    facets_[facet].successors[i] = successor;
    const Six& old = facets_[facet].vertices;
    Six& vertices = facets_[successor].vertices;
    std::copy(old.begin() + i + 1, old.end(), std::copy(old.begin(), old.begin() + i, vertices.begin()));
    vertices[5] = point;
    facets_[successor].neighbours[5] = neighbour;
    tilt(successor, facet, neighbour, point);
  }

  int newFacet() {
    if (unused_.empty()) {
      unused_.push_back(static_cast<int>(facets_.size()));
      facets_.emplace_back();
      if (planes_.cols() == unused_.back()) planes_.conservativeResize(Eigen::NoChange, 2 * planes_.cols());
    }
    const int facet = unused_.back();
    unused_.pop_back();
    facets_[facet].state = Facet::State::kept;
    return facet;
  }

  // Both weights are positive or zero: nothing cancels.
  void tilt(int successor, int visible, int kept, int point) {
    const double above = value(visible, point), below = -value(kept, point);
    planes_.col(successor) = above * planes_.col(kept);
    if (below > kOnPlane * noise_) planes_.col(successor) += below * planes_.col(visible);
    normalise(successor);
  }

  // The successor's neighbour on the far side of vertices[j] is the next around the face without i and j.
  void linkSuccessor(int facet, int i) {
    const Facet& old = facets_[facet];
    Six& neighbours = facets_[old.successors[i]].neighbours;
    for (int j = 0; j < 6; ++j) {
      if (j != i) neighbours[j < i ? j : j - 1] = acrossVisible(facet, j, old.vertices[i]);
    }
  }

  // Walks around a face of four dimensions, by way of the visible facets, to the horizon's other ridge there.
  // Every facet around that face has two more vertices: the walk leaves the one behind and turns about the
  // other.
  int acrossVisible(int facet, int leave, int pivot) {
    for (std::size_t steps = 0; steps < visible_.size(); ++steps) {
      const int next = facets_[facet].neighbours[leave];
      if (!isVisible(next)) return facets_[facet].successors[leave];
      const int entered = indexOf(facets_[next].neighbours, facet);
      leave = indexOf(facets_[next].vertices, pivot);
      if (entered == 6 || leave == 6) break;
      pivot = facets_[next].vertices[entered];
      facet = next;
    }
    consistent_ = false;
    return 0;
  }

  // Written so that a NaN fails.
  bool isSupporting(int facet) const {
    const double tolerance = kCertain * noise_;
    if (!(values(facet).array() <= tolerance).all()) return false;
    const Six& vertices = facets_[facet].vertices;
    return std::all_of(vertices.begin(), vertices.end(), [&](int vertex) {
      return std::abs(normal(facet).dot(points_.col(vertex)) + planes_(kOffset, facet)) <= tolerance;
    });
  }

  // Of the simplex of the facet and the centre.
  double volumeUnder(const Facet& facet) const {
    Eigen::Matrix<double, 6, 6> edges;
    for (int i = 0; i < 6; ++i) edges.col(i) = points_.col(facet.vertices[i]) - centre_;
    return std::abs(edges.determinant()) / 720.0;
  }

  const WrenchMatrix& points_;
  Wrench centre_;       // of the first seven points, so inside
  double noise_ = 1.0;  // how many times the flatness of the first seven points multiplies rounding
  Eigen::MatrixXd planes_;
  std::vector<Facet> facets_;
  std::vector<int> visible_, unused_;
  bool consistent_ = true;  // false: rounding has broken the facets' neighbourhood
};

}  // namespace

std::optional<WrenchHull> simplicialHull(const WrenchMatrix& points) { return Hull(points).measure(); }

}  // namespace boxgrasp
