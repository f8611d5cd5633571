// boxgrasp-trainer draw and constellations: pictures of plans (Fig. 9) and of boxes over t (Fig. 3).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace boxgrasp {

struct DrawCommand {
  std::string object;                          // its name in `objects`
  std::string objects = "builtin";             // or "paper", names, or a folder of meshes
  std::optional<std::filesystem::path> scene;  // a cloud of a whole scene, instead of an object
  std::optional<std::filesystem::path> store;  // rank by networks learnt from it without the object
  std::string meshes = "builtin";              // the store's objects
  std::filesystem::path out;                   // PNG
  int grasps = 2;                              // that are drawn, the best first
  int threads = 0;
  bool json = false;
};

// Throws InputError for objects and clouds that cannot be read; a plan without grasps is no error.
void runDraw(const DrawCommand& command);

struct ConstellationsCommand {
  std::string object;
  std::string objects = "builtin";
  std::filesystem::path out;  // PNG: a row for each split, a column for each t
  std::vector<double> gains{0.70, 0.80, 0.85, 0.90, 0.94, 0.98};  // t
  std::size_t points = 10'000;
  std::uint64_t seed = 1;
  int threads = 0;
  bool json = false;
};

void runConstellations(const ConstellationsCommand& command);

}  // namespace boxgrasp
