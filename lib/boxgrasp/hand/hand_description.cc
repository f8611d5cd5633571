#include "boxgrasp/hand/hand_description.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <fstream>
#include <numbers>
#include <span>
#include <sstream>

#include "boxgrasp/base/error.h"
#include "boxgrasp/hand/barrett_toml.h"

namespace boxgrasp {
namespace {

constexpr double kMillimetre = 1e-3;
constexpr double kDegree = std::numbers::pi / 180.0;

// One key of the file: where it stands, how its unit converts to SI, and the values that a hand can have.
struct Field {
  std::string_view section, key;
  double HandDescription::*member;
  double unit;
  double min, max;  // in the file's unit
};
using Fields = std::span<const Field>;

constexpr Field kRevolute[] = {
    {"palm", "spread_offset_mm", &HandDescription::spread_offset, kMillimetre, 0.1, 1000},
    {"palm", "base_radius_mm", &HandDescription::base_radius, kMillimetre, 0, 1000},
    {"palm", "joint_height_mm", &HandDescription::joint_height, kMillimetre, -1000, 1000},
    {"palm", "radius_mm", &HandDescription::palm_radius, kMillimetre, 0.1, 1000},
    {"palm", "thickness_mm", &HandDescription::palm_thickness, kMillimetre, 0.1, 1000},
    {"finger", "inner_length_mm", &HandDescription::inner_length, kMillimetre, 0.1, 1000},
    {"finger", "inner_rest_deg", &HandDescription::inner_rest, kDegree, 0, 90},
    {"finger", "outer_rest_deg", &HandDescription::outer_rest, kDegree, 0.01, 90},
    {"finger", "tip_length_mm", &HandDescription::tip_length, kMillimetre, 0.1, 1000},
    {"finger", "tip_radius_mm", &HandDescription::tip_radius, kMillimetre, 0, 100},
    {"finger", "coupling", &HandDescription::coupling, 1.0, 0, 1},
    {"links", "knuckle_radius_mm", &HandDescription::knuckle_radius, kMillimetre, 0.1, 100},
    {"links", "inner_radius_mm", &HandDescription::inner_radius, kMillimetre, 0.1, 100},
    {"links", "outer_radius_mm", &HandDescription::outer_radius, kMillimetre, 0.1, 100},
    {"limits", "inner_min_deg", &HandDescription::inner_min, kDegree, 0, 180},
    {"limits", "inner_max_deg", &HandDescription::inner_max, kDegree, 0, 180},
    {"limits", "outer_max_deg", &HandDescription::outer_max, kDegree, 0, 180},
    {"limits", "spread_min_deg", &HandDescription::spread_min, kDegree, 0, 180},
    {"limits", "spread_max_deg", &HandDescription::spread_max, kDegree, 0, 180},
    {"limits", "max_tip_force_n", &HandDescription::max_tip_force, 1.0, 0.01, 10000},
    {"depth", "slope", &HandDescription::depth_slope, 1.0, -100, 100},
    {"depth", "offset_mm", &HandDescription::depth_offset, kMillimetre, -1000, 1000},
};
constexpr Field kPrismatic[] = {
    {"palm", "radius_mm", &HandDescription::palm_radius, kMillimetre, 0.1, 1000},
    {"palm", "thickness_mm", &HandDescription::palm_thickness, kMillimetre, 0.1, 1000},
    {"jaw", "half_opening_mm", &HandDescription::base_radius, kMillimetre, 0.1, 1000},
    {"jaw", "virtual_offset_mm", &HandDescription::spread_offset, kMillimetre, 0.1, 1000},
    {"jaw", "foot_height_mm", &HandDescription::joint_height, kMillimetre, -1000, 1000},
    {"jaw", "stem_length_mm", &HandDescription::inner_length, kMillimetre, 0.1, 1000},
    {"jaw", "stem_radius_mm", &HandDescription::inner_radius, kMillimetre, 0.1, 100},
    {"jaw", "pad_length_mm", &HandDescription::tip_length, kMillimetre, 0.1, 1000},
    {"jaw", "pad_radius_mm", &HandDescription::tip_radius, kMillimetre, 0.1, 100},
    {"motor", "slide_mm_per_rad", &HandDescription::slide_per_rad, kMillimetre, 0.1, 1000},
    {"motor", "max_deg", &HandDescription::inner_max, kDegree, 0.1, 100000},
    {"motor", "max_force_n", &HandDescription::max_tip_force, 1.0, 0.01, 10000},
};
constexpr std::string_view kNameKey = "name", kFingersKey = "fingers";
constexpr std::string_view kRevoluteWord = "revolute", kPrismaticWord = "prismatic";

// A jaw has neither spread nor a second joint, its rail is as thick as its stem, and its tip is always as
// high.
void fillJaws(HandDescription& hand) {
  hand.knuckle_radius = hand.inner_radius;
  hand.outer_radius = hand.tip_radius;
  for (const auto member :
       {&HandDescription::inner_rest, &HandDescription::outer_rest, &HandDescription::coupling,
        &HandDescription::inner_min, &HandDescription::outer_max, &HandDescription::spread_min,
        &HandDescription::spread_max, &HandDescription::depth_slope})
    hand.*member = 0.0;
  hand.depth_offset = hand.joint_height + hand.inner_length + hand.tip_length;
}

// Reads one file; every complaint says where.
class Reader {
 public:
  Reader(const std::string& text, const std::string& file)
      : file_(file),
        root_(parse(text)),
        joint_(readJoint()),
        fields_(joint_ == FingerJoint::prismatic ? Fields(kPrismatic) : Fields(kRevolute)) {}

  HandDescription read() const {
    refuseUnknown();
    HandDescription hand;
    hand.name = readName();
    hand.joint = joint_;
    for (const Field& field : fields_) hand.*field.member = readNumber(field);
    if (hand.prismatic()) {
      fillJaws(hand);
      checkJaws(hand);
    } else {
      checkTogether(hand);
    }
    return hand;
  }

 private:
  [[noreturn]] void fail(const toml::source_region& at, const std::string& what) const {
    throw InputError(fmt::format("{}:{}:{}: {}", file_, at.begin.line, at.begin.column, what));
  }

  toml::table parse(const std::string& text) const try {
    return toml::parse(text, file_);
  } catch (const toml::parse_error& error) {
    fail(error.source(), fmt::format("not a TOML file: {}; mend the syntax here", error.description()));
  }

  bool isSection(std::string_view name) const {
    return std::ranges::any_of(fields_, [&](const Field& f) { return f.section == name; });
  }
  bool isKey(std::string_view section, std::string_view key) const {
    return std::ranges::any_of(fields_, [&](const Field& f) { return f.section == section && f.key == key; });
  }

  void refuseUnknown() const {
    for (const auto& [key, node] : root_) {
      if (key == kNameKey || key == kFingersKey) continue;
      if (!isSection(key.str())) failUnknown(key, std::string(key.str()));
      if (!node.is_table())
        fail(node.source(), fmt::format("'{0}' is a value, but must be a section; write [{0}]", key.str()));
      for (const auto& entry : *node.as_table()) {
        if (!isKey(key.str(), entry.first.str()))
          failUnknown(entry.first, fmt::format("{}.{}", key.str(), entry.first.str()));
      }
    }
  }
  [[noreturn]] void failUnknown(const toml::key& key, const std::string& path) const {
    fail(key.source(), fmt::format("unknown key '{}'; remove it or correct its spelling "
                                   "({} explains all keys)",
                                   path,
                                   joint_ == FingerJoint::prismatic ? "deploy/hands/parallel_gripper.toml"
                                                                    : "deploy/hands/barrett.toml"));
  }

  FingerJoint readJoint() const {
    const toml::node* node = root_[kFingersKey].node();
    const std::string word = node ? node->value_or(std::string()) : std::string(kRevoluteWord);
    if (word == kPrismaticWord) return FingerJoint::prismatic;
    if (word == kRevoluteWord) return FingerJoint::revolute;
    fail(node->source(),
         fmt::format("key '{}' must be \"{}\" (fingers that turn; the default) or \"{}\" (jaws)", kFingersKey,
                     kRevoluteWord, kPrismaticWord));
  }

  std::string readName() const {
    const auto* name = root_.get_as<std::string>(kNameKey);
    if (!name || name->get().empty())
      fail(root_[kNameKey].node() ? root_[kNameKey].node()->source() : root_.source(),
           "key 'name' is missing or not a text; add a line such as name = \"my hand\"");
    return name->get();
  }

  const toml::node* find(const Field& field) const { return root_[field.section][field.key].node(); }

  double readNumber(const Field& field) const {
    const toml::node* node = find(field);
    if (!node) {
      const toml::node* section = root_[field.section].node();
      fail(section ? section->source() : root_.source(),
           fmt::format("key '{1}' is missing from section [{0}]; add a line {1} = <number>", field.section,
                       field.key));
    }
    const auto value = node->is_number() ? node->value<double>() : std::nullopt;
    if (!value)
      fail(node->source(), fmt::format("key '{}.{}' is not a number; write it without quotes, as 12.5",
                                       field.section, field.key));
    if (!(*value >= field.min && *value <= field.max))
      fail(node->source(), fmt::format("key '{}.{}' is {}; give a value from {} to {}", field.section,
                                       field.key, *value, field.min, field.max));
    return *value * field.unit;
  }

  // What no single value shows.
  void checkTogether(const HandDescription& hand) const {
    require(hand.inner_min < hand.inner_max, "limits", "inner_max_deg", "must be greater than inner_min_deg");
    require(hand.spread_min < hand.spread_max, "limits", "spread_max_deg",
            "must be greater than spread_min_deg");
    // The thumb moves in the plane x = 0, the fingers stay beyond x = +-spread_offset: thin enough links
    // never meet.
    require(2 * std::max({hand.inner_radius, hand.outer_radius, hand.tip_radius}) <= hand.spread_offset,
            "palm", "spread_offset_mm",
            "must be at least twice the radius of the links and the tip, or the fingers meet the thumb");
  }
  void checkJaws(const HandDescription& hand) const {
    require(hand.slide_per_rad * hand.inner_max <= hand.base_radius, "motor", "max_deg",
            "must slide the jaws by at most half_opening_mm, or they meet before");
    require(hand.inner_radius <= hand.tip_radius, "jaw", "stem_radius_mm",
            "must be at most pad_radius_mm, or the stem touches before the pad");
  }
  void require(bool holds, std::string_view section, std::string_view key, std::string_view what) const {
    if (!holds) fail(root_[section][key].node()->source(), fmt::format("key '{}.{}' {}", section, key, what));
  }

  std::string file_;
  toml::table root_;
  FingerJoint joint_;
  Fields fields_;
};

}  // namespace

HandDescription readHandDescription(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf()))
    throw InputError(
        fmt::format("hand description '{}' cannot be read; check the path and that it is a file "
                    "with content",
                    file.string()));
  return parseHandDescription(text.str(), file.string());
}

HandDescription parseHandDescription(const std::string& toml, const std::string& name_for_errors) {
  return Reader(toml, name_for_errors).read();
}

HandDescription handOrBarrett(const std::optional<std::filesystem::path>& file) {
  return file ? readHandDescription(*file) : barrettHand();
}

const HandDescription& barrettHand() {
  static const HandDescription hand = parseHandDescription(kBarrettToml, "barrett.toml");
  return hand;
}

}  // namespace boxgrasp
