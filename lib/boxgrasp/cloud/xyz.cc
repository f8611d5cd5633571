#include <fmt/format.h>

#include "boxgrasp/cloud/parsers.h"

namespace boxgrasp {
namespace {

std::vector<std::string_view> split(std::string_view line) {
  Words words(line, Words::Separators::blanks_and_commas);
  std::vector<std::string_view> columns;
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) columns.push_back(word);
  return columns;
}

// Whether a line names its columns: none of its words is a number.
bool isHeader(const std::vector<std::string_view>& columns) {
  for (const std::string_view word : columns) {
    if (parseNumber(word)) return false;
  }
  return true;
}

}  // namespace

FileContent parseXyz(Cursor& cursor, std::size_t max_points) {
  FileContent content;
  content.format = "xyz";
  std::size_t columns = 0;  // as many as the first line has
  while (const auto line = cursor.contentLine('#')) {
    const std::vector<std::string_view> words = split(*line);
    const bool first = columns == 0;
    if (first) columns = words.size();
    if (words.size() < 3) cursor.fail(fmt::format("{} has fewer than three columns", quoted(*line)));
    if (words.size() != columns) {
      cursor.fail(fmt::format("the line has {} columns, but those before have {}", words.size(), columns));
    }
    if (first && isHeader(words)) continue;
    content.cloud.push(
        {cursor.number(words[0], "x"), cursor.number(words[1], "y"), cursor.number(words[2], "z")});
    requireFewPoints(cursor, content.cloud.size(), max_points);
  }
  return content;
}

}  // namespace boxgrasp
