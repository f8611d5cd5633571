#include "boxgrasp/objects/object_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "boxgrasp/base/error.h"
#include "boxgrasp/cloud/read_cloud.h"
#include "boxgrasp/objects/mesh_repair.h"
#include "boxgrasp/objects/mesh_simplify.h"
#include "boxgrasp/objects/parametric.h"

namespace boxgrasp {
namespace {

constexpr std::size_t kMaxTriangles = 2'000'000;
constexpr std::size_t kEnoughTriangles = 100'000;       // edges of 1 mm on a toy: as fine as fingers feel
constexpr double kMinExtent = 0.005, kMaxExtent = 2.0;  // m

void checkScales(const std::vector<double>& scales) {
  requireOption(!scales.empty(), "the number of scales", scales.size(), "at least 1");
  for (const double scale : scales)
    requireOption(std::isfinite(scale) && scale > 0, "scale", scale, "above 0 and finite");
}

bool isMesh(const std::filesystem::path& file) {
  std::string ending = file.extension();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return ending == ".off" || ending == ".obj" || ending == ".stl" || ending == ".ply";
}

std::vector<std::filesystem::path> meshesIn(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::recursive_directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error)) {
    if (at->is_regular_file() && isMesh(at->path())) files.push_back(at->path());
  }
  if (error)
    throw InputError(fmt::format("cannot read the folder '{}': {}", folder.string(), error.message()));
  if (files.empty())
    throw InputError(fmt::format("no mesh (.off, .obj, .stl, .ply) in '{}' or its folders", folder.string()));
  std::sort(files.begin(), files.end());
  return files;
}

// Names that tell all files apart.
std::vector<std::string> namesOf(const std::vector<std::filesystem::path>& files) {
  std::map<std::string, int> short_names, taken;
  for (const auto& file : files) ++short_names[file.stem()];
  std::vector<std::string> names;
  for (const auto& file : files) {
    std::string name = file.stem();
    if (short_names[name] > 1) name = file.parent_path().filename().string() + "/" + name;
    if (const int before = taken[name]++; before > 0) name += fmt::format("#{}", before + 1);
    names.push_back(name);
  }
  return names;
}

Vector3d sizesOf(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : mesh.vertices) box.extend(v);
  return box.isEmpty() ? Vector3d::Zero().eval() : box.sizes().eval();
}

void resize(TriangleMesh& mesh, const ObjectSource& source) {
  const double longest = sizesOf(mesh).maxCoeff();
  const double factor =
      source.scale *
      (source.target_size_m > 0 && longest > 0 ? source.target_size_m / longest : source.unit_m);
  for (Vector3d& v : mesh.vertices) v *= factor;
}

[[noreturn]] void refuse(const ObjectSource& source, const std::string& problem) {
  throw InputError(fmt::format("object '{}'{}: {}", source.name,
                               source.file.empty() ? "" : fmt::format(" ({})", source.file.string()),
                               problem));
}

void checkSize(const ObjectSource& source, const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) refuse(source, "the mesh has no triangles");
  if (mesh.triangles.size() > kMaxTriangles)
    refuse(source, fmt::format("{} triangles are more than {}; simplify the mesh", mesh.triangles.size(),
                               kMaxTriangles));
  for (const Vector3d& v : mesh.vertices) {
    if (!v.allFinite()) refuse(source, "a vertex is not finite");
  }
  const double longest = sizesOf(mesh).maxCoeff();
  if (longest > kMaxExtent)
    refuse(
        source,
        fmt::format("it is {:.4g} m long; a file in millimetres is read with unit 0.001, and a target size "
                    "makes any mesh graspable",
                    longest));
  if (longest < kMinExtent)
    refuse(
        source,
        fmt::format("it is {:.4g} m long, less than a finger is thick; check the unit, or set a target size",
                    longest));
}

void checkSolid(const ObjectSource& source, const TriangleMesh& mesh) {
  const MeshTopology topology = topologyOf(mesh);
  if (!topology.closed)
    refuse(source, fmt::format("the mesh is open: {} edges belong to one triangle only; fill its holes",
                               topology.open_edges));
  if (topology.crowded_edges > 0)
    refuse(source,
           fmt::format("{} edges belong to more than two triangles; separate the parts that touch there",
                       topology.crowded_edges));
  if (!topology.boundsSolid())
    refuse(source,
           "the mesh does not bound a solid: parts of it touch in a point, cross themselves like a Moebius "
           "strip, or have no volume");
}

TriangleMesh readOrMake(const ObjectSource& source) {
  if (source.file.empty()) return parametricObject(source.name, source.scale);
  TriangleMesh mesh = readMesh(source.file);
  resize(mesh, source);
  return mesh;
}

std::vector<ObjectSource> inScales(const ObjectSource& source, const std::vector<double>& scales) {
  std::vector<ObjectSource> sources;
  for (const double scale : scales) {
    sources.push_back(source);
    sources.back().scale = scale;
  }
  return sources;
}

std::vector<ObjectSource> parametricSources(const std::vector<std::string>& names,
                                            const std::vector<double>& scales) {
  checkScales(scales);
  std::vector<ObjectSource> sources;
  for (const std::string& name : names) {
    ObjectSource one;
    one.name = name;
    for (ObjectSource& source : inScales(one, scales)) sources.push_back(std::move(source));
  }
  return sources;
}

void simplifyIfLarge(const ObjectSource& source, LoadedObject& object, const StopToken& stop) {
  const std::size_t before = object.mesh_O.triangles.size();
  if (before <= kEnoughTriangles) return;
  object.mesh_O = simplified(std::move(object.mesh_O), kEnoughTriangles, stop);
  const std::size_t after = object.mesh_O.triangles.size();
  if (after > kEnoughTriangles)
    refuse(source, fmt::format("{} triangles cannot be simplified to {}; decimate the mesh", before,
                               kEnoughTriangles));
  object.repairs.push_back(fmt::format("{} triangles simplified to {}", before, after));
}

}  // namespace

void MeshFolderOptions::validate() const {
  checkScales(scales);
  requireOption(std::isfinite(unit_m) && unit_m > 0, "unit_m", unit_m, "above 0 and finite");
  requireOption(target_size_m >= 0 && target_size_m <= kMaxExtent, "target_size_m", target_size_m,
                "in [0, 2]");
}

std::vector<ObjectSource> builtinObjects(const std::vector<double>& scales) {
  return parametricSources(parametricNames(), scales);
}

std::vector<ObjectSource> paperObjects(const std::vector<double>& scales) {
  return parametricSources({"bunny", "car", "cup", "duck", "goblet", "goose", "heart", "homer", "horse",
                            "human", "mug", "paper_cup", "pen", "pillow", "radio", "squirrel", "toy_dog"},
                           scales);
}

std::vector<ObjectSource> meshFolder(const std::filesystem::path& folder, const MeshFolderOptions& options) {
  options.validate();
  const auto files = meshesIn(folder);
  const auto names = namesOf(files);
  std::vector<ObjectSource> sources;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const ObjectSource one{names[i], 1.0, files[i], options.unit_m, options.target_size_m};
    for (ObjectSource& source : inScales(one, options.scales)) sources.push_back(std::move(source));
  }
  return sources;
}

LoadedObject loadObject(const ObjectSource& source, const StopToken& stop) {
  TriangleMesh mesh = readOrMake(source);
  stop.check();
  checkSize(source, mesh);
  RepairedMesh mended = source.file.empty() ? RepairedMesh{std::move(mesh), {}} : repaired(mesh);
  stop.check();
  if (mended.mesh.triangles.empty()) refuse(source, "no triangle has an area");
  checkSolid(source, mended.mesh);
  LoadedObject object{std::move(mended.mesh), {}, std::move(mended.repairs)};
  simplifyIfLarge(source, object, stop);
  object.solid = massPropertiesOf(object.mesh_O);
  const double box = sizesOf(object.mesh_O).prod();
  if (!(object.solid.volume > 1e-6 * box)) refuse(source, "the mesh encloses no volume");
  return object;
}

}  // namespace boxgrasp
