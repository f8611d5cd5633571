// Packets of LCM, each behind a byte that says how long it is.
#include <algorithm>

#include "boxgrasp/messaging/packet_watch.h"
#include "fuzz_target.h"

namespace boxgrasp::fuzz {

void feed(Bytes bytes) {
  PacketCounter counter;
  std::int64_t packets = 0;
  for (; !bytes.empty(); ++packets) {
    const std::size_t size = std::min<std::size_t>(bytes[0], bytes.size() - 1);
    counter.take("a sender", bytes.subspan(1, size));
    bytes = bytes.subspan(1 + size);
  }
  for (const auto& [sender, count] : counter.senders()) {
    promise(count.messages > 0 && count.messages <= packets);
    promise(count.lost >= 0 && count.incomplete >= 0 && count.incomplete <= count.messages);
  }
}

std::vector<std::string> seeds() {
  const auto packet = [](std::string text) { return std::string(1, static_cast<char>(text.size())) + text; };
  const std::string whole("LC02\0\0\0\1A\0data", 14),
      first("LC03\0\0\0\2\0\0\0\x9\0\0\0\0\0\0\0\2A\0data", 26),
      second("LC03\0\0\0\2\0\0\0\x9\0\0\0\4\0\1\0\2data", 24);
  return {packet(whole), packet(whole) + packet(first) + packet(second)};
}

}  // namespace boxgrasp::fuzz
