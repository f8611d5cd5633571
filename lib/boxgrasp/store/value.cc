#include "boxgrasp/store/value.h"

#include <fmt/format.h>

#include <bit>
#include <limits>

#include "boxgrasp/store/grasp_id.h"
#include "boxgrasp/store/number_text.h"

namespace boxgrasp {
namespace {

constexpr std::array kOutcomes{TrialOutcome::missed,        TrialOutcome::collided,
                               TrialOutcome::unstable,      TrialOutcome::lost_in_lift,
                               TrialOutcome::lost_in_shake, TrialOutcome::held};

// Names with static storage, because contacts refer to theirs.
std::vector<std::string_view> linkNames() {
  std::vector<std::string_view> names{"palm"};
  for (const Capsule& link : forwardKinematics(barrettHand(), {}).links) names.push_back(link.name);
  return names;
}

std::string_view knownLink(std::string_view name) {
  static const std::vector<std::string_view> names = linkNames();
  for (const std::string_view known : names) {
    if (known == name) return known;
  }
  throw DecodeError(fmt::format("'{}' is no link of a hand", name));
}

template <typename Alternative>
const Alternative& get(const Value& value, const char* wanted) {
  if (const auto* found = std::get_if<Alternative>(&value)) return *found;
  throw DecodeError(fmt::format("it is {} instead of {}", toText(value), wanted));
}

std::int64_t integer(const Value& value) { return get<std::int64_t>(value, "an integer"); }
const std::string& words(const Value& value) { return get<std::string>(value, "text"); }

template <typename Number>
Number number(std::string_view text) {
  if (const auto parsed = parseNumber<Number>(text)) return *parsed;
  throw DecodeError(fmt::format("'{}' is no number", text));
}

std::vector<double> numbers(const Value& value, std::size_t count) {
  std::vector<double> x;
  decode(value, x);
  if (x.size() != count) throw DecodeError(fmt::format("it has {} numbers instead of {}", x.size(), count));
  return x;
}

std::array<Vector3d*, 3> vectorsOf(TrialContact& contact) {
  return {&contact.p_O, &contact.normal_O, &contact.force_O};
}

std::string contactText(TrialContact contact) {
  std::string text = fmt::format("{}", contact.finger);
  for (const Vector3d* v : vectorsOf(contact)) text += fmt::format(" {} {} {}", v->x(), v->y(), v->z());
  return fmt::format("{} {}", text, knownLink(contact.link));
}

TrialContact parseContact(std::string_view text) {
  TrialContact contact;
  contact.finger = number<int>(takeFirst(text, ' '));
  if (contact.finger < -1 || contact.finger > 2)
    throw DecodeError(fmt::format("finger {} is none", contact.finger));
  for (Vector3d* v : vectorsOf(contact)) {
    for (double& x : *v) x = number<double>(takeFirst(text, ' '));
  }
  contact.link = knownLink(text);
  return contact;
}

}  // namespace

Value encode(bool x) { return std::int64_t{x}; }
Value encode(int x) { return std::int64_t{x}; }
Value encode(std::int64_t x) { return x; }
Value encode(std::uint64_t x) { return std::bit_cast<std::int64_t>(x); }
Value encode(double x) { return std::isnan(x) ? Value() : Value(x); }
Value encode(const std::string& x) { return x; }
Value encode(GraspSource x) { return std::string(describe(x)); }
Value encode(TrialOutcome x) { return std::string(describe(x)); }
Value encode(const std::vector<double>& x) { return fmt::format("{}", fmt::join(x, " ")); }

Value encode(const Pose& x) {
  std::vector<double> entries;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) entries.push_back(x(row, column));
  }
  return encode(entries);
}

Value encode(const HandJoints& x) {
  return encode(std::vector<double>{x.spread, x.inner[0], x.inner[1], x.inner[2]});
}

Value encode(const std::vector<TrialContact>& x) {
  std::string text;
  for (const TrialContact& contact : x) text += contactText(contact) + ';';
  return text;
}

void decode(const Value& value, bool& x) {
  const std::int64_t i = integer(value);
  if (i != 0 && i != 1) throw DecodeError(fmt::format("{} is neither 0 nor 1", i));
  x = i == 1;
}

void decode(const Value& value, int& x) {
  const std::int64_t i = integer(value);
  if (i != static_cast<int>(i)) throw DecodeError(fmt::format("{} is too large", i));
  x = static_cast<int>(i);
}

void decode(const Value& value, std::int64_t& x) { x = integer(value); }
void decode(const Value& value, std::uint64_t& x) { x = std::bit_cast<std::uint64_t>(integer(value)); }

void decode(const Value& value, double& x) {
  const bool null = std::holds_alternative<std::monostate>(value);
  x = null ? std::numeric_limits<double>::quiet_NaN() : get<double>(value, "a number");
}

void decode(const Value& value, std::string& x) { x = words(value); }

void decode(const Value& value, GraspSource& x) {
  const auto source = parseGraspSource(words(value));
  if (!source) throw DecodeError(fmt::format("{} is no source of grasps", toText(value)));
  x = *source;
}

void decode(const Value& value, TrialOutcome& x) {
  const std::string& name = words(value);
  const auto found = std::ranges::find(kOutcomes, name, [](TrialOutcome o) { return describe(o); });
  if (found == kOutcomes.end()) throw DecodeError(fmt::format("{} is no outcome", toText(value)));
  x = *found;
}

void decode(const Value& value, std::vector<double>& x) {
  x.clear();
  for (std::string_view text = words(value); !text.empty();)
    x.push_back(number<double>(takeFirst(text, ' ')));
}

void decode(const Value& value, Pose& x) {
  const std::vector<double> entries = numbers(value, 12);
  x = Pose::Identity();
  for (int i = 0; i < 12; ++i) x(i / 4, i % 4) = entries[i];
}

void decode(const Value& value, HandJoints& x) {
  const std::vector<double> angles = numbers(value, 4);
  x = {angles[0], {angles[1], angles[2], angles[3]}};
}

void decode(const Value& value, std::vector<TrialContact>& x) {
  x.clear();
  for (std::string_view text = words(value); !text.empty();) x.push_back(parseContact(takeFirst(text, ';')));
}

std::string toText(const Value& value) {
  struct {
    std::string operator()(std::monostate) const { return "nan"; }
    std::string operator()(std::int64_t x) const { return fmt::format("{}", x); }
    std::string operator()(double x) const { return fmt::format("{}", x); }
    std::string operator()(const std::string& x) const { return fmt::format("{:?}", x); }
  } text;
  return std::visit(text, value);
}

}  // namespace boxgrasp
