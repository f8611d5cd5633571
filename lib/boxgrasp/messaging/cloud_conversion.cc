#include "boxgrasp/messaging/cloud_conversion.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "boxgrasp/base/error.h"
#include "boxgrasp/messaging/wire_layout.h"

namespace boxgrasp {
namespace {

using Message = drake::lcmt_point_cloud;
using Field = drake::lcmt_point_cloud_field;

static_assert(std::endian::native == std::endian::little);

Field floatField(const std::string& name, int byte_offset) {
  Field field;
  field.name = name;
  field.byte_offset = byte_offset;
  field.datatype = Field::FLOAT32;
  field.count = 1;
  return field;
}

void require(bool holds, std::string_view member, std::int64_t value, std::string_view bound) {
  if (!holds)
    throw InputError(fmt::format("point cloud message: {} is {}, but must be {}", member, value, bound));
}

int sizeOf(const Field& field) { return field.datatype == Field::FLOAT64 ? 8 : 4; }

const Field& coordinate(const Message& message, const std::string& name) {
  const auto found = std::find_if(message.fields.begin(), message.fields.end(),
                                  [&](const Field& field) { return field.name == name; });
  if (found == message.fields.end())
    throw InputError(fmt::format("point cloud message: it has no field '{}'; x, y and z are needed", name));
  require(found->datatype == Field::FLOAT32 || found->datatype == Field::FLOAT64, name + ".datatype",
          found->datatype, "7 (float32) or 8 (float64)");
  require(found->count == 1, name + ".count", found->count, "1");
  require(found->byte_offset >= 0 && found->byte_offset <= message.point_step - sizeOf(*found),
          name + ".byte_offset", found->byte_offset,
          fmt::format("within a point of {} bytes", message.point_step));
  return *found;
}

// Sizes are bounded by that of any message before they are multiplied, so that no product overflows.
void checkSizes(const Message& message) {
  const auto bounded = [](std::string_view member, std::int64_t value, std::int64_t least) {
    require(value >= least && value <= kMaxMessageBytes, member, value,
            fmt::format("{} to {}", least, kMaxMessageBytes));
  };
  bounded("width", message.width, 0);
  bounded("height", message.height, 0);
  bounded("point_step", message.point_step, 12);  // three coordinates
  const std::int64_t row = message.width * message.point_step;
  if (message.height > 1) bounded("row_step", message.row_step, row);
  const std::int64_t needed = message.height == 0 ? 0 : (message.height - 1) * message.row_step + row;
  require(needed <= static_cast<std::int64_t>(message.data.size()), "data_size", message.data_size,
          fmt::format("at least {} (the last point's end)", needed));
}

template <typename Float, typename Bits>
float valueAt(const std::uint8_t* at, bool swapped) {
  Bits bits;
  std::memcpy(&bits, at, sizeof bits);
  if (swapped) {
    auto* bytes = reinterpret_cast<std::uint8_t*>(&bits);
    std::reverse(bytes, bytes + sizeof bits);
  }
  return static_cast<float>(std::bit_cast<Float>(bits));
}

template <typename Float, typename Bits>
void readValues(const Message& message, const Field& field, std::vector<float>& out) {
  const bool swapped = message.flags & Message::IS_BIGENDIAN;
  float* to = out.data();
  for (std::int64_t row = 0; row < message.height; ++row) {
    const std::uint8_t* at = message.data.data() + row * message.row_step + field.byte_offset;
    for (std::int64_t column = 0; column < message.width; ++column, at += message.point_step)
      *to++ = valueAt<Float, Bits>(at, swapped);
  }
}

void readCoordinate(const Message& message, const Field& field, std::vector<float>& out) {
  out.resize(message.width * message.height);
  if (out.empty()) return;  // there may be no bytes to point into
  if (field.datatype == Field::FLOAT64)
    readValues<double, std::uint64_t>(message, field, out);
  else
    readValues<float, std::uint32_t>(message, field, out);
}

}  // namespace

Message toMessage(const PointCloud& cloud_C, const std::string& frame_name) {
  Message message{};
  message.frame_name = frame_name;
  message.width = static_cast<std::int64_t>(cloud_C.size());
  message.height = 1;
  message.fields = {floatField("x", 0), floatField("y", 4), floatField("z", 8)};
  message.num_fields = 3;
  message.point_step = 12;
  message.row_step = message.width * message.point_step;
  message.data_size = message.row_step;
  message.data.resize(message.data_size);
  for (std::size_t i = 0; i < cloud_C.size(); ++i) {
    const float point[3] = {cloud_C.x[i], cloud_C.y[i], cloud_C.z[i]};
    std::memcpy(message.data.data() + 12 * i, point, sizeof point);
  }
  return message;
}

PointCloud fromMessage(const Message& message) {
  checkSizes(message);
  PointCloud cloud;
  readCoordinate(message, coordinate(message, "x"), cloud.x);
  readCoordinate(message, coordinate(message, "y"), cloud.y);
  readCoordinate(message, coordinate(message, "z"), cloud.z);
  return cloud;
}

}  // namespace boxgrasp
