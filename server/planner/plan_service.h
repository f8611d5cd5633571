// Requests in, answers out: the queue, the workers and the memory of the daemon, without LCM.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "answer_memory.h"
#include "boxgrasp/live/plan_history.h"
#include "boxgrasp/messaging/codec.h"
#include "boxgrasp/planning/grasp_planner.h"
#include "latencies.h"
#include "server_options.h"

namespace boxgrasp {

using PlannerPtr = std::shared_ptr<const GraspPlanner>;

// What the network was fed for each grasp of an answer: what can be learnt from when outcomes come.
struct AnswerInputs {
  std::vector<std::string> features;
  std::vector<std::vector<double>> grasps;
};

// An encoded plan_response_t. Not fresh: given before, and repeated for a request that came again.
struct DueAnswer {
  EncodedAnswer bytes;
  bool fresh = true;
  AnswerInputs inputs = {};  // of a fresh answer with grasps
  MadePlanPtr plan = {};     // of a fresh answer that was planned, where plans are to be shown
};

// Plans on a pool of threads. Every request gets one answer: at once when it is refused, known already, or
// one too many; else when it is planned, cancelled, or its deadline passes. Thread-safe.
class PlanService {
 public:
  using Bytes = std::span<const std::uint8_t>;
  using Clock = std::chrono::steady_clock;

  // `wake` is called from any thread when answers wait to be taken.
  PlanService(PlannerPtr planner, const ServerOptions& options, std::function<void()> wake);
  // Cancels what runs and waits for it.
  ~PlanService();
  PlanService(const PlanService&) = delete;
  PlanService& operator=(const PlanService&) = delete;

  // The bytes of a plan_request_t. Throws InputError for bytes that are none: there is nobody to answer.
  // Requests with one id and one content (all but the stamp) are planned once. The same id with another
  // content is refused.
  void request(Bytes bytes);
  // The bytes of an lcmt_point_cloud from a channel: it takes the place of one that still waits. Throws as
  // above.
  void cloud(const std::string& channel, Bytes bytes);
  // Unknown ids are ignored.
  void cancel(const std::string& request_id);

  // Requests that are begun from now on are planned by this planner; those that run keep theirs. Its hand is
  // that of the one before. Costs a pointer's assignment: a request takes its planner along when a worker
  // takes the request from the queue, so plans themselves share nothing that could be locked.
  void takeOver(PlannerPtr planner);

  // The answers that are due, the first ready first. Requests whose deadline
  // passed while they waited are answered by this call: make it at least a few times a second.
  std::vector<DueAnswer> takeAnswers();

  // From now on nothing is accepted; what waits is answered with OVERLOADED, what runs goes on.
  void close();
  // Everything that runs is to stop soon.
  void cancelAll();
  // Closed, and nothing runs or waits to be taken.
  bool finished() const;
  // A plan runs on far past its deadline: something hangs.
  bool stuck() const;

  // All but what only the transport knows.
  status_t status() const;
  LatencyCounts latencies() const;

 private:
  struct Job {
    plan_request_t request;
    std::string digest;  // empty for clouds from a channel, which are planned as often as they come
    Clock::time_point arrival, deadline;
    std::shared_ptr<std::atomic<bool>> cancelled = std::make_shared<std::atomic<bool>>(false);
    const std::string& id() const { return request.request_id; }
    std::uint64_t bytes() const { return request.cloud.data.size(); }
    bool fromChannel() const { return digest.empty(); }
  };
  using JobPtr = std::shared_ptr<Job>;

  JobPtr makeJob(plan_request_t request, std::string digest) const;
  void work();
  struct Answer {
    plan_response_t response;
    AnswerInputs inputs = {};
    MadePlanPtr plan = {};
  };
  Answer answerTo(Job& job, const GraspPlanner& planner) const;
  // The following expect the lock to be held.
  void enqueue(JobPtr job);
  bool full(const Job& next) const;
  const Job* inFlight(const std::string& request_id) const;
  void finish(const Job& job, Answer answer, const GraspPlanner& planner);
  void send(DueAnswer answer);
  void refuse(std::int8_t outcome, const std::string& message, const plan_request_t& request);
  void expire();

  const ServerOptions options_;
  const std::function<void()> wake_;
  const Clock::time_point start_ = Clock::now();

  mutable std::mutex mutex_;
  std::condition_variable work_waits_;
  std::deque<JobPtr> queue_;
  std::vector<JobPtr> running_;
  PlannerPtr planner_;
  std::vector<DueAnswer> outbox_;
  AnswerMemory memory_;
  Latencies latencies_;
  std::array<std::int64_t, 7> outcomes_{};
  std::int64_t repeated_ = 0, superseded_ = 0;
  bool closed_ = false, ending_ = false;
  std::vector<std::thread> workers_;
};

}  // namespace boxgrasp
