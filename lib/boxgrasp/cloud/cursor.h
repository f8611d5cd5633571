// A cursor over the bytes of a file: lines, words, numbers and binary values, each checked against what
// remains.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace boxgrasp {

// Cuts a line into words, at blanks and optionally at commas and semicolons.
class Words {
 public:
  enum class Separators { blanks, blanks_and_commas };
  explicit Words(std::string_view line, Separators separators = Separators::blanks)
      : rest_(line), commas_(separators == Separators::blanks_and_commas) {}

  std::string_view next();  // empty when there is none left

 private:
  bool separates(char c) const {
    return c == ' ' || (c >= '\t' && c <= '\r') || (commas_ && (c == ',' || c == ';'));
  }
  std::string_view rest_;
  bool commas_;
};

// The number that a whole word spells, whatever the locale; nullopt when it spells none or one out of a
// double's range.
std::optional<double> parseNumber(std::string_view word);

// A word as it may stand in a message: shortened, with '?' for what cannot be printed.
std::string quoted(std::string_view word);

// Holds the bytes and the name by reference: both must outlive it. Everything that throws, throws InputError
// with the name and the place: the line read last, or the byte offset once binary data has been read.
class Cursor {
 public:
  Cursor(std::span<const char> bytes, const std::string& name)
      : bytes_(bytes.data(), bytes.size()), name_(name) {}

  std::size_t remaining() const { return bytes_.size() - at_; }
  std::string_view rest() const { return bytes_.substr(at_); }

  // The next line without its end (either of \n, \r\n); fails at the end of the file.
  std::string_view line();
  // The next line that holds more than blanks and a comment, without the comment; nullopt at the end of the
  // file.
  std::optional<std::string_view> contentLine(char comment);
  // The same, but fails at the end of the file, saying what was expected there.
  std::string_view contentLine(char comment, std::string_view expected);

  // The next n bytes; fails when fewer remain, saying what they were to hold.
  std::string_view take(std::size_t n, std::string_view expected);
  // One binary value of an arithmetic type.
  template <typename T>
  T value(std::endian order, std::string_view expected);

  // Numbers that a word spells; `what` says in the message what the word should be.
  double number(std::string_view word, std::string_view what) const;
  std::size_t count(std::string_view word, std::string_view what) const;

  // Fails unless `items` of at least `min_bytes` each can still follow: a declared count is not trusted
  // before.
  void requireRoomFor(std::size_t items, std::size_t min_bytes, std::string_view what) const;
  [[noreturn]] void fail(std::string_view what) const;

 private:
  std::string_view bytes_;
  const std::string& name_;
  std::size_t at_ = 0, line_ = 0;
  bool binary_ = false;
};

// Reads a value of type T from the first sizeof(T) bytes at `bytes`.
template <typename T>
T loadAs(const char* bytes, std::endian order) {
  char raw[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    raw[i] = bytes[order == std::endian::native ? i : sizeof(T) - 1 - i];
  }
  T value;
  __builtin_memcpy(&value, raw, sizeof(T));
  return value;
}

template <typename T>
T Cursor::value(std::endian order, std::string_view expected) {
  return loadAs<T>(take(sizeof(T), expected).data(), order);
}

// The type of a number in a binary file: 'I' signed, 'U' unsigned, 'F' floating point; 1, 2, 4 or 8 bytes.
struct BinaryType {
  char kind = '?';
  std::size_t bytes = 0;
  bool valid() const;
};

// What use(T{}) gives, where T is the type of such numbers. Pre: type.valid().
template <typename Use>
auto withType(BinaryType type, const Use& use) {
  if (type.kind == 'F') return type.bytes == 4 ? use(float{}) : use(double{});
  const bool has_sign = type.kind == 'I';
  switch (type.bytes) {
    case 1:
      return has_sign ? use(std::int8_t{}) : use(std::uint8_t{});
    case 2:
      return has_sign ? use(std::int16_t{}) : use(std::uint16_t{});
    case 4:
      return has_sign ? use(std::int32_t{}) : use(std::uint32_t{});
    default:
      return has_sign ? use(std::int64_t{}) : use(std::uint64_t{});
  }
}

// Pre: type.valid() and that many bytes follow.
double loadNumber(const char* bytes, BinaryType type, std::endian order);

}  // namespace boxgrasp
