#include "boxgrasp/planning/planner_config.h"

namespace boxgrasp {
namespace {

// Every struct is taken apart by name, all members of it: one that is added and forgotten here does not
// compile. A section's reader calls `read` with key and member in turn.
class Section {
 public:
  Section(ConfigFile& file, std::string name) : file_(file), name_(std::move(name)) {}

  template <typename T>
  Section& operator()(const char* key, T& value) {
    file_.read(name_, key, value);
    return *this;
  }
  template <typename Enum>
  Section& operator()(const char* key, Enum& value, const std::vector<std::string>& names) {
    int index = static_cast<int>(value);
    file_.read(name_, key, index, names);
    value = static_cast<Enum>(index);
    return *this;
  }

 private:
  ConfigFile& file_;
  std::string name_;
};

void read(Section section, ValidationOptions& options) {
  auto& [min_extent_m, max_extent_m] = options;
  section("min_extent_m", min_extent_m)("max_extent_m", max_extent_m);
}

void read(Section section, SceneOptions& options) {
  auto& [whole, plane_distance_m, min_plane_fraction, min_plane_extent_m, cluster_distance_m,
         min_cluster_points, max_object_extent_m, seed, threads] = options;  // threads: the plan's, as below
  section("whole", whole)("plane_distance_m", plane_distance_m)("min_plane_fraction", min_plane_fraction);
  section("min_plane_extent_m", min_plane_extent_m)("cluster_distance_m", cluster_distance_m);
  section("min_cluster_points", min_cluster_points)("max_object_extent_m", max_object_extent_m)("seed", seed);
}

void read(Section section, CleanOptions& options) {
  auto& [voxel_m, outlier_neighbours, outlier_deviations, max_points, threads] = options;
  section("voxel_m", voxel_m)("outlier_neighbours", outlier_neighbours);
  section("outlier_deviations", outlier_deviations)("max_points", max_points);
}

void read(Section section, CompletionOptions& options) {
  auto& [enabled, tolerance_m, azimuth_step_rad, max_contradicted, max_contradicted_level, max_hidden] =
      options;
  section("enabled", enabled)("tolerance_m", tolerance_m)("azimuth_step_rad", azimuth_step_rad);
  section("max_contradicted", max_contradicted);
  section("max_contradicted_level", max_contradicted_level);
  section("max_hidden", max_hidden);
}

void read(Section section, DecompositionOptions& options) {
  auto& [gain_t, split, gain, segment_fraction, samples_per_segment, merge_angle_rad, min_point_fraction,
         min_points, min_extent_m, bound_step_m, max_leaves, jurors, resolution_fraction, exhaustive,
         threads] = options;
  section("gain_t", gain_t)("split", split, {"hull", "bound", "robust"})("gain", gain, {"local", "sum"});
  section("segment_fraction", segment_fraction)("samples_per_segment", samples_per_segment);
  section("merge_angle_rad", merge_angle_rad)("bound_step_m", bound_step_m);
  section("min_point_fraction", min_point_fraction)("min_points", min_points)("min_extent_m", min_extent_m);
  section("jurors", jurors)("resolution_fraction", resolution_fraction);
  section("max_leaves", max_leaves)("exhaustive", exhaustive);
}

void read(Section section, FaceOptions& options) {
  auto& [inner_boxes, edges, max_aperture_m, min_width_m, min_depth_m, hand_width_m, hand_depth_m,
         max_blocked_fraction, max_shared_fraction, max_support_cosine] = options;
  section("inner_boxes", inner_boxes)("edges", edges, {"never", "last", "partial", "always"});
  section("max_aperture_m", max_aperture_m)("min_width_m", min_width_m)("min_depth_m", min_depth_m);
  section("hand_width_m", hand_width_m)("hand_depth_m", hand_depth_m);
  section("max_blocked_fraction", max_blocked_fraction)("max_shared_fraction", max_shared_fraction);
  section("max_support_cosine", max_support_cosine);
}

void read(Section section, ImageOptions& options) {
  auto& [pixel_m, border_px, max_side_px] = options;
  section("pixel_m", pixel_m)("border_px", border_px)("max_side_px", max_side_px);
}

void read(Section section, ContourOptions& options) {
  auto& [min_neighbours, splat_spacings, canny_sigma_px, high_quantile, low_fraction, min_depth_step_m,
         min_points] = options;
  section("min_neighbours", min_neighbours)("splat_spacings", splat_spacings)("canny_sigma_px",
                                                                              canny_sigma_px);
  section("high_quantile", high_quantile)("low_fraction", low_fraction)("min_depth_step_m", min_depth_step_m);
  section("min_points", min_points);
}

void read(Section section, RegionOptions& options) {
  auto& [k, smoothing_sigma, max_curvature_rad, max_total_curvature_rad, sum, min_length_m, max_length_m] =
      options;
  section("k", k)("smoothing_sigma", smoothing_sigma)("max_curvature_rad", max_curvature_rad);
  section("max_total_curvature_rad", max_total_curvature_rad)("sum", sum, {"absolute", "with_sign"});
  section("min_length_m", min_length_m)("max_length_m", max_length_m);
}

void read(Section section, TripletOptions& options) {
  auto& [friction, end_margin_m, max_triplets, pinches] = options;
  section("end_margin_m", end_margin_m)("max_triplets", max_triplets);
  section("pinches", pinches);  // the friction is the request's
}

void read(Section section, ConfigurationOptions& options) {
  auto& [friction, thumb_steps, insertion_m, depth_tolerance_m, palm_clearance_m, min_turn_rad, depth_model] =
      options;
  section("thumb_steps", thumb_steps)("insertion_m", insertion_m);  // friction and depth model: the plan's
  section("depth_tolerance_m", depth_tolerance_m)("palm_clearance_m", palm_clearance_m)("min_turn_rad",
                                                                                        min_turn_rad);
}

void read(Section section, ContactOptions& options) {
  auto& [search_m, normal_radius_m, max_normal_tilt_rad, meet_surface] = options;
  section("meet_surface", meet_surface);
  section("search_m", search_m)("normal_radius_m", normal_radius_m)("max_normal_tilt_rad",
                                                                    max_normal_tilt_rad);
}

void read(Section section, ClearanceOptions& options) {
  auto& [approach_m, skin_m, contact_m, openings_rad, min_opening_rad, closing_steps] = options;
  section("approach_m", approach_m)("skin_m", skin_m)("contact_m", contact_m)("openings_rad", openings_rad);
  section("min_opening_rad", min_opening_rad)("closing_steps", closing_steps);
}

void read(Section section, RecallOptions& options) {
  auto& [enabled, overlap, size, contacts, angle_rad, own_weight] = options;
  section("enabled", enabled)("overlap", overlap)("size", size)("contacts", contacts);
  section("angle_rad", angle_rad)("own_weight", own_weight);
}

void read(Section section, RobotOptions& options) {
  auto& [frame, answer_frame, camera_position_m, camera_quaternion_wxyz, palm_position_m,
         palm_quaternion_wxyz, gravity, approach, approach_cone_rad, workspace_min_m, workspace_max_m,
         forbidden_m, lift_m] = options;
  section("frame", frame)("answer_frame", answer_frame, {"cloud", "robot"});
  section("camera_position_m", camera_position_m)("camera_quaternion_wxyz", camera_quaternion_wxyz);
  section("palm_position_m", palm_position_m)("palm_quaternion_wxyz", palm_quaternion_wxyz);
  section("gravity", gravity)("approach", approach)("approach_cone_rad", approach_cone_rad);
  section("workspace_min_m", workspace_min_m)("workspace_max_m", workspace_max_m);
  section("forbidden_m", forbidden_m)("lift_m", lift_m);
}

void read(Section section, ShapeOptions& options) {
  auto& [snap, min_cells, max_residual_share, min_arc_rad] = options;
  section("snap", snap)("min_cells", min_cells)("max_residual_share", max_residual_share);
  section("min_arc_rad", min_arc_rad);
}

template <typename Options>
void readStage(ConfigFile& file, const std::string& section, Options& options) {
  read(Section(file, section), options);
  file.validate(section, [&] { options.validate(); });
}

}  // namespace

PlannerOptions readPlannerOptions(ConfigFile& file) {
  PlannerOptions options;
  auto& [validation, scene, clean, completion, decomposition, faces, image, contours, regions, triplets,
         configurations, contacts, clearance, shapes, recall, robot, depth_model, force_closure,
         guessed_faces, concavity_weight, merge_distance_m, merge_angle_rad, threads] = options;
  readStage(file, "validation", validation);
  readStage(file, "scene", scene);
  readStage(file, "clean", clean);
  readStage(file, "completion", completion);
  readStage(file, "decomposition", decomposition);
  readStage(file, "faces", faces);
  readStage(file, "image", image);
  readStage(file, "contours", contours);
  readStage(file, "regions", regions);
  readStage(file, "triplets", triplets);
  readStage(file, "configurations", configurations);
  readStage(file, "contacts", contacts);
  readStage(file, "clearance", clearance);
  readStage(file, "shapes", shapes);
  readStage(file, "recall", recall);
  readStage(file, "robot", robot);
  Section planner(file, "planner");
  planner("depth_model", depth_model, {"exact", "linear"})("force_closure", force_closure,
                                                           {"require", "prefer", "ignore"});
  planner("guessed_faces", guessed_faces)("concavity_weight", concavity_weight);
  planner("merge_distance_m", merge_distance_m)("merge_angle_rad", merge_angle_rad)("threads", threads);
  file.validate("planner", [&] { options.validate(); });
  return options;
}

PlannerOptions readPlannerOptions(const std::filesystem::path& path) {
  ConfigFile file(path);
  const PlannerOptions options = readPlannerOptions(file);
  file.skip("server");
  file.finish();
  return options;
}

}  // namespace boxgrasp
