#include "instance_lock.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>

#include "boxgrasp/base/error.h"
#include "boxgrasp/messaging/lcm_url.h"
#include "boxgrasp/ranking/model_file.h"

namespace boxgrasp {
namespace {

// The same for all spellings of one bus.
std::string busName(const std::string& lcm_url) {
  const auto multicast = multicastAddress(lcm_url);
  return multicast ? fmt::format("{}:{}", multicast->group, multicast->port) : withoutParameters(lcm_url);
}

}  // namespace

InstanceLock::InstanceLock(const std::string& lcm_url)
    : socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
  // A name in the abstract namespace, which begins with a zero byte, leaves no file behind.
  const std::string name = fmt::format("boxgrasp-server {}", blake2bHex(busName(lcm_url)).substr(0, 32));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  name.copy(address.sun_path + 1, sizeof address.sun_path - 1);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), size) == 0) return;
  close(socket_);
  throw InputError(
      fmt::format("another boxgrasp-server already answers on '{}'; end it first, or give this one "
                  "another port with --lcm-url",
                  lcm_url));
}

InstanceLock::~InstanceLock() { close(socket_); }

}  // namespace boxgrasp
