// Checking the bytes of a message before they are decoded: generated decoders trust every length they read.
#pragma once

#include <cstdint>
#include <span>

#include "boxgrasp/messaging/wire_layout.h"

namespace boxgrasp {

// Throws InputError with the offending value and its place unless these bytes are a message of this layout:
// the fingerprint is right, every text has 1 to kMaxTextBytes bytes and ends with a zero, every length is
// within its cap and its array within the bytes, and no byte is left over. Then the generated decoder is
// safe. 64-bit arithmetic throughout; the time grows with the texts and records, not with the bytes of
// arrays.
void checkWire(std::span<const std::uint8_t> bytes, const WireLayout& layout);

}  // namespace boxgrasp
