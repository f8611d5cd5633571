// Publisher, server and clients as processes, over real LCM: models change under load, under fire, and back.
#include "boxgrasp/messaging/publication.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <set>
#include <thread>

#include "boxgrasp/base/durable_file.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/cloud/write_cloud.h"
#include "boxgrasp/registry/model_registry.h"
#include "boxgrasp/store/outcome_store.h"
#include "processes.h"
#include "test_model.h"
#include "wire.h"

namespace boxgrasp::test {
namespace {

using testing::AnyOf;
using testing::Eq;
using testing::HasSubstr;
using testing::Not;

constexpr int kInService = model_reply_t::IN_SERVICE, kKept = model_reply_t::KEPT,
              kRefused = model_reply_t::REFUSED;

// As many kills as CI has time for; more on demand.
int kills() {
  const char* wanted = std::getenv("BOXGRASP_KILLS");
  return wanted ? std::atoi(wanted) : 8;
}

// The number makes it a model of its own, younger than those with smaller numbers.
Model numbered(int number, std::int64_t begin = utimeNow() - 3'600'000'000) {
  Model model = linearModel();
  model.name = fmt::format("model {}", number);
  model.created = modelTime(begin + std::int64_t{number} * 1'000'000);
  model.ensemble.networks[0].layers[0].weights(0, 0) = 0.2 + 0.001 * number;
  return model;
}

class Publication : public testing::Test {
 protected:
  void SetUp() override {
    writeCloud(cup(), folder / "cup.pcd");
    base = writeModel(numbered(0, begin), folder / "base.json");
    key.write(folder / "alice.key");
    fs::create_directory(folder / "keys");
    fs::copy_file(folder / "alice.key.pub", folder / "keys" / "alice.pub");
  }

  // The model, as a file.
  Model model(int number) { return writeModel(numbered(number, begin), file(number)); }
  fs::path file(int number) const { return folder / fmt::format("{}.json", number); }
  std::string bytes(int number) const { return readWhole(file(number), 1 << 20); }

  void start(const std::string& state = "state", bool trusting = true) {
    std::vector<std::string> line{BOXGRASP_SERVER,      "--lcm-url",   url(),         "--model",
                                  folder / "base.json", "--state-dir", folder / state};
    if (trusting) line.insert(line.end(), {"--trusted-keys", folder / "keys"});
    launch(line);
  }
  void launch(const std::vector<std::string>& line) {
    server.emplace(line);
    const auto end = Wire::Clock::now() + std::chrono::seconds(10);
    while (server->running() && Wire::Clock::now() < end &&
           server->err().find("answering on") == std::string::npos)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ASSERT_THAT(server->err(), HasSubstr("answering on"));
  }
  void kill() {
    server->signal(SIGKILL);
    EXPECT_EQ(server->wait(5), -SIGKILL);
  }
  Finished publish(int number) {
    return run(
        {BOXGRASP_TRAINER, "publish", file(number), "--key", folder / "alice.key", "--lcm-url", url()});
  }
  Finished client(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), BOXGRASP_CLIENT);
    arguments.insert(arguments.end(), {"--lcm-url", url()});
    return run(arguments);
  }
  Finished models(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "models");
    return client(std::move(arguments));
  }
  nlohmann::json listed() const {
    const nlohmann::json list = nlohmann::json::parse(models({"list", "--json"}).out);
    EXPECT_EQ(list["schema"], 1);
    nlohmann::json by_version;
    for (const auto& entry : list["models"]) by_version[entry["version"].get<std::string>()] = entry;
    return by_version;
  }
  // The version in service, as the server says once a second and at its start.
  std::string serving(Wire& wire) {
    wire.freshStatus();
    return wire.status.model_version;
  }

  const std::int64_t begin = utimeNow() - 3'600'000'000;
  TemporaryFolder folder;
  SigningKey key = SigningKey::generate();
  Model base;
  std::optional<Process> server;
};

TEST_F(Publication, TakesOverASignedModelAndKeepsIt) {
  const Model one = model(1);
  start();
  const Finished published = publish(1);
  ASSERT_EQ(published.code, 0) << published.err;
  EXPECT_THAT(published.out, HasSubstr("accepted: model " + one.version + " of alice is in service"));
  const Finished plan = client({"plan", folder / "cup.pcd", "--json"});
  EXPECT_EQ(nlohmann::json::parse(plan.out)["model_version"], one.version) << plan.err;
  EXPECT_TRUE(listed()[one.version]["serving"]);
  EXPECT_EQ(publish(1).code, 0) << "a publication that comes twice is answered alike";
  server->signal(SIGTERM);
  EXPECT_EQ(server->wait(10), 0);
  start();
  Wire wire;
  EXPECT_EQ(serving(wire), one.version);
}

TEST_F(Publication, ModelsAreListedShownAndCompared) {
  const Model one = model(1);
  start();
  ASSERT_EQ(publish(1).code, 0);
  const nlohmann::json all = listed();
  EXPECT_EQ(all[base.version]["state"], "base");
  EXPECT_EQ(all[one.version]["state"], "on trial");
  EXPECT_EQ(all[one.version]["key"], "alice");
  EXPECT_EQ(all[one.version]["shape"], "1 x 9-1");
  EXPECT_THAT(models({"show", one.version}).out, HasSubstr("model 1"));
  EXPECT_THAT(models({"compare", base.version, one.version}).out, HasSubstr("networks"));
  const Finished unknown = models({"show", "00000000"});
  EXPECT_EQ(unknown.code, 3);
  EXPECT_THAT(unknown.err, HasSubstr("no model '00000000'; it has " + base.version));
}

// --- refused

class RefusedPublication : public Publication {
 protected:
  void expectRefused(const publish_model_t& message, const std::string& reason) {
    const model_reply_t reply = wire.publish(message);
    EXPECT_EQ(static_cast<int>(reply.outcome), kRefused) << reason;
    EXPECT_THAT(reply.message, HasSubstr(reason));
  }
  void expectTextRefused(const std::string& text, const std::string& reason) {
    expectRefused(publication(text, key), reason);
  }
  // The file of a model that is not as it should be.
  std::string changed(const std::function<void(Model&)>& change) {
    Model next = numbered(5, begin);
    change(next);
    writeModel(next, folder / "changed.json");
    return readWhole(folder / "changed.json", 1 << 20);
  }
  static std::string replaced(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  }

  Wire wire;
};

TEST_F(RefusedPublication, SaysWhoMayPublish) {
  model(1);
  start();
  publish_model_t message = publication(bytes(1), key);
  message.signature = {};
  expectRefused(message, "is not signed");
  expectRefused(publication(bytes(1), SigningKey::generate()), "this server does not trust");
  message = publication(bytes(1), key);
  message.model[message.model.size() / 2] ^= 1;
  expectRefused(message, "altered");
  message = publication(bytes(1), key);
  message.signature = toMessage(key.sign(purpose::kModels, message.model));
  expectRefused(message, "does not fit");
  EXPECT_EQ(serving(wire), base.version);
}

TEST_F(RefusedPublication, SaysWhatIsWrongWithTheModel) {
  model(1);
  start();
  expectTextRefused("", "not valid JSON");
  expectTextRefused(bytes(1).substr(0, 400), "cut short");
  expectTextRefused(replaced(bytes(1), "\"format_version\": 2", "\"format_version\": 1"),
                    "'format_version' is 1");
  expectTextRefused(replaced(bytes(1), "0.201", "1e999"), "not valid JSON");
  expectTextRefused(replaced(bytes(1), "0.201", "0.202"), "it was changed");
  expectTextRefused(changed([](Model& m) { m.features[3] = "q10"; }), "'q10' is unknown");
  expectTextRefused(changed([](Model& m) {
                      m.ensemble.networks[0].layers[0].weights *= 1e308,
                          m.ensemble.networks[0].layers[0].weights *= 5;
                    }),
                    "scores canary grasp");
  expectTextRefused(changed([](Model& m) { m.ensemble.networks[0].layers[0].weights *= 0; }),
                    "the same score");
  expectTextRefused(changed([](Model& m) { m.created = "yesterday"; }), "created at 'yesterday'");
  expectTextRefused(changed([](Model& m) { m.created = "2999-01-01T00:00:00Z"; }), "in the future");
  EXPECT_EQ(serving(wire), base.version);
  EXPECT_TRUE(server->running());
}

TEST_F(RefusedPublication, ReplayOfAnOlderModelIsRefused) {
  const Model one = model(1), two = model(2);
  start();
  ASSERT_EQ(publish(1).code, 0);
  ASSERT_EQ(publish(2).code, 0);
  expectRefused(publication(readWhole(folder / "base.json", 1 << 20), key),
                "before the oldest that is taken");
  const model_reply_t again = wire.publish(publication(bytes(1), key));
  EXPECT_EQ(static_cast<int>(again.outcome), kKept) << again.message;
  EXPECT_EQ(serving(wire), two.version) << "a model that was published before does not come back by itself";
  ASSERT_EQ(models({"rollback", "--key", folder / "alice.key"}).code, 0);
  expectRefused(publication(bytes(2), key), "was rejected before (rolled back by alice)");
  EXPECT_EQ(serving(wire), one.version);
}

TEST_F(RefusedPublication, AServerThatTrustsNobodySaysHowToChangeThat) {
  model(1);
  start("state", false);
  const Finished untrusting = publish(1);
  EXPECT_EQ(untrusting.code, 3);
  EXPECT_THAT(untrusting.err, HasSubstr("--trusted-keys FOLDER"));
  server.reset();
  launch({BOXGRASP_SERVER, "--lcm-url", url(), "--trusted-keys", folder / "keys"});
  const Finished stateless = publish(1);
  EXPECT_EQ(stateless.code, 3);
  EXPECT_THAT(stateless.err, HasSubstr("--state-dir FOLDER"));
  server.reset();
  EXPECT_EQ(publish(1).code, 4) << "without a server";
}

// --- orders

TEST_F(Publication, PinUnpinAndRollBackFollowSignedOrders) {
  const Model one = model(1), two = model(2);
  start();
  ASSERT_EQ(publish(1).code, 0);
  const std::string k = folder / "alice.key";
  EXPECT_EQ(models({"pin", one.version, "--key", k}).code, 0);
  const Finished kept = publish(2);
  EXPECT_EQ(kept.code, 0) << kept.err;
  EXPECT_THAT(kept.out, HasSubstr("is kept, but model " + one.version + " is in service"));
  EXPECT_TRUE(listed()[one.version]["pinned"]);
  EXPECT_THAT(models({"unpin", "--key", k}).out, HasSubstr("model " + two.version + " is in service"));
  EXPECT_THAT(models({"rollback", "--key", k}).out, HasSubstr("model " + one.version + " is in service"));
  EXPECT_EQ(listed()[two.version]["state"], "rejected");
  EXPECT_THAT(models({"pin", two.version, "--key", k}).out,
              HasSubstr("model " + two.version + " is in service"));
  EXPECT_THAT(models({"pin", base.version, "--key", k}).out,
              HasSubstr("model " + base.version + " is in service"));
  EXPECT_EQ(models({"rollback", "--key", k}).code, 3) << "there is none before the base";
  EXPECT_EQ(models({"pin", "00000000", "--key", k}).code, 3);
  EXPECT_EQ(models({"pin", one.version}).code, 2) << "orders need a key";
}

TEST_F(Publication, OrdersOfStrangersAndReplayedOnesAreRefused) {
  const Model one = model(1);
  start();
  ASSERT_EQ(publish(1).code, 0);
  SigningKey::generate().write(folder / "mallory.key");
  const Finished stranger = models({"rollback", "--key", folder / "mallory.key"});
  EXPECT_EQ(stranger.code, 3);
  EXPECT_THAT(stranger.err, HasSubstr("does not trust"));
  models_request_t order{};
  order.utime = utimeNow();
  order.request_id = "pin the base";
  order.action = models_request_t::PIN;
  order.version = base.version;
  const auto obeyed = [&] {
    return ask<models_reply_t>({.lcm_url = url()}, channel::kModelsRequest, order, channel::kModelsReply);
  };
  EXPECT_THAT(obeyed().message, HasSubstr("is not signed"));
  order.signature = toMessage(key.sign(purpose::kModels, signedBytes(order)));
  EXPECT_TRUE(obeyed().done);
  EXPECT_EQ(obeyed().message, "done already") << "its answer was lost, and it came again";
  ASSERT_EQ(models({"unpin", "--key", folder / "alice.key"}).code, 0);
  EXPECT_THAT(obeyed().message, HasSubstr("a later order was obeyed already"));
  order.version = one.version;
  EXPECT_THAT(obeyed().message, HasSubstr("altered"));
}

// --- crashes and damage

TEST_F(Publication, AModelWhoseServerCrashesTwiceIsRolledBack) {
  const Model one = model(1);
  start();
  ASSERT_EQ(publish(1).code, 0);
  kill();
  start();
  Wire wire;
  EXPECT_EQ(serving(wire), one.version) << "what was accepted stays: once may have been anything";
  kill();
  start();
  EXPECT_EQ(serving(wire), base.version);
  EXPECT_THAT(server->err(), HasSubstr("is rejected: the server ended unexpectedly 2 times"));
  EXPECT_EQ(listed()[one.version]["state"], "rejected");
}

TEST_F(Publication, AfterTwentyPlansAModelIsProvenAndSurvivesCrashes) {
  const Model one = model(1);
  start();
  ASSERT_EQ(publish(1).code, 0);
  Wire wire;
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(wire.ask(wire.request(fmt::format("plan {}", i), 0.0, 1500)));
  ASSERT_TRUE(wire.until([&] { return server->err().find("has proven itself") != std::string::npos; }))
      << server->err();
  for (int i = 0; i < 2; ++i) {
    kill();
    start();
    EXPECT_EQ(serving(wire), one.version);
  }
}

TEST_F(Publication, DamagedFilesAreSetAsideAndTheModelBeforeIsUsed) {
  const Model one = model(1), two = model(2);
  start();
  ASSERT_EQ(publish(1).code, 0);
  ASSERT_EQ(publish(2).code, 0);
  kill();
  const fs::path damaged = folder / "state" / "models" / (two.version + ".json");
  std::ofstream(damaged, std::ios::in | std::ios::out).seekp(300).put('#');
  start();
  Wire wire;
  EXPECT_EQ(serving(wire), one.version);
  EXPECT_THAT(server->err(), HasSubstr("model " + two.version + " cannot be used"));
  EXPECT_TRUE(fs::exists(damaged.string() + ".damaged"));
  kill();
  fs::resize_file(folder / "state" / "models" / "registry.json", 100);
  start();
  EXPECT_EQ(serving(wire), base.version);
  EXPECT_THAT(server->err(), HasSubstr("the registry begins anew"));
}

// What is announced is on disk, and what is on disk is whole: the old model or the new one, never another.
TEST_F(Publication, KilledAtAnyMomentTheServerStartsWithAWholeModel) {
  const Model old_model = model(1), new_model = model(2);
  std::mt19937_64 random(1);
  Wire wire;
  int took_new = 0, took_old = 0;
  for (int i = 0; i < kills(); ++i) {
    SCOPED_TRACE(fmt::format("kill {}", i));
    const std::string state = fmt::format("state{}", i);
    start(state);
    ASSERT_EQ(static_cast<int>(wire.publish(publication(bytes(1), key)).outcome), kInService);
    wire.publications.clear();
    const auto sent = Wire::Clock::now();
    wire.send(channel::kPublishModel, publication(bytes(2), key));
    const auto pause = std::chrono::duration<double>(uniform(random, 0.0, 0.025));
    std::this_thread::sleep_until(sent + std::chrono::duration_cast<Wire::Clock::duration>(pause));
    kill();
    wire.until([] { return false; }, 0.05);
    const bool announced = !wire.publications.empty();
    start(state);
    const std::string now = serving(wire);
    if (announced)
      EXPECT_EQ(now, new_model.version) << "it was announced";
    else
      EXPECT_THAT(now, AnyOf(Eq(old_model.version), Eq(new_model.version)));
    ++(now == new_model.version ? took_new : took_old);
    EXPECT_THAT(server->err(), Not(HasSubstr("cannot be used")));
    const plan_response_t* plan = wire.ask(wire.request(fmt::format("after kill {}", i), 0.0, 1500));
    ASSERT_TRUE(plan);
    EXPECT_EQ(plan->model_version, now);
    server.reset();
    fs::remove_all(folder / state);
  }
  fmt::print("{} kills: {} times the new model, {} times the old one\n", kills(), took_new, took_old);
}

// --- under load

bool scoresAreOf(const Model& model, const plan_response_t& answer) {
  return std::all_of(answer.grasps.begin(), answer.grasps.end(), [&](const grasp_t& grasp) {
    return scores(model.ensemble, Eigen::Map<const Eigen::RowVectorXd>(grasp.quality, 9))[0] == grasp.score;
  });
}

TEST_F(Publication, TwoHundredSwapsUnderLoadCostNoRequest) {
  constexpr int kSwaps = 200, kByTrainer = 10;
  std::map<std::string, Model> published{{base.version, base}};
  for (int i = 1; i <= kSwaps; ++i) {
    const Model next = model(i);
    published[next.version] = next;
  }
  start();
  std::atomic<bool> swapping = true;
  std::atomic<std::size_t> answered = 0;
  int requests = 0;
  Wire client;
  std::thread load([&] {
    constexpr std::size_t kAtOnce = 4;  // more than the server's workers
    while (swapping) {
      while (requests - client.answers.size() < kAtOnce)
        client.send(channel::kPlanRequest, client.request(fmt::format("plan {}", requests++), 0.0, 2500));
      client.until([&] { return requests - client.answers.size() < kAtOnce; });
      answered = client.answers.size();
    }
    client.until([&] { return client.answers.size() >= static_cast<std::size_t>(requests); });
  });
  // However slow plans are, many models have some to answer.
  const auto awaitAnswer = [&, deadline = std::chrono::steady_clock::now() + std::chrono::minutes(5)] {
    const std::size_t before = answered;
    while (answered == before && std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  Wire publisher;
  for (int i = 1; i <= kSwaps; ++i) {
    if (i % 10 == 0) awaitAnswer();
    if (i % (kSwaps / kByTrainer) == 0) {
      const Finished finished = publish(i);
      EXPECT_EQ(finished.code, 0) << finished.err;
    } else {
      const model_reply_t reply = publisher.publish(publication(bytes(i), key));
      EXPECT_EQ(static_cast<int>(reply.outcome), kInService) << reply.message;
    }
  }
  swapping = false;
  load.join();
  EXPECT_EQ(client.answers.size(), static_cast<std::size_t>(requests)) << "requests without an answer";
  std::set<std::string> versions;
  for (const plan_response_t& answer : client.answers) {
    EXPECT_EQ(outcomeName(answer.outcome), "grasps") << answer.message;
    ASSERT_TRUE(published.contains(answer.model_version)) << answer.model_version;
    EXPECT_TRUE(scoresAreOf(published[answer.model_version], answer)) << answer.request_id;
    versions.insert(answer.model_version);
  }
  fmt::print("{} swaps, {} requests, all answered, by {} models\n", kSwaps, requests, versions.size());
  EXPECT_GT(versions.size(), 10u) << "too few models answered for the test to mean anything";
}

// --- outcomes

TEST_F(Publication, OutcomesSurviveAKillAndCountOnce) {
  start();
  const Finished plan = client({"plan", folder / "cup.pcd", "--request-id", "a plan"});
  ASSERT_EQ(plan.code, 0) << plan.err;
  EXPECT_THAT(plan.err, HasSubstr("boxgrasp feedback a plan"));
  const auto feedback = [&](const std::string& id, const char* index, const char* how) {
    return client({"feedback", id, index, how, "--what", "slipped", "--robot", "r2", "--forces-n", "1.5,2"});
  };
  const Finished first = feedback("a plan", "0", "--failed");
  ASSERT_EQ(first.code, 0) << first.err;
  kill();
  start();
  const Finished again = feedback("a plan", "0", "--failed"),
                 opposite = feedback("a plan", "0", "--succeeded"),
                 unknown = feedback("another plan", "0", "--failed"),
                 beyond = feedback("a plan", "999", "--failed");
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("counts once"));
  EXPECT_EQ(opposite.code, 3);
  EXPECT_THAT(opposite.err, HasSubstr("the opposite before"));
  EXPECT_EQ(unknown.code, 3);
  EXPECT_THAT(unknown.err, HasSubstr("no answer with grasps to a request 'another plan'"));
  EXPECT_EQ(beyond.code, 3);
  EXPECT_THAT(beyond.err, HasSubstr("has no grasp 999"));
  EXPECT_EQ(client({"feedback", "a plan", "0"}).code, 2) << "it must say how the grasp went";
  kill();
  const std::vector<StoredOutcome> stored = OutcomeStore(folder / "state" / "outcomes.db").outcomesAfter(0);
  ASSERT_EQ(stored.size(), 1u);
  EXPECT_FALSE(stored[0].outcome.succeeded);
  EXPECT_EQ(stored[0].outcome.what, "slipped");
  EXPECT_EQ(stored[0].outcome.forces_n, (std::vector<double>{1.5, 2}));
  EXPECT_EQ(stored[0].origin.model_version, base.version);
  EXPECT_FALSE(stored[0].grasp.inputs.empty()) << "what the network was fed";
  EXPECT_EQ(std::ranges::count(stored[0].origin.features, ' ') + 1, std::ssize(stored[0].grasp.inputs))
      << "an input for each feature of the model";
}

TEST_F(Publication, AStateFolderServesOneServer) {
  start();
  const Finished second = run({BOXGRASP_SERVER, "--lcm-url", "memq://", "--state-dir", folder / "state"});
  EXPECT_EQ(second.code, 3);
  EXPECT_THAT(second.err, HasSubstr("another boxgrasp-server uses the state folder"));
}

}  // namespace
}  // namespace boxgrasp::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  boxgrasp::test::enterOwnNetwork();
  return RUN_ALL_TESTS();
}
