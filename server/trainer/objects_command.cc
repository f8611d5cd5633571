#include "objects_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <sys/wait.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/exit_code.h"
#include "boxgrasp/objects/depth_camera.h"
#include "boxgrasp/objects/object_set.h"
#include "boxgrasp/rendering/canvas.h"
#include "print_json.h"
#include "tried_object.h"

namespace boxgrasp {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::vector<ObjectSource> sourcesOf(const ObjectsCommand& command) {
  if (const auto parametric = parametricSet(command.objects, command.scales)) return *parametric;
  return meshFolder(command.objects, {command.scales, command.unit_m, command.target_size_m});
}

Vector3d sizesOf(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : mesh.vertices) box.extend(p);
  return box.sizes();
}

// --- fetch

// Runs a program in a folder and waits for it. The arguments reach it as they are.
void runIn(const fs::path& folder, std::vector<std::string> arguments) {
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  pid_t child = 0;
  const int error = posix_spawnp(&child, pointers[0], &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = -1;
  if (error == 0 && waitpid(child, &status, 0) == child && status == 0) return;
  throw InputError(
      fmt::format("'{}' in {} failed; is this a Debian machine with a network, and was apt-get "
                  "update run?",
                  fmt::join(arguments, " "), folder.string()));
}

fs::path downloaded(const fs::path& folder, const std::string& package) {
  runIn(folder, {"apt-get", "download", package});
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    if (name.starts_with(package + "_") && name.ends_with(".deb")) return name;
  }
  throw InputError(fmt::format("{}: apt-get left no file of {} there", folder.string(), package));
}

void unpack(const fs::path& folder, const std::string& package) {
  const fs::path archive = downloaded(folder, package);
  runIn(folder, {"dpkg-deb", "-x", archive, "."});
}

void writeOff(const TriangleMesh& mesh, const fs::path& file) {
  std::ofstream out(file);
  out << fmt::format("OFF\n{} {} 0\n", mesh.vertices.size(), mesh.triangles.size());
  for (const Vector3d& p : mesh.vertices) out << fmt::format("{:.9g} {:.9g} {:.9g}\n", p.x(), p.y(), p.z());
  for (const auto& t : mesh.triangles) out << fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  if (!out.flush()) throw InputError(fmt::format("{}: cannot be written", file.string()));
}

// The numbers between a mark in the text and the next tag.
template <typename T>
std::vector<T> numbersAfter(const std::string& text, const std::string& mark) {
  const std::size_t at = text.find(mark);
  if (at == text.npos) throw InputError(fmt::format("the duck's file has no '{}'", mark));
  const std::size_t begin = text.find('>', at) + 1;
  std::istringstream words(text.substr(begin, text.find('<', begin) - begin));
  return std::vector<T>(std::istream_iterator<T>(words), {});
}

// The one Collada file that is needed: triangles whose corners name position, normal and texture.
TriangleMesh readDuck(const fs::path& file) {
  std::ifstream in(file);
  const std::string text(std::istreambuf_iterator<char>(in), {});
  TriangleMesh mesh;
  const auto positions = numbersAfter<double>(text, "-positions-array\" count");
  for (std::size_t i = 0; i + 2 < positions.size(); i += 3)
    mesh.vertices.push_back({positions[i], positions[i + 1], positions[i + 2]});
  const auto corners = numbersAfter<std::uint32_t>(text, "<p>");
  for (std::size_t i = 0; i + 8 < corners.size(); i += 9)
    mesh.triangles.push_back({corners[i], corners[i + 3], corners[i + 6]});
  return mesh;
}

struct RawMesh {
  const char *file, *name;
  bool y_up;
};

// Of CGAL's data.
constexpr RawMesh kMeshes[] = {
    {"bunny00", "bunny", true}, {"homer", "homer", true}, {"man", "human", false},
    {"cow", "cow", true},       {"camel", "camel", true}, {"elephant", "elephant", true},
    {"bull", "bull", true},     {"hand", "hand", false},  {"femur", "femur", false}};

// Turns y up into z up.
void turnUpright(TriangleMesh& mesh) {
  for (Vector3d& p : mesh.vertices) p = Vector3d(p.x(), -p.z(), p.y());
}

// Checks a raw mesh and leaves it in the folder at its new size, or says why not.
void keep(const fs::path& raw, const std::string& name, bool y_up, const fs::path& folder) {
  constexpr double kSize = 0.15;  // metres: toys that a hand can hold
  try {
    LoadedObject object = loadObject({name, 1.0, raw, 1.0, kSize});
    if (y_up) turnUpright(object.mesh_O);
    writeOff(object.mesh_O, folder / (name + ".off"));
    fmt::print("{:<10} {} triangles{}{}\n", name, object.mesh_O.triangles.size(),
               object.repairs.empty() ? "" : "; ", fmt::join(object.repairs, "; "));
  } catch (const InputError& error) {
    fmt::print("{:<10} left out: {}\n", name, error.what());
  }
}

// --- view

cv::Mat3b picture(const TriangleMesh& mesh, const Vector3d& forward, const std::string& title) {
  Canvas canvas(480, 480, framing(mesh.vertices, forward, Vector3d::UnitZ(), 1.0));
  canvas.mesh(mesh, Pose::Identity(), {150, 170, 200});
  cv::Mat3b image = canvas.image().clone();
  label(image, title, 8, 20);
  return image;
}

cv::Mat3b cloudPicture(const TriangleMesh& mesh, const NamedPose& view) {
  const DepthView seen = seeFrom({mesh, {}, true}, view.X_OS);
  const PointCloud cloud = seen.objectCloud_O();
  // From a quarter turn aside, where noise and the unseen back show.
  const Vector3d forward = Vector3d(-view.X_OS.linear().col(0) + view.X_OS.linear().col(2)).normalized();
  Canvas canvas(480, 480, framing(mesh.vertices, forward, Vector3d::UnitZ(), 1.0));
  for (std::size_t i = 0; i < cloud.size(); ++i) canvas.point(cloud.point(i), {30, 60, 120}, 2);
  cv::Mat3b image = canvas.image().clone();
  label(image, fmt::format("{}: {} points", view.name, cloud.size()), 8, 20);
  return image;
}

// --- list, check

// What a mesh is like, or why it is refused.
Json checked(const ObjectSource& source) {
  Json row{{"object", source.name}, {"scale", source.scale}};
  try {
    const LoadedObject object = loadObject(source);
    const Vector3d size = sizesOf(object.mesh_O);
    row["size_m"] = {size.x(), size.y(), size.z()};
    row["volume_m3"] = object.solid.volume;
    row["triangles"] = object.mesh_O.triangles.size();
    row["repairs"] = object.repairs;
  } catch (const InputError& error) {
    row["refused"] = error.what();
  }
  return row;
}

void printRow(const Json& row) {
  const std::string name =
      fmt::format("{}@{:.2f}", row["object"].get<std::string>(), row["scale"].get<double>());
  if (row.contains("refused")) {
    fmt::print("{:<20} refused: {}\n", name, row["refused"].get<std::string>());
    return;
  }
  const auto size_m = row["size_m"].get<std::vector<double>>();
  fmt::print("{:<20} {:>4.0f} x {:>3.0f} x {:>3.0f} mm  {:>7.1f} ml  {:>6} triangles  {}\n", name,
             1e3 * size_m[0], 1e3 * size_m[1], 1e3 * size_m[2], 1e6 * row["volume_m3"].get<double>(),
             row["triangles"].get<std::size_t>(),
             fmt::join(row["repairs"].get<std::vector<std::string>>(), "; "));
}

}  // namespace

void listObjects(const ObjectsCommand& command) {
  Json rows = Json::array();
  for (const ObjectSource& source : sourcesOf(command)) {
    rows.push_back({{"object", source.name}, {"scale", source.scale}, {"file", source.file.string()}});
    if (!command.json)
      fmt::print("{}@{:.2f}{}{}\n", source.name, source.scale, source.file.empty() ? "" : "  ",
                 source.file.string());
  }
  if (command.json) printJson(Json{{"schema", 1}, {"objects", rows}});
}

int checkObjects(const ObjectsCommand& command) {
  Json rows = Json::array();
  std::size_t refused = 0;
  for (const ObjectSource& source : sourcesOf(command)) {
    rows.push_back(checked(source));
    refused += rows.back().contains("refused");
    if (!command.json) printRow(rows.back());
  }
  if (command.json)
    printJson(Json{{"schema", 1}, {"objects", rows}});
  else
    fmt::print("{} of {} objects can be simulated\n", rows.size() - refused, rows.size());
  return refused == 0 ? kDone : kNothingFound;
}

void fetchObjects(const ObjectsCommand& command) {
  const fs::path cache = command.folder / "packages";
  fs::create_directories(cache);
  unpack(cache, "libcgal-demo");
  unpack(cache, "assimp-testmodels");
  runIn(cache, {"tar", "-xzf", "usr/share/doc/libcgal-dev/data.tar.gz", "data/meshes"});
  const fs::path duck = cache / "duck.off";
  writeOff(readDuck(cache / "usr/share/assimp/models/Collada/duck_triangulate.dae"), duck);
  keep(duck, "duck", true, command.folder);
  for (const RawMesh& mesh : kMeshes)
    keep(cache / "data/meshes" / fmt::format("{}.off", mesh.file), mesh.name, mesh.y_up, command.folder);
  fs::remove_all(cache);
}

void viewObject(const ObjectsCommand& command) {
  for (const ObjectSource& source : sourcesOf(command)) {
    if (source.name != command.name) continue;
    const TriangleMesh mesh = loadObject(source).mesh_O;
    const std::vector<NamedPose> views = viewRing(mesh);
    const std::vector<cv::Mat3b> panels{picture(mesh, Vector3d(-0.55, 0.75, -0.45).normalized(), source.name),
                                        cloudPicture(mesh, views[0]), cloudPicture(mesh, views[3])};
    cv::Mat3b all;
    cv::hconcat(panels, all);
    writePng(all, command.out);
    fmt::print("{} written to {}\n", source.name, command.out.string());
    return;
  }
  throw InputError(fmt::format("no object of '{}' is named '{}'; 'objects list' names them", command.objects,
                               command.name));
}

}  // namespace boxgrasp
