// Numbers as text that reads back to the bit.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace boxgrasp {

// The number that all of the text is; nullopt where it is none.
template <typename Number>
std::optional<Number> parseNumber(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

// Takes the text before the first separator off the front, and the separator with it; all of the text where
// there is no separator.
inline std::string_view takeFirst(std::string_view& text, char separator) {
  const std::string_view first = text.substr(0, text.find(separator));
  text.remove_prefix(first.size() < text.size() ? first.size() + 1 : first.size());
  return first;
}

}  // namespace boxgrasp
