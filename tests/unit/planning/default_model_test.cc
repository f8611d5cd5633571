#include "boxgrasp/planning/default_model.h"

#include <gtest/gtest.h>

#include "boxgrasp/planning/features.h"

namespace boxgrasp {
namespace {

TEST(DefaultModel, EachKindOfHandHasItsOwn) {
  const HandDescription gripper =
      readHandDescription(BOXGRASP_SOURCE_DIR "/deploy/hands/parallel_gripper.toml");
  const Model fingers = modelOrDefault({}), jaws = modelOrDefault({}, gripper);
  EXPECT_EQ(fingers.version, readModel(BOXGRASP_SOURCE_DIR "/deploy/models/default.json").version);
  EXPECT_EQ(jaws.version, readModel(BOXGRASP_SOURCE_DIR "/deploy/models/parallel_gripper.json").version);
  for (const Model& model : {fingers, jaws}) {
    EXPECT_NO_THROW(checkFeatures(model.features));
    EXPECT_NO_THROW(model.ensemble.validate());
  }
}

}  // namespace
}  // namespace boxgrasp
