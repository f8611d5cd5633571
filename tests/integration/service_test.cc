// Server and client as processes, over real LCM.
#include <arpa/inet.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <thread>

#include "boxgrasp/cloud/write_cloud.h"
#include "boxgrasp/messaging/cloud_conversion.h"
#include "boxgrasp/messaging/event_log.h"
#include "processes.h"
#include "wire.h"

namespace boxgrasp::test {
namespace {

using Clock = std::chrono::steady_clock;
using testing::AnyOf;
using testing::Contains;
using testing::HasSubstr;

std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

class Service : public testing::Test {
 protected:
  void SetUp() override {
    writeCloud(cup(), folder / "cup.pcd");
    std::ofstream(folder / "slow.toml")
        << "[server]\nstop_s = 0.5\n[clean]\nvoxel_m = 0.0\n[decomposition]\nexhaustive = true\n";
    std::ofstream(folder / "clouds.toml") << "[server]\ncloud_channel = \"CAMERA\"\n";
  }

  std::vector<std::string> serverLine(const std::vector<std::string>& more = {}) const {
    return std::vector<std::string>{BOXGRASP_SERVER, "--lcm-url", url()} + more;
  }
  void startServer(const std::vector<std::string>& more = {}) {
    server.emplace(serverLine(more));
    const auto end = Clock::now() + std::chrono::seconds(10);
    while (server->running() && Clock::now() < end && server->err().find("answering on") == std::string::npos)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_THAT(server->err(), HasSubstr("answering on"));
  }
  Finished client(const std::string& command, const std::vector<std::string>& more) const {
    return run(std::vector<std::string>{BOXGRASP_CLIENT, command, "--lcm-url", url()} + more);
  }
  Finished local(const std::vector<std::string>& more) const {
    return client("plan", std::vector<std::string>{"--local"} + more);
  }

  TemporaryFolder folder;
  std::optional<Process> server;
};

nlohmann::json withoutTimes(const std::string& text) {
  nlohmann::json json = nlohmann::json::parse(text);
  for (auto& stage : json["report"]["stages"]) stage.erase("time_s");
  json["report"].erase("time_s");
  return json;
}

TEST_F(Service, LocalEqualsTheDaemonsAnswer) {
  startServer();
  const std::vector<std::string> arguments = {folder / "cup.pcd", "--json", "--top", "5",
                                              "--gravity",        "0,0,-1"};
  const Finished there = client("plan", arguments), here = local(arguments);
  ASSERT_EQ(there.code, 0) << there.err;
  ASSERT_EQ(here.code, 0) << here.err;
  EXPECT_EQ(withoutTimes(there.out), withoutTimes(here.out));
  EXPECT_EQ(withoutTimes(there.out)["outcome"], "grasps");
  EXPECT_GT(withoutTimes(there.out)["grasps"].size(), 0u);
}

// What a request says of its robot goes over the wire, and the answer is in the robot's frame.
TEST_F(Service, AnswersInTheRobotsFrame) {
  startServer();
  const std::vector<std::string> cloud = {folder / "cup.pcd", "--json",     "--top", "5",
                                          "--table",          "0,0,0,0,0,1"};
  const std::vector<std::string> robot = {
      "--camera-pose", "1,2,3,0,1,0,0", "--answer-frame",      "robot",
      "--approach",    "0,0,1",         "--approach-cone-rad", "0.4",
      "--workspace",   "0,0,0,2,3,3",   "--forbidden",         "1.3,0,0,9,9,9"};
  const Finished there = client("plan", cloud + robot), here = local(cloud + robot);
  ASSERT_EQ(there.code, 0) << there.err;
  EXPECT_EQ(withoutTimes(there.out), withoutTimes(here.out));
  const nlohmann::json plan = withoutTimes(there.out);
  EXPECT_EQ(plan["frame"], "robot");
  for (const auto& grasp : plan["grasps"]) {
    EXPECT_GT(grasp["approach"][2], std::cos(0.4)) << "the camera looks down: its z is the robot's -z";
    EXPECT_LT(grasp["palm_pose"]["position_m"][2], 3.0);
    EXPECT_NEAR(
        grasp["pregrasp_pose"]["position_m"][2].get<double>() + 0.15 * grasp["approach"][2].get<double>(),
        grasp["palm_pose"]["position_m"][2], 1e-9);
    EXPECT_EQ(grasp["tool"]["pose"], grasp["palm_pose"]) << "no tool was told of";
    EXPECT_EQ(grasp["lift_pose"]["quaternion_wxyz"], grasp["palm_pose"]["quaternion_wxyz"]);
  }
  const Finished nowhere = client("plan", cloud + std::vector<std::string>{"--workspace", "5,5,5,6,6,6"});
  EXPECT_EQ(nowhere.code, 1);
  EXPECT_THAT(nowhere.err, HasSubstr("stage 'reach' let none of"));
}

// The keys that the JSON of a plan promises.
TEST_F(Service, JsonHasItsKeys) {
  const nlohmann::json plan = nlohmann::json::parse(local({folder / "cup.pcd", "--json", "--top", "1"}).out);
  EXPECT_EQ(plan["schema"], 1);
  for (const char* key : {"outcome", "message", "model_version", "frame", "grasps", "boxes", "report"})
    EXPECT_TRUE(plan.contains(key)) << key;
  const auto& grasp = plan["grasps"].at(0);
  EXPECT_EQ(grasp["palm_pose"]["position_m"].size(), 3u);
  EXPECT_EQ(grasp["palm_pose"]["quaternion_wxyz"].size(), 4u);
  for (const char* pose : {"pregrasp_pose", "lift_pose"})
    EXPECT_EQ(grasp[pose]["position_m"].size(), 3u) << pose;
  for (const char* joint : {"spread", "f1", "f2", "f3"})
    EXPECT_TRUE(grasp["joints_rad"][joint].is_number()) << joint;
  ASSERT_EQ(grasp["contacts"].size(), 3u);
  EXPECT_EQ(grasp["contacts"][2]["finger"], "f3");
  EXPECT_EQ(grasp["contacts"][0]["position_m"].size(), 3u);
  EXPECT_EQ(grasp["contacts"][0]["normal"].size(), 3u);
  EXPECT_EQ(grasp["approach"].size(), 3u);
  EXPECT_EQ(grasp["quality"].size(), 9u);
  EXPECT_TRUE(plan["boxes"].at(grasp["box"].get<int>())["leaf"].get<bool>())
      << "grasps are planned on leaves";
  for (const char* key : {"center_m", "quaternion_wxyz", "extents_m", "points", "parent", "leaf", "theta"})
    EXPECT_TRUE(plan["boxes"][0].contains(key)) << key;
  for (const char* key : {"name", "in", "out", "time_s"})
    EXPECT_TRUE(plan["report"]["stages"].at(0).contains(key)) << key;
  EXPECT_TRUE(plan["report"]["rejected"].is_object());
  EXPECT_TRUE(plan["report"]["seed"].is_number_integer());
}

// Where the sensor stood counts the same from the command line and from the file.
TEST_F(Service, TheViewpointIsTheFilesOrTheUsers) {
  writeCloud(cup(), folder / "seen.pcd", Vector3d(0.5, -0.25, 0.4));
  const auto plan = [&](std::vector<std::string> more) {
    return withoutTimes(local(more + std::vector<std::string>{"--json", "--top", "5"}).out);
  };
  const nlohmann::json told = plan({folder / "cup.pcd", "--viewpoint", "0.5", "-0.25", "0.4"});
  EXPECT_EQ(told["outcome"], "grasps");
  EXPECT_EQ(told, plan({folder / "seen.pcd"}));
  EXPECT_NE(told["grasps"], plan({folder / "cup.pcd"})["grasps"]);
  EXPECT_EQ(told, plan({folder / "cup.pcd", "--viewpoint", "0.5,-0.25,0.4"}));
}

TEST_F(Service, RepeatsItsAnswerWithoutPlanningTwice) {
  startServer();
  Wire wire;
  plan_request_t request = wire.request("twice");
  ASSERT_TRUE(wire.ask(request));
  ++request.utime;  // a later try
  wire.send(channel::kPlanRequest, request);
  ASSERT_TRUE(wire.until([&] { return wire.answers.size() == 2; }));
  EXPECT_EQ(wire.raw[0], wire.raw[1]);
  wire.freshStatus();
  EXPECT_EQ(wire.status.repeated, 1);
  EXPECT_EQ(wire.status.outcomes[plan_response_t::GRASPS], 1);
}

TEST_F(Service, RefusesOneIdForTwoContents) {
  startServer();
  Wire wire;
  ASSERT_TRUE(wire.ask(wire.request("one")));
  wire.answers.clear();
  const plan_response_t* second = wire.ask(wire.request("one", 0.0, 3000));
  ASSERT_TRUE(second);
  EXPECT_EQ(outcomeName(second->outcome), "bad_input");
  EXPECT_THAT(second->message, HasSubstr("choose a new one"));
}

TEST_F(Service, AnswersOverloadedAtOnceAndCancels) {
  startServer({"--config", folder / "slow.toml", "--workers", "1", "--queue", "1"});
  Wire wire;
  wire.send(channel::kPlanRequest, wire.slowRequest("runs"));
  ASSERT_TRUE(wire.until([&] { return wire.status.running == 1 && wire.active("runs"); }));
  wire.send(channel::kPlanRequest, wire.request("waits"));
  ASSERT_TRUE(wire.until([&] { return wire.active("waits"); }));
  EXPECT_TRUE(wire.status.overloaded);
  wire.send(channel::kPlanRequest, wire.slowRequest("runs"));
  const plan_response_t* third = wire.ask(wire.request("one too many"));
  ASSERT_TRUE(third);
  EXPECT_EQ(outcomeName(third->outcome), "overloaded");
  EXPECT_EQ(wire.answers.size(), 1u) << "the repeated request joins the one that runs";
  for (const std::string id : {"waits", "runs", "unknown"}) wire.send(channel::kCancel, cancel_t{1, id});
  ASSERT_TRUE(wire.until([&] { return wire.answer("waits") && wire.answer("runs"); }));
  EXPECT_EQ(outcomeName(wire.answer("waits")->outcome), "cancelled");
  EXPECT_EQ(outcomeName(wire.answer("runs")->outcome), "cancelled");
}

TEST_F(Service, SaysThatADeadlinePassed) {
  startServer({"--config", folder / "slow.toml", "--workers", "1"});
  Wire wire;
  const plan_response_t* gone = wire.ask(wire.request("passed before it came", -1.0));
  ASSERT_TRUE(gone);
  EXPECT_EQ(outcomeName(gone->outcome), "deadline");
  wire.send(channel::kPlanRequest, wire.slowRequest("short", 2.0));
  const plan_response_t* waited = wire.ask(wire.request("waits", 0.2));
  ASSERT_TRUE(waited);
  EXPECT_EQ(outcomeName(waited->outcome), "deadline");
  EXPECT_THAT(waited->message, HasSubstr("in the queue"));
  ASSERT_TRUE(wire.until([&] { return wire.answer("short") != nullptr; }));
  EXPECT_EQ(outcomeName(wire.answer("short")->outcome), "deadline");
  const Finished late = client("plan", {folder / "cup.pcd", "--deadline-s", "0.5"});
  EXPECT_EQ(late.code, 5) << late.err;
  EXPECT_THAT(late.err, HasSubstr("deadline passed"));
}

TEST_F(Service, GoesOnAfterHostileMessages) {
  startServer();
  Wire wire;
  const auto good = encoded(wire.request("good"));
  std::vector<std::vector<std::uint8_t>> bad = {
      {}, {1, 2, 3}, std::vector<std::uint8_t>(5000, 0xff), {good.begin(), good.end() - 1}};
  for (const std::size_t at :
       {0u, 16u, 17u, 18u, 19u}) {  // the fingerprint, and the bytes of a text's length
    bad.push_back(good);
    bad.back()[at] ^= 0x80;
  }
  bad.push_back(good);
  std::fill(bad.back().begin() + 16, bad.back().begin() + 20, 0);
  for (const auto& bytes : bad) {
    wire.send(channel::kPlanRequest, bytes);
    wire.send(channel::kCancel, bytes);
  }
  plan_request_t nonsense = wire.request("nonsense");
  nonsense.cloud.width = 1'000'000'000'000;
  const plan_response_t* refused = wire.ask(nonsense);
  ASSERT_TRUE(refused);
  EXPECT_EQ(outcomeName(refused->outcome), "bad_input");
  const plan_response_t* answer = wire.ask(wire.request("good"));
  ASSERT_TRUE(answer);
  EXPECT_EQ(outcomeName(answer->outcome), "grasps") << answer->message;
  wire.freshStatus();
  EXPECT_EQ(wire.status.refused, static_cast<std::int64_t>(2 * bad.size()));
}

TEST_F(Service, PlansTheCloudsOfAChannel) {
  startServer({"--config", folder / "clouds.toml"});
  Wire wire;
  drake::lcmt_point_cloud cloud = toMessage(cup(4000), "camera");
  cloud.utime = 77;
  wire.send("CAMERA", cloud);
  ASSERT_TRUE(wire.until([&] { return wire.answer("CAMERA@77") != nullptr; }));
  EXPECT_EQ(outcomeName(wire.answers[0].outcome), "grasps");
  EXPECT_EQ(wire.answers[0].frame, "camera");
}

TEST_F(Service, TheLatestCloudOfAChannelWins) {
  std::ofstream(folder / "slow_clouds.toml")
      << "[server]\ncloud_channel = \"CAMERA\"\nstop_s = 0\n[decomposition]\nexhaustive = "
         "true\n[clean]\nvoxel_m = 0.0\n";
  startServer({"--config", folder / "slow_clouds.toml", "--workers", "1"});
  Wire wire;
  drake::lcmt_point_cloud cloud = toMessage(cup(4000), "camera");
  wire.send(channel::kPlanRequest, wire.slowRequest("runs"));
  ASSERT_TRUE(wire.until([&] { return wire.status.running == 1; }));
  for (cloud.utime = 1; cloud.utime <= 3; ++cloud.utime) wire.send("CAMERA", cloud);
  ASSERT_TRUE(wire.until([&] { return wire.status.superseded == 2; }));
  EXPECT_THAT(wire.status.active, Contains("CAMERA@3"));
  EXPECT_EQ(wire.status.queue_length, 1);
}

TEST_F(Service, SigtermAnswersEverybodyAndEnds) {
  startServer({"--config", folder / "slow.toml", "--workers", "1"});
  Wire wire;
  wire.send(channel::kPlanRequest, wire.slowRequest("runs"));
  ASSERT_TRUE(wire.until([&] { return wire.status.running == 1; }));
  wire.send(channel::kPlanRequest, wire.request("waits"));
  ASSERT_TRUE(wire.until([&] { return wire.active("waits"); }));
  server->signal(SIGTERM);
  ASSERT_TRUE(wire.until([&] { return wire.answer("runs") && wire.answer("waits"); }));
  EXPECT_EQ(outcomeName(wire.answer("waits")->outcome), "overloaded");
  EXPECT_EQ(outcomeName(wire.answer("runs")->outcome), "cancelled") << "it ran on past stop_s";
  EXPECT_EQ(server->wait(10), 0) << server->err();
}

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) all.push_back(line);
  return all;
}

std::vector<double> numbersIn(std::string text) {
  for (char& c : text) {
    if (c == ',') c = ' ';
  }
  std::istringstream in(text);
  return {std::istream_iterator<double>(in), {}};
}

std::string fileText(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

// The same numbers in every format, from the plan's JSON and from the cloud.
TEST_F(Service, ExportsKeepTheGrasps) {
  const std::string json_text = local({folder / "cup.pcd", "--json", "--top", "3"}).out;
  std::ofstream(folder / "plan.json") << json_text;
  const nlohmann::json grasps = nlohmann::json::parse(json_text)["grasps"];
  const auto exported = [&](const std::vector<std::string>& more) {
    const Finished done =
        run(std::vector<std::string>{BOXGRASP_CLIENT, "export", folder / "plan.json"} + more);
    EXPECT_EQ(done.code, 0) << done.err;
    return done.out;
  };
  const std::string csv = exported({"--format", "csv"});
  const std::vector<std::string> rows = lines(csv);
  ASSERT_EQ(rows.size(), 1 + grasps.size());
  EXPECT_THAT(rows[0], testing::StartsWith("rank,score,object,box,face,palm_x_m,"));
  const auto columns = std::count(rows[0].begin(), rows[0].end(), ',') + 1;
  const std::vector<std::string> net = lines(exported({"--format", "graspnet"}));
  ASSERT_EQ(net.size(), grasps.size());
  for (std::size_t i = 0; i < grasps.size(); ++i) {
    const std::vector<double> of_csv = numbersIn(rows[i + 1]), of_net = numbersIn(net[i]);
    ASSERT_EQ(of_csv.size(), static_cast<std::size_t>(columns));
    EXPECT_EQ(of_csv[1], grasps[i]["score"].get<double>());
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(of_csv[5 + k], grasps[i]["palm_pose"]["position_m"][k].get<double>());
    for (int k = 0; k < 4; ++k)
      EXPECT_EQ(of_csv[8 + k], grasps[i]["palm_pose"]["quaternion_wxyz"][k].get<double>());
    EXPECT_EQ(of_csv.back(), grasps[i]["contacts"][2]["position_m"][2].get<double>());
    ASSERT_EQ(of_net.size(), 17u);
    const Eigen::Matrix3d axes =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(of_net.data() + 4);
    EXPECT_TRUE(axes.isUnitary(1e-9));
    EXPECT_NEAR(axes.determinant(), 1.0, 1e-9);
    const auto vector = [](const nlohmann::json& v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
    EXPECT_TRUE(axes.col(0).isApprox(vector(grasps[i]["approach"]), 1e-6));
    // Its two fingertips, half the width to each side, are as high as the contacts and on their line.
    const Eigen::Vector3d thumb = vector(grasps[i]["contacts"][2]["position_m"]);
    const Eigen::Vector3d tip = Eigen::Map<const Eigen::Vector3d>(of_net.data() + 13) +
                                of_net[3] * axes.col(0) + of_net[1] / 2 * axes.col(1);
    EXPECT_LT((thumb - tip).cross(axes.col(0)).norm(), 1e-9) << "beside the thumb's contact";
    EXPECT_LT((thumb - tip).norm(), 0.02);
  }
  const std::string yaml = exported({"--format", "isaac_grasp", "--joint-names", "a,b,c,d"});
  EXPECT_THAT(yaml, testing::StartsWith("format: isaac_grasp\nformat_version: 1.0\n"));
  EXPECT_THAT(yaml, HasSubstr(fmt::format("    position: [{}, ",
                                          grasps[0]["palm_pose"]["position_m"][0].get<double>())));
  EXPECT_THAT(yaml, HasSubstr(fmt::format("    pregrasp_cspace_position:\n      \"a\": {}\n",
                                          grasps[0]["pregrasp_rad"]["spread"].get<double>())));
  exported({"--format", "graspnet", "--out", folder / "plan.npy"});
  const std::string npy = fileText(folder / "plan.npy");
  EXPECT_EQ(npy.size() % 64, grasps.size() * 17 * 8 % 64);
  EXPECT_THAT(npy, HasSubstr(fmt::format("'shape': ({}, 17)", grasps.size())));
  const Finished of_cloud = run({BOXGRASP_CLIENT, "export", folder / "cup.pcd", "--local", "--top", "3"});
  EXPECT_EQ(of_cloud.out, csv) << of_cloud.err;
}

TEST_F(Service, ExportRefusesWhatIsNoPlan) {
  const auto problem = [&](const std::string& content, const std::vector<std::string>& more = {}) {
    std::ofstream(folder / "bad.json") << content;
    const Finished done =
        run(std::vector<std::string>{BOXGRASP_CLIENT, "export", folder / "bad.json"} + more);
    EXPECT_EQ(done.code, content.find("\"grasps\": []") != std::string::npos ? 1 : 3) << done.err;
    return done.err;
  };
  EXPECT_THAT(problem("{"), HasSubstr("is no plan"));
  EXPECT_THAT(problem("{\"grasps\": 1}"), HasSubstr("schema is none"));
  EXPECT_THAT(problem("{\"schema\": 1}"), HasSubstr("'grasps' not found"));
  EXPECT_THAT(problem("{\"schema\": 1, \"grasps\": [{\"score\": 1}]}"), HasSubstr("not found"));
  EXPECT_THAT(problem("{\"schema\": 1, \"grasps\": []}"), HasSubstr("0 grasps"));
}

TEST_F(Service, HandCheckSaysWhatIsWrongOrWhatTheHandCanDo) {
  const std::string shipped = BOXGRASP_SOURCE_DIR "/deploy/hands/barrett.toml";
  const auto check = [&](const std::vector<std::string>& more) {
    return run(std::vector<std::string>{BOXGRASP_CLIENT, "hand", "check"} + more);
  };
  const Finished good = check({shipped, "--json", "--picture", folder / "hand.svg"});
  ASSERT_EQ(good.code, 0) << good.err;
  const nlohmann::json hand = nlohmann::json::parse(good.out);
  EXPECT_EQ(hand["schema"], 1);
  EXPECT_EQ(hand["name"], "Barrett BH8");
  EXPECT_NEAR(hand["opening_m"]["open"].get<double>(), 0.30, 0.03) << "two open fingers of some 150 mm";
  EXPECT_THAT(fileText(folder / "hand.svg"), testing::StartsWith("<svg"));
  EXPECT_THAT(check({shipped}).out, HasSubstr("this hand can be planned with"));
  std::string text = fileText(shipped);
  text.replace(text.find("coupling = 0.3"), 14, "coupling = 9.3");
  std::ofstream(folder / "bad.toml") << text;
  const Finished bad = check({folder / "bad.toml"});
  EXPECT_EQ(bad.code, 3);
  EXPECT_THAT(bad.err, testing::ContainsRegex("bad.toml:[0-9]+:[0-9]+: key 'finger.coupling' is 9.3"));
  EXPECT_THAT(bad.err, HasSubstr("give a value from 0 to 1"));
}

// Until its output has the text; false if the program ends before.
bool waitFor(Process& process, const std::string& text) {
  while (process.out().find(text) == std::string::npos && process.err().find(text) == std::string::npos) {
    if (!process.running()) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

TEST_F(Service, MonitorShowsWhatIsSaid) {
  startServer();
  Process words({BOXGRASP_CLIENT, "monitor", "--lcm-url", url()});
  EXPECT_TRUE(waitFor(words, "0 of 16 waiting")) << words.err();
  words.signal(SIGINT);
  EXPECT_EQ(words.wait(10), 0);
  Process objects({BOXGRASP_CLIENT, "monitor", "--json", "--lcm-url", url()});
  EXPECT_TRUE(waitFor(objects, "\"latest\"")) << objects.err();
  objects.signal(SIGTERM);
  EXPECT_EQ(objects.wait(10), 0);
  const auto report = nlohmann::json::parse(lines(objects.out()).back());
  EXPECT_EQ(report["schema"], 1);
  EXPECT_EQ(report["channels"][0]["channel"], "BOXGRASP_STATUS");
  EXPECT_EQ(report["channels"][0]["type"], "boxgrasp.status_t");
  EXPECT_GT(report["senders"][0]["messages"], 0);
  const Finished silence = client("monitor", {"--channel", "NOBODY_*", "--once", "--seconds", "0.2"});
  EXPECT_EQ(silence.code, 1);
  EXPECT_THAT(silence.err, HasSubstr("nothing was said on NOBODY_*"));
}

// A log that its killed recorder left behind is whole, and says the same again: by our player and by LCM's.
TEST_F(Service, WhatWasRecordedIsSaidAgain) {
  startServer();
  std::vector<std::uint8_t> answer;
  {
    Wire wire;
    Process recorder(
        {BOXGRASP_CLIENT, "record", folder / "plan.log", "--lcm-url", url(), "--channel", "BOXGRASP_PLAN_*"});
    ASSERT_TRUE(waitFor(recorder, "recording")) << recorder.err();
    ASSERT_TRUE(wire.ask(wire.request("recorded")));
    answer = wire.raw.at(0);
    const auto recorded = [&] {
      EventLogReader log(folder / "plan.log");
      int n = 0;
      while (fs::file_size(folder / "plan.log") > 0 && log.next()) ++n;
      return n;
    };
    while (recorded() < 2) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    recorder.signal(SIGKILL);
    EXPECT_EQ(recorder.wait(10), -SIGKILL);
  }
  EXPECT_THAT(client("record", {"/dev/full"}).err, HasSubstr("No space left on device"));
  server.reset();
  const auto saysItAgain = [&](const std::vector<std::string>& player) {
    Wire wire;
    Process playing(player);
    EXPECT_TRUE(wire.until([&] { return !wire.raw.empty(); })) << playing.err();
    EXPECT_EQ(playing.wait(20), 0) << playing.err();
    EXPECT_THAT(wire.raw, testing::ElementsAre(answer)) << player[0];
  };
  saysItAgain({BOXGRASP_CLIENT, "replay", folder / "plan.log", "--lcm-url", url(), "--speed", "100"});
  saysItAgain({"/usr/bin/lcm-logplayer", "--lcm-url", url(), "--speed", "100", folder / "plan.log"});
  const Finished some =
      client("replay", {folder / "plan.log", "--speed", "100", "--json", "--channel", "*_REQUEST"});
  EXPECT_EQ(nlohmann::json::parse(some.out)["messages"], 1);
}

TEST_F(Service, StatusTellsHowItIs) {
  startServer();
  const Finished text = client("status", {}), json = client("status", {"--json"});
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("0 of 2 workers busy"));
  const nlohmann::json status = nlohmann::json::parse(json.out);
  EXPECT_EQ(status["schema"], 1);
  EXPECT_EQ(status["queue_capacity"], 16);
  EXPECT_EQ(status["hand"], "Barrett BH8");
  EXPECT_GT(status["receive_buffer_bytes"]["granted"].get<std::int64_t>(), 0);
}

TEST_F(Service, ASecondServerIsRefused) {
  startServer();
  const Finished second = run(serverLine());
  EXPECT_EQ(second.code, 3);
  EXPECT_THAT(second.err, HasSubstr("another boxgrasp-server already answers on"));
}

TEST_F(Service, APortInUseIsSaid) {
  const int holder = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(20000 + getpid() % 20000));
  ASSERT_EQ(bind(holder, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  const Finished finished = run(serverLine());
  close(holder);
  EXPECT_EQ(finished.code, 3);
  EXPECT_THAT(finished.err, HasSubstr("cannot be used (Address already in use)"));
}

TEST_F(Service, WithoutAServerTheClientSaysSo) {
  const Finished plan = client("plan", {folder / "cup.pcd", "--json"}), status = client("status", {});
  EXPECT_EQ(plan.code, 4);
  EXPECT_THAT(plan.err, HasSubstr("no boxgrasp-server answers on"));
  EXPECT_EQ(nlohmann::json::parse(plan.out)["outcome"], "not_reachable");
  EXPECT_EQ(status.code, 4);
}

// What stands for a server here says how it is, late, and nothing else.
TEST_F(Service, ClientsCountTheWaitForAStatusIntoTheirDeadline) {
  const auto begin = Wire::Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Wire::Clock::now() - begin).count(); };
  std::jthread server_that_says_little([&] {
    Wire wire;
    std::this_thread::sleep_for(std::chrono::milliseconds(2300));
    status_t status{};
    status.receive_buffer_granted = -1;
    wire.send(channel::kStatus, status);
  });
  const Finished plan = client("plan", {folder / "cup.pcd", "--deadline-s", "1"});
  EXPECT_EQ(plan.code, 5) << plan.err;
  EXPECT_THAT(plan.err, HasSubstr("no answer after"));
  EXPECT_LT(seconds(), 4.1) << "a second for the plan and one of grace: it should end with the first status";
}

TEST_F(Service, WrongUsageIsExitCode2) {
  EXPECT_EQ(client("plan", {}).code, 2);
  EXPECT_EQ(client("plan", {folder / "cup.pcd", "--friction", "-1"}).code, 2);
  EXPECT_EQ(client("plan", {folder / "cup.pcd", "--model", folder / "model.json"}).code, 2)
      << "a model needs --local";
  EXPECT_EQ(client("show", {folder / "cup.pcd"}).code, 2) << "show needs --picture";
  EXPECT_EQ(run({BOXGRASP_SERVER, "--workers", "x"}).code, 2);
}

TEST_F(Service, WrongConfigurationIsExitCode3) {
  std::ofstream(folder / "wrong.toml") << "[server]\nworkrs = 3\n";
  const Finished finished = run(serverLine({"--config", folder / "wrong.toml"}));
  EXPECT_EQ(finished.code, 3);
  EXPECT_THAT(finished.err,
              HasSubstr("wrong.toml:2:1: unknown key 'workrs' in section [server]; did you mean 'workers'?"));
  EXPECT_EQ(run(serverLine({"--workers", "0"})).code, 3);
  EXPECT_EQ(run({BOXGRASP_SERVER, "--model", folder / "missing.json"}).code, 3);
}

TEST_F(Service, TheShippedConfigurationIsTheDefaultOne) {
  startServer({"--config", std::string(BOXGRASP_SOURCE_DIR) + "/deploy/boxgrasp.toml"});
  EXPECT_THAT(server->err(), testing::Not(HasSubstr("sets"))) << "the server logs keys that change something";
}

// Bad input through the server and in-process: one message, one exit code, and the server goes on.
TEST_F(Service, BadFilesGetAMessageAndAnExitCode) {
  startServer();
  const auto write = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder / name) << text;
    return folder / name;
  };
  const auto points = [](int n, const std::function<Vector3d(int)>& at) {
    std::string text;
    for (int i = 0; i < n; ++i) text += fmt::format("{} {} {}\n", at(i).x(), at(i).y(), at(i).z());
    return text;
  };
  const std::string header =
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 100\nHEIGHT 1\n";
  struct Case {
    fs::path file;
    std::vector<int> codes;
  };
  const std::vector<Case> cases = {
      {write("empty.pcd", ""), {3}},
      {write("text.pcd", "this is a letter, not a cloud\n"), {3}},
      {write("empty.xyz", ""), {3}},
      {write("truncated.pcd", header + "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 100\nDATA binary\nabc"), {3}},
      {write("nan.xyz", "nan nan nan\nnan nan nan\n"), {3}},
      {write("point.xyz", "1 2 3\n"), {3}},
      {write("line.xyz", points(500, [](int i) { return Vector3d(0.0005 * i, 0, 0); })), {1, 3}},
      {write("plane.xyz",
             points(2500, [](int i) { return Vector3d(0.002 * (i % 50), 0.002 * (i / 50), 0); })),
       {1, 3}},
      {write("huge.xyz", points(500, [](int i) { return Vector3d(i % 10, i / 10 % 10, i); })), {3}},
      {fs::temp_directory_path(), {3}},
      {folder / "missing.pcd", {3}},
  };
  for (const Case& c : cases) {
    const Finished there = client("plan", {c.file, "--json"}), here = local({c.file, "--json"});
    EXPECT_THAT(c.codes, Contains(there.code)) << c.file << ": " << there.err;
    EXPECT_EQ(there.code, here.code) << c.file << ": " << here.err;
    const auto json = nlohmann::json::parse(there.out);
    EXPECT_FALSE(json["message"].get<std::string>().empty()) << c.file;
    EXPECT_THAT(there.err, HasSubstr(json["message"].get<std::string>())) << c.file;
    EXPECT_TRUE(server->running()) << c.file << " ended the server: " << server->err();
  }
}

TEST_F(Service, FiveMillionPointsGetAnAnswer) {
  writeCloud(cup(5'000'000), folder / "large.pcd");
  startServer();
  const Finished here = local({folder / "large.pcd", "--json"});
  ASSERT_EQ(here.code, 0) << here.err;
  const Finished there = client("plan", {folder / "large.pcd", "--json"});
  if (there.code == 3)
    EXPECT_THAT(there.err, HasSubstr("receive buffer")) << "a machine that grants no large buffer";
  else
    EXPECT_EQ(withoutTimes(there.out), withoutTimes(here.out)) << there.err;
}

TEST_F(Service, DrawsAPicture) {
  const Finished finished = client("show", {folder / "cup.pcd", "--picture", folder / "p.png"});
  EXPECT_EQ(finished.code, 0) << finished.err;
  EXPECT_GT(fs::file_size(folder / "p.png"), 10'000u);
}

TEST_F(Service, ExplainsWhereCandidatesWereLost) {
  startServer();
  const Finished finished = client("explain", {folder / "cup.pcd"});
  EXPECT_EQ(finished.code, 0) << finished.err;
  for (const char* text : {"decomposition", "clearance", "rejected", "regions.min_length_m"})
    EXPECT_THAT(finished.out, HasSubstr(text));
}

}  // namespace
}  // namespace boxgrasp::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  boxgrasp::test::enterOwnNetwork();
  return RUN_ALL_TESTS();
}
