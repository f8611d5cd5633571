// The check before decoding: it lets through what was encoded, and nothing that is not exactly that.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "boxgrasp/base/error.h"
#include "random_messages.h"

namespace boxgrasp {
namespace {

using Bytes = std::vector<std::uint8_t>;
using test::randomRequest;
using test::randomResponse;
using testing::HasSubstr;

std::string problemOf(const Bytes& bytes, const WireLayout& layout) {
  try {
    checkWire(bytes, layout);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

void putBigEndian(Bytes& bytes, std::size_t at, std::int64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> 8 * (size - 1 - i));
}

// Byte offsets in an encoded request with the id "id" and the frame "f".
constexpr std::size_t kIdLength = 16, kWidth = 16 + 4 + 3 + 8 + 4 + 2, kNumFields = kWidth + 16;

Bytes smallRequest() {
  std::mt19937_64 random(3);
  plan_request_t message = randomRequest(random, 4);
  message.request_id = "id";
  message.cloud.frame_name = "f";
  return encoded(message);
}

template <typename Message>
void expectGeneratedFingerprint() {
  EXPECT_EQ(wireFingerprint(layoutOf<Message>()), static_cast<std::uint64_t>(Message::getHash()))
      << Message::getTypeName();
}

// The table says what the .lcm file says: LCM's fingerprint covers every name, type and dimension.
TEST(WireLayout, HasTheFingerprintOfTheGeneratedType) {
  expectGeneratedFingerprint<drake::lcmt_point_cloud>();
  expectGeneratedFingerprint<plan_request_t>();
  expectGeneratedFingerprint<plan_response_t>();
  expectGeneratedFingerprint<status_t>();
  expectGeneratedFingerprint<cancel_t>();
  expectGeneratedFingerprint<publish_model_t>();
  expectGeneratedFingerprint<model_reply_t>();
  expectGeneratedFingerprint<models_request_t>();
  expectGeneratedFingerprint<models_reply_t>();
  expectGeneratedFingerprint<grasp_outcome_t>();
  expectGeneratedFingerprint<outcome_reply_t>();
  expectGeneratedFingerprint<retrain_request_t>();
  expectGeneratedFingerprint<training_status_t>();
}

// Computed by lcm-gen 1.3.1 from the members that Drake documents for its type.
TEST(WireLayout, PointCloudIsWireCompatibleWithDrakes) {
  EXPECT_EQ(wireFingerprint(wire::kPointCloud), 0x17f2c128b5d25a95u);
}

// An empty message is the shortest: its encoding has exactly the least number of bytes.
TEST(WireLayout, LeastSizeIsThatOfAnEmptyMessage) {
  EXPECT_EQ(minWireBytes(wire::kPlanResponse) + 8, plan_response_t{}.getEncodedSize());
  EXPECT_EQ(minWireBytes(wire::kPlanRequest) + 8, plan_request_t{}.getEncodedSize());
  EXPECT_EQ(minWireBytes(wire::kStatus) + 8, status_t{}.getEncodedSize());
}

TEST(WireCheck, LetsEncodedMessagesThrough) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(problemOf(encoded(randomRequest(random, i)), wire::kPlanRequest), "");
    EXPECT_EQ(problemOf(encoded(randomResponse(random)), wire::kPlanResponse), "");
  }
  EXPECT_EQ(problemOf(encoded(status_t{}), wire::kStatus), "");
  EXPECT_EQ(problemOf(encoded(cancel_t{}), wire::kCancel), "");
}

TEST(WireCheck, DecodedIsWhatWasEncoded) {
  std::mt19937_64 random(2);
  const plan_request_t request = randomRequest(random);
  EXPECT_EQ(encoded(decoded<plan_request_t>(encoded(request))), encoded(request));
  const plan_response_t response = randomResponse(random);
  EXPECT_EQ(encoded(decoded<plan_response_t>(encoded(response))), encoded(response));
}

TEST(WireCheck, RefusesEveryTruncationAndAnyByteTooMany) {
  std::mt19937_64 random(4);
  for (const auto& [bytes, layout] : {std::pair{smallRequest(), &wire::kPlanRequest},
                                      std::pair{encoded(randomResponse(random)), &wire::kPlanResponse}}) {
    for (std::size_t n = 0; n < bytes.size(); ++n)
      EXPECT_NE(problemOf(Bytes(bytes.begin(), bytes.begin() + n), *layout), "")
          << layout->name << " cut to " << n;
    Bytes longer = bytes;
    longer.push_back(0);
    EXPECT_THAT(problemOf(longer, *layout), HasSubstr("1 bytes too many"));
  }
}

TEST(WireCheck, RefusesAWrongFingerprint) {
  Bytes bytes = smallRequest();
  bytes[3] ^= 1;
  EXPECT_THAT(problemOf(bytes, wire::kPlanRequest), HasSubstr("is not that of plan_request_t"));
  EXPECT_THAT(problemOf(smallRequest(), wire::kCancel), HasSubstr("is not that of cancel_t"));
}

// What lcm-gen's decoders die of.
TEST(WireCheck, RefusesImpossibleLengthsAndSaysWhich) {
  struct Case {
    std::size_t at;
    std::int64_t value;
    int size;
    std::string expected;
  };
  const std::int64_t int32_min = std::numeric_limits<std::int32_t>::min(), int32_max = -1 - int32_min;
  for (const Case& c : {Case{kIdLength, 0, 4, "text 'request_id' has length 0"},
                        {kIdLength, -1, 4, "text 'request_id' has length -1"},
                        {kIdLength, int32_min, 4, "text 'request_id' has length -2147483648"},
                        {kIdLength, int32_max, 4, "text 'request_id' has length 2147483647"},
                        {kIdLength, 60000, 4, "'request_id' needs 60000 bytes"},
                        {kIdLength, 2, 4, "text 'request_id' does not end with a zero byte"},
                        {kNumFields, -1, 4, "lcmt_point_cloud.num_fields is -1"},
                        {kNumFields, int32_max, 4, "lcmt_point_cloud.num_fields is 2147483647"},
                        {kNumFields, 4000, 4, "'fields' needs"}}) {
    Bytes bytes = smallRequest();
    putBigEndian(bytes, c.at, c.value, c.size);
    EXPECT_THAT(problemOf(bytes, wire::kPlanRequest), HasSubstr(c.expected))
        << "for " << c.value << " at " << c.at;
  }
}

TEST(WireCheck, RefusesLengthsOf64BitsThatAnIntWouldTruncate) {
  std::mt19937_64 random(5);
  const drake::lcmt_point_cloud cloud = randomRequest(random, 4).cloud;
  const Bytes good = encoded(cloud);
  const std::size_t at = good.size() - cloud.data.size() - 8;
  for (const std::int64_t length :
       {std::int64_t{-1}, std::int64_t{48} + (std::int64_t{1} << 32),
        std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()}) {
    Bytes bytes = good;
    putBigEndian(bytes, at, length, 8);
    EXPECT_THAT(problemOf(bytes, wire::kPointCloud), HasSubstr("lcmt_point_cloud.data_size is")) << length;
  }
}

// Whatever the check lets through, the generated decoder takes, and encodes again to as many bytes.
TEST(WireCheck, WhatItLetsThroughDecodes) {
  std::mt19937_64 random(6);
  int passed = 0;
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes = i % 2 ? smallRequest() : encoded(randomResponse(random));
    const WireLayout& layout = i % 2 ? wire::kPlanRequest : wire::kPlanResponse;
    for (int flips = 0; flips < 3; ++flips) {
      const std::size_t at = 8 + uniformIndex(random, bytes.size() - 8);
      bytes[at] = static_cast<std::uint8_t>(random());
    }
    if (!problemOf(bytes, layout).empty()) continue;
    ++passed;
    if (i % 2)
      EXPECT_EQ(encoded(decoded<plan_request_t>(bytes)).size(), bytes.size());
    else
      EXPECT_EQ(encoded(decoded<plan_response_t>(bytes)).size(), bytes.size());
  }
  EXPECT_GT(passed, 1000) << "too few mutations were let through for the test to mean anything";
}

}  // namespace
}  // namespace boxgrasp
