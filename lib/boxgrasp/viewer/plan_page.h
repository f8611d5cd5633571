// A plan as an interactive page: one HTML file that fetches nothing when it is viewed.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "boxgrasp/planning/plan.h"

namespace boxgrasp {

struct ViewerOptions {
  std::string title;        // e.g. the name of the file
  int max_points = 60'000;  // drawn of each cloud, evenly thinned; more: a larger file
  int max_grasps = 50;      // drawn with their hand; the best
  int max_faces = 60;       // face images; those with the most grasps
  int closing_steps = 8;    // poses of the hand from pregrasp to closed
  double retreat_m = 0.10;  // how far back along the approach the hand is drawn at first
  int image_px = 320;       // longer side of a face image
  void validate() const;
};

// What the page shows, as JSON: lengths in metres, rotations as w, x, y, z; clouds and images in base64. Its
// member "schema" is raised when a reader of the old form could not read the new one. Numbers that are not
// finite are null.
nlohmann::ordered_json planScene(const PlanResult& result, const PlanTrace& trace,
                                 const HandDescription& hand, const ViewerOptions& options = {});

// The page for one scene.
std::string planPage(const nlohmann::ordered_json& scene);

// The page that a server offers: it asks that server for its scenes as they come (api/plans, api/plans/<id>,
// api/status).
std::string livePage();

// Throws InputError when the file cannot be written whole.
void writePlanPage(const nlohmann::ordered_json& scene, const std::filesystem::path& html);

}  // namespace boxgrasp
