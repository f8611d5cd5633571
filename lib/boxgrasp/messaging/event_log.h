// LCM's event logs: what lcm-logger writes and lcm-logplayer plays. One event is, big endian, the mark
// EDA1DA01 (4 bytes), its number (8), its time (8, microseconds since 1970), the lengths of channel and data
// (4 each), the channel, the data. LCM's own reader trusts the lengths in the file, and its writer leaves half
// an event on a full disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace boxgrasp {

struct LogEvent {
  std::int64_t number = 0;
  std::int64_t utime = 0;
  std::string channel;
  std::vector<std::uint8_t> data;
};

// Every event is in the file, whole, when write() returns; one that does not fit on the disk is taken off
// again.
class EventLogWriter {
 public:
  // Throws InputError for a file that exists or cannot be made.
  explicit EventLogWriter(const std::filesystem::path& file);
  ~EventLogWriter();
  EventLogWriter(const EventLogWriter&) = delete;
  EventLogWriter& operator=(const EventLogWriter&) = delete;

  // Throws InputError with the cause, such as a full disk.
  void write(const std::string& channel, std::int64_t utime, std::span<const std::uint8_t> data);

  std::int64_t events() const { return events_; }
  std::int64_t bytes() const { return bytes_; }

 private:
  const std::filesystem::path file_;
  int descriptor_;
  std::int64_t events_ = 0, bytes_ = 0;
};

// Events in the order of the file. No length in it is trusted.
class EventLogReader {
 public:
  // Throws InputError for a file that cannot be read or is no log.
  explicit EventLogReader(const std::filesystem::path& file);

  // nullopt at the end. An event that is cut off ends the log: its writer was killed, or is still at work.
  // Throws InputError with the place of bytes that are no event.
  std::optional<LogEvent> next();

  bool cutOff() const { return cut_off_; }

 private:
  [[noreturn]] void fail(const std::string& what) const;
  std::int64_t number(int bytes);

  const std::filesystem::path file_;
  std::ifstream stream_;
  std::int64_t size_ = 0, at_ = 0;
  bool cut_off_ = false;
};

}  // namespace boxgrasp
