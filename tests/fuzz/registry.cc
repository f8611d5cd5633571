// The state of the registry of models (JSON).
#include "boxgrasp/registry/model_registry.h"
#include "fuzz_target.h"

namespace boxgrasp::fuzz {
namespace {

// As the daemon starts with a registry.
void start(ModelRegistry registry) {
  const std::string chosen = registry.state().chosen();
  if (!chosen.empty()) accepts([&] { registry.load(chosen); });
  for (const RegisteredModel& model : registry.state().models) accepts([&] { registry.load(model.version); });
  registry.commit(registry.state());
}

}  // namespace

void feed(Bytes bytes) {
  static const Folder folder;
  folder.file("registry.json", bytes);
  start(ModelRegistry(folder.path()));
  promise(ModelRegistry(folder.path()).trouble().empty());
}

std::vector<std::string> seeds() {
  const Folder folder;
  RegistryState state;
  state.models.push_back({"0badc0de", "2026-01-31T00:00:00Z", 1, {}, ModelState::proven, 0, ""});
  state.models.push_back({"c0ffee00", "2026-02-01T00:00:00Z", 2, {}, ModelState::rejected, 2, "it crashed"});
  state.pinned = "0badc0de";
  ModelRegistry(folder.path()).commit(state);
  return {folder.read("registry.json")};
}

}  // namespace boxgrasp::fuzz
