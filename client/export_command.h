// boxgrasp export: grasps in the formats of other programs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "commands.h"

namespace boxgrasp {

struct ExportCommand {
  PlanCommand
      plan;  // its file is a plan's JSON, as `boxgrasp plan --json` prints it, or what can be planned on
  std::string format = "csv";            // "csv", "graspnet", "isaac_grasp"
  std::filesystem::path out;             // empty: stdout; graspnet in *.npy: as numpy saves it
  bool tool = false;                     // poses of the robot's tool instead of the palm
  std::vector<std::string> joint_names;  // in place of the plan's own, in its order
};

// csv: a header, then a line for each grasp, best first; positions in metres, quaternions w x y z, angles in
// radians.
//
// isaac_grasp: YAML of version 1.0; confidence is the score, held within 0 to 1; the object's frame is that
// of the plan.
//
// graspnet: 17 numbers for each grasp: score; width, height and depth of a two-finger gripper, metres; its
// rotation, by rows; its translation; the object's number. For a hand with a thumb, the gripper is that
// which would close along the line from the middle of the other fingers' contacts to that of the thumb:
// the first axis is the approach, the second that line, squared up. Width is the contacts' distance along it;
// depth and height are constants, 20 mm each; the translation lies `depth` before the middle of the contacts.
//
// Returns 1 when there are no grasps, and what planning returns. Throws InputError for files that are neither
// plan nor cloud, and what planning throws.
int runExport(const ExportCommand& command);

}  // namespace boxgrasp
