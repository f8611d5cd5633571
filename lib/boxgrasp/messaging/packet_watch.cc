#include "boxgrasp/messaging/packet_watch.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

#include "boxgrasp/base/error.h"
#include "boxgrasp/messaging/lcm_url.h"

namespace boxgrasp {
namespace {

constexpr std::uint32_t kWhole = 0x4c433032, kFragment = 0x4c433033;  // "LC02", "LC03"
constexpr int kBufferBytes = 8 << 20;

struct Packet {
  std::uint32_t number = 0;
  std::int64_t packets = 1;  // of the message
};

std::uint32_t bigEndian(LcmBus::Bytes bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8 | bytes[at + i];
  return value;
}

// nullopt for what is no packet of LCM.
std::optional<Packet> parse(LcmBus::Bytes bytes) {
  constexpr std::size_t kWholeHead = 8, kFragmentHead = 20, kCount = 18;
  if (bytes.size() < kWholeHead) return std::nullopt;
  const std::uint32_t magic = bigEndian(bytes, 0, 4), number = bigEndian(bytes, 4, 4);
  if (magic == kWhole) return Packet{number, 1};
  if (magic != kFragment || bytes.size() < kFragmentHead) return std::nullopt;
  return Packet{number, std::max<std::int64_t>(1, bigEndian(bytes, kCount, 2))};
}

std::string text(const sockaddr_in& address) {
  std::array<char, INET_ADDRSTRLEN> host{};
  inet_ntop(AF_INET, &address.sin_addr, host.data(), host.size());
  return fmt::format("{}:{}", host.data(), ntohs(address.sin_port));
}

MulticastAddress groupOf(const std::string& lcm_url) {
  const auto group = multicastAddress(lcm_url);
  if (!group) throw InputError(fmt::format("'{}' has no packets to watch; use udpm://", lcm_url));
  return *group;
}

}  // namespace

// A message whose number is before the newest came late: it had been counted as lost.
void PacketCounter::begin(SenderCount& count, Progress& progress, std::uint32_t number) {
  const auto ahead = static_cast<std::int32_t>(number - progress.latest);
  if (count.messages > 0 && ahead < 0) {
    count.lost = std::max<std::int64_t>(0, count.lost - 1);
  } else {
    if (count.messages > 0) count.lost += ahead - 1;
    count.incomplete += progress.missing_packets > 0;
    progress.latest = number;
  }
  ++count.messages;
}

void PacketCounter::take(const std::string& sender, LcmBus::Bytes bytes) {
  const std::optional<Packet> packet = parse(bytes);
  if (!packet) return;
  SenderCount& count = counts_[sender];
  Progress& progress = progress_[sender];
  const bool goes_on = count.messages > 0 && packet->number == progress.latest;
  if (goes_on) {
    --progress.missing_packets;
    return;
  }
  begin(count, progress, packet->number);
  if (packet->number == progress.latest) progress.missing_packets = packet->packets - 1;
}

PacketWatch::PacketWatch(const std::string& lcm_url) {
  const MulticastAddress group = groupOf(lcm_url);
  socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int on = 1;
  setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (setsockopt(socket_, SOL_SOCKET, SO_RCVBUFFORCE, &kBufferBytes, sizeof kBufferBytes) < 0)
    setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &kBufferBytes, sizeof kBufferBytes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(group.port);
  inet_pton(AF_INET, group.group.c_str(), &address.sin_addr);
  const ip_mreq membership{address.sin_addr, {htonl(INADDR_ANY)}};
  if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      setsockopt(socket_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) == 0)
    return;
  const std::string cause = std::strerror(errno);
  close(socket_);
  throw InputError(fmt::format("LCM URL '{}': {}: {}", lcm_url, cause, multicastObstacle(group)));
}

PacketWatch::~PacketWatch() { close(socket_); }

void PacketWatch::read() {
  constexpr int kMostAtOnce = 4096;  // so that a flood does not keep the caller from its other work
  std::array<std::uint8_t, 1 << 16> packet;
  for (int i = 0; i < kMostAtOnce; ++i) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t bytes =
        recvfrom(socket_, packet.data(), packet.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (bytes < 0) return;
    counter_.take(text(from), {packet.data(), static_cast<std::size_t>(bytes)});
  }
}

}  // namespace boxgrasp
