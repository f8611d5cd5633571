#include "work_command.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <mutex>
#include <thread>
#include <utility>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/exit_code.h"
#include "boxgrasp/messaging/channels.h"
#include "boxgrasp/messaging/lcm_bus.h"
#include "boxgrasp/messaging/plan_conversion.h"
#include "boxgrasp/store/file_lock.h"
#include "interruption.h"
#include "retraining.h"

namespace boxgrasp {
namespace {

using Clock = std::chrono::steady_clock;

// Notes in the outcome store, by which a worker that was killed goes on.
constexpr char kLearntUntil[] = "learnt_until";  // id of the last outcome that a finished round knew
constexpr char kPending[] = "pending";           // cause of the round that was begun; empty: none

constexpr int kNice = 10;  // planning on the same machine comes first

std::string workerName() {
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  return fmt::format("{}/{}", host, getpid());
}

// Listens, reports, and runs rounds one after the other in a thread of their own.
class Worker {
 public:
  Worker(const WorkCommand& command, StopToken interrupted)
      : command_(command),
        interrupted_(std::move(interrupted)),
        lock_(command.outcomes.string() + ".worker"),
        store_(command.outcomes),
        bus_({command.lcm_url, 1 << 20}) {
    if (!lock_.tryLock())
      throw InputError(fmt::format("another worker is at '{}'; one at a time", command.outcomes.string()));
    status_.worker = workerName();
    status_.progress = status_.remaining_s = NAN;
    bus_.subscribe(channel::kRetrainRequest, 3 * kMaxTextBytes,
                   [this](auto bytes) { asked(decoded<retrain_request_t>(bytes)); });
    bus_.subscribe(channel::kStatus, kMaxMessageBytes, [this](auto bytes) {
      const auto heard = decoded<status_t>(bytes);
      const std::lock_guard lock(mutex_);
      status_.in_service = heard.model_version;
    });
    if (const auto pending = store_.progress(kPending); pending && !pending->empty())
      due_ = fmt::format("going on after an interruption ({})", *pending);
  }
  ~Worker() { stopRound(); }

  int run() {
    if (command_.once) due_ = "asked for by --once";
    fmt::print(stderr, "worker {} at {}\n", status_.worker, command_.outcomes.string());
    while (!interrupted_.stopped()) {
      bus_.wait(100);
      lookAtClockAndStore();
      finishRound();
      if (command_.once && rounds_ > 0) break;
      if (!due_.empty() && !round_.joinable()) beginRound();
      beat();
    }
    stopRound();
    return interrupted_.stopped() ? kInterrupted : published_ ? kDone : command_.once ? kNothingFound : kDone;
  }

 private:
  void asked(const retrain_request_t& request) {
    if (request.request_id == status_.request_id && !request.request_id.empty()) return;
    fmt::print(stderr, "{}: {}\n", request.cancel ? "cancelled" : "asked to retrain", request.reason);
    status_.request_id = request.request_id;
    if (request.cancel) {
      due_.clear();
      stopRound();
      store_.setProgress(kPending, "");
    } else {
      due_ = request.reason.empty() ? "asked for" : request.reason;
    }
  }

  void lookAtClockAndStore() {
    if (round_.joinable() || Clock::now() < next_look_) return;
    next_look_ = Clock::now() + std::chrono::seconds(1);
    const std::int64_t waiting = store_.countAfter(learntUntil());
    status_.outcomes_waiting = waiting;
    if (command_.after > 0 && waiting >= command_.after) due_ = fmt::format("{} new outcomes", waiting);
    if (command_.every_h > 0 && Clock::now() >= next_scheduled_) due_ = "its time";
  }

  std::int64_t learntUntil() const { return std::stoll(store_.progress(kLearntUntil).value_or("0")); }

  void beginRound() {
    const std::vector<StoredOutcome> outcomes = store_.outcomesAfter(0);
    store_.setProgress(kPending, due_);
    if (command_.every_h > 0)
      next_scheduled_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double, std::ratio<3600>>(command_.every_h));
    const std::lock_guard lock(mutex_);
    status_.cause = std::exchange(due_, {});
    status_.state = training_status_t::TRAINING;
    status_.stage = "reading labels";
    status_.progress = 0.0;
    begun_ = Clock::now();
    known_until_ = outcomes.empty() ? 0 : outcomes.back().id;
    cancelled_ = std::make_shared<std::atomic<bool>>(false);
    done_ = false;
    round_ =
        std::thread([this, outcomes, version = status_.in_service] { trainAndPublish(outcomes, version); });
    beat_now_ = true;
  }

  void trainAndPublish(const std::vector<StoredOutcome>& outcomes, const std::string& version) {
    const StopToken stop(std::nullopt, cancelled_);
    const auto report = [this](const RoundProgress& progress) {
      const std::lock_guard lock(mutex_);
      status_.state = progress.state;
      status_.stage = progress.stage;
      status_.progress = progress.share;
      beat_now_ = true;
    };
    try {
      if (!labels_) labels_ = splitLabels(command_, stop);
      const RoundResult result = runRound(command_, *labels_, outcomes, version, report, stop);
      finished(result);
    } catch (const Stopped&) {
      say("stopped before it was done", false);
    } catch (const std::exception& error) {
      say(error.what(), true);
    }
    done_ = true;
  }

  // What a round found stands before it counts as done: a kill in between makes another round, no lost one.
  void finished(const RoundResult& result) {
    const std::lock_guard lock(mutex_);
    status_.candidate = result.candidate;
    status_.published = published_ = result.published;
    status_.labels = result.labels;
    status_.outcomes = result.outcomes;
    status_.message = result.words;
    complete_ = true;
  }

  // A round that failed is not tried again by itself: what failed would fail again.
  void say(const std::string& what, bool complete) {
    const std::lock_guard lock(mutex_);
    status_.message = what;
    complete_ = complete;
  }

  void finishRound() {
    if (!round_.joinable() || !done_) return;
    round_.join();
    if (std::exchange(complete_, false)) {
      store_.setProgress(kLearntUntil, std::to_string(known_until_));
      store_.setProgress(kPending, "");
    }
    ++rounds_;
    fmt::print(stderr, "{}\n", status_.message);
    becomeIdle();
  }

  void becomeIdle() {
    status_.state = training_status_t::IDLE;
    status_.stage.clear();
    status_.progress = status_.remaining_s = NAN;
    beat_now_ = true;
  }

  void stopRound() {
    if (!round_.joinable()) return;
    *cancelled_ = true;
    round_.join();
    complete_ = false;
    becomeIdle();
  }

  void beat() {
    if (!beat_now_ && Clock::now() < next_beat_) return;
    beat_now_ = false;
    next_beat_ = Clock::now() + std::chrono::seconds(1);
    const std::lock_guard lock(mutex_);
    status_.utime = utimeNow();
    const double spent_s = std::chrono::duration<double>(Clock::now() - begun_).count();
    if (status_.progress > 0) status_.remaining_s = spent_s / status_.progress * (1 - status_.progress);
    bus_.publish(channel::kTrainingStatus, status_);
  }

  const WorkCommand command_;
  const StopToken interrupted_;
  const FileLock lock_;
  OutcomeStore store_;
  LcmBus bus_;
  std::string due_;  // why the next round is to begin; empty: it is not
  std::thread round_;
  std::shared_ptr<std::atomic<bool>> cancelled_;
  std::optional<SplitLabels> labels_;  // of the round's thread
  std::atomic<bool> done_ = false, beat_now_ = false;
  std::mutex mutex_;  // of the status, complete_ and published_
  training_status_t status_{};
  bool complete_ = false, published_ = false;
  std::int64_t known_until_ = 0;
  int rounds_ = 0;
  Clock::time_point begun_, next_look_, next_beat_, next_scheduled_;
};

void check(const WorkCommand& command) {
  if (!command.study.store) throw InputError("work needs --store EXPERIENCE.db, the simulated labels");
  requireOption(command.after >= 0, "after", command.after, "at least 0");
  requireOption(command.every_h >= 0, "every_h", command.every_h, "at least 0");
  requireOption(command.held_out_one_in >= 2, "held_out_one_in", command.held_out_one_in, "at least 2");
}

}  // namespace

int runWork(const WorkCommand& command) {
  check(command);
  setpriority(PRIO_PROCESS, 0, kNice);
  return Worker(command, stopOnInterrupt()).run();
}

}  // namespace boxgrasp
