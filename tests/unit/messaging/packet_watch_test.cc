// What is lost, counted by the numbers of packets.
#include "boxgrasp/messaging/packet_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_of.h"

namespace boxgrasp {
namespace {

std::vector<std::uint8_t> bigEndian(std::initializer_list<std::uint32_t> words) {
  std::vector<std::uint8_t> bytes;
  for (const std::uint32_t word : words)
    for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(word >> shift));
  return bytes;
}

class Packets : public testing::Test {
 protected:
  void whole(std::uint32_t number, const std::string& sender = "a:1") {
    counter.take(sender, bigEndian({0x4c433032, number, 0x41004242}));
  }
  void fragment(std::uint32_t number, std::uint32_t i, std::uint32_t n) {
    counter.take("a:1", bigEndian({0x4c433033, number, 100'000, 0, i << 16 | n}));
  }
  void expect(std::int64_t messages, std::int64_t lost, std::int64_t incomplete) const {
    const SenderCount& count = counter.senders().at("a:1");
    EXPECT_EQ(count.messages, messages);
    EXPECT_EQ(count.lost, lost);
    EXPECT_EQ(count.incomplete, incomplete);
  }
  PacketCounter counter;
};

TEST_F(Packets, GapsAreLossesOfTheirSender) {
  for (const std::uint32_t number : {7, 8, 11, 12}) whole(number);
  for (const std::uint32_t number : {1, 2}) whole(number, "b:2");
  expect(4, 2, 0);
  EXPECT_EQ(counter.senders().at("b:2").lost, 0);
}

TEST_F(Packets, NumbersMayWrapAround) {
  for (const std::uint32_t number : {0xfffffffeu, 0xffffffffu, 0u, 2u}) whole(number);
  expect(4, 1, 0);
}

TEST_F(Packets, ALateMessageIsNotLost) {
  for (const std::uint32_t number : {1, 3, 2, 4}) whole(number);
  expect(4, 0, 0);
}

TEST_F(Packets, AMessageOfManyPacketsIsOneMessage) {
  for (std::uint32_t i = 0; i < 3; ++i) fragment(5, i, 3);
  whole(6);
  expect(2, 0, 0);
}

TEST_F(Packets, AMessageWithoutAllItsPacketsIsIncomplete) {
  fragment(5, 0, 3);
  fragment(5, 2, 3);
  whole(6);
  for (std::uint32_t i = 1; i < 3; ++i) fragment(7, i, 3);
  fragment(9, 0, 1);
  expect(4, 1, 2);
}

TEST_F(Packets, OtherBytesAreNoPackets) {
  counter.take("a:1", bigEndian({0x12345678, 1}));
  counter.take("a:1", bigEndian({0x4c433032}));
  counter.take("a:1", bigEndian({0x4c433033, 1, 2}));
  EXPECT_TRUE(counter.senders().empty());
  EXPECT_THAT(test::errorOf([] { PacketWatch watch("memq://"); }), testing::HasSubstr("no packets to watch"));
}

}  // namespace
}  // namespace boxgrasp
