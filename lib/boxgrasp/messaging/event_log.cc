#include "boxgrasp/messaging/event_log.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "boxgrasp/base/error.h"
#include "boxgrasp/messaging/wire_layout.h"

namespace boxgrasp {
namespace {

constexpr std::uint32_t kMark = 0xEDA1DA01;
constexpr std::int64_t kHeadBytes = 28;
constexpr std::int64_t kMaxChannelBytes = 1000;  // LCM's own players refuse longer ones

void put(std::vector<std::uint8_t>& bytes, std::uint64_t value, int size) {
  for (int shift = 8 * (size - 1); shift >= 0; shift -= 8)
    bytes.push_back(static_cast<std::uint8_t>(value >> shift));
}

// As much as goes; true if that was all.
bool writeAll(int descriptor, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

EventLogWriter::EventLogWriter(const std::filesystem::path& file) : file_(file) {
  const bool regular = !std::filesystem::exists(file) || std::filesystem::is_regular_file(file);
  descriptor_ = ::open(file.c_str(), O_WRONLY | O_CLOEXEC | (regular ? O_CREAT | O_EXCL : 0), 0644);
  if (descriptor_ < 0)
    throw InputError(fmt::format("cannot make the log '{}': {}; choose a new name in a folder that exists",
                                 file.string(), std::strerror(errno)));
}

EventLogWriter::~EventLogWriter() { ::close(descriptor_); }

void EventLogWriter::write(const std::string& channel, std::int64_t utime,
                           std::span<const std::uint8_t> data) {
  std::vector<std::uint8_t> event;
  event.reserve(kHeadBytes + channel.size() + data.size());
  put(event, kMark, 4);
  put(event, static_cast<std::uint64_t>(events_), 8);
  put(event, static_cast<std::uint64_t>(utime), 8);
  put(event, channel.size(), 4);
  put(event, data.size(), 4);
  event.insert(event.end(), channel.begin(), channel.end());
  event.insert(event.end(), data.begin(), data.end());
  if (!writeAll(descriptor_, event)) {
    const std::string cause = std::strerror(errno);
    const bool whole = ::ftruncate(descriptor_, bytes_) == 0;
    throw InputError(
        fmt::format("cannot write to the log '{}': {}; make room on the disk. The {} messages before "
                    "are in it{}",
                    file_.string(), cause, events_, whole ? "" : ", and a part of one more"));
  }
  bytes_ += static_cast<std::int64_t>(event.size());
  ++events_;
}

EventLogReader::EventLogReader(const std::filesystem::path& file)
    : file_(file), stream_(file, std::ios::binary) {
  if (!stream_ || !std::filesystem::is_regular_file(file))
    throw InputError(
        fmt::format("the log '{}' cannot be read; check the path and the permissions", file.string()));
  size_ = static_cast<std::int64_t>(std::filesystem::file_size(file));
}

void EventLogReader::fail(const std::string& what) const {
  throw InputError(fmt::format("{}: byte {}: {}; a log is what 'boxgrasp record' or lcm-logger wrote",
                               file_.string(), at_, what));
}

std::int64_t EventLogReader::number(int bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) value = value << 8 | static_cast<std::uint8_t>(stream_.get());
  return static_cast<std::int64_t>(value);
}

std::optional<LogEvent> EventLogReader::next() {
  if (at_ == size_) return std::nullopt;
  const auto cutOffAfter = [&](std::int64_t bytes) { return cut_off_ = size_ - at_ < bytes; };
  if (at_ > 0 && cutOffAfter(kHeadBytes)) return std::nullopt;
  if (size_ < kHeadBytes || number(4) != kMark) fail("no event of an LCM log begins here");
  LogEvent event;
  event.number = number(8);
  event.utime = number(8);
  const std::int64_t channel = number(4), data = number(4);
  if (channel < 1 || channel > kMaxChannelBytes) fail(fmt::format("a channel's name of {} bytes", channel));
  if (data > kMaxMessageBytes) fail(fmt::format("a message of {} bytes", data));
  if (cutOffAfter(kHeadBytes + channel + data)) return std::nullopt;
  event.channel.resize(static_cast<std::size_t>(channel));
  event.data.resize(static_cast<std::size_t>(data));
  stream_.read(event.channel.data(), channel);
  stream_.read(reinterpret_cast<char*>(event.data.data()), data);
  if (!stream_) fail("cannot be read to its end");
  at_ += kHeadBytes + channel + data;
  return event;
}

}  // namespace boxgrasp
