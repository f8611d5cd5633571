// The drawing of a hand: everything is on it, where the kinematics say.
#include "boxgrasp/rendering/hand_picture.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <regex>

#include "error_of.h"

namespace boxgrasp {
namespace {

using testing::HasSubstr;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

// Share of the pixels of one panel that are not white.
double ink(const cv::Mat3b& image, int column, int row, int side) {
  int n = 0;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) n += image(row * side + y, column * side + x) != cv::Vec3b(255, 255, 255);
  }
  return n / double(side * side);
}

TEST(HandPicture, HasSixPanelsWithAHandInEach) {
  const cv::Mat3b image = drawHand(barrettHand(), {.panel_px = 200});
  ASSERT_EQ(image.cols, 600);
  ASSERT_EQ(image.rows, 400);
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 3; ++column)
      EXPECT_GT(ink(image, column, row, 200), 0.08) << column << " " << row;
  }
  // Nothing is cut off at the borders.
  for (int x = 0; x < image.cols; ++x) EXPECT_EQ(image(image.rows - 1, x), cv::Vec3b(255, 255, 255)) << x;
}

// Of each panel nine links, two frames' worth of axes and the palm; a link's line is as wide as the link.
TEST(HandPicture, SvgHasEveryLinkInItsSize) {
  const std::string svg = handSvg(barrettHand(), {.panel_px = 300});
  EXPECT_EQ(count(svg, "stroke-linecap=\"round\""), 6u * 9u);
  EXPECT_EQ(count(svg, "<circle"), 3u) << "the palm from before";
  EXPECT_EQ(count(svg, "<rect x="), 3u) << "the palm from the side";
  EXPECT_EQ(count(svg, "<g "), count(svg, "</g>"));
  EXPECT_THAT(svg, HasSubstr("half closed, from the side"));
  // 50 mm of scale against twice the knuckle's radius.
  std::smatch scale;
  ASSERT_TRUE(std::regex_search(svg, scale, std::regex("M10,290 H([0-9.]+)")));
  const double px_per_m = (std::stod(scale[1]) - 10) / 0.05;
  EXPECT_THAT(svg,
              HasSubstr(fmt::format("stroke-width=\"{:.1f}", 2 * barrettHand().knuckle_radius * px_per_m)));
}

TEST(HandPicture, TheEndingSaysWhatIsWritten) {
  const auto folder = std::filesystem::temp_directory_path() / ("boxgrasp_hand_" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  const auto begin = [&](const char* name) {
    writeHandPicture(barrettHand(), folder / name, {.panel_px = 60});
    std::string text(4, ' ');
    std::ifstream(folder / name, std::ios::binary).read(text.data(), 4);
    return text;
  };
  EXPECT_EQ(begin("hand.png"), "\x89PNG");
  EXPECT_EQ(begin("hand.svg"), "<svg");
  EXPECT_THAT(test::errorOf([&] { writeHandPicture(barrettHand(), folder / "hand.jpg"); }),
              HasSubstr("name it .png or .svg"));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace boxgrasp
