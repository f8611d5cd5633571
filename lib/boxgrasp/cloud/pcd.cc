#include <fmt/format.h>
#include <liblzf/lzf.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <map>

#include "boxgrasp/cloud/parsers.h"

namespace boxgrasp {
namespace {

constexpr std::size_t kLargestCount =
    100'000;  // of a field; the longest descriptors in use have some 2,000 entries

struct Field {
  std::string_view name;
  BinaryType type;
  std::size_t count = 1;
  std::size_t bytes() const { return type.bytes * count; }
};

struct PcdHeader {
  std::vector<Field> fields;
  std::size_t width = 0, height = 0, points = 0;
  std::array<double, 7> viewpoint{0, 0, 0, 1, 0, 0, 0};  // position, orientation quaternion w x y z
  std::string_view data;

  std::size_t pointBytes() const;
  std::size_t columns() const;
};

std::size_t PcdHeader::pointBytes() const {
  std::size_t sum = 0;
  for (const Field& field : fields) sum += field.bytes();
  return sum;
}

std::size_t PcdHeader::columns() const {
  std::size_t sum = 0;
  for (const Field& field : fields) sum += field.count;
  return sum;
}

// Reads the header entry by entry; each entry is checked where it stands, so that messages name its line.
class HeaderReader {
 public:
  explicit HeaderReader(Cursor& cursor) : cursor_(cursor) {}
  PcdHeader read();

 private:
  using Entry = void (HeaderReader::*)(Words&);
  static const std::map<std::string_view, Entry>& entries();

  void version(Words&) {}
  void fields(Words& words);
  void sizes(Words& words);
  void types(Words& words);
  void counts(Words& words);
  void width(Words& words) { header_.width = cursor_.count(words.next(), "WIDTH"); }
  void height(Words& words) { header_.height = cursor_.count(words.next(), "HEIGHT"); }
  void points(Words& words) { header_.points = cursor_.count(words.next(), "POINTS"); }
  void viewpoint(Words& words);
  void data(Words& words) { header_.data = words.next(); }

  void eachField(Words& words, std::string_view entry,
                 const std::function<void(Field&, std::string_view)>& set);
  void readEntry(std::string_view line);
  void check();
  void checkCoordinates() const;
  bool seen(std::string_view entry) const { return std::ranges::count(seen_, entry) > 0; }

  Cursor& cursor_;
  PcdHeader header_;
  std::vector<std::string_view> seen_;
};

const std::map<std::string_view, HeaderReader::Entry>& HeaderReader::entries() {
  static const std::map<std::string_view, Entry> table = {
      {"VERSION", &HeaderReader::version}, {"FIELDS", &HeaderReader::fields},
      {"SIZE", &HeaderReader::sizes},      {"TYPE", &HeaderReader::types},
      {"COUNT", &HeaderReader::counts},    {"WIDTH", &HeaderReader::width},
      {"HEIGHT", &HeaderReader::height},   {"VIEWPOINT", &HeaderReader::viewpoint},
      {"POINTS", &HeaderReader::points},   {"DATA", &HeaderReader::data}};
  return table;
}

void HeaderReader::fields(Words& words) {
  constexpr std::size_t kMostFields = 1000;
  for (std::string_view name = words.next(); !name.empty(); name = words.next()) {
    header_.fields.push_back({name, {}, 1});
    if (header_.fields.size() > kMostFields) cursor_.fail("FIELDS names more than 1000 fields");
  }
}

void HeaderReader::eachField(Words& words, std::string_view entry,
                             const std::function<void(Field&, std::string_view)>& set) {
  if (!seen("FIELDS")) cursor_.fail(fmt::format("{} stands before FIELDS", entry));
  for (Field& field : header_.fields) {
    const std::string_view word = words.next();
    if (word.empty()) cursor_.fail(fmt::format("{} has fewer entries than FIELDS", entry));
    set(field, word);
  }
  if (!words.next().empty()) cursor_.fail(fmt::format("{} has more entries than FIELDS", entry));
}

void HeaderReader::sizes(Words& words) {
  eachField(words, "SIZE", [this](Field& field, std::string_view word) {
    field.type.bytes = cursor_.count(word, "SIZE");
    if (field.type.bytes > 8) cursor_.fail(fmt::format("SIZE is {}, but must be 1, 2, 4 or 8", quoted(word)));
  });
}

void HeaderReader::types(Words& words) {
  eachField(words, "TYPE", [this](Field& field, std::string_view word) {
    field.type.kind = word.size() == 1 ? word[0] : '?';
    if (word != "I" && word != "U" && word != "F") {
      cursor_.fail(fmt::format("TYPE is {}, but must be I, U or F", quoted(word)));
    }
  });
}

void HeaderReader::counts(Words& words) {
  eachField(words, "COUNT", [this](Field& field, std::string_view word) {
    field.count = cursor_.count(word, "COUNT");
    if (field.count == 0 || field.count > kLargestCount) {
      cursor_.fail(fmt::format("COUNT is {}, but must be in [1, {}]", quoted(word), kLargestCount));
    }
  });
}

void HeaderReader::viewpoint(Words& words) {
  for (double& value : header_.viewpoint) {
    value = cursor_.number(words.next(), "VIEWPOINT (x y z and a quaternion w x y z)");
    if (!std::isfinite(value)) cursor_.fail("VIEWPOINT is not finite");
  }
}

void HeaderReader::readEntry(std::string_view line) {
  Words words(line);
  std::string_view keyword = words.next();
  if (keyword == "COLUMNS") keyword = "FIELDS";  // the name in early versions of the format
  const auto entry = entries().find(keyword);
  if (entry == entries().end()) {
    cursor_.fail(fmt::format("{} is no entry of a PCD header; is this a PCD file?", quoted(keyword)));
  }
  if (seen(keyword)) cursor_.fail(fmt::format("{} stands twice in the header", keyword));
  (this->*entry->second)(words);
  seen_.push_back(entry->first);
}

void HeaderReader::checkCoordinates() const {
  for (const std::string_view axis : {"x", "y", "z"}) {
    if (std::ranges::count(header_.fields, axis, &Field::name) != 1) {
      cursor_.fail(fmt::format("FIELDS must name {} once; this is no file of points in space", axis));
    }
    const Field& field = *std::ranges::find(header_.fields, axis, &Field::name);
    if (field.type.kind != 'F' || field.count != 1) {
      cursor_.fail(fmt::format("field {} has TYPE {} and COUNT {}, but must have F and 1; convert the file",
                               axis, field.type.kind, field.count));
    }
  }
}

void HeaderReader::check() {
  for (const std::string_view entry : {"FIELDS", "SIZE", "TYPE", "WIDTH", "HEIGHT", "POINTS"}) {
    if (!seen(entry)) cursor_.fail(fmt::format("the header lacks {}", entry));
  }
  for (const Field& field : header_.fields) {
    if (!field.type.valid()) {
      cursor_.fail(fmt::format("field {} has TYPE {} and SIZE {}, which do not go together",
                               quoted(field.name), field.type.kind, field.type.bytes));
    }
  }
  checkCoordinates();
  const bool fits = header_.height == 0 ? header_.points == 0
                                        : header_.points / header_.height == header_.width &&
                                              header_.points % header_.height == 0;
  if (!fits) {
    cursor_.fail(fmt::format("POINTS is {}, but must be WIDTH x HEIGHT = {} x {}", header_.points,
                             header_.width, header_.height));
  }
}

PcdHeader HeaderReader::read() {
  while (!seen("DATA")) readEntry(cursor_.contentLine('#', "the rest of a PCD header up to DATA"));
  check();
  return header_;
}

// One field of all points in binary data: the value of point i is at first + i * stride.
struct Column {
  const char* first;
  std::size_t stride;
  BinaryType type;

  // Calls take(i, value) for each of n points.
  template <typename Take>
  void forEach(std::size_t n, const Take& take) const {
    withType(type, [&](auto as) {
      for (std::size_t i = 0; i < n; ++i)
        take(i, static_cast<double>(loadAs<decltype(as)>(first + i * stride, std::endian::little)));
    });
  }
};

// Whether the file's field of this name holds labels; labels are whole numbers.
bool isLabel(const Field& field) {
  return field.name == "label" && field.type.kind != 'F' && field.count == 1;
}

void readColumn(const Column& column, std::vector<float>& values) {
  column.forEach(values.size(), [&](std::size_t i, double value) { values[i] = static_cast<float>(value); });
}

void readColumn(const Column& column, std::vector<std::uint32_t>& values) {
  column.forEach(values.size(), [&](std::size_t i, double value) {
    values[i] = static_cast<std::uint32_t>(std::clamp(value, 0.0, 4294967295.0));
  });
}

// The points of binary data, point after point, or compressed data, field after field. Pre: data holds all
// points.
void readBinary(const PcdHeader& header, std::string_view data, bool by_field, FileContent& content) {
  content.cloud.resize(header.points);
  std::size_t offset = 0;
  for (const Field& field : header.fields) {
    const Column column{data.data() + offset * (by_field ? header.points : 1),
                        by_field ? field.bytes() : header.pointBytes(), field.type};
    if (field.name == "x") readColumn(column, content.cloud.x);
    if (field.name == "y") readColumn(column, content.cloud.y);
    if (field.name == "z") readColumn(column, content.cloud.z);
    if (isLabel(field) && content.labels.empty()) {
      content.labels.resize(header.points);
      readColumn(column, content.labels);
    }
    offset += field.bytes();
  }
}

std::vector<char> decompress(Cursor& cursor, std::size_t uncompressed_bytes) {
  constexpr std::size_t kBestRatio =
      132;  // LZF cannot do better: 264 bytes from 2, so memory stays in proportion
  const auto compressed_bytes = cursor.value<std::uint32_t>(std::endian::little, "the compressed size");
  const auto declared_bytes = cursor.value<std::uint32_t>(std::endian::little, "the uncompressed size");
  if (declared_bytes != uncompressed_bytes) {
    cursor.fail(fmt::format("the uncompressed size is {}, but POINTS and SIZE make {}", declared_bytes,
                            uncompressed_bytes));
  }
  const std::string_view packed = cursor.take(compressed_bytes, "the compressed data");
  if (uncompressed_bytes > packed.size() * kBestRatio)
    cursor.fail("the compressed data cannot hold all points");
  std::vector<char> data(uncompressed_bytes);
  if (data.empty()) return data;
  if (lzf_decompress(packed.data(), compressed_bytes, data.data(), declared_bytes) != declared_bytes) {
    cursor.fail("the compressed data is damaged");
  }
  return data;
}

void readAsciiPoint(const PcdHeader& header, const Cursor& cursor, std::string_view line,
                    FileContent& content) {
  Words words(line);
  Vector3d p = Vector3d::Zero();
  std::optional<std::uint32_t> label;
  for (const Field& field : header.fields) {
    for (std::size_t i = 0; i < field.count; ++i) {
      const std::string_view word = words.next();
      if (word.empty()) cursor.fail(fmt::format("the line has fewer than {} values", header.columns()));
      if (field.name == "x") p.x() = cursor.number(word, "x");
      if (field.name == "y") p.y() = cursor.number(word, "y");
      if (field.name == "z") p.z() = cursor.number(word, "z");
      if (isLabel(field) && !label) label = static_cast<std::uint32_t>(cursor.count(word, "label"));
    }
  }
  if (!words.next().empty()) cursor.fail(fmt::format("the line has more than {} values", header.columns()));
  content.cloud.push(p);
  if (label) content.labels.push_back(*label);
}

void readAscii(const PcdHeader& header, Cursor& cursor, FileContent& content) {
  cursor.requireRoomFor(header.points, 2 * header.columns(), "points");
  content.cloud.reserve(header.points);
  for (std::size_t i = 0; i < header.points; ++i) {
    readAsciiPoint(header, cursor,
                   cursor.contentLine('#', fmt::format("point {} of {}", i + 1, header.points)), content);
  }
  if (cursor.contentLine('#'))
    cursor.fail(fmt::format("the file goes on after its {} points", header.points));
}

// The sensor's place, unless it has the values that writers fill in when they do not know it.
std::optional<Vector3d> viewpointOf(const PcdHeader& header) {
  constexpr std::array<double, 7> kUnknown{0, 0, 0, 1, 0, 0, 0};
  const bool organised = header.height > 1;
  if (!organised && header.viewpoint == kUnknown) return std::nullopt;
  return Vector3d(header.viewpoint[0], header.viewpoint[1], header.viewpoint[2]);
}

void readData(const PcdHeader& header, Cursor& cursor, FileContent& content) {
  if (header.data == "ascii") return readAscii(header, cursor, content);
  const std::size_t bytes = header.points * header.pointBytes();
  if (header.data == "binary") return readBinary(header, cursor.take(bytes, "the points"), false, content);
  if (header.data == "binary_compressed") {
    const std::vector<char> unpacked = decompress(cursor, bytes);
    return readBinary(header, {unpacked.data(), bytes}, true, content);
  }
  cursor.fail(fmt::format("DATA is {}, but must be ascii, binary or binary_compressed", quoted(header.data)));
}

}  // namespace

FileContent parsePcd(Cursor& cursor, std::size_t max_points) {
  const PcdHeader header = HeaderReader(cursor).read();
  requireFewPoints(cursor, header.points, max_points);
  FileContent content;
  content.format = fmt::format("pcd {}", header.data);
  content.viewpoint = viewpointOf(header);
  readData(header, cursor, content);
  return content;
}

}  // namespace boxgrasp
