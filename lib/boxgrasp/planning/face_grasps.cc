#include "boxgrasp/planning/face_grasps.h"

#include <fmt/format.h>

#include <algorithm>

#include "boxgrasp/synthesis/pinches.h"
#include "boxgrasp/synthesis/round_outline.h"
#include "boxgrasp/wrench/grasp_wrench_space.h"

namespace boxgrasp {
namespace {

FaceImage imageOf(const FaceWork& work, const Face& face, Tally& tally) {
  const StageTimer timer(tally, StageId::images);
  const auto& points = work.object.tree.nodes[face.node].points;
  const FaceImage raw =
      projectFace(face, work.object.cloud_C, points, work.object.spacing_m, work.options.image);
  FaceImage image = filled(raw, work.options.contours);
  const bool occupied = std::any_of(image.gray.begin(), image.gray.end(), [](auto g) { return g > 0; });
  tally.count(StageId::images, 1, occupied);
  if (!occupied) tally.reject("image without connected points");
  return image;
}

std::vector<Region> regionsOf(const FaceWork& work, const FaceImage& image, Tally& tally, FaceTrace* trace) {
  const StageTimer timer(tally, StageId::regions);
  const std::vector<Contour> contours = findContours(image, work.options.contours);
  std::vector<Region> regions = findRegions(contours, work.options.regions);
  tally.count(StageId::regions, contours.size(), regions.size());
  if (trace) trace->contours = contours;
  return regions;
}

// The outline of a leaf that is a sphere, or a cylinder seen along its axis.
std::optional<Circle> roundOutline(const FaceWork& work, const Face& face) {
  const BoxShape shape = work.object.shapeOf(static_cast<std::size_t>(face.node));
  const bool along = std::abs(shape.axis_C.dot(face.X_CF.linear().col(2))) > 0.99;
  if (shape.kind != ShapeKind::sphere && !(shape.kind == ShapeKind::cylinder && along)) return std::nullopt;
  const Vector3d center_F = face.X_CF.inverse() * shape.center_C;
  return Circle{center_F.head<2>(), shape.radius_m};
}

std::vector<Triplet> tripletsOf(const FaceWork& work, const Face& face, const FaceImage& image,
                                const std::vector<Region>& regions, Tally& tally) {
  const StageTimer timer(tally, StageId::triplets);
  TripletOptions options = work.options.triplets;
  Triplets found;
  if (work.hand.prismatic()) {
    options.end_margin_m = std::min(options.end_margin_m, work.hand.tip_radius);  // of half a pad
  } else {
    found = findTriplets(regions, image, options, work.stop);
  }
  if (options.pinches || work.hand.prismatic()) {
    const std::vector<Triplet> pinches =
        findPinches(regions, image, 2 * work.hand.spread_offset, options, work.stop);
    found.triplets.insert(found.triplets.end(), pinches.begin(), pinches.end());
  }
  if (work.options.shapes.snap) {
    if (const auto circle = roundOutline(work, face)) snapToCircle(*circle, image, options, found.triplets);
  }
  tally.count(StageId::triplets, std::max(found.counts.considered, found.triplets.size()),
              found.triplets.size());
  tally.reject("triplet: normals do not span the plane", found.counts.not_spanning);
  tally.reject("triplet: friction cones do not meet", found.counts.cones_apart);
  tally.reject("triplet: focus outside the finger points", found.counts.focus_outside);
  tally.reject("triplet: more than max_triplets", found.counts.over_limit);
  return std::move(found.triplets);
}

Configurations configurationsOf(const FaceWork& work, const std::vector<Triplet>& triplets, Tally& tally) {
  const StageTimer timer(tally, StageId::configurations);
  ConfigurationOptions options = work.options.configurations;
  options.depth_model = work.options.depth_model;
  const Reach reach = fingerReach(work.hand);
  Configurations all;
  for (std::size_t i = 0; i < triplets.size(); ++i) {
    work.stop.check();
    Configurations found = findConfigurations(work.hand, reach, triplets[i], static_cast<int>(i), options);
    if (found.configurations.empty()) tally.reject("triplet: no hand configuration reaches it");
    std::move(found.configurations.begin(), found.configurations.end(),
              std::back_inserter(all.configurations));
    for (std::size_t r = 0; r < all.rejected.size(); ++r) all.rejected[r] += found.rejected[r];
    all.merged += found.merged;
  }
  tally.count(StageId::configurations, triplets.size(), all.configurations.size());
  for (std::size_t r = 0; r < all.rejected.size(); ++r) {
    tally.reject(describe(static_cast<ReachRejection>(r)), all.rejected[r]);
  }
  tally.reject("configuration: nearly the same as another of its triplet", all.merged);
  return all;
}

Grasp graspFrom(const FaceWork& work, const Face& face, const Triplet& triplet,
                const HandConfiguration& configuration) {
  Grasp grasp;
  grasp.X_CP = face.X_CF * configuration.X_FP;
  grasp.joints = configuration.joints;
  grasp.approach_C = grasp.X_CP.linear().col(2);
  grasp.object = work.object_index;
  grasp.box = face.node;
  grasp.face = face.number;
  grasp.configuration = configuration;
  grasp.triplet = triplet;
  return grasp;
}

// No sensor saw the surface under a contact whose nearest point was guessed.
void markGuessed(const FaceWork& work, Grasp& grasp) {
  const std::size_t seen = work.object.cloud_C.size() - work.object.guessed;
  for (SurfaceContact& contact : grasp.contacts) {
    const auto nearest = work.object_grid_C.nearest(contact.p_C, work.options.contacts.normal_radius_m);
    if (!nearest || *nearest >= seen) contact.seen = false;
  }
}

// The fingers' angles as they are in space, and what follows from them.
void followJoints(const HandDescription& hand, Grasp& grasp) {
  HandConfiguration& configuration = grasp.configuration;
  configuration.joints = grasp.joints;
  for (std::size_t finger = 0; finger < 3; ++finger) {
    const double inner = grasp.joints.inner[finger];
    configuration.extension_m[finger] = extension(hand, inner);
    configuration.tip_height_m[finger] = tipHeight(hand, inner);
    configuration.depth_m[finger] = configuration.tip_height_m[finger] + configuration.X_FP.translation().z();
  }
}

bool touchesSurface(const FaceWork& work, const Face& face, TouchedSurface& surface_C, Grasp& grasp,
                    Tally& tally) {
  const StageTimer timer(tally, StageId::contacts);
  Contacts found = findContacts(face, grasp.triplet, grasp.configuration, surface_C, work.viewpoints_C);
  if (work.options.contacts.meet_surface && !work.hand.prismatic() && !found.rejection) {
    found = meetSurface(work.hand, grasp.X_CP, grasp.joints, found, surface_C);
    followJoints(work.hand, grasp);
  }
  tally.count(StageId::contacts, 1, !found.rejection);
  if (found.rejection) tally.reject(describe(*found.rejection));
  grasp.contacts = found.contacts;
  if (work.object.guessed > 0) markGuessed(work, grasp);
  return !found.rejection;
}

bool holdsByForce(const FaceWork& work, const Grasp& grasp, Tally& tally) {
  if (work.options.force_closure == ForceClosureUse::ignore) return true;
  const StageTimer timer(tally, StageId::force_closure);
  const OrientedBox& root = work.object.tree.nodes.front().box;
  WrenchOptions wrench;
  wrench.friction = work.options.triplets.friction;
  wrench.p_CG = root.X_CB.translation();
  wrench.torque_scale_m = root.extents.norm() / 2;
  std::vector<Contact> contacts;
  for (const SurfaceContact& c : grasp.contacts) contacts.push_back({c.p_C, c.normal_C});
  const bool holds = forceClosure(contacts, wrench);
  tally.count(StageId::force_closure, 1, holds);
  if (!holds) tally.reject("contacts not in force closure");
  return holds;
}

// All points that a hand in any of the grasps could meet, sorted along the approach.
ApproachColumns columnsOf(const FaceWork& work, const Face& face, const std::vector<Grasp>& grasps,
                          Tally& tally) {
  const StageTimer timer(tally, StageId::clearance);
  Eigen::AlignedBox3d origins_F;
  for (const Grasp& grasp : grasps) origins_F.extend(grasp.configuration.X_FP.translation());
  return {work.scene_grid_C, face.X_CF, reachableRegion(work.hand, origins_F, work.options.clearance)};
}

bool isClear(const FaceWork& work, const ApproachColumns& scene_F, Grasp& grasp, Tally& tally) {
  const StageTimer timer(tally, StageId::clearance);
  const Clearance clearance =
      testClearance(work.hand, grasp.configuration.X_FP, grasp.joints, scene_F, work.options.clearance);
  tally.count(StageId::clearance, 1, clearance.pregrasp.has_value());
  if (clearance.pregrasp) grasp.pregrasp = *clearance.pregrasp;
  if (clearance.collision) {
    tally.reject(fmt::format("{} meets a point {}", clearance.collision->link, clearance.collision->phase));
  }
  return clearance.pregrasp.has_value();
}

// The way in and the way out.
void addMotion(const FaceWork& work, Grasp& grasp) {
  grasp.X_CP_pregrasp = grasp.X_CP_lift = grasp.X_CP;
  grasp.X_CP_pregrasp.translation() -= work.options.clearance.approach_m * grasp.approach_C;
  grasp.X_CP_lift.translation() -= work.options.robot.lift_m * work.gravity_C.value_or(grasp.approach_C);
}

bool isInReach(const FaceWork& work, const Grasp& grasp, Tally& tally) {
  if (!work.robot.restrictsReach()) return true;
  const StageTimer timer(tally, StageId::reach);
  const auto obstacle = work.robot.obstacle(
      work.hand, {grasp.X_CP_pregrasp, grasp.X_CP, grasp.X_CP_lift, grasp.pregrasp, grasp.joints},
      work.options.clearance.closing_steps);
  tally.count(StageId::reach, 1, !obstacle);
  if (obstacle) tally.reject(*obstacle);
  return !obstacle;
}

Vector2d shapeCentroid(const FaceImage& image) {
  Vector2d sum = Vector2d::Zero();
  double n = 0;
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      if (image.at(column, row) == 0) continue;
      sum += Vector2d(column, row);
      ++n;
    }
  }
  return image.toFace(sum / n);
}

QualityMeasures measure(const FaceWork& work, const Grasp& grasp, const Vector2d& shape_centroid_F) {
  GraspGeometry geometry;
  for (int finger = 0; finger < 3; ++finger) {
    const int point = grasp.configuration.point_of_finger[finger];
    geometry.points_F[finger] = grasp.triplet.points_F[point];
    geometry.normals_F[finger] = grasp.triplet.normals_F[point];
    geometry.surface_depth_m[finger] = grasp.triplet.nearest_depth_m[point];
    geometry.contacts_C[finger] = grasp.contacts[finger].p_C;
  }
  geometry.push_F = grasp.configuration.push_F;
  geometry.extension_m = grasp.configuration.extension_m;
  geometry.tip_height_m = grasp.configuration.tip_height_m;
  geometry.spread = grasp.joints.spread;
  geometry.focus_F = grasp.triplet.focus_F;
  geometry.shape_centroid_F = shape_centroid_F;
  geometry.root_center_C = work.object.tree.nodes.front().box.X_CB.translation();
  return qualityMeasures(geometry, work.hand, work.options.depth_model);
}

// The grasps of the configurations that hold the object by its surface.
std::vector<Grasp> holdingGrasps(const FaceWork& work, const Face& face, const std::vector<Triplet>& triplets,
                                 const std::vector<HandConfiguration>& configurations, Tally& tally) {
  TouchedSurface surface_C(work.object_grid_C, work.object.spacing_m, work.options.contacts);
  std::vector<Grasp> grasps;
  for (const HandConfiguration& configuration : configurations) {
    work.stop.check();
    Grasp grasp = graspFrom(work, face, triplets[configuration.triplet], configuration);
    if (touchesSurface(work, face, surface_C, grasp, tally) && holdsByForce(work, grasp, tally))
      grasps.push_back(std::move(grasp));
  }
  return grasps;
}

// Those to which the hand can come.
std::vector<Grasp> clearGrasps(const FaceWork& work, const Face& face, std::vector<Grasp> grasps,
                               Tally& tally) {
  if (grasps.empty()) return {};
  const ApproachColumns scene_F = columnsOf(work, face, grasps, tally);
  std::vector<Grasp> clear;
  for (Grasp& grasp : grasps) {
    work.stop.check();
    if (!isClear(work, scene_F, grasp, tally)) continue;
    addMotion(work, grasp);
    if (isInReach(work, grasp, tally)) clear.push_back(std::move(grasp));
  }
  return clear;
}

}  // namespace

std::vector<Grasp> graspsOnFace(const FaceWork& work, const Face& face, Tally& tally, FaceTrace* trace) {
  work.stop.check();
  FaceImage image = imageOf(work, face, tally);
  std::vector<Region> regions = regionsOf(work, image, tally, trace);
  std::vector<Triplet> triplets = tripletsOf(work, face, image, regions, tally);
  const std::vector<HandConfiguration> configurations =
      configurationsOf(work, triplets, tally).configurations;
  std::vector<Grasp> grasps =
      clearGrasps(work, face, holdingGrasps(work, face, triplets, configurations, tally), tally);
  const Vector2d centroid_F = shapeCentroid(image);
  for (Grasp& grasp : grasps) grasp.quality = measure(work, grasp, centroid_F);
  if (trace) {
    trace->image = std::move(image);
    trace->regions = std::move(regions);
    trace->triplets = std::move(triplets);
    trace->configurations = configurations.size();
    trace->clear = grasps.size();
  }
  return grasps;
}

}  // namespace boxgrasp
