#include "boxgrasp/messaging/lcm_url.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

[[noreturn]] void fail(const std::string& url, std::string_view what) {
  throw InputError(fmt::format(
      "LCM URL '{}': {}; write udpm://239.255.76.67:7667?ttl=0, tcpq://HOST:PORT or memq://", url, what));
}

bool isMulticast(const std::string& group) {
  in_addr address{};
  return inet_pton(AF_INET, group.c_str(), &address) == 1 && IN_MULTICAST(ntohl(address.s_addr));
}

// A datagram socket that closes itself.
class Socket {
 public:
  Socket() : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~Socket() { close(fd_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int fd() const { return fd_; }

 private:
  int fd_;
};

std::string systemError() { return std::strerror(errno); }

}  // namespace

std::string withoutParameters(const std::string& url) { return url.substr(0, url.find('?')); }

std::optional<MulticastAddress> multicastAddress(const std::string& url) {
  const std::string base = withoutParameters(url);
  const auto scheme_end = base.find("://");
  if (scheme_end == std::string::npos) fail(url, "no transport before '://'");
  const std::string scheme = base.substr(0, scheme_end), address = base.substr(scheme_end + 3);
  if (scheme == "tcpq" || scheme == "memq") return std::nullopt;
  if (scheme != "udpm") fail(url, fmt::format("transport '{}' is not one for requests and answers", scheme));
  MulticastAddress result{"239.255.76.67", 7667};
  if (address.empty()) return result;
  const auto colon = address.find(':');
  result.group = address.substr(0, colon);
  if (!isMulticast(result.group))
    fail(url, fmt::format("'{}' is not a multicast group (224.0.0.0 to 239.255.255.255)", result.group));
  if (colon == std::string::npos) return result;
  const std::string port = address.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), result.port);
  if (error != std::errc{} || end != port.data() + port.size() || result.port == 0)
    fail(url, fmt::format("'{}' is not a port (1 to 65535)", port));
  return result;
}

std::string multicastObstacle(const MulticastAddress& address) {
  sockaddr_in any{}, group{};
  any.sin_family = group.sin_family = AF_INET;
  any.sin_port = group.sin_port = htons(address.port);
  any.sin_addr.s_addr = htonl(INADDR_ANY);
  inet_pton(AF_INET, address.group.c_str(), &group.sin_addr);
  const Socket socket;
  const int on = 1;
  setsockopt(socket.fd(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (bind(socket.fd(), reinterpret_cast<const sockaddr*>(&any), sizeof any) < 0)
    return fmt::format(
        "UDP port {} cannot be used ({}); end the program that holds it (ss -ulpn 'sport = {}' shows it) or "
        "choose another port in --lcm-url",
        address.port, systemError(), address.port);
  const ip_mreq membership{group.sin_addr, {htonl(INADDR_ANY)}};
  if (setsockopt(socket.fd(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) < 0 ||
      connect(socket.fd(), reinterpret_cast<const sockaddr*>(&group), sizeof group) < 0)
    return fmt::format(
        "multicast group {} cannot be reached ({}); this machine has no route for it: as root, run 'ip link "
        "set "
        "lo up; ip route add {}/32 dev lo' to stay on this machine",
        address.group, systemError(), address.group);
  return {};
}

}  // namespace boxgrasp
