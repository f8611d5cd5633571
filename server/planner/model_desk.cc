#include "model_desk.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "boxgrasp/base/error.h"
#include "boxgrasp/messaging/plan_conversion.h"
#include "boxgrasp/messaging/publication.h"
#include "boxgrasp/registry/canary.h"

namespace boxgrasp {
namespace {

constexpr std::int64_t kSecond = 1'000'000;  // of a stamp
constexpr std::int64_t kFresh = 300 * kSecond, kAhead = 86'400 * kSecond;

std::string_view textOf(const std::vector<std::uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string clipped(const std::string& text) {
  constexpr std::size_t kMost = 1000;
  return text.size() > kMost ? text.substr(0, kMost) : text;
}

// As "4 x 9-8-1".
std::string shapeOf(const Ensemble& ensemble) {
  std::string shape = fmt::format("{} x {}", ensemble.networks.size(), ensemble.inputs());
  for (const Layer& layer : ensemble.networks.front().layers) shape += fmt::format("-{}", layer.bias.size());
  return shape;
}

model_info_t describe(const Model& model) {
  model_info_t info{};
  info.version = model.version;
  info.name = clipped(model.name);
  info.created = clipped(model.created);
  info.trained_on = clipped(model.trained_on);
  info.command = clipped(model.command);
  info.data_hash = clipped(model.data_hash);
  info.seed = static_cast<std::int64_t>(model.seed);
  info.features = clipped(fmt::format("{}", fmt::join(model.features, " ")));
  info.shape = shapeOf(model.ensemble);
  constexpr std::size_t kMostMetrics = 64;
  for (const auto& [name, value] : model.metrics) {
    if (info.metrics.size() < kMostMetrics) info.metrics.push_back({clipped(name), value});
  }
  info.num_metrics = static_cast<std::int32_t>(info.metrics.size());
  return info;
}

constexpr char kNoFolder[] =
    "this server keeps no models: start it with --state-dir FOLDER and --trusted-keys FOLDER";

}  // namespace

struct ModelDesk::Candidate {
  PlannerPtr planner;
  std::string signer;
};

ModelDesk::ModelDesk(PlannerPtr base, ModelDeskOptions options, TakeOver take_over, Log log)
    : base_(std::move(base)),
      options_(std::move(options)),
      take_over_(std::move(take_over)),
      log_(std::move(log)),
      serving_(base_) {
  if (options_.folder.empty()) return;
  registry_.emplace(options_.folder);
  if (!registry_->trouble().empty()) log_(registry_->trouble());
  try {
    countUncleanEnd();
    serving_ = choose();
  } catch (const InputError& error) {  // a full disk, say: plans come first
    log_(fmt::format("model {} is in service: {}", serving_->model().version, error.what()));
  }
}

ModelDesk::~ModelDesk() {
  if (!trial_) return;
  try {
    RegistryState next = state();
    pauseTrial(next);
    registry_->commit(std::move(next));
  } catch (const std::exception& error) {
    log_(fmt::format("the end of model {}'s trial cannot be written: {}", trial_->version(), error.what()));
  }
}

const RegistryState& ModelDesk::state() const {
  static const RegistryState kNone;
  return registry_ ? registry_->state() : kNone;
}

void ModelDesk::countUncleanEnd() {
  RegistryState next = state();
  const auto tried = std::find_if(next.models.begin(), next.models.end(), [](const RegisteredModel& model) {
    return model.state == ModelState::on_trial;
  });
  if (tried == next.models.end()) return;
  if (++tried->unclean_ends >= kMostUncleanEnds) {
    next.reject(tried->version, fmt::format("the server ended unexpectedly {} times while it was on trial",
                                            tried->unclean_ends));
    log_(fmt::format("model {} is rejected: {}", tried->version, tried->reason));
  }
  registry_->commit(std::move(next));
}

// --- which model is in service

PlannerPtr ModelDesk::plannerOf(const std::string& version) const {
  if (version == base_->model().version) return base_;
  const RegisteredModel* entry = state().find(version);
  if (!entry) throw InputError("it is not among the models of this server");
  if (!options_.keys.nameOf(entry->signature.key))
    throw InputError(fmt::format("its key {} is not trusted any more", hexOf(entry->signature.key)));
  try {
    return std::make_shared<const GraspPlanner>(base_->hand(), registry_->load(version), base_->options());
  } catch (const InputError&) {
    registry_->setAside(version);
    throw;
  }
}

// The planner of the model that the state chooses. Models that cannot be used are discarded on the way. What
// has not proven itself is on trial from now on, on disk before anybody plans with it.
PlannerPtr ModelDesk::choose() {
  for (std::string version = state().chosen(); !version.empty(); version = state().chosen()) {
    PlannerPtr planner;
    try {
      planner = plannerOf(version);
    } catch (const InputError& error) {
      discard(version, error.what());
      continue;
    }
    const RegisteredModel* entry = state().find(version);
    if (entry && entry->state != ModelState::proven)
      beginTrial(version);
    else
      trial_.reset();
    return planner;
  }
  trial_.reset();
  return base_;
}

void ModelDesk::discard(const std::string& version, const std::string& reason) {
  log_(fmt::format("model {} cannot be used: {}", version, reason));
  RegistryState next = state();
  next.pinned.clear();
  if (next.find(version)) next.reject(version, reason);
  registry_->commit(std::move(next));
}

void ModelDesk::serve(PlannerPtr planner) {
  serving_ = std::move(planner);
  take_over_(serving_);
  log_(fmt::format("model {} is in service", serving_->model().version));
}

// --- publication

const std::string& ModelDesk::signerOf(const Signature& signature, std::string_view what,
                                       std::span<const std::uint8_t> bytes, std::string_view purpose) const {
  if (options_.keys.empty())
    throw InputError(
        "this server trusts no key; start it with --trusted-keys FOLDER, where the publisher's .pub file "
        "lies");
  if (signature.empty())
    throw InputError(fmt::format("the {} is not signed; name a key with --key FILE", what));
  const std::string* name = options_.keys.nameOf(signature.key);
  if (!name)
    throw InputError(
        fmt::format("the {} is signed with the key {}, which this server does not trust; copy its .pub file "
                    "into the server's "
                    "folder of trusted keys and restart the server, or sign with another key",
                    what, hexOf(signature.key)));
  if (!isValid(signature, purpose, bytes))
    throw InputError(fmt::format(
        "the signature does not fit the {}: it was altered after it was signed, or on its way; send it again",
        what));
  return *name;
}

void ModelDesk::checkAge(const Model& model) const {
  if (!isModelTime(model.created))
    throw InputError(fmt::format("the model was created at '{}', but must say a time like {}; train it again",
                                 clipped(model.created), modelTime(0)));
  if (model.created > modelTime(utimeNow() + kAhead))
    throw InputError(fmt::format(
        "the model was created at {}, which is in the future; set the trainer's clock, and train it again",
        model.created));
  std::string oldest = options_.oldest;
  for (const RegisteredModel& known : state().models) oldest = std::max(oldest, known.created);
  if (model.created < oldest)
    throw InputError(
        fmt::format("the model was created at {}, before the oldest that is taken, {}; train it again, or, "
                    "to go back to a "
                    "model that was published before: boxgrasp models pin VERSION",
                    model.created, oldest));
}

ModelDesk::Candidate ModelDesk::examine(const publish_model_t& message) const {
  if (!registry_) throw InputError(kNoFolder);
  Candidate candidate;
  candidate.signer = signerOf(fromMessage(message.signature), "model", message.model, purpose::kModel);
  Model model = parseModel(std::string(textOf(message.model)), "the published one");
  const RegisteredModel* known = state().find(model.version);
  if (known && known->state == ModelState::rejected)
    throw InputError(
        fmt::format("model {} was rejected before ({}); train another, or try it again with: boxgrasp "
                    "models pin {}",
                    model.version, known->reason, model.version));
  if (!known) checkAge(model);
  runCanary(model, slowestAllowed(graspSeconds(serving_->model())));
  candidate.planner = std::make_shared<const GraspPlanner>(base_->hand(), std::move(model), base_->options());
  return candidate;
}

// On disk first; then in service, unless another model is pinned.
void ModelDesk::accept(const publish_model_t& message, const Candidate& candidate) {
  const Model& model = candidate.planner->model();
  if (state().find(model.version)) return;
  RegistryState next = state();
  if (next.pinned.empty()) pauseTrial(next);
  RegisteredModel& entry = next.models.emplace_back();
  entry.version = model.version;
  entry.created = model.created;
  entry.accepted = utimeNow();
  entry.signature = fromMessage(message.signature);
  entry.state = next.pinned.empty() ? ModelState::on_trial : ModelState::waiting;
  registry_->add(textOf(message.model), std::move(next));
  if (!state().pinned.empty()) return;
  beginTrial(model.version);
  serve(candidate.planner);
}

model_reply_t ModelDesk::publish(const publish_model_t& message) {
  model_reply_t reply{};
  reply.request_id = message.request_id;
  reply.outcome = model_reply_t::REFUSED;
  try {
    const Candidate candidate = examine(message);
    reply.outcome = model_reply_t::FAILED;
    reply.version = candidate.planner->model().version;
    accept(message, candidate);
    const bool serves = serving_->model().version == reply.version;
    reply.outcome = serves ? model_reply_t::IN_SERVICE : model_reply_t::KEPT;
    reply.message =
        serves ? fmt::format("model {} of {} is in service", reply.version, candidate.signer)
               : fmt::format("model {} of {} is kept, but model {} is in service; boxgrasp models {}",
                             reply.version, candidate.signer, serving_->model().version,
                             state().pinned.empty() ? "pin " + reply.version : "unpin");
  } catch (const std::exception& error) {
    reply.message = error.what();
  }
  log_(fmt::format("publication of model '{}': {}", reply.version, reply.message));
  reply.utime = utimeNow();
  return reply;
}

// --- trials

// Durable before it begins. One that goes on for the same model goes on.
void ModelDesk::beginTrial(const std::string& version) {
  if (trial_ && trial_->version() == version) return;
  if (state().find(version)->state != ModelState::on_trial) {
    RegistryState next = state();
    next.find(version)->state = ModelState::on_trial;
    registry_->commit(std::move(next));
  }
  trial_.emplace(version, graspSeconds(serving_->model()));
}

// The model on trial, unless it was rejected meanwhile, will be tried again when its turn comes.
void ModelDesk::pauseTrial(RegistryState& next) const {
  RegisteredModel* tried = trial_ ? next.find(trial_->version()) : nullptr;
  if (tried && tried->state == ModelState::on_trial) tried->state = ModelState::waiting;
}

void ModelDesk::observe(const plan_response_t& plan) {
  if (!trial_) return;
  trial_->add(plan);
  if (!trial_->failed() && !trial_->passed()) return;
  const std::string version = trial_->version();
  RegistryState next = state();
  if (trial_->passed()) {
    next.find(version)->state = ModelState::proven;
    registry_->commit(std::move(next));
    trial_.reset();
    return log_(fmt::format("model {} has proven itself", version));
  }
  log_(fmt::format("model {} is rejected: {}", version, trial_->failure()));
  next.reject(version, trial_->failure());
  registry_->commit(std::move(next));
  serve(choose());
}

// --- orders

void ModelDesk::requireFresh(const models_request_t& order) const {
  if (std::abs(utimeNow() - order.utime) > kFresh)
    throw InputError(
        fmt::format("the order was given at {}, but here it is {}; orders are obeyed within {} s: give it "
                    "again, and set the "
                    "clocks if that does not help",
                    modelTime(order.utime), modelTime(utimeNow()), kFresh / kSecond));
  if (order.utime <= state().last_order) throw InputError("a later order was obeyed already; give it again");
}

std::string ModelDesk::pin(RegistryState& next, const std::string& version) const {
  RegisteredModel* entry = next.find(version);
  if (!entry && version != base_->model().version)
    throw InputError(fmt::format("there is no model '{}' here; boxgrasp models list shows them", version));
  if (entry && entry->state == ModelState::rejected) {
    entry->state = ModelState::waiting;
    entry->unclean_ends = 0;
    entry->reason.clear();
  }
  plannerOf(version);
  next.pinned = version;
  return fmt::format("model {} is pinned", version);
}

std::string ModelDesk::rollBack(RegistryState& next, const std::string& signer) const {
  const std::string version = serving_->model().version;
  if (!next.find(version))
    throw InputError(fmt::format(
        "model {} is in service, which the server was started with: there is none before it", version));
  next.reject(version, fmt::format("rolled back by {}", signer));
  return fmt::format("model {} is rolled back", version);
}

std::string ModelDesk::obey(const models_request_t& order) {
  if (!registry_) throw InputError(kNoFolder);
  const std::vector<std::uint8_t> bytes = signedBytes(order);
  const std::string& signer = signerOf(fromMessage(order.signature), "order", bytes, purpose::kModels);
  if (order.utime == state().last_order && order.request_id == state().last_order_id) return "done already";
  requireFresh(order);
  RegistryState next = state();
  next.last_order = order.utime;
  next.last_order_id = order.request_id;
  std::string done = "no model is pinned any more";
  if (order.action == models_request_t::PIN)
    done = pin(next, order.version);
  else if (order.action == models_request_t::UNPIN)
    next.pinned.clear();
  else if (order.action == models_request_t::ROLL_BACK)
    done = rollBack(next, signer);
  else
    throw InputError(
        fmt::format("{} is no action; this server is older or newer than its client", order.action));
  const std::string before = serving_->model().version;
  if (next.chosen() != before) pauseTrial(next);
  registry_->commit(std::move(next));
  const PlannerPtr chosen = choose();
  if (chosen->model().version != before) serve(chosen);
  return fmt::format("{}; model {} is in service", done, serving_->model().version);
}

models_reply_t ModelDesk::answer(const models_request_t& request) {
  models_reply_t reply{};
  reply.request_id = request.request_id;
  try {
    if (request.action != models_request_t::LIST) {
      reply.message = obey(request);
      log_(fmt::format("order: {}", reply.message));
    }
    reply.done = true;
  } catch (const std::exception& error) {
    reply.message = error.what();
    log_(fmt::format("order refused: {}", reply.message));
  }
  std::erase_if(infos_, [&](const auto& info) { return !state().find(info.first); });
  reply.models.push_back(baseInfo());
  for (const RegisteredModel& entry : state().models) reply.models.push_back(infoOf(entry));
  for (model_info_t& info : reply.models) {
    info.serving = info.version == serving_->model().version;
    info.pinned = info.version == state().pinned;
  }
  reply.num_models = static_cast<std::int32_t>(reply.models.size());
  reply.utime = utimeNow();
  return reply;
}

model_info_t ModelDesk::baseInfo() const {
  model_info_t info = describe(base_->model());
  info.state = "base";
  return info;
}

model_info_t ModelDesk::infoOf(const RegisteredModel& entry) {
  model_info_t info{};
  try {
    if (!infos_.contains(entry.version)) infos_[entry.version] = describe(registry_->load(entry.version));
    info = infos_[entry.version];
  } catch (const InputError&) {  // a damaged model that is not in service: its entry still says why
    info.version = entry.version;
    info.created = entry.created;
  }
  const std::string* name = options_.keys.nameOf(entry.signature.key);
  info.key = name ? *name : hexOf(entry.signature.key);
  info.state = describe(entry.state);
  info.reason = clipped(entry.reason);
  info.accepted = entry.accepted;
  return info;
}

}  // namespace boxgrasp
