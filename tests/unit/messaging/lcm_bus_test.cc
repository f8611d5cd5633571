// The seam in front of LCM, over LCM's in-process transport and over what cannot be opened.
#include "boxgrasp/messaging/lcm_bus.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "boxgrasp/base/error.h"
#include "boxgrasp/messaging/lcm_url.h"

namespace boxgrasp {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string problemOf(const std::string& url) {
  try {
    LcmBus bus({.url = url});
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(LcmBus, DeliversBytes) {
  LcmBus bus({.url = "memq://"});
  std::vector<std::vector<std::uint8_t>> heard;
  bus.subscribe("CHANNEL", 100, [&](LcmBus::Bytes bytes) { heard.emplace_back(bytes.begin(), bytes.end()); });
  bus.publish("CHANNEL", std::vector<std::uint8_t>{1, 2, 3});
  bus.publish("OTHER", std::vector<std::uint8_t>{4});
  bus.publish("CHANNEL", std::vector<std::uint8_t>{});
  bus.wait(1000);
  EXPECT_THAT(heard, ElementsAre(ElementsAre(1, 2, 3), ElementsAre()));
  EXPECT_EQ(bus.receiveBuffer().granted, -1);
}

TEST(LcmBus, ListensToAllChannelsOfAKind) {
  LcmBus bus({.url = "memq://"});
  std::vector<std::string> heard;
  bus.listen("ROBOT_*", [&](const LcmBus::Heard& message) {
    heard.push_back(message.channel + ":" + std::to_string(message.bytes.size()));
    EXPECT_GT(message.utime, 1'500'000'000'000'000);
  });
  for (const char* channel : {"ROBOT_ARM", "OTHER", "ROBOT_", "MY_ROBOT_ARM"})
    bus.publish(channel, std::vector<std::uint8_t>{1, 2});
  bus.wait(1000);
  EXPECT_THAT(heard, ElementsAre("ROBOT_ARM:2", "ROBOT_:2"));
  EXPECT_THROW(bus.listen("ROBOT_(", [](const LcmBus::Heard&) {}), InputError);
}

TEST(LcmBus, LargeMessagesAndExceptionsAreReportedAndTheNextMessageArrives) {
  std::vector<std::string> problems;
  LcmBus bus({.url = "memq://"}, [&](const std::string& channel, const std::string& what) {
    problems.push_back(channel + ": " + what);
  });
  int heard = 0;
  bus.subscribe("CHANNEL", 2, [&](LcmBus::Bytes bytes) {
    if (bytes.size() == 1) throw InputError("one byte");
    ++heard;
  });
  for (const std::size_t size : {3, 1, 2}) bus.publish("CHANNEL", std::vector<std::uint8_t>(size));
  bus.wait(1000);
  EXPECT_THAT(problems, ElementsAre("CHANNEL: 3 bytes are more than 2 allowed", "CHANNEL: one byte"));
  EXPECT_EQ(heard, 1);
}

TEST(LcmBus, RefusesToPublishWhatReceiversDrop) {
  LcmBus bus({.url = "memq://"});
  EXPECT_THROW(bus.publish("CHANNEL", std::vector<std::uint8_t>(kMaxMessageBytes + 1)), InputError);
}

// A regular expression would subscribe to what nobody asked for.
TEST(LcmBus, RefusesChannelsThatAreNotNames) {
  LcmBus bus({.url = "memq://"});
  for (const std::string channel : {"", ".*", "A B", "CLOUD[0-9]"})
    EXPECT_THROW(bus.subscribe(channel, 1, [](LcmBus::Bytes) {}), InputError) << channel;
}

TEST(LcmBus, SaysWhatIsWrongWithAnUrl) {
  EXPECT_THAT(problemOf("nonsense"), HasSubstr("no transport before '://'"));
  EXPECT_THAT(problemOf("http://x"), HasSubstr("transport 'http'"));
  EXPECT_THAT(problemOf("udpm://10.0.0.1:7667"), HasSubstr("'10.0.0.1' is not a multicast group"));
  EXPECT_THAT(problemOf("udpm://239.255.76.67:99999"), HasSubstr("'99999' is not a port"));
  EXPECT_THAT(problemOf("udpm://239.255.76.67:x"), HasSubstr("'x' is not a port"));
  EXPECT_THAT(problemOf("tcpq://127.0.0.1:1"), HasSubstr("no broker answers; start one"));
}

TEST(LcmBus, SaysThatAPortIsTaken) {
  const int holder = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  ASSERT_EQ(bind(holder, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  socklen_t size = sizeof address;
  getsockname(holder, reinterpret_cast<sockaddr*>(&address), &size);
  const std::string url = "udpm://239.255.76.67:" + std::to_string(ntohs(address.sin_port)) + "?ttl=0";
  EXPECT_THAT(problemOf(url), HasSubstr("cannot be used (Address already in use)"));
  close(holder);
}

TEST(LcmUrl, Multicast) {
  EXPECT_EQ(multicastAddress("udpm://")->port, 7667);
  EXPECT_EQ(multicastAddress("udpm://239.1.2.3:77?ttl=1")->group, "239.1.2.3");
  EXPECT_EQ(multicastAddress("udpm://239.1.2.3:77?ttl=1")->port, 77);
  EXPECT_FALSE(multicastAddress("memq://"));
  EXPECT_EQ(withoutParameters("udpm://239.1.2.3:77?ttl=1"), "udpm://239.1.2.3:77");
}

}  // namespace
}  // namespace boxgrasp
