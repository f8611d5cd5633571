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

// Every visitColumns(record, visit) calls visit(name of the column, field) for each field, in the table's
// order.
void visitColumns(IsA<ModelRecord> auto& model, auto&& visit) {
  visit("object", model.key.object);
  visit("scale", model.key.scale);
  visit("view", model.key.view);
  visit("mesh_hash", model.mesh_hash);
  visit("mass_kg", model.mass_kg);
  visit("size_m", model.size_m);
  visit("boxes", model.boxes);
  visit("leaves", model.leaves);
  visit("projections", model.projections);
  visit("triplets", model.triplets);
  visit("configurations", model.configurations);
  visit("message", model.message);
}

void visitColumns(IsA<QualityMeasures> auto& quality, auto&& visit) {
  constexpr std::array<const char*, 9> kNames{"q1", "q2", "q3", "q4", "q5", "q6", "q7", "q8", "q9"};
  for (std::size_t i = 0; i < quality.size(); ++i) visit(kNames[i], quality[i]);
}

void visitColumns(IsA<HypothesisRecord> auto& hypothesis, auto&& visit) {
  visit("source", hypothesis.source);
  visit("grasp_index", hypothesis.index);
  visit("X_OP", hypothesis.X_OP);
  visit("joints", hypothesis.joints);
  visit("pregrasp", hypothesis.pregrasp);
  visit("approach_m", hypothesis.approach_m);
  visitColumns(hypothesis.quality, visit);
  visit("box", hypothesis.box);
  visit("face", hypothesis.face);
}

void visitColumns(IsA<GraspLabel> auto& label, auto&& visit) {
  visit("perturbation", label.perturbation);
  visit("seed", label.seed);
  visit("friction", label.friction);
  visit("mass_factor", label.mass_factor);
  visit("outcome", label.outcome);
  visit("force_closure", label.force_closure);
  visit("epsilon", label.epsilon);
  visit("nu", label.nu);
  visit("lift_slip_m", label.lift_slip_m);
  visit("lift_rotation_rad", label.lift_rotation_rad);
  visit("push_force_n", label.push_force_n);
  visit("six_push_displacement_m", label.six_push_displacement_m);
  visit("gravities_held", label.gravities_held);
  visit("contacts", label.contacts);
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

// "INSERT INTO <table> (<owner>, ...) VALUES (?, ...)"; the owner is the column that says whose the record
// is, empty for none.
template <typename Record>
std::string insertStatement(const char* table, const std::string& owner) {
  std::vector<std::string> names = columnNames<Record>();
  if (!owner.empty()) names.insert(names.begin(), owner);
  const std::vector<const char*> places(names.size(), "?");
  return fmt::format("INSERT INTO {} ({}) VALUES ({})", table, fmt::join(names, ", "),
                     fmt::join(places, ", "));
}

template <typename Record>
std::vector<Value> valuesOf(const Record& record) {
  std::vector<Value> values;
  visitColumns(record, [&](const char*, const auto& field) { values.push_back(encode(field)); });
  return values;
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
