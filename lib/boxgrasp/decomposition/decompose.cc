#include "boxgrasp/decomposition/decompose.h"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/parallel.h"
#include "boxgrasp/decomposition/splits.h"
#include "boxgrasp/geometry/min_volume_box.h"

namespace boxgrasp {
namespace {

void requireUsable(const PointCloud& cloud_C) {
  if (cloud_C.empty()) throw InputError("cannot decompose an empty cloud: it needs at least one point");
  for (std::size_t i = 0; i < cloud_C.size(); ++i) {
    if (!std::isfinite(cloud_C.x[i]) || !std::isfinite(cloud_C.y[i]) || !std::isfinite(cloud_C.z[i])) {
      throw InputError(
          fmt::format("cannot decompose a cloud whose point {} is not finite: validate it first", i));
    }
  }
}

BoxNode nodeOf(const PointCloud& cloud_C, std::vector<std::uint32_t> points, int parent, int depth,
               const StopToken& stop) {
  BoxNode node;
  node.box = minVolumeBox(select(cloud_C, points), {}, stop);
  node.parent = parent;
  node.depth = depth;
  node.points = std::move(points);
  return node;
}

// Grows the tree breadth first: one node after the other is split or becomes a leaf with a reason.
class TreeBuilder {
 public:
  TreeBuilder(const PointCloud& cloud_C, const DecompositionOptions& options, const StopToken& stop)
      : cloud_C_(cloud_C), options_(options), stop_(stop) {}

  BoxTree build() {
    std::vector<std::uint32_t> all(cloud_C_.size());
    std::iota(all.begin(), all.end(), 0u);
    tree_.nodes.push_back(nodeOf(cloud_C_, std::move(all), -1, 0, stop_));
    volume_ = tree_.nodes.front().box.volume();
    for (std::size_t i = 0; i < tree_.nodes.size(); ++i) {
      stop_.check();
      tree_.nodes[i].stop_reason = splitOrReason(static_cast<int>(i));
    }
    return std::move(tree_);
  }

 private:
  // Splits the node and returns nothing, or says why it stays whole.
  std::string splitOrReason(int index) {
    if (std::string reason = tooSmall(tree_.nodes[index]); !reason.empty()) return reason;
    std::optional<Split> split = bestSplit(tree_.nodes[index]);
    if (!split) return "no cut between long segments of the hull leaves enough points on both sides";
    tree_.nodes[index].theta = split->theta;
    tree_.nodes[index].cut = split->cut;
    if (split->theta >= options_.gain_t)
      return fmt::format("Theta* {:.3f} is not below t = {:.3f}", split->theta, options_.gain_t);
    return tryChildren(index, std::move(*split));
  }

  std::string tooSmall(const BoxNode& node) const {
    if (node.points.size() < static_cast<std::size_t>(options_.min_points)) {
      return fmt::format("{} points are fewer than {}", node.points.size(), options_.min_points);
    }
    if (node.box.extents[1] < options_.min_extent_m)
      return fmt::format("{:.1f} mm is thinner than a finger", 1e3 * node.box.extents[1]);
    return {};
  }

  std::optional<Split> bestSplit(const BoxNode& node) const {
    FaceProjections faces;
    parallelFor(faces.size(), options_.threads,
                [&](std::size_t axis) { faces[axis] = projectNode(cloud_C_, node, static_cast<int>(axis)); });
    const std::optional<BestLine> best = options_.split == SplitRule::hull
                                             ? bestHullLine(faces, options_, stop_)
                                             : bestBoundLine(faces, options_);
    if (!best) return std::nullopt;
    return splitBy(faces[best->face], best->line, best->theta, node.points);
  }

  std::string tryChildren(int index, Split split) {
    std::array<std::vector<std::uint32_t>, 2> points{std::move(split.first), std::move(split.second)};
    std::array<BoxNode, 2> children;
    parallelFor(2, options_.threads, [&](std::size_t i) {
      children[i] = nodeOf(cloud_C_, std::move(points[i]), index, tree_.nodes[index].depth + 1, stop_);
    });
    const double before = tree_.nodes[index].box.volume(),
                 after = children[0].box.volume() + children[1].box.volume();
    tree_.nodes[index].volume_gain = after / before;
    const double gain =
        options_.gain == GainMeasure::local ? after / before : (volume_ - before + after) / volume_;
    if (gain >= options_.gain_t)
      return fmt::format("volume gain {:.3f} is not below t = {:.3f}", gain, options_.gain_t);
    if (leaves_ == options_.max_leaves) return fmt::format("there are {} boxes already", leaves_);
    volume_ += after - before;
    ++leaves_;
    adopt(index, children);
    return {};
  }

  void adopt(int index, std::array<BoxNode, 2>& children) {
    tree_.nodes[index].first = static_cast<int>(tree_.nodes.size());
    tree_.nodes[index].second = tree_.nodes[index].first + 1;
    for (BoxNode& child : children) tree_.nodes.push_back(std::move(child));
  }

  const PointCloud& cloud_C_;
  const DecompositionOptions& options_;
  const StopToken& stop_;
  BoxTree tree_;
  double volume_ = 0.0;  // summed over the present leaves
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
  requireOption(threads >= 0, "threads", threads, "at least 0");
}

BoxTree decompose(const PointCloud& cloud_C, const DecompositionOptions& options, const StopToken& stop) {
  options.validate();
  requireUsable(cloud_C);
  stop.check();
  return TreeBuilder(cloud_C, options, stop).build();
}

}  // namespace boxgrasp
