#include "boxgrasp/registry/model_registry.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <nlohmann/json.hpp>
#include <utility>

#include "boxgrasp/base/durable_file.h"
#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uintmax_t kMaxModelFile = std::uintmax_t{32} << 20, kMaxStateFile = std::uintmax_t{4} << 20;
constexpr int kFormatVersion = 1;
constexpr std::array kStates{ModelState::waiting, ModelState::on_trial, ModelState::proven,
                             ModelState::rejected};

std::span<const std::uint8_t> bytesOf(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

json toJson(const RegisteredModel& model) {
  return {{"version", model.version},
          {"created", model.created},
          {"accepted", model.accepted},
          {"key", hexOf(model.signature.key)},
          {"signature", hexOf(model.signature.bytes)},
          {"state", describe(model.state)},
          {"unclean_ends", model.unclean_ends},
          {"reason", model.reason}};
}

ModelState stateOf(const std::string& name) {
  for (const ModelState state : kStates) {
    if (describe(state) == name) return state;
  }
  throw InputError(fmt::format("'{}' is no state of a model", name));
}

// Numbers that the type does not hold are damage: the library would convert them to whatever comes out.
template <typename Integer>
Integer wholeNumber(const json& object, const char* key) {
  const json& value = object.at(key);
  const bool fits = value.is_number_unsigned()
                        ? std::in_range<Integer>(value.get<std::uint64_t>())
                        : value.is_number_integer() && std::in_range<Integer>(value.get<std::int64_t>());
  if (!fits)
    throw InputError(fmt::format("'{}' is {}, but must be a whole number that fits into {} bits", key,
                                 value.dump(), 8 * sizeof(Integer)));
  return value.get<Integer>();
}

RegisteredModel modelFrom(const json& entry) {
  RegisteredModel model;
  model.version = entry.at("version");
  std::array<std::uint8_t, 4> number;  // a version names a file, so it is nothing but hex digits
  readHex(model.version, number, "version");
  model.created = entry.at("created");
  model.accepted = wholeNumber<std::int64_t>(entry, "accepted");
  readHex(entry.at("key").get<std::string>(), model.signature.key, "key");
  readHex(entry.at("signature").get<std::string>(), model.signature.bytes, "signature");
  model.state = stateOf(entry.at("state"));
  model.unclean_ends = wholeNumber<int>(entry, "unclean_ends");
  model.reason = entry.at("reason");
  return model;
}

std::string textOf(const RegistryState& state) {
  json models = json::array();
  for (const RegisteredModel& model : state.models) models.push_back(toJson(model));
  const json content{{"format", "boxgrasp-registry"},
                     {"format_version", kFormatVersion},
                     {"models", models},
                     {"pinned", state.pinned},
                     {"last_order", state.last_order},
                     {"last_order_id", state.last_order_id}};
  return content.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

RegistryState stateFrom(const std::string& text) {
  const json content = json::parse(text);
  if (content.at("format") != "boxgrasp-registry" || content.at("format_version") != kFormatVersion)
    throw InputError(fmt::format("it is not a registry of format {}", kFormatVersion));
  RegistryState state;
  for (const json& entry : content.at("models")) state.models.push_back(modelFrom(entry));
  state.pinned = content.at("pinned");
  if (!state.pinned.empty() && !state.find(state.pinned))
    throw InputError(fmt::format("'{}' is pinned, but is none of its models", state.pinned));
  state.last_order = wholeNumber<std::int64_t>(content, "last_order");
  state.last_order_id = content.at("last_order_id");
  return state;
}

auto findIn(auto& models, const std::string& version) -> decltype(models.data()) {
  const auto found =
      std::find_if(models.begin(), models.end(), [&](const auto& model) { return model.version == version; });
  return found == models.end() ? nullptr : &*found;
}

}  // namespace

std::string_view describe(ModelState state) {
  constexpr std::array<std::string_view, kStates.size()> kNames{"waiting", "on trial", "proven", "rejected"};
  return kNames[static_cast<std::size_t>(state)];
}

const RegisteredModel* RegistryState::find(const std::string& version) const {
  return findIn(models, version);
}
RegisteredModel* RegistryState::find(const std::string& version) { return findIn(models, version); }

std::string RegistryState::chosen() const {
  if (!pinned.empty()) return pinned;
  const auto newest = std::find_if(models.rbegin(), models.rend(), [](const RegisteredModel& model) {
    return model.state != ModelState::rejected;
  });
  return newest == models.rend() ? "" : newest->version;
}

void RegistryState::reject(const std::string& version, const std::string& reason) {
  RegisteredModel& model = *find(version);
  model.state = ModelState::rejected;
  model.reason = reason;
  if (pinned == version) pinned.clear();
}

std::string modelTime(std::int64_t utime) {
  const std::time_t seconds = utime / 1'000'000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

bool isModelTime(const std::string& text) {
  std::tm utc{};
  const char* end = strptime(text.c_str(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return end && *end == '\0' && text.size() == modelTime(0).size();
}

ModelRegistry::ModelRegistry(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error)
    throw InputError(fmt::format("the folder '{}' cannot be made: {}; check --state-dir and its permissions",
                                 folder_.string(), error.message()));
  open();
  removeLeftovers();
}

void ModelRegistry::open() {
  const fs::path file = folder_ / "registry.json";
  if (!fs::exists(file)) return;
  try {
    state_ = stateFrom(readWhole(file, kMaxStateFile));
  } catch (const std::exception& error) {
    const fs::path aside = file.string() + ".damaged";
    std::error_code stays;  // where nothing can be written
    fs::rename(file, aside, stays);
    trouble_ = fmt::format("'{}' is damaged: the registry begins anew, and the old one is '{}' now; {}",
                           file.string(), (stays ? file : aside).filename().string(), error.what());
  }
}

// What a process left that was killed while it wrote: temporary files, and models that no entry speaks of. A
// damaged state may still speak of them.
void ModelRegistry::removeLeftovers() const {
  constexpr std::string_view kTemporaryEnd = ".XXXXXX";
  const bool keep_models = !trouble_.empty() || fs::exists(folder_ / "registry.json.damaged");
  std::error_code stays;  // where nothing can be written; it will be tried again with the next start
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
    const fs::path &file = entry.path(), extension = file.extension();
    const bool is_model = extension == ".json" && file.stem() != "registry",
               is_temporary =
                   file.stem().extension() == ".json" && extension.string().size() == kTemporaryEnd.size();
    if (is_temporary || (is_model && !keep_models && !state_.find(file.stem().string())))
      fs::remove(file, stays);
  }
}

fs::path ModelRegistry::fileOf(const std::string& version) const { return folder_ / (version + ".json"); }

void ModelRegistry::commit(RegistryState next) {
  writeDurably(folder_ / "registry.json", textOf(next));
  state_ = std::move(next);
}

void ModelRegistry::add(std::string_view file, RegistryState next) {
  writeDurably(fileOf(next.models.back().version), file);
  const std::string chosen = next.chosen();
  std::vector<std::string> dropped;
  while (next.models.size() > kMostModels) {
    const auto oldest = next.models.begin() + (next.models.front().version == chosen);
    dropped.push_back(oldest->version);
    next.models.erase(oldest);
  }
  commit(std::move(next));
  std::error_code left;  // removed with the next start
  for (const std::string& version : dropped) fs::remove(fileOf(version), left);
}

Model ModelRegistry::load(const std::string& version) const {
  const fs::path file = fileOf(version);
  const std::string bytes = readWhole(file, kMaxModelFile);
  if (!isValid(state_.find(version)->signature, purpose::kModel, bytesOf(bytes)))
    throw InputError(fmt::format("'{}' is damaged: its bytes are not those that were signed", file.string()));
  Model model = parseModel(bytes, file.string());
  if (model.version != version)
    throw InputError(fmt::format("'{}' holds model {}", file.string(), model.version));
  return model;
}

void ModelRegistry::setAside(const std::string& version) const {
  std::error_code ignored;  // it may be missing
  fs::rename(fileOf(version), fileOf(version).string() + ".damaged", ignored);
}

}  // namespace boxgrasp
