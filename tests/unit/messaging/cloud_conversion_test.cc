// Point clouds as messages: what goes in comes out, in any layout that fits; what does not fit is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "boxgrasp/base/error.h"
#include "random_messages.h"

namespace boxgrasp {
namespace {

using Message = drake::lcmt_point_cloud;
using Field = drake::lcmt_point_cloud_field;
using testing::HasSubstr;

std::string problemOf(const Message& message) {
  try {
    fromMessage(message);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

Message cloudOf(std::size_t points) {
  std::mt19937_64 random(1);
  return toMessage(test::randomCloud(random, points), "camera");
}

template <typename Float>
void store(Message& message, std::size_t at, double value, bool big_endian) {
  const auto number = static_cast<Float>(value);
  std::uint8_t bytes[sizeof number];
  std::memcpy(bytes, &number, sizeof number);
  if (big_endian) std::reverse(bytes, bytes + sizeof number);
  std::memcpy(message.data.data() + at, bytes, sizeof number);
}

Field field(const std::string& name, int offset, int datatype) {
  Field f;
  f.name = name;
  f.byte_offset = offset;
  f.datatype = static_cast<std::int8_t>(datatype);
  f.count = 1;
  return f;
}

TEST(CloudConversion, RoundTripKeepsEveryBit) {
  std::mt19937_64 random(2);
  PointCloud cloud = test::randomCloud(random, 1000);
  cloud.x[3] = std::numeric_limits<float>::infinity();
  cloud.y[4] = -0.0f;
  const PointCloud back = fromMessage(toMessage(cloud, "f"));
  EXPECT_EQ(back, cloud);
  EXPECT_TRUE(std::signbit(back.y[4]));
  EXPECT_TRUE(fromMessage(toMessage({}, "f")).empty());
}

// Mixed types, another order, gaps between points and between rows, both byte orders.
TEST(CloudConversion, ReadsAnyLayout) {
  std::mt19937_64 random(3);
  const PointCloud cloud = test::randomCloud(random, 12);
  for (const bool big_endian : {false, true}) {
    Message message{};
    message.width = 4;
    message.height = 3;
    message.fields = {field("rgb", 0, 6), field("z", 1, 7), field("x", 5, 8), field("y", 17, 7)};
    message.flags = big_endian ? Message::IS_BIGENDIAN : 0;
    message.point_step = 23;
    message.row_step = 4 * 23 + 5;
    message.data.resize(3 * message.row_step);
    for (std::size_t i = 0; i < 12; ++i) {
      const std::size_t at = i / 4 * message.row_step + i % 4 * 23;
      store<float>(message, at + 1, cloud.z[i], big_endian);
      store<double>(message, at + 5, cloud.x[i], big_endian);
      store<float>(message, at + 17, cloud.y[i], big_endian);
    }
    EXPECT_EQ(fromMessage(message), cloud) << (big_endian ? "big" : "little") << " endian";
  }
}

TEST(CloudConversion, RefusesWhatDoesNotFitAndSaysWhat) {
  const auto with = [](auto change) {
    Message message = cloudOf(5);
    change(message);
    return problemOf(message);
  };
  const auto huge = std::numeric_limits<std::int64_t>::max();
  EXPECT_THAT(with([](Message& m) { m.width = -1; }), HasSubstr("width is -1"));
  EXPECT_THAT(with([&](Message& m) { m.width = huge; }), HasSubstr("width is 9223372036854775807"));
  EXPECT_THAT(with([&](Message& m) { m.height = huge; }), HasSubstr("height is"));
  EXPECT_THAT(with([](Message& m) { m.height = 2; }), HasSubstr("data_size is 60, but must be at least 120"));
  EXPECT_THAT(with([](Message& m) { m.width = 6; }), HasSubstr("at least 72"));
  EXPECT_THAT(with([](Message& m) { m.point_step = 0; }), HasSubstr("point_step is 0"));
  EXPECT_THAT(with([](Message& m) { m.point_step = -12; }), HasSubstr("point_step is -12"));
  EXPECT_THAT(with([](Message& m) { m.height = 2, m.row_step = -60; }), HasSubstr("row_step is -60"));
  EXPECT_THAT(with([](Message& m) { m.fields[2].name += '2'; }), HasSubstr("no field 'z'"));
  EXPECT_THAT(with([](Message& m) { m.fields[1].byte_offset = 9; }), HasSubstr("y.byte_offset is 9"));
  EXPECT_THAT(with([](Message& m) { m.fields[1].byte_offset = -1; }), HasSubstr("y.byte_offset is -1"));
  EXPECT_THAT(with([](Message& m) { m.fields[0].datatype = 5; }), HasSubstr("x.datatype is 5"));
  EXPECT_THAT(with([](Message& m) { m.fields[0].count = 3; }), HasSubstr("x.count is 3"));
}

}  // namespace
}  // namespace boxgrasp
