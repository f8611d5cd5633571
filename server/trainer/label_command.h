// boxgrasp-trainer label: plans grasps on a set of objects, tries them in the simulator, and keeps what it
// says.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace boxgrasp {

struct LabelCommand {
  std::string objects = "builtin";            // or "paper", or a folder of meshes
  std::optional<std::filesystem::path> hand;  // else the Barrett hand
  std::filesystem::path out;  // the experience store; what it holds already is not labelled again
  std::vector<double> scales{0.75, 1.0, 1.5};
  double unit_m = 1.0;         // of the meshes' coordinates
  double target_size_m = 0.0;  // longest side of a mesh; 0: as its file says
  int views = 0;               // depth cameras around each object, besides the cloud of its whole surface
  bool pairs = false;          // each camera's view together with another's, too
  int perturbations = 0;       // of each hypothesis
  std::string last_stage = "push";
  bool protocols = false;
  std::vector<std::string> sources{"planner"};
  int limit = 0;      // hypotheses of each model and source, evenly chosen; 0: all
  int random = 200;   // random grasps of each model
  std::string only;   // one object alone
  std::string shard;  // "i/n": every n-th (object, scale), from the i-th on, i = 0 .. n - 1
  std::uint64_t seed = 1;
  int threads = 0;
  bool json = false;
};

// Labels what is missing. On Ctrl-C it finishes the batch at hand and says how to go on. Objects that cannot
// be simulated are named and left out. Returns the program's exit code: kInterrupted, kNothingFound when an
// object was left out, else kDone. Throws InputError, StoreError among them.
int runLabel(const LabelCommand& command);

}  // namespace boxgrasp
