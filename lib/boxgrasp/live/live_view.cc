#include "boxgrasp/live/live_view.h"

#include <fmt/format.h>
#include <sodium.h>

#include <charconv>
#include <utility>

#include "boxgrasp/live/metrics.h"
#include "boxgrasp/live/status_json.h"
#include "boxgrasp/messaging/plan_conversion.h"
#include "boxgrasp/viewer/plan_page.h"

namespace boxgrasp {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::chrono::seconds kTrainingMemory{5};  // a worker says how it is once a second
constexpr std::chrono::seconds kLookMemory{10};     // a page asks once a second
constexpr char kJsonType[] = "application/json; charset=utf-8";

WebReply jsonReply(const Json& json, int status = 200) {
  return {status, kJsonType, json.dump(-1, ' ', false, Json::error_handler_t::replace)};
}

WebReply notFound(const std::string& what) { return jsonReply({{"schema", 1}, {"error", what}}, 404); }

// The texts between <tag> and </tag>, as sources that a Content-Security-Policy lets through.
std::string hashesOf(const std::string& page, const std::string& tag) {
  std::string sources;
  const std::string begin = "<" + tag + ">", end = "</" + tag + ">";
  for (std::size_t at = page.find(begin); at != std::string::npos; at = page.find(begin, at)) {
    at += begin.size();
    const std::size_t size = page.find(end, at) - at;
    unsigned char hash[crypto_hash_sha256_BYTES];
    crypto_hash_sha256(hash, reinterpret_cast<const unsigned char*>(page.data()) + at, size);
    char text[sodium_base64_ENCODED_LEN(sizeof hash, sodium_base64_VARIANT_ORIGINAL)];
    sodium_bin2base64(text, sizeof text, hash, sizeof hash, sodium_base64_VARIANT_ORIGINAL);
    sources += fmt::format(" 'sha256-{}'", text);
    at += size;
  }
  return sources;
}

// Its own scripts and styles, images within the page, and questions to where it came from: nothing else.
WebReply pageReply() {
  WebReply reply{200, "text/html; charset=utf-8", livePage(), {}};
  reply.policy = fmt::format(
      "default-src 'none'; script-src{}; style-src{}; img-src data:; connect-src 'self'; base-uri 'none'; "
      "form-action 'none'; frame-ancestors 'none'",
      hashesOf(reply.body, "script"), hashesOf(reply.body, "style"));
  return reply;
}

Json summaryJson(const AnsweredRequest& request) {
  return {{"id", request.id},
          {"request_id", request.request_id},
          {"utime", request.utime},
          {"outcome", outcomeName(request.outcome)},
          {"message", request.message},
          {"model_version", request.model_version},
          {"num_grasps", request.num_grasps},
          {"time_s", request.time_s},
          {"planned", request.plan != nullptr}};
}

}  // namespace

LiveView::LiveView(HandDescription hand, const LiveViewOptions& options)
    : hand_(std::move(hand)),
      history_(options.max_plans, options.max_bytes),
      looked_at_((Clock::now() - 2 * kLookMemory).time_since_epoch().count()) {}

void LiveView::answered(const plan_response_t& answer, MadePlanPtr plan) {
  history_.add(answer, std::move(plan));
}

void LiveView::update(ServerState state) {
  const std::lock_guard lock(mutex_);
  state_ = std::move(state);
}

void LiveView::update(const training_status_t& training) {
  const std::lock_guard lock(mutex_);
  training_ = training;
  training_heard_ = Clock::now();
}

void LiveView::update(models_reply_t models) {
  const std::lock_guard lock(mutex_);
  models_ = std::move(models);
}

bool LiveView::isLookedAt() const {
  return Clock::now() - Clock::time_point(Clock::duration(looked_at_.load())) < kLookMemory;
}

std::optional<training_status_t> LiveView::trainingNow() const {
  return Clock::now() - training_heard_ < kTrainingMemory ? training_ : std::nullopt;
}

WebReply LiveView::page(const std::string& path) {
  static const std::string plans = "/api/plans/";
  if (path == "/") return pageReply();
  if (path == "/api/status") return statusPage();
  if (path == "/api/plans") return plansPage();
  if (path.starts_with(plans)) return planPage(path.substr(plans.size()));
  return notFound("there are /, /api/status, /api/plans and /api/plans/<id>");
}

WebReply LiveView::metrics(const std::string& path) const {
  if (path != "/metrics") return notFound("there is /metrics");
  const std::lock_guard lock(mutex_);
  return {200, "text/plain; version=0.0.4; charset=utf-8", metricsText(state_, trainingNow())};
}

WebReply LiveView::statusPage() {
  looked_at_ = Clock::now().time_since_epoch().count();
  const std::lock_guard lock(mutex_);
  Json json = statusJson(state_.status), models = Json::array();
  for (const model_info_t& model : models_.models) models.push_back(modelJson(model));
  json["utime"] = state_.status.utime;
  json["receiver_restarts"] = state_.receiver_restarts;
  json["resident_bytes"] = state_.resident_bytes;
  const auto training = trainingNow();
  json["training"] = training ? trainingJson(*training) : Json(nullptr);
  json["models"] = models;
  return jsonReply(json);
}

WebReply LiveView::plansPage() {
  Json plans = Json::array();
  for (const AnsweredRequest& request : history_.newestFirst()) plans.push_back(summaryJson(request));
  return jsonReply({{"schema", 1}, {"plans", plans}});
}

WebReply LiveView::planPage(const std::string& id) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(id.data(), id.data() + id.size(), number);
  const bool is_number = error == std::errc{} && end == id.data() + id.size();
  const auto request = is_number ? history_.find(number) : std::nullopt;
  if (!request) return notFound("no such plan; only the latest are kept, and /api/plans lists them");
  return sceneOf(*request);
}

WebReply LiveView::sceneOf(const AnsweredRequest& request) {
  const std::lock_guard lock(scene_mutex_);
  if (scene_id_ != request.id) {
    static const MadePlan not_planned;
    const MadePlan& plan = request.plan ? *request.plan : not_planned;
    Json scene = planScene(plan.result, plan.trace, hand_, {.title = request.request_id});
    scene["outcome"] = outcomeName(request.outcome);
    scene["message"] = request.message;
    scene["model_version"] = request.model_version;
    scene_ = jsonReply(scene).body;
    scene_id_ = request.id;
  }
  return {200, kJsonType, scene_};
}

}  // namespace boxgrasp
