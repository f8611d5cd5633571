#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <thread>

#include "boxgrasp/live/live_view.h"
#include "boxgrasp/live/metrics.h"

namespace boxgrasp {
namespace {

using testing::HasSubstr;
using testing::Not;

plan_response_t answerTo(const std::string& id, std::int8_t outcome = plan_response_t::NO_GRASP) {
  plan_response_t answer{};
  answer.request_id = id;
  answer.outcome = outcome;
  answer.message = "nothing <script>";
  return answer;
}

MadePlanPtr planOf(std::size_t points = 0) {
  auto plan = std::make_shared<MadePlan>();
  plan->trace.scene_C.resize(points);
  return plan;
}

std::vector<std::string> idsOf(const PlanHistory& history) {
  std::vector<std::string> ids;
  for (const AnsweredRequest& request : history.newestFirst()) ids.push_back(request.request_id);
  return ids;
}

nlohmann::json at(LiveView& view, const std::string& path) {
  return nlohmann::json::parse(view.page(path).body);
}

TEST(PlanHistory, KeepsTheNewestByCount) {
  PlanHistory history(3, 1 << 20);
  for (const char* id : {"a", "b", "c", "d"}) history.add(answerTo(id), planOf());
  EXPECT_EQ(idsOf(history), (std::vector<std::string>{"d", "c", "b"}));
  EXPECT_FALSE(history.find(1)) << "the oldest went";
  EXPECT_EQ(history.find(4)->request_id, "d");
}

TEST(PlanHistory, KeepsWithinItsBytes) {
  const std::size_t one = planOf(10'000)->bytes();
  EXPECT_GE(one, 120'000u) << "10 000 points of 12 bytes";
  PlanHistory history(100, 3 * one);
  for (int i = 0; i < 10; ++i) history.add(answerTo(std::to_string(i)), planOf(10'000));
  EXPECT_EQ(history.newestFirst().size(), 2u) << "three plans and their texts are more";
  history.add(answerTo("huge"), planOf(1'000'000));
  EXPECT_TRUE(history.newestFirst().empty()) << "a plan above all bounds is not kept";
}

TEST(PlanHistory, RefusedRequestsLeaveThePlans) {
  PlanHistory history(10, 1 << 20);
  for (int i = 0; i < 5; ++i) history.add(answerTo("planned " + std::to_string(i)), planOf());
  for (int i = 0; i < 1000; ++i) history.add(answerTo("refused", plan_response_t::OVERLOADED), nullptr);
  const auto ids = idsOf(history);
  EXPECT_EQ(ids.size(), 10u);
  EXPECT_EQ(std::count(ids.begin(), ids.end(), "refused"), 5);
}

TEST(PlanHistory, ReadersAndWritersMayMeet) {
  PlanHistory history(4, 1 << 20);
  std::atomic<bool> done = false;
  std::thread reader([&] {
    while (!done) {
      for (const AnsweredRequest& request : history.newestFirst()) ASSERT_TRUE(request.plan);
    }
  });
  for (int i = 0; i < 2000; ++i) history.add(answerTo("x"), planOf(100));
  done = true;
  reader.join();
  EXPECT_EQ(history.find(2000)->id, 2000);
}

TEST(LatencyCounts, EveryTimeIsInTheFirstBucketThatHoldsIt) {
  LatencyCounts latencies;
  const auto& bounds = LatencyCounts::kBounds_s;
  for (const double bound : bounds) latencies.add(bound);
  latencies.add(std::nextafter(bounds[0], 1.0));
  latencies.add(1e9);
  EXPECT_EQ(latencies.counts()[0], 1) << "a bound belongs to its bucket";
  EXPECT_EQ(latencies.counts()[1], 2);
  EXPECT_EQ(latencies.counts().back(), 1);
}

TEST(Metrics, BucketsAddUpAndLabelsAreEscaped) {
  ServerState state;
  state.status.hand = "a \"hand\"\\\n";
  for (const double time_s : {0.01, 0.3, 0.3, 1000.0}) state.latencies.add(time_s);
  const std::string text = metricsText(state, std::nullopt);
  EXPECT_THAT(text, HasSubstr("boxgrasp_request_duration_seconds_bucket{le=\"0.05\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("boxgrasp_request_duration_seconds_bucket{le=\"0.5\"} 3\n"));
  EXPECT_THAT(text, HasSubstr("boxgrasp_request_duration_seconds_bucket{le=\"+Inf\"} 4\n"));
  EXPECT_THAT(text, HasSubstr("boxgrasp_request_duration_seconds_count 4\n"));
  EXPECT_THAT(text, HasSubstr("hand=\"a \\\"hand\\\"\\\\\\n\"} 1\n"));
  EXPECT_THAT(text, Not(HasSubstr("training"))) << "no worker is heard";
}

TEST(Metrics, AWorkerThatIsIdleHasNoProgress) {
  training_status_t training{};
  training.progress = NAN;
  EXPECT_THAT(metricsText({}, training), HasSubstr("boxgrasp_training_progress{worker=\"\"} NaN\n"));
}

TEST(LiveView, ServesThePageItsPlansAndNothingElse) {
  LiveView view(barrettHand(), {});
  view.answered(answerTo("mug", plan_response_t::OVERLOADED), nullptr);
  EXPECT_EQ(view.page("/").status, 200);
  EXPECT_EQ(at(view, "/api/plans")["plans"][0]["outcome"], "overloaded");
  const auto scene = at(view, "/api/plans/1");
  EXPECT_EQ(scene["title"], "mug");
  EXPECT_EQ(scene["outcome"], "overloaded") << "as the answer says, also where nothing was planned";
  EXPECT_EQ(scene["grasps"].size(), 0u);
  for (const char* path : {"", "/api", "/api/plans/2", "/api/plans/1x", "/api/plans/", "/api/plans/-1",
                           "/etc/passwd", "/api/plans/99999999999999999999"})
    EXPECT_EQ(view.page(path).status, 404) << path;
  for (const char* path : {"/api/status", "/api/plans", "/api/plans/1", "/nowhere"})
    EXPECT_EQ(at(view, path)["schema"], 1) << path;
}

TEST(LiveView, ItsPolicyLetsThroughItsOwnScriptsAlone) {
  LiveView view(barrettHand(), {});
  const WebReply page = view.page("/");
  EXPECT_THAT(page.policy, HasSubstr("default-src 'none'; script-src 'sha256-"));
  EXPECT_THAT(page.policy, Not(HasSubstr("unsafe")));
  EXPECT_EQ(view.page("/api/plans").policy, "default-src 'none'");
}

TEST(LiveView, OnlyWhoAsksForTheStatusLooks) {
  LiveView view(barrettHand(), {});
  EXPECT_FALSE(view.isLookedAt());
  view.metrics("/metrics");
  EXPECT_FALSE(view.isLookedAt()) << "a collector is nobody who looks at models";
  view.page("/api/status");
  EXPECT_TRUE(view.isLookedAt());
}

TEST(LiveView, TextThatIsNotUtf8DoesNoHarm) {
  LiveView view(barrettHand(), {});
  view.answered(answerTo("\xff\xfe"), planOf());
  EXPECT_EQ(at(view, "/api/plans")["plans"].size(), 1u);
  EXPECT_EQ(view.page("/api/plans/1").status, 200);
}

}  // namespace
}  // namespace boxgrasp
