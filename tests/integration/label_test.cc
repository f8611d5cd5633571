// Labelling as users run it: in pieces, under fire, on a full disk, with bad objects.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "boxgrasp/objects/parametric.h"
#include "boxgrasp/store/experience_store.h"
#include "processes.h"

namespace boxgrasp::test {
namespace {

using testing::HasSubstr;

class Label : public testing::Test {
 protected:
  std::vector<std::string> line(const fs::path& store, int limit = 40,
                                std::vector<std::string> more = {}) const {
    std::vector<std::string> all{BOXGRASP_TRAINER, "label", "--out",        store,
                                 "--scales",       "0.75",  "--last-stage", "close",
                                 "--only",         "mug",   "--limit",      std::to_string(limit)};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  // Seconds of work that remain after planning: time to be killed in.
  std::vector<std::string> slowLine(const fs::path& store) const {
    return {BOXGRASP_TRAINER, "label", "--out",  store, "--scales", "0.75",
            "--last-stage",   "push",  "--only", "mug", "--limit",  "60"};
  }
  static void waitUntilItSays(const Process& process, const std::string& words) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (process.err().find(words) == std::string::npos) {
      ASSERT_LT(std::chrono::steady_clock::now(), end) << "waited for '" << words << "': " << process.err();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  static std::string hashOf(const fs::path& store) {
    return ExperienceStore::openForReading(store).contentHash();
  }
  // What an uninterrupted run on one thread makes.
  static const std::string& wanted() {
    static const std::string hash = [] {
      const TemporaryFolder folder;
      const Finished run_ =
          run({BOXGRASP_TRAINER, "label", "--out", folder / "one.db", "--scales", "0.75", "--limit", "40",
               "--last-stage", "close", "--only", "mug", "--threads", "1"});
      EXPECT_EQ(run_.code, 0) << run_.err;
      return hashOf(folder / "one.db");
    }();
    return hash;
  }
  // A closed mesh as an OFF file, some of it left out.
  void writeMesh(const std::string& name, std::size_t leave_out, double unit = 1.0) {
    const TriangleMesh mesh = parametricObject("heart", 0.75);
    fs::create_directories(folder / "meshes");
    std::ofstream file(folder / "meshes" / name);
    file << "OFF\n" << mesh.vertices.size() << ' ' << mesh.triangles.size() - leave_out << " 0\n";
    for (const Vector3d& v : mesh.vertices)
      file << unit * v.x() << ' ' << unit * v.y() << ' ' << unit * v.z() << '\n';
    for (std::size_t i = leave_out; i < mesh.triangles.size(); ++i)
      file << "3 " << mesh.triangles[i][0] << ' ' << mesh.triangles[i][1] << ' ' << mesh.triangles[i][2]
           << '\n';
  }

  TemporaryFolder folder;
};

TEST_F(Label, SameLabelsOnTwoThreads) {
  ASSERT_EQ(run(line(folder / "two.db", 40, {"--threads", "2"})).code, 0);
  EXPECT_EQ(hashOf(folder / "two.db"), wanted());
}

TEST_F(Label, KilledAtAnyMomentItLosesAndRepeatsNothing) {
  const fs::path store = folder / "killed.db", whole = folder / "whole.db";
  for (const int pause_ms : {0, 200, 500}) {
    Process labeller(slowLine(store));
    waitUntilItSays(labeller, "planning: 1 of 1");
    std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms));
    labeller.signal(SIGKILL);
    EXPECT_EQ(labeller.wait(10), -SIGKILL) << "the kill came too late to try anything";
  }
  ASSERT_EQ(run(slowLine(store), 120).code, 0);
  ASSERT_EQ(run(slowLine(whole), 120).code, 0);
  EXPECT_EQ(hashOf(store), hashOf(whole));
  EXPECT_THAT(run(slowLine(store)).out, HasSubstr("0 labels added")) << "nothing is labelled twice";
}

TEST_F(Label, InterruptedItSaysHowToGoOn) {
  const fs::path store = folder / "interrupted.db";
  Process labeller(slowLine(store));
  waitUntilItSays(labeller, "planning: 1 of 1");
  labeller.signal(SIGINT);
  EXPECT_EQ(labeller.wait(30), 130);
  EXPECT_THAT(labeller.err(), HasSubstr("give the same command again"));
  EXPECT_EQ(run(slowLine(store), 120).code, 0);
}

TEST_F(Label, ShardsMakeTheWhole) {
  const auto both = [&](const std::string& store, std::vector<std::string> more) {
    std::vector<std::string> all{
        BOXGRASP_TRAINER, "label", "--out",        folder / store, "--scales", "0.75", "1",
        "--limit",        "6",     "--last-stage", "close",        "--only",   "heart"};
    all.insert(all.end(), more.begin(), more.end());
    const Finished done = run(all);
    EXPECT_EQ(done.code, 0) << done.err;
  };
  both("whole.db", {});
  both("0.db", {"--shard", "0/2"});
  both("1.db", {"--shard", "1/2"});
  const std::vector<std::string> merge{BOXGRASP_TRAINER, "merge", folder / "merged.db", folder / "1.db",
                                       folder / "0.db"};
  ASSERT_EQ(run(merge).code, 0);
  EXPECT_EQ(hashOf(folder / "merged.db"), hashOf(folder / "whole.db"));
  ASSERT_EQ(run(merge).code, 0);
  EXPECT_EQ(hashOf(folder / "merged.db"), hashOf(folder / "whole.db")) << "merging twice changes nothing";
}

TEST_F(Label, SaysInJsonWhatItDid) {
  std::vector<std::string> labelling = line(folder / "one.db", 6, {"--json"});
  const nlohmann::json labelled = nlohmann::json::parse(run(labelling).out);
  EXPECT_EQ(labelled["schema"], 1);
  EXPECT_EQ(labelled["labels_added"], 6);
  const nlohmann::json merged = nlohmann::json::parse(
      run({BOXGRASP_TRAINER, "merge", folder / "all.db", folder / "one.db", "--json"}).out);
  EXPECT_EQ(merged["labels"], 6);
  EXPECT_EQ(merged["content"], hashOf(folder / "one.db"));
  writeMesh("whole.off", 0);
  writeMesh("open.off", 1);
  const Finished checked =
      run({BOXGRASP_TRAINER, "objects", "check", "--objects", folder / "meshes", "--json"});
  EXPECT_EQ(checked.code, 1) << "one of them is refused";
  const nlohmann::json rows = nlohmann::json::parse(checked.out)["objects"];
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].contains("refused") + rows[1].contains("refused"), 1) << rows.dump();
  const nlohmann::json key =
      nlohmann::json::parse(run({BOXGRASP_TRAINER, "keygen", "--out", folder / "k.key", "--json"}).out);
  EXPECT_EQ(key["public_key"].get<std::string>().size(), 64u);
}

TEST_F(Label, OtherSettingsDoNotMix) {
  ASSERT_EQ(run(line(folder / "x.db", 4)).code, 0);
  const Finished other = run(line(folder / "x.db", 4, {"--seed", "2"}));
  EXPECT_EQ(other.code, 3);
  EXPECT_THAT(other.err, HasSubstr("seed"));
}

TEST_F(Label, EveryKindOfLabelIsMade) {
  const Finished done = run({BOXGRASP_TRAINER, "label",     "--out",           folder / "all.db",
                             "--scales",       "0.75",      "--limit",         "2",
                             "--random",       "2",         "--only",          "heart",
                             "--views",        "1",         "--perturbations", "1",
                             "--protocols",    "--sources", "planner",         "random",
                             "approach"},
                            120);
  ASSERT_EQ(done.code, 0) << done.err;
  const ExperienceStore store = ExperienceStore::openForReading(folder / "all.db");
  ASSERT_EQ(store.models().size(), 2u) << "whole and view0";
  for (const ModelRecord& model : store.models()) {
    for (const GraspSource source : {GraspSource::planner, GraspSource::random, GraspSource::approach}) {
      for (const LabelledHypothesis& one : store.labelled(model.key, source)) {
        EXPECT_EQ(one.labels.size(), 2u) << formatModelKey(model.key) << ' ' << describe(source);
        EXPECT_GE(one.labels[0].gravities_held, 0) << "the protocols";
      }
    }
    EXPECT_EQ(store.labelled(model.key, GraspSource::random).size(), 2u);
  }
}

TEST_F(Label, BadObjectsAreNamedAndLeftOut) {
  writeMesh("good.off", 0);
  writeMesh("open.off", 7);
  writeMesh("millimetres.off", 0, 1000.0);
  std::ofstream(folder / "meshes" / "empty.off").flush();
  std::ofstream(folder / "meshes" / "flat.off")
      << "OFF\n4 4 0\n0 0 0\n0.1 0 0\n0 0.1 0\n0.1 0.1 0\n3 0 1 2\n3 1 0 3\n3 2 1 3\n3 0 2 3\n";
  const Finished done = run({BOXGRASP_TRAINER, "label", "--out", folder / "x.db", "--objects",
                             folder / "meshes", "--scales", "1", "--limit", "4", "--last-stage", "close"});
  EXPECT_EQ(done.code, 1) << done.err;
  for (const char* bad : {"open", "millimetres", "empty", "flat"})
    EXPECT_THAT(done.err, HasSubstr(fmt::format("left out: {}", bad)));
  const auto models = ExperienceStore::openForReading(folder / "x.db").models();
  ASSERT_EQ(models.size(), 1u);
  EXPECT_EQ(models[0].key.object, "good");
}

TEST_F(Label, GoesOnWhenTheDiskHasRoomAgain) {
  const fs::path disk = folder / "disk";
  fs::create_directory(disk);
  const auto size = [&](const char* bytes, unsigned long flags) {
    return mount("tmpfs", disk.c_str(), "tmpfs", flags, fmt::format("size={}", bytes).c_str()) == 0;
  };
  if (!size("90k", 0)) GTEST_SKIP() << "may not mount a small disk here";
  const Finished full = run(line(disk / "x.db"));
  EXPECT_EQ(full.code, 3) << full.err;
  EXPECT_THAT(full.err, HasSubstr("x.db")) << "which file";
  EXPECT_TRUE(size("50m", MS_REMOUNT));
  const Finished again = run(line(disk / "x.db"));
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(hashOf(disk / "x.db"), wanted());
  umount(disk.c_str());
}

}  // namespace
}  // namespace boxgrasp::test
