// Any message in one line, for people who watch.
#pragma once

#include <string>

#include "boxgrasp/messaging/lcm_bus.h"

namespace boxgrasp {

struct MessageText {
  std::string type;     // "boxgrasp.status_t"; empty for a type that is not ours
  std::string summary;  // or what is wrong with its bytes
};
MessageText describe(LcmBus::Bytes bytes);

// 1536 -> "1.5 kB".
std::string bytesText(double bytes);

}  // namespace boxgrasp
