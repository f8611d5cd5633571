// What a column of a store holds, and how the fields of records become such values and come back.
#pragma once

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "boxgrasp/training/experience.h"

namespace boxgrasp {

// NULL, INTEGER, REAL or TEXT. Doubles keep their bits, -0 among them, in columns without conversion (ANY in
// a STRICT table); a NaN is NULL. Several numbers in one column are text, separated by blanks, each with as
// many digits as it needs to read back to the bit.
using Value = std::variant<std::monostate, std::int64_t, double, std::string>;

Value encode(bool x);
Value encode(int x);
Value encode(std::int64_t x);
Value encode(std::uint64_t x);  // its bits
Value encode(double x);
Value encode(const std::string& x);
Value encode(GraspSource x);   // its name
Value encode(TrialOutcome x);  // its name
Value encode(const std::vector<double>& x);
Value encode(const Pose& x);        // the three upper rows of its matrix, row by row
Value encode(const HandJoints& x);  // spread, then the inner joints
// Ten numbers (finger, p_O, normal_O, force_O) and the link each, separated by ';'.
Value encode(const std::vector<TrialContact>& x);

// The value is none that `encode` makes for this type: the file is damaged, or made up.
struct DecodeError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The inverse of encode. Throws DecodeError.
void decode(const Value& value, bool& x);
void decode(const Value& value, int& x);
void decode(const Value& value, std::int64_t& x);
void decode(const Value& value, std::uint64_t& x);
void decode(const Value& value, double& x);
void decode(const Value& value, std::string& x);
void decode(const Value& value, GraspSource& x);
void decode(const Value& value, TrialOutcome& x);
void decode(const Value& value, std::vector<double>& x);
void decode(const Value& value, Pose& x);
void decode(const Value& value, HandJoints& x);
void decode(const Value& value, std::vector<TrialContact>& x);

// For people, on one line: "nan" for NULL, text in quotes.
std::string toText(const Value& value);

}  // namespace boxgrasp
