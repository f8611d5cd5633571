// The models that were published to a server, on its disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "boxgrasp/ranking/model_file.h"
#include "boxgrasp/registry/signing.h"

namespace boxgrasp {

enum class ModelState {
  waiting,   // never in service, or not since a clean end of its trial
  on_trial,  // in service, and not yet proven: a crash now may be its fault
  proven,
  rejected,  // refused after it was accepted: rolled back, crashed, slow, damaged
};
std::string_view describe(ModelState state);

struct RegisteredModel {
  std::string version;
  std::string created;        // as its file says
  std::int64_t accepted = 0;  // microseconds since 1970
  Signature signature;        // of its file's bytes
  ModelState state = ModelState::waiting;
  int unclean_ends = 0;  // of the server, while it was on trial
  std::string reason;    // why it was rejected
};

struct RegistryState {
  std::vector<RegisteredModel> models;  // as they were accepted
  std::string pinned;                   // version; empty: none
  std::int64_t last_order = 0;          // stamp of the last order that was obeyed, microseconds since 1970
  std::string last_order_id;

  RegisteredModel* find(const std::string& version);
  const RegisteredModel* find(const std::string& version) const;
  // What is to be in service: the pinned version; else the newest that is not rejected; else empty.
  std::string chosen() const;
  // Also takes the pin off it. Pre: the version is there.
  void reject(const std::string& version, const std::string& reason);
};

// When a model was created, as its file says it: ISO 8601, UTC, whole seconds. Such texts sort like their
// times.
std::string modelTime(std::int64_t utime);
bool isModelTime(const std::string& text);

// One folder: "<version>.json" for each model, byte for byte as it was published, and "registry.json" for the
// state. Every change is one rename, with all that it speaks of on the disk before it: a process that is
// killed at any moment leaves the state before or after the change. For one process at a time.
class ModelRegistry {
 public:
  static constexpr std::size_t kMostModels = 50;  // beyond, the oldest are deleted

  // Makes the folder where there is none. A state that cannot be read is set aside, which trouble() tells,
  // and the registry begins anew. Throws InputError where the folder cannot be used.
  explicit ModelRegistry(std::filesystem::path folder);

  const RegistryState& state() const { return state_; }
  // What was wrong with the folder when it was opened; empty: nothing.
  const std::string& trouble() const { return trouble_; }

  // Durable on return. Throws InputError where it cannot be written; then nothing has changed.
  void commit(RegistryState next);
  // Writes the file of next's last model, deletes the oldest models above kMostModels, and commits. As
  // commit().
  void add(std::string_view file, RegistryState next);

  // The model of an entry, its signature checked. Throws InputError for a file that is missing, damaged or
  // altered.
  Model load(const std::string& version) const;
  // Renames the file of a damaged model to "<version>.json.damaged", where it does no harm and can be looked
  // at.
  void setAside(const std::string& version) const;

 private:
  std::filesystem::path fileOf(const std::string& version) const;
  void open();
  void removeLeftovers() const;

  std::filesystem::path folder_;
  RegistryState state_;
  std::string trouble_;
};

}  // namespace boxgrasp
