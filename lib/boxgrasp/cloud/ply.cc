#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "boxgrasp/cloud/parsers.h"

namespace boxgrasp {
namespace {

struct Property {
  std::string_view name;
  BinaryType type;        // of the value, or of each item of a list
  BinaryType count_type;  // of a list's count; invalid for a single value
  bool isList() const { return count_type.valid(); }
};

struct Element {
  std::string_view name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding { ascii, little_endian, big_endian };

struct PlyHeader {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
};

BinaryType parseType(const Cursor& cursor, std::string_view word) {
  static const std::map<std::string_view, BinaryType> types = {
      {"char", {'I', 1}},  {"int8", {'I', 1}},    {"uchar", {'U', 1}},  {"uint8", {'U', 1}},
      {"short", {'I', 2}}, {"int16", {'I', 2}},   {"ushort", {'U', 2}}, {"uint16", {'U', 2}},
      {"int", {'I', 4}},   {"int32", {'I', 4}},   {"uint", {'U', 4}},   {"uint32", {'U', 4}},
      {"float", {'F', 4}}, {"float32", {'F', 4}}, {"double", {'F', 8}}, {"float64", {'F', 8}}};
  const auto found = types.find(word);
  if (found == types.end())
    cursor.fail(fmt::format("{} is no PLY type, such as float or uchar", quoted(word)));
  return found->second;
}

Encoding parseEncoding(const Cursor& cursor, std::string_view word) {
  if (word == "ascii") return Encoding::ascii;
  if (word == "binary_little_endian") return Encoding::little_endian;
  if (word == "binary_big_endian") return Encoding::big_endian;
  cursor.fail(fmt::format("format is {}, but must be ascii, binary_little_endian or binary_big_endian",
                          quoted(word)));
}

Property parseProperty(const Cursor& cursor, Words& words) {
  Property property;
  std::string_view word = words.next();
  if (word == "list") {
    property.count_type = parseType(cursor, words.next());
    if (property.count_type.kind == 'F') cursor.fail("a list's count must have a whole number's type");
    word = words.next();
  }
  property.type = parseType(cursor, word);
  property.name = words.next();
  return property;
}

PlyHeader parseHeader(Cursor& cursor) {
  if (cursor.line() != "ply") cursor.fail("a PLY file must begin with the line 'ply'");
  PlyHeader header;
  bool has_format = false;
  for (;;) {
    Words words(cursor.line());
    const std::string_view keyword = words.next();
    if (keyword == "end_header") break;
    if (keyword == "comment" || keyword == "obj_info") continue;
    if (keyword == "format") {
      header.encoding = parseEncoding(cursor, words.next());
      has_format = true;
    } else if (keyword == "element") {
      const std::string_view name = words.next();
      header.elements.push_back({name, cursor.count(words.next(), "the element's count"), {}});
    } else if (keyword == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(parseProperty(cursor, words));
    } else {
      cursor.fail(fmt::format("{} is out of place in a PLY header", quoted(keyword)));
    }
  }
  if (!has_format) cursor.fail("the PLY header lacks its format line");
  return header;
}

// The numbers after the header one by one, whatever the encoding.
class Numbers {
 public:
  Numbers(Cursor& cursor, Encoding encoding) : cursor_(cursor), encoding_(encoding) {}

  void beginRow(std::string_view element);
  void endRow() const;
  double next(BinaryType type);
  std::size_t nextCount(BinaryType type);
  std::size_t bytesAtLeast(BinaryType type) const { return encoding_ == Encoding::ascii ? 2 : type.bytes; }

 private:
  Cursor& cursor_;
  Encoding encoding_;
  Words row_{""};
};

void Numbers::beginRow(std::string_view element) {
  if (encoding_ == Encoding::ascii)
    row_ = Words(cursor_.contentLine('\n', fmt::format("element {}", quoted(element))));
}

void Numbers::endRow() const {
  Words rest = row_;
  if (!rest.next().empty()) cursor_.fail("the line has more values than the element has properties");
}

double Numbers::next(BinaryType type) {
  if (encoding_ == Encoding::ascii) return cursor_.number(row_.next(), "a property");
  const auto order = encoding_ == Encoding::little_endian ? std::endian::little : std::endian::big;
  return loadNumber(cursor_.take(type.bytes, "a property").data(), type, order);
}

std::size_t Numbers::nextCount(BinaryType type) {
  const double count = next(type);
  if (!(count >= 0.0 && count <= 4294967295.0 && count == std::floor(count))) {
    cursor_.fail(fmt::format("a list's count is {}, but must be a whole number, 0 or more", count));
  }
  return static_cast<std::size_t>(count);
}

// Reads the elements into a mesh; properties that it has no use for are read over.
class ElementReader {
 public:
  ElementReader(Cursor& cursor, Encoding encoding, TriangleMesh& mesh)
      : cursor_(cursor), numbers_(cursor, encoding), mesh_(mesh) {}

  void read(const Element& element);

 private:
  void checkCount(const Element& element) const;
  void readVertex(const Element& element);
  void readFace(const Element& element);
  void readList(const Property& property);

  Cursor& cursor_;
  Numbers numbers_;
  TriangleMesh& mesh_;
  std::vector<double> list_;  // the list read last
  std::vector<std::uint32_t> polygon_;
};

void ElementReader::checkCount(const Element& element) const {
  if (element.properties.empty())
    cursor_.fail(fmt::format("element {} has no properties", quoted(element.name)));
  std::size_t row_bytes = 0;
  for (const Property& property : element.properties) {
    row_bytes += numbers_.bytesAtLeast(property.isList() ? property.count_type : property.type);
  }
  cursor_.requireRoomFor(element.count, row_bytes, fmt::format("elements {}", quoted(element.name)));
}

void ElementReader::readList(const Property& property) {
  const std::size_t count = numbers_.nextCount(property.count_type);
  list_.clear();
  for (std::size_t i = 0; i < count; ++i) list_.push_back(numbers_.next(property.type));
}

void ElementReader::readVertex(const Element& element) {
  Vector3d p = Vector3d::Zero();
  for (const Property& property : element.properties) {
    if (property.isList()) {
      readList(property);
      continue;
    }
    const double value = numbers_.next(property.type);
    if (property.name == "x") p.x() = value;
    if (property.name == "y") p.y() = value;
    if (property.name == "z") p.z() = value;
  }
  mesh_.vertices.push_back(p);
}

void ElementReader::readFace(const Element& element) {
  for (const Property& property : element.properties) {
    if (!property.isList()) {
      numbers_.next(property.type);
      continue;
    }
    readList(property);
    if (property.name != "vertex_indices" && property.name != "vertex_index") continue;
    polygon_.clear();
    for (const double index : list_) polygon_.push_back(checkedVertex(cursor_, index, mesh_.vertices.size()));
    appendFan(mesh_, polygon_);
  }
}

void ElementReader::read(const Element& element) {
  if (element.count == 0) return;
  checkCount(element);
  if (element.name == "vertex") mesh_.vertices.reserve(element.count);
  for (std::size_t i = 0; i < element.count; ++i) {
    numbers_.beginRow(element.name);
    if (element.name == "vertex") {
      readVertex(element);
    } else {
      readFace(element);
    }
    numbers_.endRow();
  }
}

void requireCoordinates(const Cursor& cursor, const PlyHeader& header) {
  const auto vertex = std::ranges::find(header.elements, "vertex", &Element::name);
  if (vertex == header.elements.end()) cursor.fail("the PLY header declares no element 'vertex'");
  for (const std::string_view axis : {"x", "y", "z"}) {
    const auto named = [&](const Property& property) { return property.name == axis && !property.isList(); };
    if (std::ranges::count_if(vertex->properties, named) != 1) {
      cursor.fail(fmt::format("element vertex must have the property {} once", axis));
    }
  }
  if (std::ranges::count(header.elements, "vertex", &Element::name) > 1)
    cursor.fail("element vertex is declared twice");
}

}  // namespace

FileContent parsePly(Cursor& cursor, std::size_t max_points) {
  const PlyHeader header = parseHeader(cursor);
  requireCoordinates(cursor, header);
  FileContent content;
  content.format = "ply";
  ElementReader reader(cursor, header.encoding, content.mesh);
  for (const Element& element : header.elements) {
    if (element.name == "vertex") requireFewPoints(cursor, element.count, max_points);
    reader.read(element);
  }
  return content;
}

}  // namespace boxgrasp
