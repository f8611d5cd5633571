#include "boxgrasp/registry/model_registry.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "boxgrasp/base/durable_file.h"

namespace boxgrasp {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ModelRegistryFolder : public testing::Test {
 protected:
  ModelRegistryFolder()
      : folder(fs::temp_directory_path() / ("boxgrasp-registry-" + std::to_string(getpid()))) {
    fs::remove_all(folder);
  }
  ~ModelRegistryFolder() override { fs::remove_all(folder); }

  RegistryState twoModels() const {
    RegistryState state;
    state.models.push_back({"0badc0de", "2026-01-31T00:00:00Z", 1, {}, ModelState::proven, 0, ""});
    state.models.push_back(
        {"c0ffee00", "2026-02-01T00:00:00Z", 2, {}, ModelState::rejected, 2, "it crashed"});
    return state;
  }
  std::string text() const { return readWhole(folder / "registry.json", 1 << 20); }
  // Writes the state of two models, with one piece of its text exchanged for another.
  void writeWith(const std::string& piece, const std::string& other) const {
    ModelRegistry(folder).commit(twoModels());
    std::string content = text();
    const std::size_t at = content.find(piece);
    ASSERT_NE(at, std::string::npos) << content;
    std::ofstream(folder / "registry.json") << content.replace(at, piece.size(), other);
  }

  fs::path folder;
};

TEST_F(ModelRegistryFolder, HoldsItsStateOverRestarts) {
  RegistryState state = twoModels();
  state.pinned = "0badc0de";
  state.last_order = 7;
  state.last_order_id = "order";
  ModelRegistry(folder).commit(state);
  const ModelRegistry again(folder);
  EXPECT_EQ(again.trouble(), "");
  ASSERT_EQ(again.state().models.size(), 2u);
  EXPECT_EQ(again.state().models[1].reason, "it crashed");
  EXPECT_EQ(again.state().models[1].state, ModelState::rejected);
  EXPECT_EQ(again.state().pinned, "0badc0de");
  EXPECT_EQ(again.state().last_order, 7);
  EXPECT_EQ(again.state().last_order_id, "order");
}

TEST_F(ModelRegistryFolder, AVersionThatLeadsOutOfTheFolderIsDamage) {
  writeWith("0badc0de", "../../../etc/passwd");
  const ModelRegistry registry(folder);
  EXPECT_THAT(registry.trouble(), HasSubstr("version"));
  EXPECT_TRUE(registry.state().models.empty());
  EXPECT_TRUE(fs::exists(folder / "registry.json.damaged"));
}

TEST_F(ModelRegistryFolder, APinOfNoModelIsDamage) {
  writeWith("\"pinned\": \"\"", "\"pinned\": \"deadbeef\"");
  const ModelRegistry registry(folder);
  EXPECT_THAT(registry.trouble(), HasSubstr("'deadbeef' is pinned, but is none of its models"));
  EXPECT_EQ(registry.state().chosen(), "");
}

TEST_F(ModelRegistryFolder, ANumberThatDoesNotFitIsDamage) {
  struct Case {
    std::string key, value, other;
  };
  for (const auto& [key, value, other] :
       {Case{"accepted", "1", "277988833338888888883333333333"},
        Case{"accepted", "1", "18446744073709551615"}, Case{"accepted", "1", "1.5"},
        Case{"unclean_ends", "0", "4294967297"}, Case{"unclean_ends", "0", "\"2\""},
        Case{"last_order", "0", "-1e30"}}) {
    const std::string place = "\"" + key + "\": ";
    writeWith(place + value, place + other);
    const ModelRegistry registry(folder);
    EXPECT_THAT(registry.trouble(), HasSubstr("'" + key + "' is ")) << other;
    EXPECT_THAT(registry.trouble(), HasSubstr("must be a whole number")) << other;
    EXPECT_TRUE(registry.state().models.empty()) << other;
  }
}

TEST_F(ModelRegistryFolder, TheNewestThatIsNotRejectedIsChosenUnlessOneIsPinned) {
  RegistryState state = twoModels();
  EXPECT_EQ(state.chosen(), "0badc0de");
  state.find("c0ffee00")->state = ModelState::waiting;
  EXPECT_EQ(state.chosen(), "c0ffee00");
  state.pinned = "0badc0de";
  EXPECT_EQ(state.chosen(), "0badc0de");
  state.reject("0badc0de", "slow");
  EXPECT_EQ(state.chosen(), "c0ffee00");
}

}  // namespace
}  // namespace boxgrasp
