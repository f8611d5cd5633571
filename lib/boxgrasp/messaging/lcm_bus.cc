#include "boxgrasp/messaging/lcm_bus.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cctype>
#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <optional>

#include "boxgrasp/base/error.h"
#include "boxgrasp/messaging/lcm_url.h"

namespace boxgrasp {
namespace {

struct Subscriber {
  std::string channel;
  std::int64_t max_bytes;
  LcmBus::Handler handler;
  const LcmBus::ProblemHandler& on_problem;
};

// No exception may leave for LCM, which is C and would stay locked.
void receive(const lcm::ReceiveBuffer* buffer, const std::string& channel, Subscriber* to) noexcept try {
  if (buffer->data_size > to->max_bytes)
    throw InputError(fmt::format("{} bytes are more than {} allowed", buffer->data_size, to->max_bytes));
  to->handler({static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
} catch (const std::exception& error) {
  if (to->on_problem) to->on_problem(channel, error.what());
}

// The same for messages of many channels.
struct ChannelListener {
  LcmBus::Listener listener;
  const LcmBus::ProblemHandler& on_problem;
};

void hear(const lcm::ReceiveBuffer* buffer, const std::string& channel, ChannelListener* to) noexcept try {
  to->listener(
      {channel, {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size}, buffer->recv_utime});
} catch (const std::exception& error) {
  if (to->on_problem) to->on_problem(channel, error.what());
}

// The descriptor of this process's socket that is bound to the UDP port. LCM keeps it to itself.
std::optional<int> boundTo(std::uint16_t port) {
  constexpr int kMaxDescriptors = 1024;  // LCM's select() reaches no further
  for (int fd = 0; fd < kMaxDescriptors; ++fd) {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    if (getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0 && address.sin_family == AF_INET &&
        ntohs(address.sin_port) == port)
      return fd;
  }
  return std::nullopt;
}

// Linux reports twice of what it grants, and keeps the other half for its own records.
std::int64_t grantedBytes(int socket) {
  int doubled = 0;
  socklen_t size = sizeof doubled;
  getsockopt(socket, SOL_SOCKET, SO_RCVBUF, &doubled, &size);
  return doubled / 2;
}

// Asks as root first, whom rmem_max does not bind, then as anyone.
ReceiveBuffer askForBuffer(int socket, std::int64_t bytes) {
  const int asked = static_cast<int>(std::clamp<std::int64_t>(bytes, 0, 1 << 30));
  if (grantedBytes(socket) < asked &&
      setsockopt(socket, SOL_SOCKET, SO_RCVBUFFORCE, &asked, sizeof asked) < 0)
    setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &asked, sizeof asked);
  return {bytes, grantedBytes(socket)};
}

// LCM warns about small buffers by what it saw when it opened its socket: it is told to ask for as much as
// every kernel grants, and askForBuffer() raises that.
std::string withReceiveBuffer(const std::string& url) {
  if (url.find("recv_buf_size") != std::string::npos) return url;
  return url + (url.find('?') == std::string::npos ? "?" : "&") + "recv_buf_size=262144";
}

[[noreturn]] void failToOpen(const std::string& url, const std::optional<MulticastAddress>& multicast) {
  std::string obstacle = multicast ? multicastObstacle(*multicast) : "";
  if (obstacle.empty() && url.starts_with("tcpq"))
    obstacle =
        "no broker answers; start one (java -cp /usr/share/java/lcm.jar lcm.lcm.TCPService PORT) or use "
        "udpm://";
  if (obstacle.empty()) obstacle = "LCM cannot open it; its own message stands above";
  throw InputError(fmt::format("LCM URL '{}': {}", url, obstacle));
}

bool isChannelName(const std::string& channel) {
  return !channel.empty() && channel.size() < 64 &&
         std::all_of(channel.begin(), channel.end(),
                     [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-' || c == '/'; });
}

}  // namespace

struct LcmBus::Impl {
  Impl(const std::string& url, ProblemHandler problem_handler)
      : lcm(url), on_problem(std::move(problem_handler)) {}
  lcm::LCM lcm;
  ProblemHandler on_problem;
  std::deque<Subscriber> subscribers;  // LCM holds their addresses
  std::deque<ChannelListener> listeners;
};

LcmBus::LcmBus(const LcmBusOptions& options, ProblemHandler on_problem) {
  const auto multicast = multicastAddress(options.url);
  impl_ =
      std::make_unique<Impl>(multicast ? withReceiveBuffer(options.url) : options.url, std::move(on_problem));
  // LCM opens its sockets with the first subscription or question for the descriptor.
  if (!impl_->lcm.good() || impl_->lcm.getFileno() < 0) failToOpen(options.url, multicast);
  const auto socket = multicast ? boundTo(multicast->port) : std::nullopt;
  if (socket) receive_buffer_ = askForBuffer(*socket, options.receive_buffer_bytes);
}

LcmBus::~LcmBus() = default;

void LcmBus::subscribe(const std::string& channel, std::int64_t max_bytes, Handler handler) {
  if (!isChannelName(channel))
    throw InputError(
        fmt::format("LCM channel '{}' is not a name of 1 to 63 letters, digits, '_', '-' and '/'", channel));
  Subscriber& subscriber =
      impl_->subscribers.emplace_back(Subscriber{channel, max_bytes, std::move(handler), impl_->on_problem});
  impl_->lcm.subscribeFunction(channel, receive, &subscriber);
}

void LcmBus::listen(const std::string& names, Listener listener) {
  std::string name = names, pattern;
  std::replace(name.begin(), name.end(), '*', '_');
  if (!isChannelName(name))
    throw InputError(
        fmt::format("LCM channels '{}': write a name of 1 to 63 letters, digits, '_', '-' and '/', in which "
                    "'*' stands for "
                    "any text",
                    names));
  for (const char c : names) pattern += c == '*' ? std::string(".*") : std::string(1, c);
  ChannelListener& to =
      impl_->listeners.emplace_back(ChannelListener{std::move(listener), impl_->on_problem});
  impl_->lcm.subscribeFunction(pattern, hear, &to);
}

void LcmBus::publish(const std::string& channel, Bytes bytes) {
  if (bytes.size() > static_cast<std::size_t>(kMaxMessageBytes))
    throw InputError(
        fmt::format("a message of {} bytes is more than LCM carries ({})", bytes.size(), kMaxMessageBytes));
  if (impl_->lcm.publish(channel, bytes.data(), static_cast<unsigned>(bytes.size())) != 0)
    throw TransportError(fmt::format("LCM cannot publish {} bytes on {}; the broker or the network is gone",
                                     bytes.size(), channel));
}

int LcmBus::fileno() const {
  const int fd = impl_->lcm.getFileno();
  if (fd < 0) throw TransportError("LCM lost its connection; the broker has ended");
  return fd;
}

void LcmBus::dispatch() { wait(0); }

void LcmBus::wait(int timeout_ms) {
  constexpr int kMostAtOnce = 64;  // so that a flood of messages does not keep the caller from its other work
  pollfd ready{fileno(), POLLIN, 0};
  for (int i = 0; i < kMostAtOnce && poll(&ready, 1, i == 0 ? timeout_ms : 0) > 0; ++i) {
    if (impl_->lcm.handle() < 0) throw TransportError("LCM lost its connection while reading");
    ready.fd = fileno();
  }
}

}  // namespace boxgrasp
