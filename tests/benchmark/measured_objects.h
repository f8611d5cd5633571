// The objects whose points are measured on: parametric ones, and with --meshes=FOLDER the meshes of a folder,
// which `boxgrasp-trainer objects fetch FOLDER` fills with scanned objects.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "boxgrasp/base/error.h"
#include "boxgrasp/objects/object_set.h"
#include "boxgrasp/objects/parametric.h"

namespace boxgrasp {

struct MeasuredObject {
  std::string name;
  std::function<TriangleMesh()> mesh;
};

// The meshes of a folder, brought to 15 cm. Ends the program, with the reason, where there are none.
inline std::vector<MeasuredObject> measuredMeshes(const std::filesystem::path& folder) {
  std::vector<MeasuredObject> objects;
  try {
    for (const ObjectSource& source : meshFolder(folder, {.scales = {1.0}, .target_size_m = 0.15}))
      objects.push_back({source.name + " (mesh)", [source] { return loadObject(source).mesh_O; }});
  } catch (const InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    std::exit(1);
  }
  return objects;
}

inline std::vector<MeasuredObject> parametricObjects(const std::vector<std::string>& names) {
  std::vector<MeasuredObject> objects;
  for (const std::string& name : names) objects.push_back({name, [name] { return parametricObject(name); }});
  return objects;
}

// Parametric objects, and the meshes that the arguments ask for. Takes --meshes out of them.
inline std::vector<MeasuredObject> measuredObjects(const std::vector<std::string>& parametric, int& argc,
                                                   char** argv) {
  constexpr std::string_view kMeshes = "--meshes=";
  std::vector<MeasuredObject> objects = parametricObjects(parametric);
  int kept = 0;
  for (int i = 0; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (!argument.starts_with(kMeshes)) {
      argv[kept++] = argv[i];
      continue;
    }
    for (MeasuredObject& object : measuredMeshes(argument.substr(kMeshes.size())))
      objects.push_back(std::move(object));
  }
  argc = kept;
  return objects;
}

}  // namespace boxgrasp
