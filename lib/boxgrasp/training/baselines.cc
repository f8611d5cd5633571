#include "boxgrasp/training/baselines.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/projection/graspable_faces.h"

namespace boxgrasp {
namespace {

constexpr int kRolls = 4;
constexpr std::array<double, 2> kSpreads{0.0, std::numbers::pi / 3};
constexpr double kSceneCell_m = 0.010;  // of the grid over the cloud: about a link's radius
constexpr int kJointSteps = 256;        // over a finger's range: its height is then exact to 10 micrometres

HandJoints openHand(const HandDescription& hand, double spread) {
  return {std::clamp(spread, hand.spread_min, hand.spread_max),
          {hand.inner_min, hand.inner_min, hand.inner_min}};
}

HypothesisRecord hypothesis(GraspSource source, int index, const Pose& X_OP, const HandJoints& open) {
  HypothesisRecord record;
  record.source = source;
  record.index = index;
  record.X_OP = X_OP;
  record.joints = record.pregrasp = open;
  record.quality.fill(NAN);
  return record;
}

// From the pose back to where the whole hand is before the object: the corners bound the object.
template <typename Points>
double clearWay(const HandDescription& hand, const Pose& X_OP, const Points& corners_O) {
  const Vector3d approach_O = X_OP.linear().col(2);
  double farthest = 0.0;
  for (const Vector3d& corner_O : corners_O)
    farthest = std::max(farthest, approach_O.dot(X_OP.translation() - corner_O));
  return farthest + fingerReachHeight(hand);
}

// Uniform over the unit sphere.
Vector3d randomDirection(std::mt19937_64& random) {
  const double z = uniform(random, -1.0, 1.0), turn = uniform(random, 0.0, 2 * std::numbers::pi);
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

// Turned about the approach by `roll` from some fixed axes.
Matrix3d palmAxes(const Vector3d& approach, double roll) {
  const Vector3d u = approach.unitOrthogonal(), v = approach.cross(u);
  Matrix3d axes;
  axes.col(0) = std::cos(roll) * u + std::sin(roll) * v;
  axes.col(1) = approach.cross(axes.col(0));
  axes.col(2) = approach;
  return axes;
}

struct SurfacePoint {
  Vector3d p_O, outward_O;
};

// Draws points of a mesh, uniform by area.
class Surface {
 public:
  explicit Surface(const TriangleMesh& mesh) : mesh_(mesh) {
    double area = 0.0;
    for (const auto& triangle : mesh.triangles) areas_.push_back(area += 0.5 * cross(triangle).norm());
    if (!(area > 0)) throw InputError("the mesh has no triangle of positive area");
  }

  SurfacePoint draw(std::mt19937_64& random) const {
    const double at = uniform(random) * areas_.back();
    const auto chosen = std::upper_bound(areas_.begin(), areas_.end(), at);
    const auto& triangle = mesh_.triangles[static_cast<std::size_t>(chosen - areas_.begin())];
    const double root = std::sqrt(uniform(random)), along = uniform(random);
    const auto& v = mesh_.vertices;
    return {(1 - root) * v[triangle[0]] + root * ((1 - along) * v[triangle[1]] + along * v[triangle[2]]),
            cross(triangle).normalized()};
  }

 private:
  Vector3d cross(const std::array<std::uint32_t, 3>& triangle) const {
    const auto& v = mesh_.vertices;
    return (v[triangle[1]] - v[triangle[0]]).cross(v[triangle[2]] - v[triangle[0]]);
  }

  const TriangleMesh& mesh_;
  std::vector<double> areas_;  // up to and with each triangle
};

std::vector<Face> graspableLeafFaces(const BoxTree& tree, const PointCloud& cloud) {
  FaceOptions options;
  options.inner_boxes = false;
  std::vector<Face> faces;
  for (const FaceDecision& decision :
       graspableFaces(tree, cloud, PointGrid(cloud, kSceneCell_m), {}, options)) {
    if (decision.graspable()) faces.push_back(decision.face);
  }
  return faces;
}

}  // namespace

double fingerReachHeight(const HandDescription& hand) {
  double highest = 0.0;
  for (int i = 0; i <= kJointSteps; ++i) {
    const double inner = hand.inner_min + (hand.inner_max - hand.inner_min) * i / kJointSteps;
    highest = std::max(highest, tipHeight(hand, inner) + hand.tip_radius);
  }
  return highest;
}

std::vector<HypothesisRecord> randomHypotheses(const HandDescription& hand, const TriangleMesh& mesh_O, int n,
                                               std::uint64_t seed) {
  requireOption(n >= 0, "the number of random grasps", n, "at least 0");
  const Surface surface(mesh_O);
  const double reach = fingerReachHeight(hand);
  std::mt19937_64 random(seed);
  std::vector<HypothesisRecord> records;
  for (int i = 0; i < n; ++i) {
    const SurfacePoint aim = surface.draw(random);
    const Vector3d direction_O = randomDirection(random);
    const Vector3d approach_O = direction_O.dot(aim.outward_O) > 0 ? Vector3d(-direction_O) : direction_O;
    const double roll = uniform(random, 0.0, 2 * std::numbers::pi);
    const HandJoints open = openHand(hand, uniform(random, hand.spread_min, hand.spread_max));
    const double distance = uniform(random, 0.0, reach);
    const Pose X_OP = makePose(palmAxes(approach_O, roll), aim.p_O - distance * approach_O);
    records.push_back(hypothesis(GraspSource::random, i, X_OP, open));
    records.back().approach_m = clearWay(hand, X_OP, mesh_O.vertices);
  }
  return records;
}

std::vector<HypothesisRecord> approachHypotheses(const HandDescription& hand, const BoxTree& tree_O,
                                                 const PointCloud& cloud_O) {
  std::vector<HypothesisRecord> records;
  for (const Face& face : graspableLeafFaces(tree_O, cloud_O)) {
    for (const double spread : kSpreads) {
      for (int roll = 0; roll < kRolls; ++roll) {
        const Pose X_FP = Eigen::Translation3d(0, 0, 0.5 * face.depth_m) *
                          Pose(Eigen::AngleAxisd(roll * std::numbers::pi / 2, Vector3d::UnitZ()));
        const Pose X_OP = face.X_CF * X_FP;
        HypothesisRecord record =
            hypothesis(GraspSource::approach, static_cast<int>(records.size()), X_OP, openHand(hand, spread));
        record.approach_m = clearWay(hand, X_OP, tree_O.nodes.front().box.corners());
        record.box = face.node;
        record.face = face.number;
        records.push_back(record);
      }
    }
  }
  return records;
}

TrialInput trialInput(const HypothesisRecord& hypothesis) {
  TrialInput input;
  input.X_OP = hypothesis.X_OP;
  input.pregrasp = hypothesis.pregrasp;
  input.approach_m = hypothesis.approach_m;
  return input;
}

}  // namespace boxgrasp
