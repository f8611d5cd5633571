// What can be said about an LCM URL before and beside LCM.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace boxgrasp {

// Where a udpm:// URL sends to.
struct MulticastAddress {
  std::string group;
  std::uint16_t port = 0;
};

// The URL up to its parameters: URLs that are equal so far name one bus.
std::string withoutParameters(const std::string& url);

// The address of a udpm:// URL (LCM's default where the URL has none); nullopt for other transports. Throws
// InputError for an URL that LCM would misread: no transport, an unknown one, no multicast group, no port.
std::optional<MulticastAddress> multicastAddress(const std::string& url);

// Why this machine cannot receive from the address, with the remedy, found by trying what LCM does; empty if
// nothing is wrong.
std::string multicastObstacle(const MulticastAddress& address);

}  // namespace boxgrasp
