// Logs of messages, against LCM's own reader and writer.
#include "boxgrasp/messaging/event_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <lcm/lcm-cpp.hpp>

#include "boxgrasp/base/random.h"
#include "error_of.h"

namespace boxgrasp {
namespace {

using testing::HasSubstr;

class EventLog : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file); }
  std::string text() const {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void overwrite(const std::string& bytes) const { std::ofstream(file, std::ios::binary) << bytes; }

  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("boxgrasp_event_log_" + std::to_string(getpid()));
};

std::vector<LogEvent> randomEvents(std::mt19937_64& random, int n) {
  std::vector<LogEvent> events;
  for (int i = 0; i < n; ++i) {
    LogEvent event{
        i, static_cast<std::int64_t>(random() >> 1), "CHANNEL_" + std::to_string(random() % 5), {}};
    event.data.resize(1 + random() % 200);
    for (auto& byte : event.data) byte = static_cast<std::uint8_t>(random());
    events.push_back(event);
  }
  return events;
}

void write(const std::filesystem::path& file, const std::vector<LogEvent>& events) {
  EventLogWriter writer(file);
  for (const LogEvent& event : events) writer.write(event.channel, event.utime, event.data);
  EXPECT_EQ(writer.events(), static_cast<std::int64_t>(events.size()));
  EXPECT_EQ(writer.bytes(), static_cast<std::int64_t>(std::filesystem::file_size(file)));
}

void expectSame(const LogEvent& a, const LogEvent& b) {
  EXPECT_EQ(a.number, b.number);
  EXPECT_EQ(a.utime, b.utime);
  EXPECT_EQ(a.channel, b.channel);
  EXPECT_EQ(a.data, b.data);
}

TEST_F(EventLog, IsWhatLcmReads) {
  std::mt19937_64 random(1);
  const std::vector<LogEvent> events = randomEvents(random, 100);
  write(file, events);
  lcm::LogFile log(file, "r");
  ASSERT_TRUE(log.good());
  for (const LogEvent& event : events) {
    const lcm::LogEvent* read = log.readNextEvent();
    ASSERT_TRUE(read);
    const auto* data = static_cast<const std::uint8_t*>(read->data);
    expectSame(event, {read->eventnum, read->timestamp, read->channel, {data, data + read->datalen}});
  }
  EXPECT_FALSE(log.readNextEvent());
}

TEST_F(EventLog, ReadsWhatLcmWrites) {
  std::mt19937_64 random(2);
  std::vector<LogEvent> events = randomEvents(random, 100);
  {
    lcm::LogFile log(file, "w");
    for (LogEvent& event : events) {
      lcm::LogEvent to_write{0, event.utime, event.channel, static_cast<std::int32_t>(event.data.size()),
                             event.data.data()};
      ASSERT_EQ(log.writeEvent(&to_write), 0);
    }
  }
  EventLogReader reader(file);
  for (const LogEvent& event : events) {
    const auto read = reader.next();
    ASSERT_TRUE(read);
    expectSame(event, *read);
  }
  EXPECT_FALSE(reader.next());
  EXPECT_FALSE(reader.cutOff());
}

// A log may end anywhere: all whole events before are read, and the rest is said to be cut off.
TEST_F(EventLog, MayBeCutOffAnywhere) {
  std::mt19937_64 random(3);
  const std::vector<LogEvent> events = randomEvents(random, 3);
  write(file, events);
  const std::string whole = text();
  const std::size_t last = 28 + events[2].channel.size() + events[2].data.size();
  for (std::size_t left = whole.size() - last; left <= whole.size(); ++left) {
    overwrite(whole.substr(0, left));
    EventLogReader reader(file);
    std::size_t n = 0;
    while (reader.next()) ++n;
    EXPECT_EQ(n, left == whole.size() ? 3u : 2u);
    EXPECT_EQ(reader.cutOff(), left != whole.size() && left != whole.size() - last) << left;
  }
}

TEST_F(EventLog, NamesThePlaceOfWhatIsNoEvent) {
  std::mt19937_64 random(4);
  const std::vector<LogEvent> events = randomEvents(random, 2);
  write(file, events);
  const std::string whole = text();
  const std::size_t second = 28 + events[0].channel.size() + events[0].data.size();
  const auto problem = [&](std::size_t at, const std::string& bytes) {
    std::string damaged = whole;
    damaged.replace(at, bytes.size(), bytes);
    overwrite(damaged);
    return test::errorOf([&] {
      EventLogReader reader(file);
      while (reader.next()) {
      }
    });
  };
  EXPECT_EQ(problem(0, ""), "accepted");
  EXPECT_THAT(problem(0, "PLY"), HasSubstr(": byte 0: no event of an LCM log"));
  EXPECT_THAT(problem(second, "X"), HasSubstr(": byte " + std::to_string(second) + ": no event"));
  EXPECT_THAT(problem(second + 20, std::string(4, '\xff')),
              HasSubstr("a channel's name of 4294967295 bytes"));
  EXPECT_THAT(problem(24, std::string(4, '\x7f')), HasSubstr("a message of 2139062143 bytes"));
  overwrite("short");
  EXPECT_THAT(test::errorOf([&] { EventLogReader(file).next(); }), HasSubstr("no event of an LCM log"));
  EXPECT_THAT(test::errorOf([&] { EventLogReader("/no/such.log"); }), HasSubstr("cannot be read"));
}

TEST_F(EventLog, SaysWhenTheDiskIsFullAndKeepsWhatIsThere) {
  EventLogWriter full("/dev/full");
  const std::vector<std::uint8_t> data(10);
  EXPECT_THAT(test::errorOf([&] { full.write("A", 1, data); }), HasSubstr("No space left on device"));
  write(file, {});
  EXPECT_THAT(test::errorOf([&] { EventLogWriter again(file); }), HasSubstr("File exists"));
}

}  // namespace
}  // namespace boxgrasp
