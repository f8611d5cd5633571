#include "boxgrasp/projection/graspable_faces.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

constexpr double kBlockCell_m = 0.005;      // edge of the cells in which the swept square is counted
constexpr double kFaceThickness_m = 0.003;  // points this near the plane belong to the face
constexpr double kJustOutside_m =
    0.002;                          // where a face is tested for neighbours, and how much these are grown
constexpr int kSharedSamples = 12;  // samples along each edge of a face

bool near(const Face& face, const OrientedBox& box) {
  const double reach = 0.5 * (face.size.norm() + box.extents.norm()) + 2.0 * kJustOutside_m;
  return (box.X_CB.translation() - face.X_CF.translation()).norm() <= reach;
}

bool isWithin(const BoxTree& tree, int node, int ancestor) {
  while (node >= 0 && node != ancestor) node = tree.nodes[node].parent;
  return node == ancestor;
}

// The leaf boxes near a face that are not part of its own box.
std::vector<const OrientedBox*> neighbours(const Face& face, const BoxTree& tree) {
  std::vector<const OrientedBox*> boxes;
  for (const int leaf : tree.leaves()) {
    const OrientedBox& box = tree.nodes[leaf].box;
    if (near(face, box) && !isWithin(tree, leaf, face.node)) boxes.push_back(&box);
  }
  return boxes;
}

bool inAny(const std::vector<const OrientedBox*>& boxes, const Vector3d& p_C) {
  return std::any_of(boxes.begin(), boxes.end(),
                     [&](const OrientedBox* box) { return box->contains(p_C, kJustOutside_m); });
}

double coveredFraction(const Face& face, const BoxTree& tree) {
  const auto boxes = neighbours(face, tree);
  if (boxes.empty()) return 0.0;
  int covered = 0;
  for (int i = 0; i < kSharedSamples; ++i) {
    for (int j = 0; j < kSharedSamples; ++j) {
      const Vector2d at = Vector2d(i + 0.5, j + 0.5) / kSharedSamples - Vector2d(0.5, 0.5);
      const Vector3d p_F(at.x() * face.size.x(), at.y() * face.size.y(), -kJustOutside_m);
      covered += inAny(boxes, face.X_CF * p_F);
    }
  }
  return static_cast<double>(covered) / (kSharedSamples * kSharedSamples);
}

// Just outside of an edge there is nothing to tell an inside of the object from an outside: its two faces do.
double sharedFraction(const Face& face, const BoxTree& tree) {
  if (!isEdge(face.number)) return coveredFraction(face, tree);
  double most = 0.0;
  for (const int number : facesBeside(face.number))
    most = std::max(most, coveredFraction(faceOf(tree.nodes[face.node].box, face.node, number), tree));
  return most;
}

bool isBlocked(const Face& face, const PointGrid& scene, const FaceOptions& options) {
  const double half = 0.5 * options.hand_width_m;
  const Eigen::AlignedBox3d swept_F(Vector3d(-half, -half, -options.hand_depth_m),
                                    Vector3d(half, half, -kFaceThickness_m));
  const int cells = static_cast<int>(std::ceil(options.hand_width_m / kBlockCell_m));
  std::vector<bool> occupied(static_cast<std::size_t>(cells) * cells, false);
  const double allowed = options.max_blocked_fraction * static_cast<double>(occupied.size());
  const Pose X_FC = face.X_CF.inverse();
  int count = 0;
  return scene.visitBox(swept_F.transformed(face.X_CF), [&](std::uint32_t i) {
    const Vector3d p_F = X_FC * scene.cloud().point(i);
    if (!swept_F.contains(p_F)) return false;
    const int column = std::min(cells - 1, static_cast<int>((p_F.x() + half) / kBlockCell_m));
    const int row = std::min(cells - 1, static_cast<int>((p_F.y() + half) / kBlockCell_m));
    auto cell = occupied[static_cast<std::size_t>(row) * cells + column];
    if (cell) return false;
    cell = true;
    return ++count > allowed;
  });
}

FaceRejection rejectionOfSize(const Face& face, const FaceOptions& options) {
  if (face.size.y() > options.max_aperture_m) return FaceRejection::too_wide;
  if (face.size.y() < options.min_width_m) return FaceRejection::too_narrow;
  if (face.depth_m < options.min_depth_m) return FaceRejection::too_shallow;
  return FaceRejection::none;
}

FaceRejection rejectionOfDirection(const Face& face, const Surroundings& surroundings,
                                   const FaceOptions& options) {
  const Vector3d outward_C = -face.X_CF.linear().col(2);
  const Viewpoints& viewpoints_C = surroundings.viewpoints_C;
  if (!viewpoints_C.empty() && !facesASensor(face.X_CF.translation(), outward_C, viewpoints_C))
    return FaceRejection::hidden;
  if (surroundings.gravity_C && outward_C.dot(*surroundings.gravity_C) > options.max_support_cosine)
    return FaceRejection::supported;
  return FaceRejection::none;
}

FaceRejection rejectionOf(const Face& face, const BoxTree& tree, const PointGrid& scene,
                          const Surroundings& surroundings, const FaceOptions& options) {
  const FaceRejection size = rejectionOfSize(face, options);
  if (size != FaceRejection::none) return size;
  const FaceRejection direction = rejectionOfDirection(face, surroundings, options);
  if (direction != FaceRejection::none) return direction;
  if (sharedFraction(face, tree) > options.max_shared_fraction) return FaceRejection::shared;
  return isBlocked(face, scene, options) ? FaceRejection::blocked : FaceRejection::none;
}

}  // namespace

std::string_view describe(FaceRejection rejection) {
  switch (rejection) {
    case FaceRejection::none:
      return "face graspable";
    case FaceRejection::blocked:
      return "face blocked by other points";
    case FaceRejection::shared:
      return "face covered by a neighbouring box";
    case FaceRejection::hidden:
      return "face turned away from the sensor";
    case FaceRejection::supported:
      return "face towards the ground";
    case FaceRejection::too_wide:
      return "face wider than the hand opens";
    case FaceRejection::too_narrow:
      return "face too narrow for a finger";
    case FaceRejection::not_allowed:
      return "face from where the robot may not come";
    case FaceRejection::too_shallow:
      return "box too shallow under the face";
  }
  assert(false);
  return "";
}

void FaceOptions::validate() const {
  requireOption(max_aperture_m > 0.0, "faces.max_aperture_m", max_aperture_m, "above 0");
  requireOption(min_width_m >= 0.0, "faces.min_width_m", min_width_m, "at least 0");
  requireOption(min_depth_m >= 0.0, "faces.min_depth_m", min_depth_m, "at least 0");
  requireOption(hand_width_m >= kBlockCell_m && hand_width_m <= 10.0, "faces.hand_width_m", hand_width_m,
                "in [0.005, 10]");
  requireOption(hand_depth_m > kFaceThickness_m, "faces.hand_depth_m", hand_depth_m, "above 0.003");
  requireOption(max_blocked_fraction >= 0.0 && max_blocked_fraction <= 1.0, "faces.max_blocked_fraction",
                max_blocked_fraction, "in [0, 1]");
  requireOption(max_shared_fraction >= 0.0 && max_shared_fraction <= 1.0, "faces.max_shared_fraction",
                max_shared_fraction, "in [0, 1]");
  requireOption(max_support_cosine >= -1.0 && max_support_cosine <= 1.0, "faces.max_support_cosine",
                max_support_cosine, "in [-1, 1]");
}

std::vector<FaceDecision> graspableFaces(const BoxTree& tree, const PointCloud& cloud_C,
                                         const PointGrid& scene, const Surroundings& surroundings,
                                         const FaceOptions& options, const StopToken& stop) {
  options.validate();
  std::vector<FaceDecision> decisions;
  for (int node = 0; node < static_cast<int>(tree.nodes.size()); ++node) {
    if (!options.inner_boxes && !tree.nodes[node].leaf()) continue;
    for (const Face& face : facesOf(tree, node, cloud_C, options.edges == EdgeUse::always)) {
      stop.check();
      decisions.push_back({face, rejectionOf(face, tree, scene, surroundings, options)});
    }
  }
  return decisions;
}

}  // namespace boxgrasp
