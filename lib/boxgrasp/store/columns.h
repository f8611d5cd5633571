// The columns of records: each record names its fields once, and from that list come statements, rows, the
// text of a dump and what two records differ in.
#pragma once

#include <fmt/format.h>

#include <concepts>
#include <string>
#include <vector>

#include "boxgrasp/store/database.h"
#include "boxgrasp/store/value.h"

namespace boxgrasp {

// A record of this type, constant or not.
template <typename Record, typename Type>
concept IsA = std::same_as<std::remove_const_t<Record>, Type>;

// Each record has a visitColumns(record, visit) that calls visit(name of the column, field) for each field.
void visitColumns(IsA<QualityMeasures> auto& quality, auto&& visit) {
  constexpr std::array<const char*, 9> kNames{"q1", "q2", "q3", "q4", "q5", "q6", "q7", "q8", "q9"};
  for (std::size_t i = 0; i < quality.size(); ++i) visit(kNames[i], quality[i]);
}

template <typename Record>
std::vector<std::string> columnNames() {
  std::vector<std::string> names;
  Record record{};
  visitColumns(record, [&](const char* name, const auto&) { names.emplace_back(name); });
  return names;
}

// "source, grasp_index, ..."
template <typename Record>
std::string columnList() {
  return fmt::format("{}", fmt::join(columnNames<Record>(), ", "));
}

// "INSERT INTO <table> (<owners>, ...) VALUES (?, ...)"; the owners are the columns that say whose the record
// is.
template <typename Record>
std::string insertStatement(const char* table, const std::vector<std::string>& owners) {
  std::vector<std::string> names = owners;
  for (std::string& name : columnNames<Record>()) names.push_back(std::move(name));
  const std::vector<const char*> places(names.size(), "?");
  return fmt::format("INSERT INTO {} ({}) VALUES ({})", table, fmt::join(names, ", "),
                     fmt::join(places, ", "));
}

// The owners' values, then the record's.
template <typename Record>
std::vector<Value> valuesOf(const Record& record, std::vector<Value> owners = {}) {
  visitColumns(record, [&](const char*, const auto& field) { owners.push_back(encode(field)); });
  return owners;
}

// The record in the row's columns from `first` on. Throws StoreError for values that are none of ours.
template <typename Record>
Record readRecord(const Statement& row, int first) {
  Record record{};
  visitColumns(record, [&, column = first](const char*, auto& field) mutable { row.read(column++, field); });
  return record;
}

// " name=value name=value ...": all of the record, to the bit but for the kinds of NaN.
template <typename Record>
std::string recordText(const Record& record) {
  std::string text;
  visitColumns(record, [&](const char* name, const auto& field) {
    text += fmt::format(" {}={}", name, toText(encode(field)));
  });
  return text;
}

// "name is a in the one and b in the other" for the first field that differs; empty where all agree.
template <typename Record>
std::string difference(const Record& stored, const Record& given) {
  const std::vector<std::string> names = columnNames<Record>();
  const std::vector<Value> is = valuesOf(stored), wanted = valuesOf(given);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string a = toText(is[i]), b = toText(wanted[i]);
    if (a != b) return fmt::format("{} is {} there, and {} here", names[i], a, b);
  }
  return {};
}

}  // namespace boxgrasp
