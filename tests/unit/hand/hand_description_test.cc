#include "boxgrasp/hand/hand_description.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <sstream>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

using ::testing::HasSubstr;
constexpr double kDegree = std::numbers::pi / 180;

const std::string kHands = BOXGRASP_SOURCE_DIR "/deploy/hands/";

std::string textOf(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << "the description no longer contains '" << what << "'";
  return text.replace(at, what.size(), with);
}

// The line of `what` in `text`, counted from 1.
std::size_t lineOf(const std::string& text, const std::string& what) {
  return 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find(what)), '\n');
}

std::string complaint(const std::string& toml) {
  try {
    parseHandDescription(toml, "my.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

TEST(HandDescription, TheBuiltInHandIsTheFile) {
  const HandDescription file = readHandDescription(kHands + "barrett.toml"), &built_in = barrettHand();
  EXPECT_EQ(file.name, built_in.name);
  for (const auto member :
       {&HandDescription::spread_offset,  &HandDescription::base_radius,  &HandDescription::inner_length,
        &HandDescription::tip_length,     &HandDescription::tip_radius,   &HandDescription::joint_height,
        &HandDescription::inner_rest,     &HandDescription::outer_rest,   &HandDescription::coupling,
        &HandDescription::inner_min,      &HandDescription::inner_max,    &HandDescription::outer_max,
        &HandDescription::spread_min,     &HandDescription::spread_max,   &HandDescription::knuckle_radius,
        &HandDescription::inner_radius,   &HandDescription::outer_radius, &HandDescription::palm_radius,
        &HandDescription::palm_thickness, &HandDescription::depth_slope,  &HandDescription::depth_offset,
        &HandDescription::max_tip_force}) {
    EXPECT_TRUE(std::isfinite(built_in.*member));
    EXPECT_EQ(file.*member, built_in.*member);
  }
}

// Definitions 3.1 and 3.2.
TEST(HandDescription, TheRealHandHasThePublishedNumbersInSiUnits) {
  const HandDescription& hand = barrettHand();
  EXPECT_DOUBLE_EQ(hand.spread_offset, 0.025);
  EXPECT_DOUBLE_EQ(hand.base_radius, 0.050);
  EXPECT_DOUBLE_EQ(hand.inner_length, 0.070);
  EXPECT_DOUBLE_EQ(hand.joint_height, -0.0046);
  EXPECT_NEAR(hand.inner_rest + hand.outer_rest, 45 * kDegree, 1e-12)
      << "the outer link at rest over the palm";
  EXPECT_NEAR(hand.tip_length + hand.tip_radius, 0.059, 1e-12);
  EXPECT_DOUBLE_EQ(hand.inner_max, 140 * kDegree);
  EXPECT_DOUBLE_EQ(hand.outer_max, 48 * kDegree);
  EXPECT_DOUBLE_EQ(hand.spread_max, std::numbers::pi);
  EXPECT_DOUBLE_EQ(hand.coupling, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(hand.max_tip_force, 15.0);
}

TEST(HandDescription, TheSimulatorsHandIsReadable) {
  const HandDescription hand = readHandDescription(kHands + "barrett_graspit.toml");
  EXPECT_EQ(hand.tip_radius, 0.0);
  EXPECT_DOUBLE_EQ(hand.tip_length, 0.055);
}

struct Mistake {
  const char* what;
  std::string from, to;
  std::string at;  // text on the line to blame, after the replacement
  std::vector<std::string> mentions;
};

TEST(HandDescription, EveryMistakeIsNamedWithItsPlaceAndARemedy) {
  const std::string good = textOf(kHands + "barrett.toml");
  const std::vector<Mistake> mistakes{
      {"misspelt key",
       "tip_radius_mm = 9.0",
       "tip_radios_mm = 9.0",
       "tip_radios_mm",
       {"finger.tip_radios_mm", "spelling"}},
      {"unknown section", "[depth]", "[debth]", "[debth]", {"unknown key 'debth'"}},
      {"unknown key at the top", "name = ", "colour = \"red\"\nname = ", "colour", {"unknown key 'colour'"}},
      {"missing key", "tip_radius_mm = 9.0", "", "[finger]", {"tip_radius_mm", "missing", "[finger]", "add"}},
      {"text for a number",
       "tip_length_mm = 50.0",
       "tip_length_mm = \"50\"",
       "tip_length_mm = ",
       {"not a number", "quotes"}},
      {"list for a number",
       "tip_length_mm = 50.0",
       "tip_length_mm = [50]",
       "tip_length_mm = ",
       {"not a number"}},
      {"negative length",
       "tip_length_mm = 50.0",
       "tip_length_mm = -50.0",
       "tip_length_mm = ",
       {"-50", "from 0.1"}},
      {"not finite",
       "tip_length_mm = 50.0",
       "tip_length_mm = nan",
       "tip_length_mm = ",
       {"nan", "give a value"}},
      {"infinite",
       "tip_length_mm = 50.0",
       "tip_length_mm = inf",
       "tip_length_mm = ",
       {"inf", "give a value"}},
      {"empty range",
       "inner_max_deg = 140.0",
       "inner_max_deg = 0.0",
       "inner_max_deg = ",
       {"greater than inner_min_deg"}},
      {"empty spread",
       "spread_min_deg = 0.0",
       "spread_min_deg = 180",
       "spread_max_deg = ",
       {"greater than spread_min_deg"}},
      {"links that meet",
       "inner_radius_mm = 10.0",
       "inner_radius_mm = 13.0",
       "spread_offset_mm = ",
       {"meet the thumb"}},
      {"name not a text", "name = \"Barrett BH8\"", "name = 8", "name = 8", {"'name'", "add a line"}},
      {"section as value", "name = ", "depth = 3\nname = ", "depth = 3", {"section", "[depth]"}},
      {"no TOML", "coupling = ", "coupling == ", "coupling == ", {"not a TOML file"}},
  };
  for (const Mistake& mistake : mistakes) {
    std::string text = replaced(good, mistake.from, mistake.to);
    if (std::string(mistake.what) == "section as value") text.erase(text.find("[depth]"));
    const std::string said = complaint(text);
    EXPECT_THAT(said, HasSubstr("my.toml:" + std::to_string(lineOf(text, mistake.at)) + ":")) << mistake.what;
    for (const auto& mention : mistake.mentions) EXPECT_THAT(said, HasSubstr(mention)) << mistake.what;
  }
}

TEST(HandDescription, AMissingSectionOrNameIsNamed) {
  const std::string good = textOf(kHands + "barrett.toml");
  EXPECT_THAT(complaint(good.substr(0, good.find("[depth]"))),
              HasSubstr("'slope' is missing from section [depth]"));
  EXPECT_THAT(complaint(replaced(good, "name = \"Barrett BH8\"", "")), HasSubstr("'name' is missing"));
  EXPECT_THAT(complaint(""), HasSubstr("'name' is missing"));
}

TEST(HandDescription, AMissingFileIsNamed) {
  for (const char* path : {"/no/such/hand.toml", "/"}) {
    try {
      readHandDescription(path);
      ADD_FAILURE() << path << " was read";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(path));
    }
  }
}

// Integers are numbers too.
TEST(HandDescription, WholeNumbersAreFine) {
  const std::string text =
      replaced(textOf(kHands + "barrett.toml"), "tip_length_mm = 50.0", "tip_length_mm = 50");
  EXPECT_EQ(parseHandDescription(text, "my.toml").tip_length, barrettHand().tip_length);
}

}  // namespace
}  // namespace boxgrasp
