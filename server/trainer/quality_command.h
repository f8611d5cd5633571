// boxgrasp-trainer quality: epsilon, nu and force closure of contacts in a file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace boxgrasp {

// The file (JSON, millimetres) is a grasp, a list of grasps, an object with such a list as "cases", or a bare
// list of contacts. A grasp: {"contacts": [...], "name", "mu", "cone_edges", "cog_mm", "torque_scale_mm"}; a
// contact: {"position_mm": [x, y, z], "inward_normal": [x, y, z], "mu"}. Of a grasp only the contacts are
// needed: the centre of gravity is then the origin, and the torque scale the largest distance of a contact
// from it.
struct QualityCommand {
  std::filesystem::path contacts;
  std::optional<double> friction;  // in place of the file's, of all contacts
  std::optional<int> edges;        // of the friction cones, in place of the file's
  std::string norm = "l1";         // or "linf"
  bool json = false;
};

// Prints a line, or a JSON object, for each grasp. Throws InputError that names file, place and value.
void runQuality(const QualityCommand& command);

}  // namespace boxgrasp
