// boxgrasp-trainer objects: what there is to label, whether it can be simulated, and how it looks.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace boxgrasp {

struct ObjectsCommand {
  std::string objects = "builtin";  // or "paper", or a folder of meshes
  std::vector<double> scales{1.0};
  double unit_m = 1.0;                       // of the meshes' coordinates
  double target_size_m = 0.0;                // longest side of a mesh; 0: as its file says
  std::filesystem::path folder = "objects";  // fetch: where the meshes go
  std::string name;                          // view: one of the objects
  std::filesystem::path out = "object.png";  // view: the picture
  bool json = false;                         // list, check
};

// Prints the name and scale of each object.
void listObjects(const ObjectsCommand& command);

// Loads each object, and prints its size, its volume and what was mended, or why it cannot be simulated.
// Returns the program's exit code: kNothingFound when one was refused.
int checkObjects(const ObjectsCommand& command);

// Takes the paper's objects, and some others, from Debian's packages libcgal-demo and assimp-testmodels:
// bunny, duck, homer and human. apt-get downloads the packages into the folder, nothing is installed. The
// objects go there as OFF files, 0.15 m long. Throws InputError when a package cannot be had.
void fetchObjects(const ObjectsCommand& command);

// Writes a picture of an object, and of what a depth camera sees of it on a table from two sides.
void viewObject(const ObjectsCommand& command);

}  // namespace boxgrasp
