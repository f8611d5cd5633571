// What got lost on its way: the packets of LCM's UDP multicast, seen beside LCM, which does not tell.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "boxgrasp/messaging/lcm_bus.h"

namespace boxgrasp {

// What one sender sent, by the numbers that it gives its messages, on all channels together.
struct SenderCount {
  std::int64_t messages = 0;    // of which at least one packet came
  std::int64_t lost = 0;        // of which none came: gaps in the numbers
  std::int64_t incomplete = 0;  // of which some packets did not come; LCM drops these too
};

// Counts by the packets alone. A number that comes late takes its gap back.
class PacketCounter {
 public:
  void take(const std::string& sender, LcmBus::Bytes packet);
  const std::map<std::string, SenderCount>& senders() const { return counts_; }

 private:
  struct Progress {
    std::uint32_t latest = 0;          // number of the newest message
    std::int64_t missing_packets = 0;  // of it
  };
  void begin(SenderCount& count, Progress& progress, std::uint32_t number);

  std::map<std::string, SenderCount> counts_;
  std::map<std::string, Progress> progress_;
};

// A socket of its own in the multicast group of a udpm:// URL.
class PacketWatch {
 public:
  // Throws InputError for a URL that is none of udpm://.
  explicit PacketWatch(const std::string& lcm_url);
  ~PacketWatch();
  PacketWatch(const PacketWatch&) = delete;
  PacketWatch& operator=(const PacketWatch&) = delete;

  // Takes what waits in the socket.
  void read();
  const PacketCounter& counter() const { return counter_; }

 private:
  int socket_;
  PacketCounter counter_;
};

}  // namespace boxgrasp
