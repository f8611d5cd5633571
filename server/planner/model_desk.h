// The models of the daemon: who may publish them, which one is in service, and back to the one before.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "boxgrasp/messaging/codec.h"
#include "boxgrasp/registry/model_registry.h"
#include "plan_service.h"
#include "trial.h"

namespace boxgrasp {

struct ModelDeskOptions {
  std::filesystem::path folder;  // of the registry; empty: none, and nothing can be published
  TrustedKeys keys;
  std::string oldest;  // creation time (ISO 8601, UTC); models created before it are refused; empty: none are
};

// Holds the registry and decides. A published model is examined, tried on canary grasps, written to disk, and
// only then taken over and announced; then it is on trial. It is rejected, and the one before it is back in
// service, when its trial fails or the server ends uncleanly twice while it is on trial: once may have been
// anything. All calls from one thread at a time, none of them from where plans are made.
class ModelDesk {
 public:
  // Called with the planner that takes over.
  using TakeOver = std::function<void(PlannerPtr)>;
  using Log = std::function<void(const std::string&)>;

  static constexpr int kMostUncleanEnds = 2;

  // `base` is in service until a model is published, and when all are rejected. Damaged models are set aside,
  // with a line in the log. Throws InputError where the folder cannot be used.
  ModelDesk(PlannerPtr base, ModelDeskOptions options, TakeOver take_over, Log log);
  // A clean end: a trial that runs begins anew with the next start.
  ~ModelDesk();
  ModelDesk(const ModelDesk&) = delete;
  ModelDesk& operator=(const ModelDesk&) = delete;

  const PlannerPtr& serving() const { return serving_; }

  model_reply_t publish(const publish_model_t& message);
  models_reply_t answer(const models_request_t& request);
  // A plan that was made: it counts in a trial.
  void observe(const plan_response_t& plan);

 private:
  struct Candidate;
  Candidate examine(const publish_model_t& message) const;
  const std::string& signerOf(const Signature& signature, std::string_view what,
                              std::span<const std::uint8_t> bytes, std::string_view purpose) const;
  void checkAge(const Model& model) const;
  void accept(const publish_model_t& message, const Candidate& candidate);
  std::string obey(const models_request_t& order);
  void requireFresh(const models_request_t& order) const;
  std::string pin(RegistryState& next, const std::string& version) const;
  std::string rollBack(RegistryState& next, const std::string& signer) const;

  const RegistryState& state() const;
  void countUncleanEnd();
  void pauseTrial(RegistryState& next) const;
  void discard(const std::string& version, const std::string& reason);
  PlannerPtr plannerOf(const std::string& version) const;
  PlannerPtr choose();
  void serve(PlannerPtr planner);
  void beginTrial(const std::string& version);
  model_info_t infoOf(const RegisteredModel& entry);
  model_info_t baseInfo() const;

  const PlannerPtr base_;
  const ModelDeskOptions options_;
  const TakeOver take_over_;
  const Log log_;
  std::optional<ModelRegistry> registry_;
  PlannerPtr serving_;
  std::optional<Trial> trial_;
  std::map<std::string, model_info_t>
      infos_;  // what the files of the registry say, as far as it was asked for
};

}  // namespace boxgrasp
