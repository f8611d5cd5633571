#include "boxgrasp/rendering/svg_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>

#include "boxgrasp/base/random.h"
#include "error_of.h"

namespace boxgrasp {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

// All matches, each with its groups: [0] the whole.
std::vector<std::vector<std::string>> matches(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::vector<std::vector<std::string>> all;
  for (std::sregex_iterator match(text.begin(), text.end(), regex), end; match != end; ++match)
    all.emplace_back(std::vector<std::string>(match->begin(), match->end()));
  return all;
}

std::size_t count(const std::string& text, const std::string& pattern) {
  return matches(text, pattern).size();
}

// Why the text is no well-formed XML; empty where it is. Knows elements, attributes and the named entities.
std::string malformed(const std::string& xml) {
  const std::string name = "[a-zA-Z][a-zA-Z0-9]*", text = "(?:[^<>&]|&(?:amp|lt|gt|quot);)*";
  const std::regex token("<(/?)(" + name + ")((?: [a-zA-Z-]+=\"(?:[^<>&\"]|&(?:amp|lt|gt|quot);)*\")*)(/?)>" +
                         text);
  std::vector<std::string> open;
  auto at = xml.cbegin();
  for (std::smatch match; at != xml.cend(); at = match[0].second) {
    if (!std::regex_search(at, xml.cend(), match, token, std::regex_constants::match_continuous))
      return "at: " + std::string(at, std::min(at + 80, xml.cend()));
    if (match.length(1)) {
      if (open.empty() || open.back() != match.str(2)) return "closes " + match.str(2);
      open.pop_back();
    } else if (!match.length(4)) {
      open.push_back(match.str(2));
    }
  }
  return open.empty() ? "" : "open: " + open.back();
}

struct Frame {
  double left, top, right, bottom;
  bool contains(double x, double y) const {
    return x >= left - 0.11 && x <= right + 0.11 && y >= top - 0.11 && y <= bottom + 0.11;
  }
};

Frame frameOf(const std::string& svg) {
  const auto frame = matches(
      svg, "class=\"frame\" x=\"([-0-9.]+)\" y=\"([-0-9.]+)\" width=\"([-0-9.]+)\" height=\"([-0-9.]+)\"");
  if (frame.size() != 1) throw std::runtime_error("not one frame");
  const auto value = [&](int i) { return std::stod(frame[0][i]); };
  return {value(1), value(2), value(1) + value(3), value(2) + value(4)};
}

// The groups of the series, without axes and legend.
std::string seriesOf(const std::string& svg) {
  const auto from = svg.find("<g class=\"series\""), to = svg.find("<g class=\"swatch\"");
  return from == std::string::npos ? "" : svg.substr(from, to == std::string::npos ? to : to - from);
}

Series scatter(std::vector<Vector2d> points) {
  return {.name = "points",
          .kind = SeriesKind::points,
          .points = std::move(points),
          .low = {},
          .marker = Marker::circle};
}

TEST(NiceTicks, CoverTheRangeInEvenRoundSteps) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20'000; ++i) {
    const double size = std::pow(10.0, uniform(random, -8, 8));
    const double low = uniform(random, -1.0, 1.0) * std::pow(10.0, uniform(random, -8, 8)), high = low + size;
    if (size < 1e-9 * std::abs(low)) continue;
    const std::vector<double> ticks = niceTicks(low, high, 6);
    EXPECT_LE(ticks.front(), low);
    EXPECT_GE(ticks.back(), high);
    ASSERT_GE(ticks.size(), 2u);
    EXPECT_LE(ticks.size(), 14u) << low << " to " << high;
    const double step = (ticks.back() - ticks.front()) / static_cast<double>(ticks.size() - 1);
    const double mantissa = step / std::pow(10.0, std::floor(std::log10(step * 1.0001)));
    EXPECT_TRUE(std::abs(mantissa - 1) < 1e-4 || std::abs(mantissa - 2) < 1e-4 ||
                std::abs(mantissa - 5) < 1e-4)
        << "step " << step;
    EXPECT_LT(low - ticks.front(), 1.001 * step) << "no empty step below";
    EXPECT_LT(ticks.back() - high, 1.001 * step) << "no empty step above";
  }
}

TEST(NiceTicks, KnowsSomeByHeart) {
  using ::testing::DoubleNear, ::testing::ElementsAre;
  const auto near = [](double value) { return DoubleNear(value, 1e-9); };
  EXPECT_THAT(niceTicks(0, 1, 5), ElementsAre(near(0), near(0.2), near(0.4), near(0.6), near(0.8), near(1)));
  EXPECT_THAT(niceTicks(3, 97, 5), ElementsAre(near(0), near(20), near(40), near(60), near(80), near(100)));
  const auto alone = niceTicks(7, 7, 5);
  EXPECT_LT(alone.front(), 7);
  EXPECT_GT(alone.back(), 7);
}

TEST(SvgPlot, EveryPointIsInTheFrameInProportion) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 30; ++round) {
    const double size = std::pow(10.0, uniform(random, -6, 6)), shift = uniform(random, -3, 3) * size;
    std::vector<Vector2d> points;
    for (int i = 0; i < 50; ++i)
      points.emplace_back(shift + size * normal(random), shift + size * uniform(random));
    Plot plot;
    plot.series = {scatter(points)};
    const std::string svg = svgOf(plot);
    ASSERT_EQ(malformed(svg), "");
    const Frame frame = frameOf(svg);
    const auto circles = matches(seriesOf(svg), "cx=\"([-0-9.]+)\" cy=\"([-0-9.]+)\"");
    ASSERT_EQ(circles.size(), points.size());
    // Affine: what three points say of the axes must hold for all. Pixels have one decimal.
    const auto pixel = [&](std::size_t i) {
      return Vector2d(std::stod(circles[i][1]), std::stod(circles[i][2]));
    };
    const auto by_x =
        std::minmax_element(points.begin(), points.end(), [](auto& a, auto& b) { return a.x() < b.x(); });
    const std::size_t least = by_x.first - points.begin(), most = by_x.second - points.begin();
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_TRUE(frame.contains(pixel(i).x(), pixel(i).y())) << circles[i][0];
      const double share = (points[i].x() - points[least].x()) / (points[most].x() - points[least].x());
      EXPECT_NEAR(pixel(i).x(), pixel(least).x() + share * (pixel(most).x() - pixel(least).x()), 0.15);
    }
    const auto by_y =
        std::max_element(points.begin(), points.end(), [](auto& a, auto& b) { return a.y() < b.y(); });
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_GE(pixel(i).y(), pixel(by_y - points.begin()).y()) << "greater values are higher up";
  }
}

TEST(SvgPlot, TickNamesSayWhereTheyStand) {
  Plot plot;
  plot.series = {scatter({{0.013, -20}, {0.071, 135}})};
  const std::string svg = svgOf(plot);
  const auto ticks = [&](const std::string& axis, int coordinate) {
    const auto from = svg.find("<g class=\"" + axis + "\"");
    std::vector<Vector2d> result;  // value, pixel
    for (const auto& text : matches(svg.substr(from, svg.find("</g>", from) - from),
                                    "<text x=\"([0-9.]+)\" y=\"([0-9.]+)\"[^>]*>([^<]*)<"))
      result.emplace_back(std::stod(text[3]), std::stod(text[coordinate]));
    return result;
  };
  const auto x = ticks("x-ticks", 1), y = ticks("y-ticks", 2);
  const auto circle = matches(seriesOf(svg), "cx=\"([-0-9.]+)\" cy=\"([-0-9.]+)\"").front();
  const auto interpolated = [](const std::vector<Vector2d>& t, double value) {
    return t.front().y() +
           (value - t.front().x()) / (t.back().x() - t.front().x()) * (t.back().y() - t.front().y());
  };
  EXPECT_LE(x.front().x(), 0.013);
  EXPECT_GE(x.back().x(), 0.071);
  EXPECT_NEAR(std::stod(circle[1]), interpolated(x, 0.013), 0.2);
  EXPECT_NEAR(std::stod(circle[2]), interpolated(y, -20) - 0.35 * PlotOptions().font_px, 0.2);
}

TEST(SvgPlot, TextIsEscapedWhateverItsBytes) {
  const std::string nasty = "<a & \"b\"> \x01 \xCE\xB5 \xFF\xC0\xAF </svg>";
  Plot plot;
  plot.title = plot.subtitle = plot.x.label = plot.y.label = plot.second_y.label = nasty;
  plot.x.categories = {nasty, nasty};
  plot.series = {scatter({{0, 1}, {1, 2}})};
  plot.series[0].name = nasty;
  plot.series[0].second_axis = true;
  const std::string svg = svgOf(plot);
  EXPECT_EQ(malformed(svg), "");
  EXPECT_THAT(svg, HasSubstr("&lt;a &amp; &quot;b&quot;&gt;   \xCE\xB5 ??? &lt;/svg&gt;"));
}

TEST(SvgPlot, ValuesThatAreNoNumbersAreLeftOutAndBreakALine) {
  Plot plot;
  Series series = scatter({{0, 0}, {1, NAN}, {INFINITY, 1}, {1, -INFINITY}, {2, 1}, {3, 1e200}, {4, 2}});
  plot.series = {series};
  EXPECT_EQ(count(seriesOf(svgOf(plot)), "<circle"), 3u);
  plot.series[0].kind = SeriesKind::line;
  EXPECT_EQ(count(seriesOf(svgOf(plot)), "M[0-9]"), 3u) << "three pieces";
  EXPECT_THAT(svgOf(plot), Not(::testing::ContainsRegex("nan|inf|e[+]")));
  plot.series[0].points = {{NAN, NAN}};
  EXPECT_EQ(malformed(svgOf(plot)), "");
  plot.series.clear();
  EXPECT_EQ(malformed(svgOf(plot)), "") << "an empty plot is a plot";
}

TEST(SvgPlot, SecondAxisHasAScaleOfItsOwn) {
  Plot plot;
  Series success = scatter({{1, 0.01}, {2, 0.05}}), time = scatter({{1, 1000}, {2, 5000}});
  time.second_axis = true;
  plot.series = {success, time};
  const std::string svg = svgOf(plot);
  EXPECT_EQ(count(svg, "second-y-ticks"), 1u);
  const auto circles = matches(seriesOf(svg), "cy=\"([-0-9.]+)\"");
  ASSERT_THAT(circles, SizeIs(4));
  EXPECT_EQ(circles[0][1], circles[2][1]) << "same share of either axis";
  EXPECT_EQ(circles[1][1], circles[3][1]);
}

TEST(SvgPlot, BarsStandSideBySideOnZero) {
  Plot plot;
  plot.x.categories = {"held", "lost"};
  plot.y.low = -1.0;
  for (const double sign : {1.0, -1.0})
    plot.series.push_back(
        {.name = "s", .kind = SeriesKind::bars, .points = {{0, sign * 2}, {1, sign * 3}}, .low = {}});
  const std::string svg = svgOf(plot);
  const Frame frame = frameOf(svg);
  std::vector<std::array<double, 4>> bars;
  for (const auto& bar :
       matches(seriesOf(svg), "x=\"([-0-9.]+)\" y=\"([-0-9.]+)\" width=\"([-0-9.]+)\" height=\"([-0-9.]+)\""))
    bars.push_back({std::stod(bar[1]), std::stod(bar[2]), std::stod(bar[3]), std::stod(bar[4])});
  ASSERT_THAT(bars, SizeIs(4));
  const double zero = bars[0][1] + bars[0][3];
  EXPECT_NEAR(bars[2][1], zero, 0.02) << "negative bars hang from zero";
  EXPECT_NEAR(bars[1][3] / bars[0][3], 1.5, 0.01);
  for (const auto& bar : bars) {
    EXPECT_TRUE(frame.contains(bar[0], bar[1])) << bar[0];
    EXPECT_TRUE(frame.contains(bar[0] + bar[2], bar[1] + bar[3])) << bar[0];
  }
  std::sort(bars.begin(), bars.end());
  for (std::size_t i = 0; i + 1 < bars.size(); ++i) EXPECT_LE(bars[i][0] + bars[i][2], bars[i + 1][0] + 0.02);
}

TEST(SvgPlot, SpansReachFromLowToHigh) {
  Plot plot;
  plot.series = {{.name = "", .kind = SeriesKind::spans, .points = {{0, 1}, {1, 2}}, .low = {0, 0.5}}};
  EXPECT_EQ(count(seriesOf(svgOf(plot)), "class=\"span\" d=\"M[0-9.]+ [0-9.]+V[0-9.]+\""), 2u);
  EXPECT_EQ(count(svgOf(plot), "swatch"), 0u) << "nameless series stay out of the legend";
  plot.series[0].low.pop_back();
  EXPECT_THAT(test::errorOf([&] { svgOf(plot); }), HasSubstr("low ends"));
}

TEST(SvgPlot, StaysWholeWhereThereIsHardlyRoom) {
  Plot plot;
  plot.title = plot.x.label = std::string(300, 'x');
  for (int i = 0; i < 40; ++i) {
    plot.x.categories.push_back("a rather long name");
    plot.series.push_back(scatter({{i + 0.0, 1e7 * i}}));
    plot.series.back().name = "another name";
  }
  const std::string svg = svgOf(plot, {.width_px = 100, .height_px = 100});
  EXPECT_EQ(malformed(svg), "");
  const Frame frame = frameOf(svg);
  EXPECT_LT(frame.left, frame.right);
  EXPECT_LT(frame.top, frame.bottom);
}

TEST(SvgPlot, RefusesBadOptionsAndUnwritableFilesByName) {
  EXPECT_THAT(test::errorOf([] { svgOf({}, {.width_px = 1}); }), HasSubstr("width_px"));
  EXPECT_THAT(test::errorOf([] { svgOf({}, {.font_px = NAN}); }), HasSubstr("font_px"));
  EXPECT_THAT(test::errorOf([] { writeSvg({}, "/no such folder/plot.svg"); }),
              HasSubstr("/no such folder/plot.svg"));
}

}  // namespace
}  // namespace boxgrasp
