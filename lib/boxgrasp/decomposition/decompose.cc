#include "boxgrasp/decomposition/decompose.h"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/parallel.h"
#include "boxgrasp/decomposition/jury.h"
#include "boxgrasp/decomposition/splits.h"
#include "boxgrasp/decomposition/z_order.h"
#include "boxgrasp/geometry/min_volume_box.h"

namespace boxgrasp {
namespace {

void requireUsable(const PointCloud& cloud_C) {
  if (cloud_C.empty()) throw InputError("cannot decompose an empty cloud: it needs at least one point");
  for (std::size_t i = 0; i < cloud_C.size(); ++i) {
    if (!std::isfinite(cloud_C.x[i]) || !std::isfinite(cloud_C.y[i]) || !std::isfinite(cloud_C.z[i])) {
      throw InputError(
          fmt::format("cannot decompose a cloud whose point {} is "
                      "not finite: validate it first",
                      i));
    }
  }
}

// The points of a node, together in memory, with their indices in the cloud.
struct Part {
  PointCloud points_C;
  std::vector<std::uint32_t> indices;
  OrientedBox box;
};

Part partOf(PointCloud points_C, std::vector<std::uint32_t> indices) {
  return {std::move(points_C), std::move(indices), {}};
}

BoxNode nodeOf(const OrientedBox& box, int parent, int depth) {
  BoxNode node;
  node.box = box;
  node.parent = parent;
  node.depth = depth;
  return node;
}

using Parts = std::array<Part, 2>;

// Appends runs of a node's points to a part that has room for all that come.
class Filler {
 public:
  Filler(const Part& from, Part& to) : from_(from), to_(to) {}

  void append(std::size_t begin, std::size_t end) {
    const std::size_t count = end - begin;
    std::copy_n(&from_.points_C.x[begin], count, &to_.points_C.x[filled_]);
    std::copy_n(&from_.points_C.y[begin], count, &to_.points_C.y[filled_]);
    std::copy_n(&from_.points_C.z[begin], count, &to_.points_C.z[filled_]);
    std::copy_n(&from_.indices[begin], count, &to_.indices[filled_]);
    filled_ += count;
  }

 private:
  const Part& from_;
  Part& to_;
  std::size_t filled_ = 0;
};

// Both sides of the plane through a line on a face.
Parts divide(const Part& part, const FaceProjection& face, const Line& line) {
  const std::size_t n = part.indices.size(), first = countFirst(face, line);
  Parts parts;
  for (const std::size_t side : {0, 1}) {
    parts[side].points_C.resize(side == 0 ? first : n - first);
    parts[side].indices.resize(parts[side].points_C.size());
  }
  std::array<Filler, 2> fillers{Filler(part, parts[0]), Filler(part, parts[1])};
  for (std::size_t begin = 0, end = 0; begin < n; begin = end) {
    const bool is_first = line.isFirst(face.x[begin], face.y[begin]);
    while (end < n && line.isFirst(face.x[end], face.y[end]) == is_first) ++end;
    fillers[is_first ? 0 : 1].append(begin, end);
  }
  return parts;
}

// What became of the attempt to split a node.
struct Trial {
  double theta = -1.0;
  std::optional<Cut> cut;
  Parts parts;
  double volume = -1.0;    // of both parts' boxes
  bool fitted = false;     // else the parts have no boxes, which would have that volume at least
  std::string impossible;  // why there are no parts
};

// Grows the tree breadth first. The trials of one level do not depend on each other; what is made of them is
// decided in order.
class TreeBuilder {
 public:
  TreeBuilder(const PointCloud& cloud_C, const DecompositionOptions& options, const StopToken& stop)
      : cloud_C_(cloud_C), options_(options), stop_(stop) {}

  BoxTree build() {
    std::vector<std::uint32_t> order = zOrder(cloud_C_);
    PointCloud points_C = select(cloud_C_, order);
    std::vector<Part> level{partOf(std::move(points_C), std::move(order))};
    level[0].box = minVolumeBox(level[0].points_C, {}, stop_);
    tree_.nodes.push_back(nodeOf(level[0].box, -1, 0));
    volume_ = level[0].box.volume();
    for (int first = 0; !level.empty(); first = first_of_level_) level = nextLevel(first, std::move(level));
    givePoints();
    return std::move(tree_);
  }

 private:
  // Splits the nodes of a level, numbered from `first`; returns the parts of the next one.
  std::vector<Part> nextLevel(int first, std::vector<Part> level) {
    std::vector<Trial> trials(level.size());
    parallelFor(level.size(), options_.threads, [&](std::size_t i) { trials[i] = trySplit(level[i]); });
    first_of_level_ = static_cast<int>(tree_.nodes.size());
    std::vector<Part> next;
    for (std::size_t i = 0; i < level.size(); ++i) {
      const int index = first + static_cast<int>(i);
      tree_.nodes[index].stop_reason = decide(index, trials[i]);
      if (tree_.nodes[index].stop_reason.empty()) {
        for (Part& part : trials[i].parts) next.push_back(std::move(part));
      } else {
        leaves_of_.emplace_back(index, std::move(level[i].indices));
      }
    }
    return next;
  }

  Trial trySplit(const Part& part) const {
    Trial trial;
    stop_.check();
    trial.impossible = tooSmall(part);
    if (!trial.impossible.empty()) return trial;
    const PointCloud cloud_B = transformed(part.points_C, part.box.X_CB.inverse());
    FaceProjections faces;
    for (int axis = 0; axis < 3; ++axis) faces[axis] = projectionAlong(axis, part.box, cloud_B);
    const std::optional<BestLine> best = bestLine(faces);
    if (!best || best->theta >= options_.gain_t) {
      trial.impossible = fmt::format("no cut with enough points on both sides has a Theta below t = {:.3f}",
                                     options_.gain_t);
      return trial;
    }
    trial.theta = best->theta;
    trial.cut = cutAlong(best->line, best->face, part.box);
    trial.parts = divide(part, faces[best->face], best->line);
    fitBoxes(part.box.volume(), trial);
    return trial;
  }

  // Fits boxes to the parts, unless it is certain before they are found that they are not small enough: most
  // trials end so.
  void fitBoxes(double volume, Trial& trial) const {
    std::array<std::optional<BoxSearch>, 2> searches;
    std::array<bool, 2> goes_on{};
    parallelFor(2, options_.threads,
                [&](std::size_t i) { searches[i].emplace(trial.parts[i].points_C, stop_); });
    do {
      trial.volume = searches[0]->volumeAtLeast() + searches[1]->volumeAtLeast();
      if (gainOf(volume, trial.volume) >= options_.gain_t) return;
      parallelFor(2, options_.threads, [&](std::size_t i) { goes_on[i] = searches[i]->advance(stop_); });
    } while (goes_on[0] || goes_on[1]);
    for (const std::size_t i : {0, 1}) trial.parts[i].box = searches[i]->box();
    trial.volume = trial.parts[0].box.volume() + trial.parts[1].box.volume();
    trial.fitted = true;
  }

  // The gain where a box of a volume gives way to two of another in sum.
  double gainOf(double before, double after) const {
    return options_.gain == GainMeasure::local ? after / before : (volume_ - before + after) / volume_;
  }

  std::string tooSmall(const Part& part) const {
    if (part.indices.size() < static_cast<std::size_t>(options_.min_points))
      return fmt::format("{} points are fewer than {}", part.indices.size(), options_.min_points);
    if (part.box.extents[1] < options_.min_extent_m) {
      return fmt::format(
          "thinner than a finger: the second extent is {:.1f} "
          "mm, below {:.1f} mm",
          1e3 * part.box.extents[1], 1e3 * options_.min_extent_m);
    }
    return {};
  }

  std::optional<BestLine> bestLine(const FaceProjections& faces) const {
    return options_.split == SplitRule::hull ? bestHullLine(faces, options_, stop_)
                                             : bestBoundLine(faces, options_);
  }

  // Makes the split, or says why not.
  std::string decide(int index, Trial& trial) {
    if (!trial.impossible.empty()) return trial.impossible;
    BoxNode& node = tree_.nodes[index];
    const int depth = node.depth + 1;
    node.theta = trial.theta;
    node.cut = trial.cut;
    const double before = node.box.volume();
    if (!trial.fitted && gainOf(before, trial.volume) < options_.gain_t) fitBoxes(before, trial);
    node.volume_gain = trial.volume / before;
    const double gain = gainOf(before, trial.volume);
    if (gain >= options_.gain_t) {
      return fmt::format("volume gain {}{:.3f} is not below t = {:.3f}", trial.fitted ? "" : "of at least ",
                         gain, options_.gain_t);
    }
    if (leaves_ == options_.max_leaves) return fmt::format("there are {} boxes already", leaves_);
    volume_ += trial.volume - before;
    ++leaves_;
    node.first = static_cast<int>(tree_.nodes.size());
    node.second = node.first + 1;
    for (const Part& part : trial.parts) tree_.nodes.push_back(nodeOf(part.box, index, depth));
    return {};
  }

  // Gives all points to the root, and each node's points to its children, in ascending order.
  void givePoints() {
    std::vector<int> leaf_of(cloud_C_.size());
    std::vector<std::size_t> sizes(tree_.nodes.size(), 0);
    for (const auto& [leaf, indices] : leaves_of_) {
      for (const std::uint32_t index : indices) leaf_of[index] = leaf;
      for (int node = leaf; node >= 0; node = tree_.nodes[node].parent) sizes[node] += indices.size();
    }
    for (std::size_t node = 0; node < sizes.size(); ++node) tree_.nodes[node].points.resize(sizes[node]);
    std::iota(tree_.nodes[0].points.begin(), tree_.nodes[0].points.end(), 0u);
    for (const BoxNode& node : tree_.nodes) {
      if (!node.leaf()) partPoints(node, leaf_of);
    }
  }

  void partPoints(const BoxNode& node, const std::vector<int>& leaf_of) {
    std::vector<char> is_first(tree_.nodes.size());  // of leaves: below the first child
    for (const auto& [leaf, indices] : leaves_of_) {
      int above = leaf;
      while (above > node.first) above = tree_.nodes[above].parent;  // children stand behind their parents
      is_first[leaf] = above == node.first ? 1 : 0;
    }
    std::uint32_t* first = tree_.nodes[node.first].points.data();
    std::uint32_t* second = tree_.nodes[node.second].points.data();
    for (const std::uint32_t index : node.points) {
      std::uint32_t*& to = is_first[leaf_of[index]] ? first : second;
      *to++ = index;
    }
  }

  const PointCloud& cloud_C_;
  const DecompositionOptions& options_;
  const StopToken& stop_;
  BoxTree tree_;
  std::vector<std::pair<int, std::vector<std::uint32_t>>> leaves_of_;
  int first_of_level_ = 0;  // the first node of the next level
  double volume_ = 0.0;     // summed over the present leaves
  int leaves_ = 1;
};

}  // namespace

void DecompositionOptions::validate() const {
  requireOption(gain_t > 0 && gain_t <= 1, "gain_t", gain_t, "in (0, 1]");
  requireOption(segment_fraction >= 0 && segment_fraction < 1, "segment_fraction", segment_fraction,
                "in [0, 1)");
  requireOption(samples_per_segment >= 1 && samples_per_segment <= 100, "samples_per_segment",
                samples_per_segment, "in [1, 100]");
  requireOption(merge_angle_rad >= 0 && merge_angle_rad < 1, "merge_angle_rad", merge_angle_rad, "in [0, 1)");
  requireOption(min_point_fraction >= 0 && min_point_fraction < 0.5, "min_point_fraction", min_point_fraction,
                "in [0, 0.5)");
  requireOption(min_points >= 2, "min_points", min_points, "at least 2");
  requireOption(min_extent_m >= 0, "min_extent_m", min_extent_m, "at least 0");
  requireOption(bound_step_m > 1e-6, "bound_step_m", bound_step_m, "above 1e-6");
  requireOption(max_leaves >= 1, "max_leaves", max_leaves, "at least 1");
  requireOption(jurors >= 1 && jurors <= 99, "jurors", jurors, "in [1, 99]");
  requireOption(resolution_fraction >= 0.005 && resolution_fraction <= 0.2, "resolution_fraction",
                resolution_fraction, "in [0.005, 0.2]");
  requireOption(threads >= 0, "threads", threads, "at least 0");
}

BoxTree decompose(const PointCloud& cloud_C, const DecompositionOptions& options, const StopToken& stop) {
  options.validate();
  requireUsable(cloud_C);
  stop.check();
  if (options.split == SplitRule::robust) return juryTree(cloud_C, options, stop);
  return TreeBuilder(cloud_C, options, stop).build();
}

}  // namespace boxgrasp
