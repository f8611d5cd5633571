// Configuration files: every option is reachable, every mistake is named with its place.
#include "boxgrasp/planning/planner_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

const std::filesystem::path kShipped =
    std::filesystem::path(BOXGRASP_SOURCE_DIR) / "deploy" / "boxgrasp.toml";

PlannerOptions parsed(const std::string& text) {
  ConfigFile file(text, "my.toml");
  const PlannerOptions options = readPlannerOptions(file);
  file.finish();
  return options;
}

std::string problemOf(const std::string& text) {
  try {
    parsed(text);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(PlannerConfig, ShippedFileHasEveryKeyWithItsDefault) {
  ConfigFile file(kShipped);
  readPlannerOptions(file);
  EXPECT_THAT(file.absent(), IsEmpty()) << "deploy/boxgrasp.toml does not explain these options";
  EXPECT_THAT(file.changed(), IsEmpty())
      << "deploy/boxgrasp.toml does not have the defaults of these options";
  EXPECT_NO_THROW(readPlannerOptions(kShipped))
      << "[server] is another program's, but all else must be known";
}

TEST(PlannerConfig, AnEmptyFileKeepsTheDefaults) {
  ConfigFile file("", "my.toml");
  readPlannerOptions(file);
  EXPECT_NO_THROW(file.finish());
  EXPECT_THAT(file.changed(), IsEmpty());
}

// One key of every type, through to the options.
TEST(PlannerConfig, ReadsEveryType) {
  const PlannerOptions options = parsed(R"(
    [scene]
    whole = true
    min_cluster_points = 99
    [decomposition]
    gain_t = 1
    split = "bound"
    gain = "local"
    max_leaves = 8
    [clearance]
    openings_rad = [0, 0.1, 0.2, 0.3]
    [robot]
    answer_frame = "robot"
    approach = [1, 0.5, 0]
    workspace_max_m = [1.0, 2.0, inf]
    forbidden_m = [[0, 0, 0, 1, 1, 1], [2, 2, 2, 3, 3, inf]]
    [planner]
    depth_model = "linear"
  )");
  EXPECT_TRUE(options.scene.whole);
  EXPECT_EQ(options.scene.min_cluster_points, 99u);
  EXPECT_EQ(options.decomposition.gain_t, 1.0);
  EXPECT_EQ(options.decomposition.split, SplitRule::bound);
  EXPECT_EQ(options.decomposition.gain, GainMeasure::local);
  EXPECT_EQ(options.decomposition.max_leaves, 8);
  EXPECT_THAT(options.clearance.openings_rad, ElementsAre(0, 0.1, 0.2, 0.3));
  EXPECT_EQ(options.robot.answer_frame, AnswerFrame::robot);
  EXPECT_THAT(options.robot.approach, ElementsAre(1, 0.5, 0));
  EXPECT_THAT(options.robot.workspace_max_m, ElementsAre(1, 2, RobotOptions::kUnbounded));
  ASSERT_EQ(options.robot.forbidden_m.size(), 2u);
  EXPECT_THAT(options.robot.forbidden_m[1], ElementsAre(2, 2, 2, 3, 3, RobotOptions::kUnbounded));
  EXPECT_EQ(options.depth_model, DepthModel::linear);
}

TEST(PlannerConfig, TellsWhichKeysChangeSomething) {
  ConfigFile file("[scene]\nwhole = true\nseed = 1\n[planner]\nthreads = 3\n", "my.toml");
  readPlannerOptions(file);
  EXPECT_THAT(file.changed(), ElementsAre("scene.whole", "planner.threads"));
}

TEST(PlannerConfig, NamesUnknownKeysWithTheirPlaceAndTheNearestName) {
  EXPECT_EQ(problemOf("[clean]\nvoxel_m = 0.002\nvoxl_m = 0.001\n"),
            "my.toml:3:1: unknown key 'voxl_m' in section [clean]; did you mean 'voxel_m'?");
  EXPECT_EQ(problemOf("\n[secne]\nwhole = true\n"),
            "my.toml:2:2: unknown section [secne]; did you mean 'scene'?");
  EXPECT_EQ(problemOf("[scene]\nfriction_of_everything = 1\n"),
            "my.toml:2:1: unknown key 'friction_of_everything' in section [scene]");
  EXPECT_THAT(problemOf("whole = true\n"),
              StartsWith("my.toml:1:1: unknown key 'whole' outside of any section"));
}

TEST(PlannerConfig, NamesWrongTypesAndValuesWithTheirPlace) {
  EXPECT_EQ(problemOf("[scene]\nwhole = 1\n"), "my.toml:2:9: 'whole' must be true or false");
  EXPECT_EQ(problemOf("[scene]\nseed = -4\n"), "my.toml:2:8: 'seed' is -4, but must be at least 0");
  EXPECT_EQ(problemOf("[clean]\nvoxel_m = \"1 mm\"\n"), "my.toml:2:11: 'voxel_m' must be a number");
  EXPECT_EQ(problemOf("[image]\nborder_px = 1.5\n"), "my.toml:2:13: 'border_px' must be a whole number");
  EXPECT_EQ(problemOf("[image]\nborder_px = 9000000000\n"),
            "my.toml:2:13: 'border_px' is 9000000000, which is out of range");
  EXPECT_EQ(problemOf("[decomposition]\nsplit = \"hul\"\n"),
            "my.toml:2:9: 'split' is \"hul\", but must be one of \"hull\", \"bound\", \"robust\"");
  EXPECT_THAT(problemOf("[clearance]\nopenings_rad = [1, 2]\n"), HasSubstr("must be a list of 4 numbers"));
  EXPECT_EQ(problemOf("scene = 3\n"), "my.toml:1:9: 'scene' must be a section; write [scene]");
}

TEST(PlannerConfig, NamesImpossibleValuesWithTheirSection) {
  EXPECT_THAT(problemOf("[planner]\nmerge_distance_m = -1\n"),
              AllOf(StartsWith("my.toml:1:1: [planner]: "), HasSubstr("'merge_distance_m' is -1")));
}

TEST(PlannerConfig, NamesBrokenSyntax) {
  EXPECT_THAT(problemOf("[scene\nwhole = true\n"), StartsWith("my.toml:1:"));
}

TEST(PlannerConfig, RefusesFilesThatCannotBeRead) {
  EXPECT_THROW(readPlannerOptions("/nonexistent/boxgrasp.toml"), InputError);
  EXPECT_THROW(readPlannerOptions("/tmp"), InputError) << "a directory is no file";
}

}  // namespace
}  // namespace boxgrasp
