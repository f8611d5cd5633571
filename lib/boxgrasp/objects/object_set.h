// Sets of objects to label: the built-in ones and folders of meshes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/objects/mesh_properties.h"

namespace boxgrasp {

// Where an object in one size comes from.
struct ObjectSource {
  std::string name;
  double scale = 1.0;          // relative to its natural size
  std::filesystem::path file;  // empty: the parametric object of this name
  double unit_m = 1.0;         // of the file's coordinates: 0.001 for a file in millimetres
  double target_size_m = 0.0;  // longest side of its axis-aligned box at scale 1; 0: as the file says
};

// All parametric objects, each in every scale, in the order of their names.
std::vector<ObjectSource> builtinObjects(const std::vector<double>& scales);

// The 17 objects of the paper's Table I in its order, as parametric objects, each in every scale.
std::vector<ObjectSource> paperObjects(const std::vector<double>& scales);

struct MeshFolderOptions {
  std::vector<double> scales{1.0};
  double unit_m = 1.0;
  double target_size_m = 0.0;
  void validate() const;
};

// The meshes in a folder and the folders in it (OFF, OBJ, STL, PLY), each in every scale, in the order of
// their names. An object is named after its file; where files in several folders have one name, after folder
// and file; a number is added where that is not enough. Throws InputError when there is no such folder or no
// mesh in it, and for bad options.
std::vector<ObjectSource> meshFolder(const std::filesystem::path& folder,
                                     const MeshFolderOptions& options = {});

struct LoadedObject {
  TriangleMesh mesh_O;               // bounds a solid; frame O is the file's
  MassProperties solid;              // of density 1
  std::vector<std::string> repairs;  // what was mended, with counts
};

// Reads, mends and checks an object; a mesh of more than 100,000 triangles is simplified to that many, which
// is one of the repairs. That a surface passes through itself is not noticed. Throws InputError that names
// the object, what is wrong and the remedy: unreadable or empty files, holes and edges of more than two
// triangles with their numbers, no volume, an extent outside 5 mm to 2 m (millimetres taken for metres), more
// than two million triangles; Stopped when told to stop.
LoadedObject loadObject(const ObjectSource& source, const StopToken& stop = {});

}  // namespace boxgrasp
