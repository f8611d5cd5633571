#include "boxgrasp/decomposition/jury.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "boxgrasp/base/parallel.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/base/tolerances.h"
#include "boxgrasp/decomposition/even_surface.h"
#include "boxgrasp/geometry/canonical_frame.h"
#include "boxgrasp/geometry/min_volume_box.h"

namespace boxgrasp {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kCuts = 8;         // plateaus whose halves are boxed
constexpr double kLeastShare = 0.03;     // of a part's points on each side of a cut
constexpr std::size_t kLeastPoints = 4;  // on each side: fewer have no volume
constexpr std::size_t kMostSplits = 5;   // a jury agrees on no more: noise decides on smaller parts
constexpr double kScales = 0.1;          // jurors' resolutions differ by this share up and down
// How far from t a split may be decided, in units of 1 - t. The wider, the wider the widest gap and the
// steadier the tree; wider still, and many things are one box.
constexpr double kBelow = 0.6, kAbove = 0.8;
constexpr double kAgreement = 0.05;  // jurors' D agree when they differ by about
                                     // this, in units of the cloud's size

// A rotation from four normal deviates is uniform over all.
Matrix3d randomRotation(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Eigen::Vector4d q;
  for (double& value : q) value = normal(random);
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
}

double skinnedVolume(const OrientedBox& box, double resolution_m) {
  return (box.extents.array() + resolution_m).prod();
}

class JurorHearing {
 public:
  JurorHearing(std::size_t cloud_points, double resolution_m, const DecompositionOptions& options,
               const StopToken& stop)
      : cloud_points_(cloud_points), resolution_m_(resolution_m), options_(options), stop_(stop) {}

  Juror hear(PointCloud surface_C) {
    juror_.resolution_m = resolution_m_;
    surface_points_ = surface_C.size();
    add(std::move(surface_C), -1);
    note();
    const std::size_t most = std::min(kMostSplits, static_cast<std::size_t>(options_.max_leaves) - 1);
    while (juror_.volumes.size() <= most) {
      const int best = mostSaving();
      if (best < 0) break;
      split(best);
      note();
    }
    return std::move(juror_);
  }

 private:
  void add(PointCloud points_C, int parent) {
    JurorNode node;
    node.box = minVolumeBox(points_C, {}, stop_);
    node.volume = skinnedVolume(node.box, resolution_m_);
    node.parent = parent;
    node.depth = parent < 0 ? 0 : juror_.nodes[parent].depth + 1;
    node.points_C = std::move(points_C);
    findCut(node);
    juror_.nodes.push_back(std::move(node));
  }

  // Of the cuts from the lowest plateaus the one that leaves the least volume.
  void findCut(JurorNode& node) const {
    stop_.check();
    node.cut_volume = kInfinity;
    const double share = static_cast<double>(node.points_C.size()) / static_cast<double>(surface_points_);
    if (share * static_cast<double>(cloud_points_) < options_.min_points ||
        node.box.extents[1] < options_.min_extent_m)
      return;
    const auto least = std::max(kLeastPoints, leastOf(node));
    for (const PlateauCut& cut : plateauCuts(node.points_C, node.box, least, kCuts)) {
      const auto [first, second] = sides(node.points_C, cut);
      if (std::min(first.size(), second.size()) < kLeastPoints) continue;
      const double volume = skinnedVolume(minVolumeBox(first, {}, stop_), resolution_m_) +
                            skinnedVolume(minVolumeBox(second, {}, stop_), resolution_m_);
      if (volume >= node.cut_volume) continue;
      node.cut_volume = volume;
      node.cut = cut;
    }
  }

  static std::size_t leastOf(const JurorNode& node) {
    return static_cast<std::size_t>(kLeastShare * static_cast<double>(node.points_C.size()));
  }

  static std::pair<PointCloud, PointCloud> sides(const PointCloud& points_C, const PlateauCut& cut) {
    std::pair<PointCloud, PointCloud> result;
    for (std::size_t i = 0; i < points_C.size(); ++i) {
      const Vector3d p = points_C.point(i);
      (cut.normal_C.dot(p) <= cut.offset_m ? result.first : result.second).push(p);
    }
    return result;
  }

  int mostSaving() const {
    int best = -1;
    double saved = 0.0;
    for (std::size_t i = 0; i < juror_.nodes.size(); ++i) {
      const JurorNode& node = juror_.nodes[i];
      if (node.first >= 0 || node.volume - node.cut_volume <= saved) continue;
      saved = node.volume - node.cut_volume;
      best = static_cast<int>(i);
    }
    return best;
  }

  void split(int index) {
    auto [first, second] = sides(juror_.nodes[index].points_C, juror_.nodes[index].cut);
    juror_.nodes[index].first = static_cast<int>(juror_.nodes.size());
    juror_.nodes[index].second = juror_.nodes[index].first + 1;
    add(std::move(first), index);
    add(std::move(second), index);
  }

  // Volume and distances of the present leaves.
  void note() {
    double volume = 0.0, distance = 0.0;
    std::vector<Vector3d> centers;
    for (const JurorNode& node : juror_.nodes) {
      if (node.first >= 0) continue;
      volume += node.volume;
      for (const Vector3d& other : centers) distance += (node.box.X_CB.translation() - other).norm();
      centers.push_back(node.box.X_CB.translation());
    }
    juror_.volumes.push_back(volume);
    juror_.distances.push_back(distance);
  }

  std::size_t cloud_points_, surface_points_ = 0;
  double resolution_m_;
  const DecompositionOptions& options_;
  const StopToken& stop_;
  Juror juror_;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

// Of volumes after one split more than `splits` and before it; 1 where a juror knows no more.
double medianRatio(const std::vector<Juror>& jury, std::size_t splits) {
  std::vector<double> ratios;
  for (const Juror& juror : jury) {
    const bool known = splits + 1 < juror.volumes.size();
    ratios.push_back(known ? juror.volumes[splits + 1] / juror.volumes[splits] : 1.0);
  }
  return median(std::move(ratios));
}

// The juror around whose D the others lie most densely; of equals the first.
std::size_t spokesman(const std::vector<Juror>& jury, std::size_t splits, double agreement_m) {
  std::size_t best = 0;
  double most = 0.0;
  for (std::size_t j = 0; j < jury.size(); ++j) {
    if (splits >= jury[j].distances.size()) continue;
    double agreed = 0.0;
    for (const Juror& other : jury) {
      if (splits >= other.distances.size()) continue;
      const double apart = (other.distances[splits] - jury[j].distances[splits]) / agreement_m;
      agreed += std::exp(-0.5 * apart * apart);
    }
    if (agreed <= most) continue;
    most = agreed;
    best = j;
  }
  return best;
}

// A juror's tree with the cloud's points.
class Transfer {
 public:
  Transfer(const PointCloud& cloud_C, const Juror& juror, const Verdict& verdict,
           const DecompositionOptions& options)
      : cloud_C_(cloud_C), juror_(juror), verdict_(verdict), options_(options) {}

  BoxTree build() {
    std::vector<std::uint32_t> all(cloud_C_.size());
    std::iota(all.begin(), all.end(), 0u);
    add(std::move(all), 0, -1);
    for (std::size_t i = 0; i < tree_.nodes.size(); ++i) splitOrStop(static_cast<int>(i));
    return std::move(tree_);
  }

 private:
  void add(std::vector<std::uint32_t> points, int opinion, int parent) {
    BoxNode node;
    node.box = juror_.nodes[opinion].box;
    node.box.extents.array() += juror_.resolution_m;
    node.parent = parent;
    node.depth = juror_.nodes[opinion].depth;
    node.points = std::move(points);
    tree_.nodes.push_back(std::move(node));
    opinion_.push_back(opinion);
  }

  void splitOrStop(int index) {
    const JurorNode& opinion = juror_.nodes[opinion_[index]];
    if (opinion.cut.theta < 0) {
      tree_.nodes[index].stop_reason = "too few points or thinner than a finger, so no cut was looked for";
      return;
    }
    BoxNode& node = tree_.nodes[index];
    node.theta = opinion.cut.theta;
    node.cut = Cut{opinion.cut.normal_C, opinion.cut.offset_m, axisAlong(node.box, opinion.cut.along_C)};
    node.volume_gain = opinion.cut_volume / opinion.volume;
    if (juror_.leafAfter(static_cast<std::size_t>(opinion_[index]), verdict_.splits)) {
      node.stop_reason = fmt::format(
          "one cut more would leave {:.3f} of all "
          "volume, too much for t = {:.3f}",
          verdict_.next_ratio, options_.gain_t);
      return;
    }
    split(index, opinion);
  }

  void split(int index, const JurorNode& opinion) {
    std::array<std::vector<std::uint32_t>, 2> sides;
    for (const std::uint32_t p : tree_.nodes[index].points) {
      const bool first = opinion.cut.normal_C.dot(cloud_C_.point(p)) <= opinion.cut.offset_m;
      sides[first ? 0 : 1].push_back(p);
    }
    if (sides[0].empty() || sides[1].empty()) {
      tree_.nodes[index].stop_reason = "the cut has no points on one side";
      return;
    }
    tree_.nodes[index].first = static_cast<int>(tree_.nodes.size());
    tree_.nodes[index].second = tree_.nodes[index].first + 1;
    add(std::move(sides[0]), opinion.first, index);
    add(std::move(sides[1]), opinion.second, index);
    BoxNode& node = tree_.nodes[index];
    node.volume_gain =
        (tree_.nodes[node.first].box.volume() + tree_.nodes[node.second].box.volume()) / node.box.volume();
  }

  static int axisAlong(const OrientedBox& box, const Vector3d& direction_C) {
    int axis = -1;
    (box.X_CB.linear().transpose() * direction_C).cwiseAbs().maxCoeff(&axis);
    return axis;
  }

  const PointCloud& cloud_C_;
  const Juror& juror_;
  const Verdict& verdict_;
  const DecompositionOptions& options_;
  BoxTree tree_;
  std::vector<int> opinion_;  // the juror's node for each of the tree's
};

double resolutionOf(const PointCloud& cloud_C, const Matrix3d& axes_C, const DecompositionOptions& options) {
  return std::max(options.resolution_fraction * trimmedSize(cloud_C, axes_C), tolerance::kFlatExtent);
}

}  // namespace

bool Juror::leafAfter(std::size_t node, std::size_t splits) const {
  return nodes[node].first < 0 || static_cast<std::size_t>(nodes[node].first) > 2 * splits;
}

Juror hearJuror(const PointCloud& cloud_C, int number, const DecompositionOptions& options,
                const StopToken& stop) {
  const Matrix3d axes_C = canonicalFrame(cloud_C).linear();
  const double place = (number + 0.5) / options.jurors - 0.5;  // -0.5 .. 0.5
  const double resolution_m = (1 + 2 * kScales * place) * resolutionOf(cloud_C, axes_C, options);
  const Matrix3d turned_C = axes_C * randomRotation(static_cast<std::uint64_t>(number) + 1);
  return JurorHearing(cloud_C.size(), resolution_m, options, stop)
      .hear(evenSurface(cloud_C, resolution_m, turned_C, stop));
}

Verdict verdictOf(const std::vector<Juror>& jury, const DecompositionOptions& options) {
  Verdict verdict;
  const double t = options.gain_t, high = t + kAbove * (1 - t);
  double reached = t - kBelow * (1 - t), widest = -kInfinity, ratio = -1.0;
  for (std::size_t splits = 0; ratio < high; ++splits) {
    ratio = medianRatio(jury, splits);
    const double gap = std::min(ratio, high) - reached;
    if (gap > widest) {
      widest = gap;
      verdict.splits = splits;
      verdict.next_ratio = ratio;
    }
    reached = std::max(reached, ratio);
  }
  const double size_m = jury.front().nodes.front().box.extents.maxCoeff();
  verdict.juror = spokesman(jury, verdict.splits, kAgreement * size_m);
  return verdict;
}

BoxTree juryTree(const PointCloud& cloud_C, const DecompositionOptions& options, const StopToken& stop) {
  std::vector<Juror> jury(static_cast<std::size_t>(options.jurors));
  parallelFor(jury.size(), options.threads,
              [&](std::size_t i) { jury[i] = hearJuror(cloud_C, static_cast<int>(i), options, stop); });
  const Verdict verdict = verdictOf(jury, options);
  return Transfer(cloud_C, jury[verdict.juror], verdict, options).build();
}

}  // namespace boxgrasp
