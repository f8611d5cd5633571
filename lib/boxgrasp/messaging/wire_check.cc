#include "boxgrasp/messaging/wire_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <string_view>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

using Bytes = std::span<const std::uint8_t>;

// Goes through the bytes as the layout says. Throws InputError at the first that is wrong.
class Walker {
 public:
  explicit Walker(Bytes bytes) : rest_(bytes) {}

  void message(const WireLayout& layout) {
    const auto sent = static_cast<std::uint64_t>(integer(8, "the fingerprint"));
    const std::uint64_t expected = wireFingerprint(layout);
    if (sent != expected)
      throw InputError(fmt::format(
          "fingerprint {:016x} is not that of {}, {:016x}: another type, or another version of it", sent,
          layout.name, expected));
    record(layout);
    if (!rest_.empty()) throw InputError(fmt::format("{} bytes too many", rest_.size()));
  }

 private:
  static constexpr std::size_t kMaxFields = 32;
  using Values =
      std::array<std::int64_t, kMaxFields>;  // of a record's members, where they are single integers

  void record(const WireLayout& layout) {
    assert(layout.fields.size() <= kMaxFields);
    Values values{};
    for (std::size_t i = 0; i < layout.fields.size(); ++i) {
      const WireField& field = layout.fields[i];
      if (!field.count.empty())
        array(field, length(layout, field, values));
      else if (field.fixed > 0)
        array(field, field.fixed);
      else
        values[i] = single(field);
    }
  }

  static std::int64_t length(const WireLayout& layout, const WireField& field, const Values& values) {
    const auto at = std::find_if(layout.fields.begin(), layout.fields.end(),
                                 [&](const WireField& other) { return other.name == field.count; });
    const std::int64_t n = values[at - layout.fields.begin()];
    if (n < 0 || n > field.cap)
      throw InputError(
          fmt::format("{}.{} is {}, but must be 0 to {}", layout.name, field.count, n, field.cap));
    return n;
  }

  void array(const WireField& field, std::int64_t n) {
    const std::int64_t least = field.type == WireType::record ? minWireBytes(*field.record)
                               : field.type == WireType::text ? kMinTextBytes
                                                              : wireBytes(field.type);
    need(n * least, field.name);  // caps keep the product far below 2^63
    if (field.type != WireType::record && field.type != WireType::text) return skip(n * least);
    for (std::int64_t i = 0; i < n; ++i) single(field);
  }

  // Goes past one value, and returns it where it is an integer.
  std::int64_t single(const WireField& field) {
    switch (field.type) {
      case WireType::record:
        record(*field.record);
        return 0;
      case WireType::text:
        text(field.name);
        return 0;
      default:
        return integer(wireBytes(field.type), field.name);
    }
  }

  void text(std::string_view name) {
    const std::int64_t length = integer(4, name);
    if (length < 1 || length > kMaxTextBytes)
      throw InputError(
          fmt::format("text '{}' has length {}, but must have 1 to {}", name, length, kMaxTextBytes));
    need(length, name);
    if (rest_[length - 1] != 0)
      throw InputError(fmt::format("text '{}' does not end with a zero byte", name));
    skip(length);
  }

  // A big-endian signed integer.
  std::int64_t integer(int bytes, std::string_view name) {
    need(bytes, name);
    std::uint64_t value = rest_[0] & 0x80 ? ~std::uint64_t{0} : 0;
    for (int i = 0; i < bytes; ++i) value = value << 8 | rest_[i];
    skip(bytes);
    return static_cast<std::int64_t>(value);
  }

  void need(std::int64_t bytes, std::string_view name) const {
    if (bytes > static_cast<std::int64_t>(rest_.size()))
      throw InputError(fmt::format(
          "'{}' needs {} bytes, but the message ends after {}: it is cut short or its lengths are wrong",
          name, bytes, rest_.size()));
  }
  void skip(std::int64_t bytes) { rest_ = rest_.subspan(bytes); }

  Bytes rest_;
};

}  // namespace

void checkWire(Bytes bytes, const WireLayout& layout) {
  if (bytes.size() > static_cast<std::size_t>(kMaxMessageBytes))
    throw InputError(
        fmt::format("{} bytes are more than a message may have ({})", bytes.size(), kMaxMessageBytes));
  Walker(bytes).message(layout);
}

}  // namespace boxgrasp
