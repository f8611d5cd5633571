// The trainer's commands as users run them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "boxgrasp/base/exit_code.h"
#include "processes.h"

namespace boxgrasp::test {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

const fs::path kOracle = BOXGRASP_SOURCE_DIR "/../shared/oracle/gws_cases.json";

class Quality : public ::testing::Test {
 protected:
  Finished quality(const std::string& contacts, std::vector<std::string> options = {}) {
    std::ofstream(folder_ / "contacts.json") << contacts;
    options.insert(options.begin(), {BOXGRASP_TRAINER, "quality", folder_ / "contacts.json"});
    return run(options);
  }
  json values(const json& contacts, std::vector<std::string> options = {}) {
    options.push_back("--json");
    const Finished finished = quality(contacts.dump(), options);
    EXPECT_EQ(finished.code, kDone) << finished.err;
    const json report = json::parse(finished.out);
    EXPECT_EQ(report["schema"], 1);
    return report["cases"];
  }
  // That the program refuses the contacts, and says so.
  void expectRefused(const std::string& contacts, const ::testing::Matcher<std::string>& message) {
    const Finished finished = quality(contacts);
    EXPECT_EQ(finished.code, kBadInput) << contacts;
    EXPECT_THAT(finished.err, message);
  }

 private:
  TemporaryFolder folder_;
};

void expectEqual(const json& got, const json& expected) {
  SCOPED_TRACE(expected["name"].get<std::string>());
  const double nu = expected["volume"], epsilon = expected["epsilon"];
  EXPECT_NEAR(got["nu"].get<double>(), nu, 1e-6 * nu);
  if (expected["borderline"]) return;
  EXPECT_EQ(got["force_closure"], expected["force_closure"]);
  EXPECT_NEAR(got["epsilon"].get<double>(), epsilon, 1e-6 * std::abs(epsilon));
}

TEST_F(Quality, OfEveryReferenceCaseIsThatOfACertifiedHull) {
  if (!fs::exists(kOracle)) GTEST_SKIP() << "no reference values at " << kOracle;
  const json oracle = json::parse(std::ifstream(kOracle));
  const json got = values(oracle);
  ASSERT_EQ(got.size(), oracle["cases"].size());
  for (std::size_t i = 0; i < got.size(); ++i) expectEqual(got[i], oracle["cases"][i]);
  expectEqual(values(oracle["cases"]).at(7), oracle["cases"][7]);
  expectEqual(values(oracle["cases"][7]).at(0), oracle["cases"][7]);
}

json contact(std::vector<double> position_mm, std::vector<double> normal) {
  return {{"position_mm", position_mm}, {"inward_normal", normal}};
}

// Three fingers around a ball.
const json kThree{contact({50, 0, 0}, {-1, 0, 0}), contact({-25, 43.30127, 0}, {0.5, -0.8660254, 0}),
                  contact({-25, -43.30127, 0}, {0.5, 0.8660254, 0})};

TEST_F(Quality, OfABareListOfContactsTakesTheScaleFromThem) {
  const json bare = values(kThree).at(0);
  EXPECT_TRUE(bare["force_closure"]);
  EXPECT_NEAR(bare["torque_scale_mm"].get<double>(), 50, 1e-4);
  const json whole =
      values({{"contacts", kThree}, {"torque_scale_mm", 50}, {"mu", 0.4}, {"cone_edges", 8}}).at(0);
  EXPECT_NEAR(bare["epsilon"].get<double>(), whole["epsilon"].get<double>(), 1e-6);
}

TEST_F(Quality, FollowsTheOptions) {
  const double l1 = values(kThree).at(0)["epsilon"];
  EXPECT_GT(values(kThree, {"--norm", "linf"}).at(0)["epsilon"], l1)
      << "three forces of 1 instead of a sum of 1";
  EXPECT_GT(values(kThree, {"--friction", "1"}).at(0)["epsilon"], l1);
  EXPECT_GT(values(kThree, {"--edges", "16"}).at(0)["nu"], values(kThree).at(0)["nu"])
      << "inscribed cones grow";
  EXPECT_FALSE(values(kThree, {"--friction", "0"}).at(0)["force_closure"]);
}

TEST_F(Quality, RefusesBadInputByPlaceAndValue) {
  expectRefused("[{\"position_mm\": [0, 0, 0], ", AllOf(HasSubstr("no JSON"), HasSubstr("line 1")));
  expectRefused("7", AllOf(HasSubstr("7"), HasSubstr("list of contacts")));
  expectRefused("[]", AllOf(HasSubstr("file is []"), HasSubstr("list of contacts")));
  expectRefused("{}", HasSubstr("no \"contacts\""));
  expectRefused("{\"contacts\": 3}", AllOf(HasSubstr("file.contacts is 3"), HasSubstr("list")));
  expectRefused("{\"contacts\": [], \"friction\": 1}", AllOf(HasSubstr("\"friction\""), HasSubstr("mu")));
  expectRefused("[{\"contacts\": []}, {\"contacts\": [], \"cone_edges\": 2.5}]",
                HasSubstr("file[1].cone_edges is 2.5"));
  json bad = kThree;
  bad[1]["inward_normal"] = {1, 1, 0};
  expectRefused(bad.dump(), AllOf(HasSubstr("file[1].inward_normal is [1,1,0]"), HasSubstr("length 1")));
  bad = kThree;
  bad[2]["position_mm"] = {1, "two", 3};
  expectRefused(bad.dump(), AllOf(HasSubstr("file[2].position_mm"), HasSubstr("three numbers")));
  bad = kThree;
  bad[0].erase("inward_normal");
  expectRefused(bad.dump(), HasSubstr("file[0] has no \"inward_normal\""));
  expectRefused("{\"contacts\": [], \"torque_scale_mm\": 0}", HasSubstr("torque_scale_mm is 0"));
  expectRefused(std::string(200'000, '['), HasSubstr("no JSON"));
}

TEST_F(Quality, RefusesBadOptions) {
  EXPECT_THAT(quality(kThree.dump(), {"--norm", "l2"}).err, HasSubstr("l2"));
  EXPECT_THAT(quality(kThree.dump(), {"--edges", "2"}).err, HasSubstr("cone_edges"));
  EXPECT_THAT(run({BOXGRASP_TRAINER, "quality", "/no/such.json"}).err, HasSubstr("/no/such.json"));
}

Finished trainer(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), BOXGRASP_TRAINER);
  return run(arguments, 120.0);
}

TEST(Show, DrawsAGraspOfAnObjectThatIsPlannedAnew) {
  const TemporaryFolder folder;
  const Finished shown = trainer({"show", "mug@1.00/whole/random/3", "--out", folder / "film.png"});
  ASSERT_EQ(shown.code, kDone) << shown.err;
  EXPECT_THAT(shown.out, AllOf(HasSubstr("mug@1.00/whole/random/3"), HasSubstr("planned anew")));
  EXPECT_GT(fs::file_size(folder / "film.png"), 10'000u);
}

TEST(Show, RefusesGraspsThatAreNotThereByName) {
  const auto refusal = [](const std::string& grasp) {
    const Finished finished = trainer({"show", grasp, "--out", "/tmp/never.png"});
    EXPECT_EQ(finished.code, kBadInput) << grasp;
    return finished.err;
  };
  EXPECT_THAT(refusal("mug"), HasSubstr("mug@1.00/whole/planner/17"));
  EXPECT_THAT(refusal("elk@1.00/whole/planner/1"), HasSubstr("no object 'elk' in 'builtin'"));
  EXPECT_THAT(refusal("mug@1.00/whole/planner/99999"), HasSubstr("no grasp mug@1.00/whole/planner/99999"));
  EXPECT_THAT(refusal("mug@1.00/camera-1/planner/1"), HasSubstr("--store"));
}

TEST(Sample, SaysWhatItWrote) {
  const TemporaryFolder folder;
  const Finished sample =
      trainer({"sample", "mug", "--points", "500", "--out", folder / "mug.pcd", "--json"});
  ASSERT_EQ(sample.code, kDone) << sample.err;
  const json report = json::parse(sample.out);
  EXPECT_EQ(report["schema"], 1);
  EXPECT_EQ(report["points"], 500);
  EXPECT_TRUE(fs::exists(report["file"].get<std::string>()));
  const json names = json::parse(trainer({"sample", "--list", "--json"}).out);
  EXPECT_EQ(names["schema"], 1);
  EXPECT_THAT(names["objects"], testing::Contains("mug"));
}

TEST(Spread, TellsWhereTheHypothesesStandTheSameOnAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const auto spread = [&](const std::string& threads) {
    const Finished finished = trainer({"spread", "--object", "cup", "--random", "20", "--json", "--threads",
                                       threads, "--out", folder / "spread.svg"});
    EXPECT_EQ(finished.code, kDone) << finished.err;
    std::ifstream plot(folder / "spread.svg");
    return finished.out + std::string(std::istreambuf_iterator<char>(plot), {});
  };
  const std::string one = spread("1");
  EXPECT_EQ(one, spread("2"));
  EXPECT_THAT(one, AllOf(HasSubstr("\"schema\": 1"), HasSubstr("percentile_epsilon"), HasSubstr("</svg>")));
}

TEST(Spread, CtrlCStopsItAndNothingIsWritten) {
  const TemporaryFolder folder;
  Process process({BOXGRASP_TRAINER, "spread", "--random", "500", "--out", folder / "spread.svg"});
  while (process.running() && process.err().find("closing: ") == std::string::npos) usleep(50'000);
  process.signal(SIGINT);
  EXPECT_EQ(process.wait(30.0), kInterrupted);
  EXPECT_THAT(process.err(), HasSubstr("stopped"));
  EXPECT_FALSE(fs::exists(folder / "spread.svg"));
}

// A mesh of a wooden block of 180 g.
std::string smallBlock(const TemporaryFolder& folder) {
  std::ofstream(folder / "box.off")
      << "OFF\n8 12 0\n0 0 0\n.06 0 0\n.06 .05 0\n0 .05 0\n0 0 .12\n.06 0 .12\n.06 .05 .12\n0 .05 .12\n"
         "3 0 2 1\n3 0 3 2\n3 4 5 6\n3 4 6 7\n3 0 1 5\n3 0 5 4\n3 1 2 6\n3 1 6 5\n3 2 3 7\n3 2 7 6\n"
         "3 3 0 4\n3 3 4 7\n";
  return folder / "box.off";
}

TEST(Rates, LeavesOutWhatCannotBeSimulatedAndCountsTheRest) {
  const TemporaryFolder folder;
  std::ofstream(folder / "open.off") << "OFF\n3 1 0\n0 0 0\n0.1 0 0\n0 0.1 0\n3 0 1 2\n";
  smallBlock(folder);
  const Finished rates =
      trainer({"rates", "--objects", folder / "", "--random", "5", "--limit", "10", "--json"});
  ASSERT_EQ(rates.code, kDone) << rates.err;
  EXPECT_THAT(rates.err, AllOf(HasSubstr("left out"), HasSubstr("open.off")));
  const json report = json::parse(rates.out);
  ASSERT_EQ(report["objects"].size(), 1u);
  const json box = report["objects"][0];
  EXPECT_EQ(box["object"], "box");
  EXPECT_EQ(box["hypotheses"]["of"], 10);
  EXPECT_EQ(box["random"]["of"], 5);
  EXPECT_EQ(box["first"]["of"], 1);
  EXPECT_EQ(report["all"]["hypotheses"], box["hypotheses"]);
  EXPECT_GE(box["hypotheses"]["held"], 8) << "a wooden block of 180 g";
}

TEST(Rates, CountPlansOfEachSightAndSeedAndSayHowTheyEnded) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "meshes");
  fs::copy(smallBlock(folder), folder / "meshes/block.off");
  const Finished rates = trainer({"rates", "--objects", folder / "meshes", "--seen", "view", "--views", "2",
                                  "--seeds", "3", "--protocol", "lift", "--answers-only", "--json"});
  ASSERT_EQ(rates.code, kDone) << rates.err;
  const json report = json::parse(rates.out), first = report["all"]["first"];
  EXPECT_EQ(report["schema"], 1);
  EXPECT_EQ(first["of"], 6) << "two cameras, three seeds";
  EXPECT_EQ(report["first_by_seed"].size(), 3u);
  EXPECT_EQ(report["all"]["hypotheses"]["of"], 0) << "only answers were asked for";
  int ends = 0;
  for (const json& count : first["endings"]) ends += count.get<int>();
  EXPECT_EQ(ends, 6) << first.dump();
}

TEST(Rates, PlanAsTheConfigurationSays) {
  const TemporaryFolder folder;
  std::ofstream(folder / "edges.toml") << "[faces]\nedges = \"always\"\n[planner]\nthreads = 0\n";
  smallBlock(folder);
  const auto ratesWith = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"rates", "--objects", folder / "", "--answers-only", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished rates = trainer(arguments);
    EXPECT_EQ(rates.code, kDone) << rates.err;
    return json::parse(rates.out);
  };
  const json faces = ratesWith({}), edges = ratesWith({"--config", folder / "edges.toml"});
  EXPECT_EQ(faces["changed_options"], json::array());
  EXPECT_EQ(edges["changed_options"], json::array({"faces.edges"})) << "threads are as by default";
  EXPECT_GT(edges["all"]["found"], faces["all"]["found"]) << "more faces to grasp at, more grasps";
}

TEST(Rates, RefuseWhatTheyDoNotKnow) {
  EXPECT_THAT(trainer({"rates", "--seen", "half"}).err, HasSubstr("whole, view or pair"));
  EXPECT_THAT(trainer({"rates", "--protocol", "throw"}).err, HasSubstr("six_gravities"));
  EXPECT_THAT(trainer({"rates", "--views", "0"}).err, HasSubstr("'--views' is 0"));
}

// A store with labels of three objects, few of each.
std::string smallStore(const TemporaryFolder& folder) {
  for (const char* object : {"cup", "mug", "banana"}) {
    const Finished labelled = trainer({"label", "--only", object, "--scales", "1", "--limit", "12",
                                       "--last-stage", "shake", "--out", folder / "store.db"});
    EXPECT_EQ(labelled.code, kDone) << labelled.err;
  }
  return folder / "store.db";
}

std::string contentOf(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Learning, RanksObjectsLeftOutAndSaysSoTheSameOnAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const std::string store = smallStore(folder);
  const auto evaluate = [&](const std::string& threads) {
    const Finished finished =
        trainer({"evaluate", "--store", store, "--repeats", "2", "--json", "--threads", threads});
    EXPECT_EQ(finished.code, kDone) << finished.err;
    json report = json::parse(finished.out);
    report.erase("time_s");
    return report;
  };
  const json one = evaluate("1");
  EXPECT_EQ(one, evaluate("2"));
  EXPECT_EQ(one["schema"], 1);
  EXPECT_EQ(one["objects"].size(), 3u);
  EXPECT_EQ(one["samples"], 36);
  EXPECT_NEAR(one["random"]["span_fraction"].get<double>(), 0.5, 0.1);
  for (const char* ranking : {"network", "recalled", "random", "best_of_q1_to_q9"})
    EXPECT_TRUE(one.contains(ranking));
}

TEST(Learning, WritesAModelWithItsOriginAndAReportThatFetchesNothing) {
  const TemporaryFolder folder;
  const std::string store = smallStore(folder);
  const Finished trained = trainer({"train", "--store", store, "--repeats", "1", "--ensemble", "2", "--out",
                                    folder / "model.json", "--report", folder / "report.html"});
  ASSERT_EQ(trained.code, kDone) << trained.err;
  const json model = json::parse(contentOf(folder / "model.json"));
  EXPECT_THAT(model["trained_on"].get<std::string>(), HasSubstr("36 planned grasps on 3 objects"));
  EXPECT_THAT(model["command"].get<std::string>(), HasSubstr("train --store"));
  EXPECT_EQ(model["networks"].size(), 2u);
  EXPECT_EQ(model["data_hash"].get<std::string>().size(), 64u);
  const std::string page = contentOf(folder / "report.html");
  EXPECT_THAT(page, AllOf(HasSubstr("Data card"), HasSubstr("Model card"), HasSubstr("Learning curves"),
                          HasSubstr("Which inputs matter"), HasSubstr("</svg>")));
  for (const char* fetching : {"src=", "href=", "@import", "<script"})
    EXPECT_THAT(page, ::testing::Not(HasSubstr(fetching)));
}

TEST(Learning, RemembersWhatWasTriedWhereThatIsAskedFor) {
  const TemporaryFolder folder;
  const std::string store = smallStore(folder);
  const auto trained = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{"train",      "--store", store,   "--repeats",           "1",
                                       "--ensemble", "2",       "--out", folder / "model.json", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished finished = trainer(arguments);
    EXPECT_EQ(finished.code, kDone) << finished.err;
    return json::parse(contentOf(folder / "model.json"));
  };
  EXPECT_FALSE(trained({}).contains("recollections")) << "a model remembers nothing unasked";
  const json model = trained({"--recollections"});
  ASSERT_EQ(model["recollections"].size(), 3u) << "one for each object";
  std::size_t grasps = 0;
  for (const json& recollection : model["recollections"]) grasps += recollection["places"].size();
  EXPECT_EQ(grasps, 36u) << "each that was tried";
  std::ofstream(folder / "recall.toml") << "[recall]\nenabled = true\n";
  const Finished rates = trainer({"rates", "--objects", "mug", "--store", store, "--answers-only", "--config",
                                  folder / "recall.toml", "--json"});
  ASSERT_EQ(rates.code, kDone) << rates.err;
  EXPECT_EQ(json::parse(rates.out)["changed_options"], json({"recall.enabled"}));
}

TEST(Learning, RefusesWhatCannotBeLearnt) {
  const TemporaryFolder folder;
  const auto refusal = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"train", "--out", folder / "model.json"});
    const Finished finished = trainer(arguments);
    EXPECT_EQ(finished.code, kBadInput) << finished.err;
    EXPECT_FALSE(fs::exists(folder / "model.json"));
    return finished.err;
  };
  EXPECT_THAT(refusal({"--inputs", "all"}), HasSubstr("would learn its own input"));
  EXPECT_THAT(refusal({"--inputs", "q1,q0"}), HasSubstr("'q0' is unknown"));
  EXPECT_THAT(refusal({"--target", "hold"}), HasSubstr("needs --store"));
  EXPECT_THAT(refusal({"--recollections"}), HasSubstr("--recollections needs --store"));
  EXPECT_THAT(refusal({"--target", "luck"}), HasSubstr("s, hold or both"));
  EXPECT_THAT(refusal({"--store", "/no/such.db"}), HasSubstr("/no/such.db"));
}

TEST(Learning, CtrlCStopsItAndNothingIsWritten) {
  const TemporaryFolder folder;
  Process training({BOXGRASP_TRAINER, "train", "--objects", "mug", "--objects", "cup", "--objects", "bowl",
                    "--out", folder / "model.json"});
  while (training.running() && training.err().find("labelling: ") == std::string::npos) usleep(50'000);
  training.signal(SIGINT);
  EXPECT_EQ(training.wait(30.0), kInterrupted);
  EXPECT_FALSE(fs::exists(folder / "model.json"));
}

}  // namespace
}  // namespace boxgrasp::test
