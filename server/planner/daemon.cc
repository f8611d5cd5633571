#include "daemon.h"

#include <poll.h>
#include <pthread.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <optional>

#include "boxgrasp/base/error.h"
#include "boxgrasp/messaging/channels.h"
#include "boxgrasp/messaging/isolated_bus.h"
#include "boxgrasp/messaging/plan_conversion.h"
#include "clerk.h"
#include "http_server.h"
#include "instance_lock.h"
#include "receiver_program.h"
#include "state_folder.h"

namespace boxgrasp {
namespace {

using Clock = std::chrono::steady_clock;

// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() { close(fd_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

// SIGTERM and SIGINT as a descriptor. Made before any thread, so that all threads leave them to it.
int signalDescriptor() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK);
}

// Text from the network for the log: no control characters, and not too much of it.
std::string printable(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  constexpr std::size_t kMost = 200;
  if (text.size() > kMost) text = text.substr(0, kMost) + "...";
  return text;
}

// Of this process; -1: unknown.
std::int64_t residentBytes() {
  std::int64_t size = 0, resident = 0;
  return std::ifstream("/proc/self/statm") >> size >> resident ? resident * sysconf(_SC_PAGESIZE) : -1;
}

TrustedKeys keysIn(const std::string& folder) { return folder.empty() ? TrustedKeys() : TrustedKeys(folder); }

void log(const std::string& text) { spdlog::info("{}", printable(text)); }

void logAnswer(const plan_response_t& answer, bool fresh) {
  const auto level = !fresh                                              ? spdlog::level::debug
                     : answer.outcome == plan_response_t::INTERNAL_ERROR ? spdlog::level::err
                     : answer.outcome == plan_response_t::OVERLOADED     ? spdlog::level::warn
                                                                         : spdlog::level::info;
  spdlog::log(level, "{}: {} ({:.2f} s): {}{}", printable(answer.request_id), outcomeName(answer.outcome),
              answer.time_s, printable(answer.message), fresh ? "" : " (answered before)");
}

class Daemon {
 public:
  Daemon(GraspPlanner planner, const ServerOptions& options)
      : options_(options),
        lock_(options.lcm_url),
        state_(options.state_dir),
        bus_(
            {{options.lcm_url, static_cast<std::int64_t>(options.receive_buffer_bytes)},
             receiverProgram(ownFolder())},
            [this](const std::string& channel, const std::string& problem) { refused(channel, problem); },
            [](const std::string& what) { spdlog::warn("{}", what); }),
        models_(
            std::make_shared<const GraspPlanner>(std::move(planner)),
            {state_.file("models"), keysIn(options.trusted_keys), options.oldest_model},
            [this](PlannerPtr next) { service_.takeOver(std::move(next)); }, log),
        outcomes_(state_.file("outcomes.db"), models_.serving()->hand().name),
        service_(models_.serving(), options, [this] { wake(); }),
        live_(models_.serving()->hand(), {options.shown_plans, options.shown_bytes}),
        clerk_(
            models_, outcomes_, [this] { wake(); }, log) {
    bus_.subscribe(channel::kPlanRequest, kMaxMessageBytes, [this](auto bytes) { service_.request(bytes); });
    bus_.subscribe(channel::kCancel, kMaxTextBytes + 64,
                   [this](auto bytes) { service_.cancel(decoded<cancel_t>(bytes).request_id); });
    bus_.subscribe(channel::kPublishModel, kMaxModelBytes + kMaxTextBytes + 256,
                   [this](auto bytes) { clerk_.publication(decoded<publish_model_t>(bytes)); });
    bus_.subscribe(channel::kModelsRequest, 2 * kMaxTextBytes + 256,
                   [this](auto bytes) { clerk_.request(decoded<models_request_t>(bytes)); });
    bus_.subscribe(channel::kGraspOutcome, 4 * kMaxTextBytes,
                   [this](auto bytes) { clerk_.outcome(decoded<grasp_outcome_t>(bytes)); });
    if (isWatched())
      bus_.subscribe(channel::kTrainingStatus, 8 * kMaxTextBytes,
                     [this](auto bytes) { live_.update(decoded<training_status_t>(bytes)); });
    if (!options.cloud_channel.empty())
      bus_.subscribe(options.cloud_channel, kMaxMessageBytes,
                     [this](auto bytes) { service_.cloud(options_.cloud_channel, bytes); });
    bus_.open();
    if (!options.http.empty())
      openWeb(page_, options.http, "page", [this](const std::string& path) { return live_.page(path); });
    if (!options.metrics.empty())
      openWeb(metrics_, options.metrics, "metrics",
              [this](const std::string& path) { return live_.metrics(path); });
  }

  void run() {
    sayReady();
    while (!stop_by_ || !service_.finished() || !clerk_.idle()) {
      waitForSomething();
      bus_.dispatch();
      readSignals();
      publishAnswers();
      publishReplies();
      beat();
    }
    spdlog::info("stopped");
  }

 private:
  void wake() const { eventfd_write(wake_.get(), 1); }

  bool isWatched() const { return !options_.http.empty() || !options_.metrics.empty(); }

  static void openWeb(std::optional<HttpServer>& server, const std::string& address, const char* what,
                      HttpServer::Handler handler) {
    server.emplace(address, std::move(handler));
    spdlog::info("{} at {}", what, server->url());
    if (!HttpAddress::parse(address).isLoopback())
      spdlog::warn(
          "the {} at {} can be read by everyone who reaches this machine; 127.0.0.1 is this machine alone",
          what, address);
  }

  void sayReady() const {
    const ReceiveBuffer& buffer = bus_.receiveBuffer();
    spdlog::info("answering on {} with {} workers and model {}", options_.lcm_url, options_.workers,
                 models_.serving()->model().version);
    if (buffer.granted < buffer.asked)
      spdlog::warn(
          "the receive buffer is {} bytes, not {}: clouds of more than {} points can get lost; to raise it: "
          "sysctl -w net.core.rmem_max={}, then start again",
          buffer.granted, buffer.asked, buffer.granted / 12, buffer.asked);
    sd_notify(0, "READY=1");
  }

  void waitForSomething() {
    constexpr int kTick_ms = 100;  // deadlines of waiting requests are looked at this often
    pollfd ready[] = {{bus_.fileno(), POLLIN, 0}, {wake_.get(), POLLIN, 0}, {signals_.get(), POLLIN, 0}};
    poll(ready, std::size(ready), kTick_ms);
    eventfd_t count;
    eventfd_read(wake_.get(), &count);
  }

  void readSignals() {
    signalfd_siginfo signal;
    while (read(signals_.get(), &signal, sizeof signal) == sizeof signal) {
      if (stop_by_)
        service_.cancelAll();
      else
        beginToStop();
    }
    if (stop_by_ && Clock::now() > *stop_by_) service_.cancelAll();
  }

  void beginToStop() {
    spdlog::info("stopping: what runs is finished, within {} s", options_.stop_s);
    sd_notify(0, "STOPPING=1");
    service_.close();
    stop_by_ = Clock::now() +
               std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options_.stop_s));
  }

  void publishAnswers() {
    for (DueAnswer& answer : service_.takeAnswers()) {
      const auto response = decoded<plan_response_t>(*answer.bytes);
      if (answer.fresh) clerk_.answered(response, answer.inputs);
      bus_.publish(channel::kPlanResponse, LcmBus::Bytes(*answer.bytes));
      logAnswer(response, answer.fresh);
      if (answer.fresh && !options_.http.empty()) live_.answered(response, std::move(answer.plan));
    }
  }

  void publishReplies() {
    for (const Reply& reply : clerk_.takeReplies()) bus_.publish(reply.channel, LcmBus::Bytes(reply.bytes));
  }

  // Once a second: the status, and the sign of life for systemd, unless a worker hangs.
  void beat() {
    if (Clock::now() < next_beat_) return;
    next_beat_ = Clock::now() + std::chrono::seconds(1);
    status_t status = service_.status();
    status.version = BOXGRASP_VERSION;
    status.refused = refused_;
    status.receive_buffer_asked = bus_.receiveBuffer().asked;
    status.receive_buffer_granted = bus_.receiveBuffer().granted;
    bus_.publish(channel::kStatus, status);
    if (isWatched())
      live_.update({std::move(status), service_.latencies(), bus_.restarts(), residentBytes()});
    if (live_.isLookedAt())
      clerk_.listModels([this](models_reply_t models) { live_.update(std::move(models)); });
    if (!service_.stuck()) sd_notify(0, "WATCHDOG=1");
  }

  void refused(const std::string& channel, const std::string& problem) {
    ++refused_;
    spdlog::warn("message on {} refused: {}", channel, printable(problem));
  }

  const ServerOptions options_;
  const Descriptor signals_{signalDescriptor()};
  const Descriptor wake_{eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};
  const InstanceLock lock_;
  const StateFolder state_;
  IsolatedBus bus_;
  ModelDesk models_;
  OutcomeDesk outcomes_;
  PlanService service_;
  LiveView live_;
  Clerk clerk_;  // what it does in the background uses the others
  std::optional<HttpServer> page_, metrics_;
  std::int64_t refused_ = 0;
  std::optional<Clock::time_point> stop_by_;
  Clock::time_point next_beat_;
};

}  // namespace

void serve(GraspPlanner planner, const ServerOptions& options) { Daemon(std::move(planner), options).run(); }

}  // namespace boxgrasp
