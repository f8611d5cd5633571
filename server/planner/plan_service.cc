#include "plan_service.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <new>
#include <utility>

#include "boxgrasp/base/error.h"
#include "boxgrasp/messaging/plan_conversion.h"

namespace boxgrasp {
namespace {

constexpr std::size_t kStampEnd = 16;  // fingerprint and utime, which are no part of a request's content
constexpr double kLongestDeadline_s = 86400.0;  // keeps the clock's arithmetic in range
constexpr double kStuck_s = 60.0;               // stages look at their deadline far more often

// Tells contents apart at the speed of memory, since every request waits for it. Two that differ in one word
// never have the same; it is no defence against senders who want two to look alike, and need not be one.
std::string contentDigest(PlanService::Bytes bytes) {
  constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15;
  std::array<std::uint64_t, 4> lanes{1, 2, 3, bytes.size()};
  const auto mix = [&](std::uint64_t& lane, std::uint64_t word) {
    lane = std::rotl((lane ^ word) * kOdd, 29);
  };
  PlanService::Bytes rest = bytes.subspan(kStampEnd);
  for (; rest.size() >= sizeof lanes; rest = rest.subspan(sizeof lanes)) {
    std::array<std::uint64_t, 4> words;
    std::memcpy(words.data(), rest.data(), sizeof words);
    for (std::size_t i = 0; i < lanes.size(); ++i) mix(lanes[i], words[i]);
  }
  for (const std::uint8_t byte : rest) mix(lanes[0], byte);
  return fmt::format("{:016x}", fmt::join(lanes, ""));
}

// Of a request whose bytes were checked: the text after its stamp.
std::string requestIdOf(PlanService::Bytes bytes) {
  constexpr std::size_t kLengthBytes = 4;
  return reinterpret_cast<const char*>(bytes.data() + kStampEnd + kLengthBytes);
}

PlanService::Clock::duration seconds(double s) {
  return std::chrono::duration_cast<PlanService::Clock::duration>(
      std::chrono::duration<double>(std::min(s, kLongestDeadline_s)));
}

double secondsSince(PlanService::Clock::time_point start) {
  return std::chrono::duration<double>(PlanService::Clock::now() - start).count();
}

bool isWorthKeeping(std::int8_t outcome) {
  return outcome != plan_response_t::OVERLOADED && outcome != plan_response_t::INTERNAL_ERROR;
}

constexpr char kNoMemory[] =
    "the server has not enough memory for this cloud; thin it, or give the server more";

AnswerInputs inputsOf(const PlanResult& result, const Model& model) {
  AnswerInputs inputs{model.features, {}};
  for (const Grasp& grasp : result.grasps) inputs.grasps.push_back(grasp.inputs);
  return inputs;
}

}  // namespace

PlanService::PlanService(PlannerPtr planner, const ServerOptions& options, std::function<void()> wake)
    : options_(options),
      wake_(std::move(wake)),
      planner_(std::move(planner)),
      memory_(options.answers, options.answers_bytes) {
  for (int i = 0; i < options_.workers; ++i) workers_.emplace_back([this] { work(); });
}

PlanService::~PlanService() {
  close();
  cancelAll();
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  work_waits_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

PlanService::JobPtr PlanService::makeJob(plan_request_t request, std::string digest) const {
  const auto arrival = Clock::now();
  const double given_s = request.deadline_s;
  // NaN, which is refused later, also gets the default: a worker must come to it.
  const double deadline_s = given_s < 0 ? 0.0 : given_s > 0 ? given_s : options_.deadline_s;
  return std::make_shared<Job>(
      Job{std::move(request), std::move(digest), arrival, arrival + seconds(deadline_s)});
}

void PlanService::request(Bytes bytes) try {
  plan_request_t message = decoded<plan_request_t>(bytes);
  const JobPtr job = makeJob(std::move(message), contentDigest(bytes));
  const std::lock_guard lock(mutex_);
  const AnswerMemory::Entry* known = memory_.find(job->id());
  const Job* twin = known ? nullptr : inFlight(job->id());
  if (job->id().empty())
    return refuse(plan_response_t::BAD_INPUT, "the request has no request_id; choose one", job->request);
  if ((known && known->digest != job->digest) || (twin && twin->digest != job->digest))
    return refuse(plan_response_t::BAD_INPUT,
                  "this request_id was used for another request; choose a new one", job->request);
  if (known || twin) ++repeated_;
  if (known) return send({known->answer, false});
  if (twin) return;
  if (closed_ || full(*job))
    return refuse(plan_response_t::OVERLOADED,
                  closed_ ? "the server is ending; ask again when it is back"
                          : fmt::format("{} requests wait already; ask again later", queue_.size()),
                  job->request);
  enqueue(job);
} catch (const std::bad_alloc&) {
  plan_request_t request{};
  request.request_id = requestIdOf(bytes);
  const std::lock_guard lock(mutex_);
  refuse(plan_response_t::INTERNAL_ERROR, kNoMemory, request);
}

void PlanService::cloud(const std::string& channel, Bytes bytes) {
  plan_request_t message{};
  message.cloud = decoded<drake::lcmt_point_cloud>(bytes);
  message.request_id = fmt::format("{}@{}", channel, message.cloud.utime);
  message.object = -1;
  const JobPtr job = makeJob(std::move(message), "");
  const std::lock_guard lock(mutex_);
  if (closed_) return;
  const auto waiting =
      std::find_if(queue_.begin(), queue_.end(), [](const JobPtr& j) { return j->fromChannel(); });
  if (waiting == queue_.end()) return enqueue(job);
  *waiting = job;
  ++superseded_;
}

void PlanService::cancel(const std::string& request_id) {
  const std::lock_guard lock(mutex_);
  for (const JobPtr& job : running_) {
    if (job->id() == request_id) job->cancelled->store(true);
  }
  const auto waiting =
      std::find_if(queue_.begin(), queue_.end(), [&](const JobPtr& job) { return job->id() == request_id; });
  if (waiting == queue_.end()) return;
  const JobPtr job = *waiting;
  queue_.erase(waiting);
  finish(*job,
         {refusal(plan_response_t::CANCELLED, "cancelled before it was begun", job->id(),
                  job->request.cloud.frame_name)},
         *planner_);
}

void PlanService::takeOver(PlannerPtr planner) {
  const std::lock_guard lock(mutex_);
  planner_ = std::move(planner);
}

std::vector<DueAnswer> PlanService::takeAnswers() {
  const std::lock_guard lock(mutex_);
  expire();
  return std::exchange(outbox_, {});
}

void PlanService::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  for (const JobPtr& job : std::exchange(queue_, {}))
    refuse(plan_response_t::OVERLOADED, "the server is ending; ask again when it is back", job->request);
}

void PlanService::cancelAll() {
  const std::lock_guard lock(mutex_);
  for (const JobPtr& job : running_) job->cancelled->store(true);
}

bool PlanService::finished() const {
  const std::lock_guard lock(mutex_);
  return closed_ && running_.empty() && outbox_.empty();
}

bool PlanService::stuck() const {
  const std::lock_guard lock(mutex_);
  return std::any_of(running_.begin(), running_.end(),
                     [](const JobPtr& job) { return secondsSince(job->deadline) > kStuck_s; });
}

status_t PlanService::status() const {
  const std::lock_guard lock(mutex_);
  status_t status{};
  status.utime = utimeNow();
  status.model_version = planner_->model().version;
  status.hand = planner_->hand().name;
  status.uptime_s = secondsSince(start_);
  status.workers = options_.workers;
  status.running = static_cast<int>(running_.size());
  status.queue_length = static_cast<int>(queue_.size());
  status.queue_capacity = options_.queue;
  status.overloaded = full({});
  for (const JobPtr& job : running_) status.active.push_back(job->id());
  for (const JobPtr& job : queue_) status.active.push_back(job->id());
  status.num_active = static_cast<int>(status.active.size());
  std::copy(outcomes_.begin(), outcomes_.end(), status.outcomes);
  status.repeated = repeated_;
  status.superseded = superseded_;
  status.latency_p50_s = latencies_.quantile(0.50);
  status.latency_p90_s = latencies_.quantile(0.90);
  status.latency_p99_s = latencies_.quantile(0.99);
  return status;
}

LatencyCounts PlanService::latencies() const {
  const std::lock_guard lock(mutex_);
  return latencies_.counts();
}

void PlanService::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    work_waits_.wait(lock, [&] { return ending_ || !queue_.empty(); });
    if (queue_.empty()) return;
    const JobPtr job = queue_.front();
    queue_.pop_front();
    running_.push_back(job);
    const PlannerPtr planner = planner_;
    lock.unlock();
    Answer answer = answerTo(*job, *planner);
    lock.lock();
    std::erase(running_, job);
    if (answer.response.outcome != plan_response_t::DEADLINE) latencies_.add(secondsSince(job->arrival));
    finish(*job, std::move(answer), *planner);
  }
}

PlanService::Answer PlanService::answerTo(Job& job, const GraspPlanner& planner) const {
  const std::string frame = job.request.cloud.frame_name;
  try {
    PlanRequest request = fromMessage(job.request);
    if (std::isnan(job.request.deadline_s))
      throw InputError("request: deadline_s is nan, but must be a number");
    std::vector<std::uint8_t>().swap(job.request.cloud.data);  // the planner has its own copy
    const bool shown = !options_.http.empty();
    const auto plan = std::make_shared<MadePlan>();
    plan->result = planner.plan(std::move(request), StopToken(job.deadline, job.cancelled),
                                shown ? &plan->trace : nullptr);
    return {toMessage(plan->result, job.id(), frame), inputsOf(plan->result, planner.model()),
            shown ? plan : nullptr};
  } catch (const InputError& error) {
    return {refusal(plan_response_t::BAD_INPUT, error.what(), job.id(), frame)};
  } catch (const std::bad_alloc&) {
    return {refusal(plan_response_t::INTERNAL_ERROR, kNoMemory, job.id(), frame)};
  } catch (const std::exception& error) {
    return {refusal(plan_response_t::INTERNAL_ERROR, fmt::format("internal error: {}", error.what()),
                    job.id(), frame)};
  }
}

void PlanService::enqueue(JobPtr job) {
  queue_.push_back(std::move(job));
  work_waits_.notify_one();
}

bool PlanService::full(const Job& next) const {
  std::uint64_t bytes = next.bytes();
  for (const JobPtr& job : queue_) bytes += job->bytes();
  const bool too_many = static_cast<int>(queue_.size()) >= options_.queue;
  return too_many || (!queue_.empty() && bytes > options_.queue_bytes);
}

const PlanService::Job* PlanService::inFlight(const std::string& request_id) const {
  const auto is = [&](const JobPtr& job) { return job->id() == request_id; };
  if (const auto job = std::find_if(running_.begin(), running_.end(), is); job != running_.end())
    return job->get();
  if (const auto job = std::find_if(queue_.begin(), queue_.end(), is); job != queue_.end()) return job->get();
  return nullptr;
}

void PlanService::finish(const Job& job, Answer due, const GraspPlanner& planner) {
  plan_response_t& response = due.response;
  response.utime = utimeNow();
  response.model_version = planner.model().version;
  ++outcomes_.at(response.outcome);
  const auto answer = std::make_shared<const std::vector<std::uint8_t>>(encoded(response));
  if (!job.fromChannel() && isWorthKeeping(response.outcome)) memory_.keep({job.id(), job.digest, answer});
  send({answer, true, std::move(due.inputs), std::move(due.plan)});
}

void PlanService::send(DueAnswer answer) {
  outbox_.push_back(std::move(answer));
  wake_();
}

void PlanService::refuse(std::int8_t outcome, const std::string& message, const plan_request_t& request) {
  plan_response_t response = refusal(outcome, message, request.request_id, request.cloud.frame_name);
  response.utime = utimeNow();
  response.model_version = planner_->model().version;
  ++outcomes_.at(outcome);
  send({std::make_shared<const std::vector<std::uint8_t>>(encoded(response))});
}

void PlanService::expire() {
  const auto late = std::stable_partition(queue_.begin(), queue_.end(),
                                          [](const JobPtr& job) { return Clock::now() < job->deadline; });
  const std::vector<JobPtr> expired(late, queue_.end());
  queue_.erase(late, queue_.end());
  for (const JobPtr& job : expired)
    finish(*job,
           {refusal(plan_response_t::DEADLINE, "the deadline passed while the request waited in the queue",
                    job->id(), job->request.cloud.frame_name)},
           *planner_);
}

}  // namespace boxgrasp
