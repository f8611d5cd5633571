#include "quality_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "boxgrasp/base/error.h"
#include "boxgrasp/wrench/grasp_wrench_space.h"
#include "print_json.h"

namespace boxgrasp {
namespace {

using nlohmann::json;

constexpr double kMetre = 1000.0;          // in millimetres, the unit of the file
constexpr double kNormalTolerance = 1e-3;  // how far from 1 a normal's length may be in the file
constexpr std::size_t kQuoted = 60;        // characters of a wrong value that a message shows

// What a grasp may say besides what is read: remarks, and the values of others.
const std::vector<std::string> kGraspKeys{
    "name",          "source",  "mu",     "cone_edges", "cog_mm",     "torque_scale_mm", "contacts",
    "force_closure", "epsilon", "volume", "nu",         "borderline", "closed_form",     "graspit_shipped"};
const std::vector<std::string> kContactKeys{"position_mm", "inward_normal", "mu"};

// The value as a message shows it; of nested ones only what they are.
std::string quoted(const json& value) {
  const bool flat = std::none_of(value.begin(), value.end(), [](const json& v) { return v.is_structured(); });
  if (value.is_object() || !flat) return value.is_object() ? "an object" : "a list";
  const std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  return text.size() > kQuoted ? text.substr(0, kQuoted) + "..." : text;
}

// A value and where it stands, for messages.
struct Place {
  const json& value;
  std::string path;

  void require(bool holds, std::string_view bound) const {
    if (!holds) throw InputError(fmt::format("{} is {}, but must be {}", path, quoted(value), bound));
  }
  Place at(std::size_t i) const { return {value[i], fmt::format("{}[{}]", path, i)}; }
  Place at(const std::string& key) const {
    if (!value.contains(key)) throw InputError(fmt::format("{} has no \"{}\"", path, key));
    return {value[key], path + "." + key};
  }
  // Null stands for absent.
  bool has(const std::string& key) const { return value.contains(key) && !value[key].is_null(); }
};

void requireObject(const Place& place, const std::vector<std::string>& known, std::string_view what) {
  place.require(place.value.is_object(), what);
  for (const auto& [key, value] : place.value.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    throw InputError(
        fmt::format("{} has the unknown key \"{}\"; known are {}", place.path, key, fmt::join(known, ", ")));
  }
}

double numberAt(const Place& place, double least, std::string_view bound) {
  place.require(place.value.is_number() && place.value.get<double>() >= least, bound);
  return place.value.get<double>();
}

Vector3d vectorAt(const Place& place) {
  const json& value = place.value;
  const bool three =
      value.is_array() && value.size() == 3 &&
      std::all_of(value.begin(), value.end(), [](const json& number) { return number.is_number(); });
  place.require(three, "three numbers");
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

Contact contactAt(const Place& place) {
  requireObject(place, kContactKeys, "a contact: an object with \"position_mm\" and \"inward_normal\"");
  const Place normal = place.at("inward_normal");
  const Vector3d direction = vectorAt(normal);
  normal.require(std::abs(direction.norm() - 1) < kNormalTolerance, "of length 1");
  Contact contact{vectorAt(place.at("position_mm")) / kMetre, direction.normalized()};
  if (place.has("mu")) contact.friction = numberAt(place.at("mu"), 0.0, "a number of at least 0");
  return contact;
}

struct NamedGrasp {
  std::string name;
  std::vector<Contact> contacts;
  WrenchOptions options;
};

std::vector<Contact> contactsAt(const Place& place) {
  place.require(place.value.is_array(), "a list of contacts");
  std::vector<Contact> contacts;
  for (std::size_t i = 0; i < place.value.size(); ++i) contacts.push_back(contactAt(place.at(i)));
  return contacts;
}

double farthest(const std::vector<Contact>& contacts, const Vector3d& center) {
  double distance = 0.0;
  for (const Contact& contact : contacts) distance = std::max(distance, (contact.p_C - center).norm());
  return distance > 0 ? distance : 1.0;
}

NamedGrasp bareGrasp(const Place& place) {
  NamedGrasp grasp{"contacts", contactsAt(place), {}};
  grasp.options.torque_scale_m = farthest(grasp.contacts, grasp.options.p_CG);
  return grasp;
}

NamedGrasp graspAt(const Place& place) {
  requireObject(place, kGraspKeys, "a grasp: an object with \"contacts\"");
  NamedGrasp grasp{place.path, contactsAt(place.at("contacts")), {}};
  WrenchOptions& options = grasp.options;
  if (place.has("name")) {
    place.at("name").require(place.value["name"].is_string(), "text");
    grasp.name = place.value["name"];
  }
  if (place.has("mu")) options.friction = numberAt(place.at("mu"), 0.0, "a number of at least 0");
  if (place.has("cone_edges")) {
    const Place edges = place.at("cone_edges");
    edges.require(edges.value.is_number_integer() && edges.value >= 3 && edges.value <= 64,
                  "a whole number from 3 to 64");
    options.cone_edges = edges.value;
  }
  if (place.has("cog_mm")) options.p_CG = vectorAt(place.at("cog_mm")) / kMetre;
  options.torque_scale_m = farthest(grasp.contacts, options.p_CG);
  if (place.has("torque_scale_mm")) {
    options.torque_scale_m = numberAt(place.at("torque_scale_mm"), 1e-9, "a positive number") / kMetre;
  }
  return grasp;
}

std::vector<NamedGrasp> graspList(const Place& list) {
  list.require(list.value.is_array() && !list.value.empty(),
               "a grasp, a list of grasps, or a list of contacts");
  if (list.value[0].is_object() && list.value[0].contains("position_mm")) return {bareGrasp(list)};
  std::vector<NamedGrasp> grasps;
  for (std::size_t i = 0; i < list.value.size(); ++i) grasps.push_back(graspAt(list.at(i)));
  return grasps;
}

std::vector<NamedGrasp> graspsIn(const Place& file) {
  if (!file.value.is_object()) return graspList(file);
  if (file.value.contains("cases")) return graspList(file.at("cases"));
  return {graspAt(file)};
}

std::vector<NamedGrasp> readGrasps(const std::filesystem::path& path) {
  std::ifstream stream(path);
  if (!stream)
    throw InputError(fmt::format("cannot read '{}': check the name and the rights", path.string()));
  json file;
  try {
    file = json::parse(stream);
  } catch (const json::exception& error) {
    throw InputError(fmt::format("'{}' is no JSON: {}", path.string(), error.what()));
  }
  try {
    return graspsIn({file, "file"});
  } catch (const InputError& error) {
    throw InputError(fmt::format("'{}': {}", path.string(), error.what()));
  }
}

WrenchNorm normOf(const std::string& name) {
  if (name == "l1") return WrenchNorm::l1;
  if (name == "linf") return WrenchNorm::linf;
  throw InputError(fmt::format("--norm is '{}', but must be 'l1' or 'linf'", name));
}

void applyOptions(const QualityCommand& command, NamedGrasp& grasp) {
  grasp.options.norm = normOf(command.norm);
  if (command.edges) grasp.options.cone_edges = *command.edges;
  if (!command.friction) return;
  grasp.options.friction = *command.friction;
  for (Contact& contact : grasp.contacts) contact.friction = -1.0;
}

GraspQuality qualityOf(const NamedGrasp& grasp) {
  try {
    return graspQuality(grasp.contacts, grasp.options);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", grasp.name, error.what()));
  }
}

json asJson(const NamedGrasp& grasp, const GraspQuality& quality) {
  return {{"name", grasp.name},
          {"contacts", grasp.contacts.size()},
          {"cone_edges", grasp.options.cone_edges},
          {"torque_scale_mm", kMetre * grasp.options.torque_scale_m},
          {"epsilon", quality.epsilon},
          {"nu", quality.volume},
          {"force_closure", quality.force_closure}};
}

}  // namespace

void runQuality(const QualityCommand& command) {
  json cases = json::array();
  if (!command.json)
    fmt::print("{:<32} {:>8} {:>12} {:>12} {:>13}\n", "grasp", "contacts", "epsilon", "nu", "force closure");
  for (NamedGrasp& grasp : readGrasps(command.contacts)) {
    applyOptions(command, grasp);
    const GraspQuality quality = qualityOf(grasp);
    if (command.json)
      cases.push_back(asJson(grasp, quality));
    else
      fmt::print("{:<32} {:>8} {:>12.6g} {:>12.6g} {:>13}\n", grasp.name, grasp.contacts.size(),
                 quality.epsilon, quality.volume, quality.force_closure ? "yes" : "no");
  }
  if (command.json) printJson(json{{"schema", 1}, {"norm", command.norm}, {"cases", cases}});
}

}  // namespace boxgrasp
