#include "boxgrasp/cloud/cursor.h"

#include <charconv>

#include "boxgrasp/base/error.h"

namespace boxgrasp {

std::string_view Words::next() {
  std::size_t begin = 0;
  while (begin < rest_.size() && separates(rest_[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest_.size() && !separates(rest_[end])) ++end;
  const std::string_view word = rest_.substr(begin, end - begin);
  rest_.remove_prefix(end);
  return word;
}

std::optional<double> parseNumber(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || word.empty()) return std::nullopt;
  return value;
}

std::string quoted(std::string_view word) {
  constexpr std::size_t kShown = 40;
  std::string text = "'";
  for (const char c : word.substr(0, kShown)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > kShown ? "...'" : "'");
}

std::string_view Cursor::line() {
  ++line_;
  if (at_ == bytes_.size()) fail("the file ends here; is it truncated?");
  const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
  std::string_view text = bytes_.substr(at_, end - at_);
  at_ = std::min(end + 1, bytes_.size());
  if (text.ends_with('\r')) text.remove_suffix(1);
  return text;
}

std::optional<std::string_view> Cursor::contentLine(char comment) {
  while (remaining() > 0) {
    std::string_view text = line();
    text = text.substr(0, text.find(comment));
    if (!Words(text).next().empty()) return text;
  }
  return std::nullopt;
}

std::string_view Cursor::contentLine(char comment, std::string_view expected) {
  if (const auto text = contentLine(comment)) return *text;
  fail(fmt::format("the file ends where {} should follow; is it truncated?", expected));
}

std::string_view Cursor::take(std::size_t n, std::string_view expected) {
  binary_ = true;
  if (n > remaining()) {
    fail(fmt::format("{} needs {} bytes, but only {} remain; is the file truncated?", expected, n,
                     remaining()));
  }
  at_ += n;
  return bytes_.substr(at_ - n, n);
}

double Cursor::number(std::string_view word, std::string_view what) const {
  if (const auto value = parseNumber(word)) return *value;
  if (word.empty()) fail(fmt::format("{} is missing", what));
  fail(fmt::format("{} is {}, but must be a number", what, quoted(word)));
}

std::size_t Cursor::count(std::string_view word, std::string_view what) const {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty()) fail(fmt::format("{} is missing", what));
  if (error != std::errc() || end != word.data() + word.size()) {
    fail(fmt::format("{} is {}, but must be a whole number, 0 or more", what, quoted(word)));
  }
  return value;
}

void Cursor::requireRoomFor(std::size_t items, std::size_t min_bytes, std::string_view what) const {
  if (items <= (remaining() + 1) / min_bytes) return;
  fail(fmt::format("{} {} are declared, but only {} bytes remain; is the file truncated?", items, what,
                   remaining()));
}

void Cursor::fail(std::string_view what) const {
  const std::string place = binary_ ? fmt::format("byte {}", at_) : fmt::format("line {}", line_);
  throw InputError(fmt::format("{}: {}: {}", name_, place, what));
}

bool BinaryType::valid() const {
  const bool size_known = bytes == 4 || bytes == 8 || ((bytes == 1 || bytes == 2) && kind != 'F');
  return size_known && (kind == 'I' || kind == 'U' || kind == 'F');
}

double loadNumber(const char* bytes, BinaryType type, std::endian order) {
  return withType(type, [&](auto as) { return static_cast<double>(loadAs<decltype(as)>(bytes, order)); });
}

}  // namespace boxgrasp
