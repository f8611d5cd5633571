// The report of a reproduction as a function of what its steps printed.
#include "reproduction_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace boxgrasp {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

ReportedStep stepOf(const std::string& name, const std::string& kind, const json& output) {
  return {name, kind, "subject of " + name, "boxgrasp-trainer " + kind, "b", 1.0, {}, output};
}

json stabilityOf(double robust) {
  json rows = json::array(), means;
  for (const auto& [split, percent] : {std::pair{"old", 60.0}, {"new", 70.0}, {"robust", robust}}) {
    rows.push_back({{"object", "mug"},
                    {"split", split},
                    {"boxes", 2},
                    {"similar_percent", percent},
                    {"paper_percent", nullptr}});
    means[split] = {{"similar_percent", percent}, {"boxes", 2.0}};
  }
  return {{"rows", rows}, {"means", means}};
}

json endings(int held, int of) {
  return {{"held", held}, {"of", of}, {"endings", {{"held", held}, {"lost <in> lift", of - held}}}};
}

json ratesOf(int held, int of) {
  json all{{"object", "all"}};
  for (const char* column : {"first", "any_of_five"}) all[column] = endings(held, of);
  json mug = all;
  mug["object"] = "mug";
  return {{"protocol", "lift_shake"},
          {"seen", "whole"},
          {"all", all},
          {"objects", {mug}},
          {"first_by_seed", {0.5, 0.7}}};
}

std::string reportOf(const std::vector<ReportedStep>& steps, bool quick = false) {
  return reproductionReport({"1.0", "b", quick, steps, {}});
}

TEST(Wilson, RangeEndsWhereTheShareIsJustPossible) {
  constexpr double z = 1.959963984540054;
  for (const auto& [held, of] : {std::pair{3, 17}, {9, 10}, {50, 100}, {1, 2}}) {
    const ShareRange range = wilson(held, of);
    for (const double p : {range.low, range.high})
      EXPECT_NEAR(std::abs(static_cast<double>(held) / of - p), z * std::sqrt(p * (1 - p) / of), 1e-12)
          << held << " of " << of;
    EXPECT_LT(range.low, range.high);
  }
}

TEST(Wilson, OfNothingIsAnythingAndOfAllIsNeverBeyondOne) {
  EXPECT_EQ(wilson(0, 0).low, 0.0);
  EXPECT_EQ(wilson(0, 0).high, 1.0);
  EXPECT_NEAR(wilson(0, 5).low, 0.0, 1e-12);
  EXPECT_LE(wilson(5, 5).high, 1.0);
  EXPECT_LT(wilson(5, 5).low, 1.0);
}

TEST(ReproductionReport, HasAllSectionsEvenWithoutSteps) {
  const std::string page = reportOf({});
  for (const char* id : {"summary", "robot", "failures", "ablation", "stability", "constellations", "spread",
                         "counts", "hidden", "spans", "grasps", "commands"})
    EXPECT_THAT(page, HasSubstr(std::string("<section id=\"") + id + "\"")) << "and the contents lead there";
  EXPECT_THAT(page, HasSubstr("not measured"));
}

TEST(ReproductionReport, GivesMeansAndSpreadOverSeeds) {
  const std::string page = reportOf({stepOf("stability_1", "stability", stabilityOf(88)),
                                     stepOf("stability_2", "stability", stabilityOf(94))});
  EXPECT_THAT(page, HasSubstr("91.0 &plusmn; 4.2")) << "mean and standard deviation of 88 and 94";
  EXPECT_THAT(page, HasSubstr("met")) << "91 is at least 90";
}

TEST(ReproductionReport, JudgesGoalsByTheSharesHeld) {
  const auto pageWith = [](int held) {
    return reportOf({stepOf("rates_whole_lift_shake", "rates", ratesOf(held, 20))});
  };
  EXPECT_THAT(pageWith(17), HasSubstr("<span class=\"met\">met</span>")) << "17 of 20 are 85 %";
  EXPECT_THAT(pageWith(17), HasSubstr("met</span>, but its range reaches below")) << "20 plans say little";
  EXPECT_THAT(pageWith(16), Not(HasSubstr("<span class=\"met\">")));
  EXPECT_THAT(pageWith(16), HasSubstr("5.0 points short"));
  EXPECT_THAT(pageWith(16), HasSubstr("data-from=\"rates_whole_lift_shake#/all/first/held\""));
}

TEST(ReproductionReport, SetsEachChangeBesideTheDefault) {
  ReportedStep changed = stepOf("ablation_coarse", "ablation", ratesOf(8, 20));
  changed.subject = "coarser <boxes>";
  const std::string page = reportOf({stepOf("ablation_default_whole", "ablation", ratesOf(15, 20)), changed});
  EXPECT_THAT(page,
              AllOf(HasSubstr("coarse</td><td>coarser &lt;boxes&gt;</td><td>whole</td>"), HasSubstr("-35.0")))
      << "what was changed, and 8 of 20 less 15 of 20";
}

TEST(ReproductionReport, NamesWhatFailedAndEscapesIt) {
  ReportedStep failed = stepOf("spread_mug", "spread", {});
  failed.error = "exit code 3: <b> is no mesh";
  const std::string page = reportOf({failed}, true);
  EXPECT_THAT(page, HasSubstr("spread_mug failed: exit code 3: &lt;b&gt; is no mesh"));
  EXPECT_THAT(page, HasSubstr("A quick run"));
  EXPECT_THAT(reportOf({stepOf("rates_view_lift_shake", "rates", ratesOf(1, 3))}),
              HasSubstr("2 lost &lt;in&gt; lift"));
}

}  // namespace
}  // namespace boxgrasp
