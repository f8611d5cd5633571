// The circle: server, robots, worker and publication as processes, over real LCM.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <optional>
#include <thread>

#include "boxgrasp/cloud/write_cloud.h"
#include "processes.h"
#include "wire.h"

namespace boxgrasp::test {
namespace {

using testing::HasSubstr;

// Hears the worker, and asks it to train.
class WorkerWire : public Wire {
 public:
  WorkerWire() : bus_({.url = url()}) {
    bus_.subscribe(channel::kTrainingStatus, kMaxMessageBytes,
                   [this](auto bytes) { seen.push_back(decoded<training_status_t>(bytes)); });
  }
  void ask(const std::string& id, bool cancel = false) {
    bus_.publish(channel::kRetrainRequest, retrain_request_t{1, id, cancel, "asked for by a test"});
  }
  bool hears(const std::function<bool(const training_status_t&)>& condition, double timeout_s = 90.0) {
    const auto end = Clock::now() + std::chrono::duration<double>(timeout_s);
    while (Clock::now() < end) {
      bus_.wait(20);
      if (std::ranges::any_of(seen, condition)) return true;
    }
    return false;
  }

  std::vector<training_status_t> seen;

 private:
  LcmBus bus_;
};

class Worker : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    labels = new TemporaryFolder;
    const Finished labelled = run({BOXGRASP_TRAINER, "label", "--out", *labels / "labels.db", "--scales",
                                   "0.75", "--limit", "12", "--last-stage", "close"},
                                  300);
    ASSERT_EQ(labelled.code, 0) << labelled.err;
  }
  static void TearDownTestSuite() { delete labels; }

  void SetUp() override {
    writeCloud(cup(), folder / "cup.pcd");
    ASSERT_EQ(run({BOXGRASP_TRAINER, "keygen", "--out", folder / "lab"}).code, 0);
    fs::create_directory(folder / "keys");
    fs::copy_file(folder / "lab.pub", folder / "keys" / "lab.pub");
    server.emplace(std::vector<std::string>{BOXGRASP_SERVER, "--lcm-url", url(), "--state-dir",
                                            folder / "state", "--trusted-keys", folder / "keys"});
    Wire wire;
    ASSERT_TRUE(wire.until([&] { return wire.status.utime != 0; })) << server->err();
    in_service = wire.status.model_version;
  }
  std::vector<std::string> workLine(std::vector<std::string> more = {}) const {
    std::vector<std::string> line{BOXGRASP_TRAINER, "work",
                                  "--store",        *labels / "labels.db",
                                  "--outcomes",     folder / "state" / "outcomes.db",
                                  "--state-dir",    folder / "state",
                                  "--key",          folder / "lab",
                                  "--keep",         folder / "kept",
                                  "--lcm-url",      url(),
                                  "--ensemble",     "2",
                                  "--hidden",       "3"};
    line.insert(line.end(), more.begin(), more.end());
    return line;
  }
  Finished client(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), BOXGRASP_CLIENT);
    arguments.insert(arguments.end(), {"--lcm-url", url()});
    return run(arguments);
  }

  static inline TemporaryFolder* labels = nullptr;
  TemporaryFolder folder;
  std::optional<Process> server;
  std::string in_service;
};

bool ended(const training_status_t& status) {
  return status.state == training_status_t::IDLE && !status.candidate.empty();
}

TEST_F(Worker, LearnsFromReportsWhenAskedAndPublishesWhatPassed) {
  ASSERT_EQ(client({"plan", folder / "cup.pcd", "--request-id", "a plan"}).code, 0);
  ASSERT_EQ(client({"feedback", "a plan", "0", "--succeeded"}).code, 0);
  ASSERT_EQ(client({"feedback", "a plan", "1", "--failed"}).code, 0);
  const Process worker(workLine());
  WorkerWire wire;
  ASSERT_TRUE(wire.hears([](const auto& status) { return status.outcomes_waiting == 2; })) << worker.err();
  wire.ask("now");
  ASSERT_TRUE(wire.hears(ended)) << worker.err();
  const training_status_t last = wire.seen.back();
  EXPECT_EQ(last.request_id, "now");
  EXPECT_GT(last.labels, 100);
  EXPECT_THAT(last.message, HasSubstr("on objects kept out"));
  EXPECT_TRUE(
      std::ranges::any_of(wire.seen, [](const auto& s) { return s.state == training_status_t::TRAINING; }));
  EXPECT_TRUE(fs::exists(folder / "kept" / (last.candidate + ".comparison.json")));
  const std::string expected = last.published ? last.candidate : in_service;
  EXPECT_TRUE(wire.until([&] { return wire.status.model_version == expected; }))
      << "in service is " << wire.status.model_version << "; " << last.message;
  ASSERT_TRUE(wire.hears([](const auto& s) { return ended(s) && s.outcomes_waiting == 0; }))
      << "what was learnt from does not wait any more";
}

TEST_F(Worker, IsAloneAtItsStore) {
  const Process first(workLine());
  WorkerWire wire;
  ASSERT_TRUE(wire.hears([](const auto&) { return true; })) << first.err();
  const Finished second = run(workLine());
  EXPECT_EQ(second.code, 3);
  EXPECT_THAT(second.err, HasSubstr("another worker"));
}

TEST_F(Worker, GoesOnAfterAKillAndStopsWhenCancelled) {
  {
    Process worker(workLine());
    WorkerWire wire;
    ASSERT_TRUE(wire.hears([](const auto&) { return true; })) << worker.err();
    wire.ask("first");
    ASSERT_TRUE(wire.hears([](const auto& s) { return s.state == training_status_t::TRAINING; }));
    worker.signal(SIGKILL);
    worker.wait(5);
  }
  const Process worker(workLine());
  WorkerWire wire;
  ASSERT_TRUE(wire.hears([](const auto& s) { return s.cause.find("interruption") != std::string::npos; }))
      << worker.err();
  wire.ask("enough", true);
  ASSERT_TRUE(wire.hears([&](const auto& s) {
    return s.request_id == "enough" && s.state == training_status_t::IDLE;
  })) << worker.err();
  wire.freshStatus();
  EXPECT_EQ(wire.status.model_version, in_service);
}

TEST_F(Worker, SaysWhatItNeeds) {
  const Finished without = run({BOXGRASP_TRAINER, "work", "--outcomes", folder / "outcomes.db"});
  EXPECT_EQ(without.code, 3);
  EXPECT_THAT(without.err, HasSubstr("--store"));
}

}  // namespace
}  // namespace boxgrasp::test
