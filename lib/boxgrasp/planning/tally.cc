#include "boxgrasp/planning/tally.h"

#include <fmt/format.h>

#include <algorithm>

namespace boxgrasp {
namespace {

constexpr std::array<StageText, kStageCount> kStages{{
    {"scene", "finite points", "objects",
     "scene.min_cluster_points, scene.max_object_extent_m, or scene.whole = true for a single object"},
    {"clean", "points of objects", "points", "clean.outlier_neighbours = 0"},
    {"completion", "points seen", "points", "completion.enabled = false"},
    {"decomposition", "objects", "leaf boxes", "decomposition.gain_t"},
    {"faces", "faces", "graspable faces",
     "faces.max_aperture_m, faces.max_blocked_fraction, or the direction of gravity"},
    {"approach", "graspable faces", "faces from where the robot may come",
     "robot.approach_cone_rad, robot.approach, or the request's approach and camera pose"},
    {"images", "graspable faces", "images with points", "image.pixel_m"},
    {"regions", "contours", "regions",
     "regions.min_length_m, regions.max_curvature_rad, or contours.splat_spacings for a sparse cloud"},
    {"triplets", "triples of regions", "triplets", "the friction coefficient, regions.max_length_m"},
    {"configurations", "triplets", "configurations",
     "the friction coefficient, configurations.depth_tolerance_m"},
    {"contacts", "configurations", "with contacts", "contacts.search_m, contacts.max_normal_tilt_rad"},
    {"force closure", "with contacts", "in force closure",
     "the friction coefficient, planner.force_closure = \"ignore\""},
    {"clearance", "in force closure", "clear of collisions",
     "clearance.skin_m, clearance.approach_m, decomposition.gain_t"},
    {"reach", "clear of collisions", "in the robot's reach",
     "robot.workspace_min_m, robot.workspace_max_m, robot.forbidden_m, or the camera pose: what is forbidden "
     "is in the robot's frame"},
    {"ranking", "clear of collisions", "scored", "the model"},
    {"distinct", "scored", "grasps returned", "merge_distance_m"},
}};

// The reasons with the largest counts, most frequent first.
std::string commonestReasons(const std::map<std::string, std::size_t>& rejected, std::size_t most) {
  std::vector<std::pair<std::string, std::size_t>> rows(rejected.begin(), rejected.end());
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string text;
  for (std::size_t i = 0; i < std::min(most, rows.size()); ++i) {
    text += fmt::format("{}{} ({})", i ? ", " : "", rows[i].first, rows[i].second);
  }
  return text;
}

}  // namespace

const StageText& stageText(StageId id) { return kStages[static_cast<std::size_t>(id)]; }

void Tally::count(StageId id, std::size_t in, std::size_t out) {
  Entry& entry = at(id);
  entry.in += in;
  entry.out += out;
  entry.reached = true;
}

void Tally::reject(std::string_view reason, std::size_t n) {
  if (n > 0) rejected_[std::string(reason)] += n;
}

void Tally::add(const Tally& other) {
  for (std::size_t i = 0; i < kStageCount; ++i) {
    entries_[i].in += other.entries_[i].in;
    entries_[i].out += other.entries_[i].out;
    entries_[i].time_s += other.entries_[i].time_s;
    entries_[i].reached |= other.entries_[i].reached;
  }
  for (const auto& [reason, n] : other.rejected_) rejected_[reason] += n;
}

std::string whyNoGrasp(const Tally& tally) {
  for (std::size_t i = 0; i < kStageCount; ++i) {
    const auto id = static_cast<StageId>(i);
    const Tally::Entry& entry = tally[id];
    if (!entry.reached || entry.out > 0) continue;
    const StageText& text = stageText(id);
    std::string before;
    for (std::size_t j = 0; j < i; ++j) {
      const auto earlier = static_cast<StageId>(j);
      if (tally[earlier].reached)
        before +=
            fmt::format("{}{} {}", before.empty() ? "" : ", ", tally[earlier].out, stageText(earlier).gives);
    }
    std::string message =
        fmt::format("no grasp: stage '{}' let none of {} {} through", text.name, entry.in, text.takes);
    if (!before.empty()) message += fmt::format(" (before it: {})", before);
    const std::string reasons = commonestReasons(tally.rejected(), 4);
    if (!reasons.empty()) message += fmt::format("; rejected: {}", reasons);
    return message + fmt::format("; knobs: {}", text.knob);
  }
  return "no grasp";
}

}  // namespace boxgrasp
