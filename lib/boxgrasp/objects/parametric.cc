#include "boxgrasp/objects/parametric.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "boxgrasp/base/error.h"
#include "boxgrasp/objects/polygonise.h"
#include "boxgrasp/objects/shapes.h"

namespace boxgrasp {
namespace {

struct Recipe {
  const char* name;
  shapes::Shape (*shape)();
};

constexpr Recipe kRecipes[] = {
    {"mug", shapes::mug},           {"cup", shapes::cup},
    {"goblet", shapes::goblet},     {"paper_cup", shapes::paperCup},
    {"pen", shapes::pen},           {"pillow", shapes::pillow},
    {"radio", shapes::radio},       {"heart", shapes::heart},
    {"car", shapes::car},           {"duck", shapes::duck},
    {"bunny", shapes::bunny},       {"goose", shapes::goose},
    {"horse", shapes::horse},       {"human", shapes::human},
    {"squirrel", shapes::squirrel}, {"toy_dog", shapes::toyDog},
    {"bottle", shapes::bottle},     {"bowl", shapes::bowl},
    {"hammer", shapes::hammer},     {"banana", shapes::banana},
    {"dumbbell", shapes::dumbbell}, {"spray_can", shapes::sprayCan},
    {"teapot", shapes::teapot},     {"screwdriver", shapes::screwdriver},
    {"torus", shapes::ring},        {"homer", shapes::homer},
};

const Recipe& recipeFor(const std::string& name) {
  for (const Recipe& recipe : kRecipes) {
    if (recipe.name == name) return recipe;
  }
  throw InputError(fmt::format("no parametric object is named '{}'; choose one of {}", name,
                               fmt::join(parametricNames(), ", ")));
}

}  // namespace

std::vector<std::string> parametricNames() {
  std::vector<std::string> names;
  for (const Recipe& recipe : kRecipes) names.emplace_back(recipe.name);
  return names;
}

TriangleMesh parametricObject(const std::string& name, double scale) {
  if (!(scale > 0.0) || !std::isfinite(scale)) {
    throw InputError(fmt::format(
        "parametric object '{}': the scale is {}, but must be positive; 1 is the natural size", name, scale));
  }
  const shapes::Shape shape = recipeFor(name).shape();
  TriangleMesh mesh = polygonise(shape.field, shape.bounds, shape.cell);
  double lowest = std::numeric_limits<double>::infinity();
  for (const Vector3d& vertex : mesh.vertices) lowest = std::min(lowest, vertex.z());
  for (Vector3d& vertex : mesh.vertices) vertex = 1e-3 * scale * (vertex - Vector3d(0, 0, lowest));
  return mesh;
}

}  // namespace boxgrasp
