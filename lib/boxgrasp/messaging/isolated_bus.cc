#include "boxgrasp/messaging/isolated_bus.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <utility>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/exit_code.h"

namespace boxgrasp {
namespace {

enum Kind : std::uint32_t { kReady = 1, kMessage, kProblem, kFailure };

constexpr int kReceiverFd = 3;  // of the socket in the receiving process
constexpr std::chrono::milliseconds kStartPause{
    50};  // between two starts, so that a receiver that dies at once burns no core
constexpr std::chrono::seconds kWatchPause{1};
constexpr std::chrono::seconds kOpenPatience{10};
constexpr std::size_t kMaxProblemBytes = 4096;
constexpr std::size_t kKeptBytes = 4 << 20;  // of memory, from one message to the next

std::int64_t residentBytes(pid_t process) {
  std::ifstream statm(fmt::format("/proc/{}/statm", process));
  std::int64_t size = 0, resident = 0;
  statm >> size >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

std::string describeEnd(int status) {
  if (WIFSIGNALED(status))
    return fmt::format("was ended by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
  return fmt::format("ended with exit code {}", WEXITSTATUS(status));
}

// The child has no descriptor but its socket and the three standard ones, and no signal blocked.
pid_t spawn(const std::vector<std::string>& arguments, int socket) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, socket, kReceiverFd);
  posix_spawn_file_actions_addclosefrom_np(&actions, kReceiverFd + 1);
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t process = -1;
  const int error = posix_spawn(&process, argv[0], &actions, &attributes, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (error != 0)
    throw TransportError(
        fmt::format("cannot start the receiving process {}: {}", arguments[0], std::strerror(error)));
  return process;
}

std::int64_t numberIn(std::string_view text) {
  std::int64_t value = -1;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

// Writes everything, or false when nobody reads any more.
bool writeAll(int fd, const void* data, std::size_t size) {
  const auto* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t written = send(fd, at, size, MSG_NOSIGNAL);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    at += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

}  // namespace

IsolatedBus::IsolatedBus(const IsolatedBusOptions& options, ProblemHandler on_problem, EventHandler on_event)
    : options_(options),
      on_problem_(std::move(on_problem)),
      on_event_(std::move(on_event)),
      sender_(LcmBusOptions{options.lcm.url, 0}) {
  if (options.lcm.url.starts_with("memq"))
    throw InputError(
        fmt::format("LCM URL '{}' stays within one process; use udpm:// or tcpq://", options.lcm.url));
}

IsolatedBus::~IsolatedBus() {
  if (receiver_ > 0) end("");
}

void IsolatedBus::subscribe(const std::string& channel, std::int64_t max_bytes, Handler handler) {
  subscriptions_.push_back({channel, max_bytes, std::move(handler)});
}

void IsolatedBus::open() {
  start();
  const auto late = Clock::now() + kOpenPatience;
  while (!ready_ && Clock::now() < late && receiver_ > 0) {
    pollfd readable{socket_, POLLIN, 0};
    poll(&readable, 1, 100);
    while (socket_ >= 0 && readSome()) {
    }
  }
  if (!failure_.empty()) throw InputError(failure_);
  if (!ready_) throw TransportError("the receiving process does not open LCM");
}

void IsolatedBus::start() {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) < 0)
    throw TransportError(
        fmt::format("cannot make a socket for the receiving process: {}", std::strerror(errno)));
  std::vector<std::string> arguments{options_.receiver, options_.lcm.url,
                                     std::to_string(options_.lcm.receive_buffer_bytes),
                                     std::to_string(options_.max_receiver_bytes)};
  for (const Subscription& to : subscriptions_)
    arguments.push_back(fmt::format("{}={}", to.channel, to.max_bytes));
  receiver_ = spawn(arguments, ends[1]);
  close(ends[1]);
  socket_ = ends[0];
  fcntl(socket_, F_SETFL, O_NONBLOCK);
  ready_ = false;
  partial_.assign(sizeof(Head), 0);
  received_ = 0;
  next_start_ = Clock::now() + kStartPause;
}

// Whatever a receiver has sent in part is lost with it, like a message on the network.
void IsolatedBus::end(const std::string& why) {
  close(socket_);
  socket_ = -1;
  kill(receiver_, SIGKILL);
  int status = 0;
  while (waitpid(receiver_, &status, 0) < 0 && errno == EINTR) {
  }
  const pid_t process = std::exchange(receiver_, -1);
  if (!why.empty())
    on_event_(fmt::format("receiving process {} {}", process, why == "died" ? describeEnd(status) : why));
}

void IsolatedBus::startAgain() {
  if (receiver_ > 0 || Clock::now() < next_start_) return;
  start();
  ++restarts_;
}

void IsolatedBus::dispatch() {
  constexpr int kMostAtOnce =
      256;  // reads, so that a flood of messages does not keep the caller from its other work
  for (int i = 0; i < kMostAtOnce && socket_ >= 0 && readSome(); ++i) {
  }
  startAgain();
  watchGrowth();
}

void IsolatedBus::watchGrowth() {
  if (Clock::now() < next_watch_ || receiver_ < 0) return;
  next_watch_ = Clock::now() + kWatchPause;
  const std::int64_t resident = residentBytes(receiver_);
  if (resident > options_.max_receiver_bytes)
    end(fmt::format("had grown to {} MB and was ended", resident >> 20));
}

// Reads once; false when nothing waits.
bool IsolatedBus::readSome() {
  const ssize_t count = recv(socket_, partial_.data() + received_, partial_.size() - received_, 0);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return false;
  if (count <= 0) {
    end("died");
    return false;
  }
  received_ += static_cast<std::size_t>(count);
  if (received_ < sizeof(Head)) return true;
  Head head;
  std::memcpy(&head, partial_.data(), sizeof head);
  if (!sound(head)) {
    end("sent what is no message and was ended");
    return false;
  }
  const std::size_t whole = sizeof(Head) + head.size;
  if (partial_.size() < whole) partial_.resize(whole);
  if (received_ < whole) return true;
  take(head, Bytes(partial_).subspan(sizeof(Head)));
  if (partial_.capacity() > kKeptBytes) std::vector<std::uint8_t>().swap(partial_);
  partial_.assign(sizeof(Head), 0);
  received_ = 0;
  return true;
}

// The receiver reads from the network: what it sends is believed no more than that.
bool IsolatedBus::sound(const Head& head) const {
  switch (head.kind) {
    case kReady:
      return head.size == sizeof(ReceiveBuffer);
    case kFailure:
      return head.size <= kMaxProblemBytes;
    case kProblem:
      return head.channel < subscriptions_.size() && head.size <= kMaxProblemBytes;
    case kMessage:
      return head.channel < subscriptions_.size() &&
             head.size <= static_cast<std::uint64_t>(subscriptions_[head.channel].max_bytes);
    default:
      return false;
  }
}

void IsolatedBus::take(const Head& head, Bytes bytes) {
  const auto text = [&] { return std::string(bytes.begin(), bytes.end()); };
  switch (head.kind) {
    case kReady:
      std::memcpy(&receive_buffer_, bytes.data(), sizeof receive_buffer_);
      ready_ = true;
      if (restarts_ > 0) on_event_(fmt::format("receiving process {} takes its place", receiver_));
      return;
    case kFailure:
      failure_ = text();
      return;
    case kProblem:
      return on_problem_(subscriptions_[head.channel].channel, text());
    default:
      deliver(subscriptions_[head.channel], bytes);
  }
}

void IsolatedBus::deliver(const Subscription& to, Bytes bytes) try {
  to.handler(bytes);
} catch (const std::exception& error) {
  on_problem_(to.channel, error.what());
}

namespace {

// What the receiving process does: every message it gets goes to the socket.
class Receiver {
 public:
  Receiver(int argc, char** argv)
      : bus_(LcmBusOptions{argv[0], numberIn(argv[1])},
             [this](const std::string& channel, const std::string& problem) {
               sendProblem(channel, problem);
             }) {
    for (int i = 3; i < argc; ++i) subscribe(argv[i]);
  }

  void run() {
    const ReceiveBuffer& buffer = bus_.receiveBuffer();
    send(kReady, 0, {reinterpret_cast<const std::uint8_t*>(&buffer), sizeof buffer});
    while (connected_) {
      pollfd ready[] = {{bus_.fileno(), POLLIN, 0}, {kReceiverFd, POLLIN, 0}};
      poll(ready, 2, -1);
      // Nothing ever comes from the other end but its end.
      if (ready[1].revents != 0) return;
      bus_.dispatch();
    }
  }

  static void sendFailure(const std::string& why) {
    const std::string text = why.substr(0, kMaxProblemBytes);
    const std::uint32_t kind_channel[2] = {kFailure, 0};
    const std::uint64_t size = text.size();
    writeAll(kReceiverFd, kind_channel, sizeof kind_channel) && writeAll(kReceiverFd, &size, sizeof size) &&
        writeAll(kReceiverFd, text.data(), text.size());
  }

 private:
  // "CHANNEL=BYTES"
  void subscribe(std::string_view argument) {
    const std::size_t equals = argument.rfind('=');
    const auto index = static_cast<std::uint32_t>(channels_.size());
    channels_.emplace_back(argument.substr(0, equals));
    bus_.subscribe(channels_.back(), numberIn(argument.substr(equals + 1)),
                   [this, index](LcmBus::Bytes bytes) { send(kMessage, index, bytes); });
  }

  void sendProblem(const std::string& channel, const std::string& problem) {
    const auto at = std::find(channels_.begin(), channels_.end(), channel);
    const std::string text = problem.substr(0, kMaxProblemBytes);
    send(kProblem, static_cast<std::uint32_t>(at - channels_.begin()),
         {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }

  void send(std::uint32_t kind, std::uint32_t channel, LcmBus::Bytes bytes) {
    const std::uint32_t kind_channel[2] = {kind, channel};
    const std::uint64_t size = bytes.size();
    connected_ = connected_ && writeAll(kReceiverFd, kind_channel, sizeof kind_channel) &&
                 writeAll(kReceiverFd, &size, sizeof size) &&
                 writeAll(kReceiverFd, bytes.data(), bytes.size());
  }

  std::vector<std::string> channels_;
  bool connected_ = true;
  LcmBus bus_;
};

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kBoundsAddresses = false;  // sanitizers reserve terabytes of them
#else
constexpr bool kBoundsAddresses = true;
#endif

// An address space of its own, bounded; no new rights; and it goes when the other end goes.
void confine(std::int64_t max_bytes) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  const rlim_t bytes =
      static_cast<rlim_t>(max_bytes) + (std::int64_t{1} << 30);  // code, stacks, kernel's reserve
  const rlimit address_space{bytes, bytes};
  if (kBoundsAddresses) setrlimit(RLIMIT_AS, &address_space);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
}

}  // namespace

int runReceiver(int argc, char** argv) {
  if (argc < 3) return kUsage;
  confine(numberIn(argv[2]));
  try {
    Receiver(argc, argv).run();
    return kDone;
  } catch (const std::exception& error) {
    Receiver::sendFailure(error.what());
    return kNotReachable;
  }
}

}  // namespace boxgrasp
