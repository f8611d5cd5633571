#include "boxgrasp/rendering/filmstrip.h"

#include <gmock/gmock.h>

#include "boxgrasp/rendering/hand_mesh.h"
#include "error_of.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

using namespace test;

TriangleMesh ball() { return capsuleMesh({-0.01, 0, 0}, {0.01, 0, 0}, 0.03); }

FilmFrame frameAt(const Pose& X_WP) {
  FilmFrame frame{"caption", "remark", X_WP, X_WP * Eigen::Translation3d(0, 0, 0.06), {}, {}};
  for (Capsule link : forwardKinematics(barrettHand(), {0.0, {1.0, 1.0, 1.0}}).links) {
    link.a = X_WP * link.a;
    link.b = X_WP * link.b;
    frame.links_W.push_back(link);
  }
  return frame;
}

Film oneFrame(const Pose& X_WP) { return {"title", "subtitle", ball(), {frameAt(X_WP)}, 0}; }

// The pictures of frame i, below its caption.
cv::Mat3b pictures(const cv::Mat3b& sheet, int i, const FilmOptions& options) {
  return sheet(cv::Rect(i * options.panel_px, sheet.rows - 2 * options.panel_px, options.panel_px,
                        2 * options.panel_px));
}

int differences(const cv::Mat3b& a, const cv::Mat3b& b) {
  cv::Mat3b difference;
  cv::absdiff(a, b, difference);
  return cv::countNonZero(difference.reshape(1));
}

TEST(Filmstrip, LooksFromTwoSidesALittleFromAboveAcrossTheHand) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 100; ++i) {
    const Vector3d up_W = randomPose(random).linear().col(0);
    const Pose X_WP = randomPose(random);
    const auto [first, second] = filmViews(X_WP, up_W);
    for (const Vector3d& view : {first, second}) {
      EXPECT_NEAR(view.norm(), 1, 1e-12);
      EXPECT_LT(view.dot(up_W), -0.2) << "downwards";
    }
    const double turn = std::acos(std::clamp(std::abs(first.dot(second)), 0.0, 1.0));
    EXPECT_GT(turn, 60 * std::numbers::pi / 180) << "between the views";
    EXPECT_LT(std::abs(first.dot(X_WP.linear().col(2))), 0.8) << "the palm hides nothing";
  }
}

TEST(Filmstrip, SheetHoldsAllFramesInRows) {
  Film film = oneFrame(Pose::Identity());
  film.frames.assign(7, film.frames[0]);
  FilmOptions options{.panel_px = 80, .columns = 3};
  const cv::Mat3b sheet = drawFilm(film, barrettHand(), options);
  EXPECT_EQ(sheet.cols, 3 * 80);
  options.columns = 100;
  const cv::Mat3b strip = drawFilm(film, barrettHand(), options);
  EXPECT_EQ(strip.cols, 7 * 80) << "no empty columns";
  EXPECT_EQ((sheet.rows - strip.rows) % 2, 0) << "three rows instead of one";
  EXPECT_GT(sheet.rows, strip.rows + 4 * 80);
  for (int i = 1; i < 7; ++i)
    EXPECT_EQ(differences(pictures(strip, 0, options), pictures(strip, i, options)), 0) << "frame " << i;
}

TEST(Filmstrip, PictureDoesNotDependOnWhereTheWorldBegins) {
  std::mt19937_64 random(6);
  const Pose X_WP = randomPose(random);
  const cv::Mat3b here = drawFilm(oneFrame(X_WP), barrettHand());
  const cv::Mat3b there = drawFilm(oneFrame(Eigen::Translation3d(0.5, -1, 2) * X_WP), barrettHand());
  EXPECT_LT(differences(here, there), here.total() / 200) << "but for rounding";
}

TEST(Filmstrip, ViewsGoWithTheLiftedHandAndStandStillBeforeIt) {
  Film film = oneFrame(Pose::Identity());
  film.frames = {frameAt(Pose(Eigen::Translation3d(0, 0, -0.05))), frameAt(Pose::Identity()),
                 frameAt(Pose(Eigen::Translation3d(0, 0, 0.2)))};
  film.grasped = 1;
  const FilmOptions options{.panel_px = 120};
  const cv::Mat3b sheet = drawFilm(film, barrettHand(), options);
  const cv::Mat3b grasped = pictures(sheet, 1, options);
  EXPECT_LT(differences(grasped, pictures(sheet, 2, options)), grasped.total() / 100);
  EXPECT_GT(differences(grasped, pictures(sheet, 0, options)), grasped.total() / 10);
}

TEST(Filmstrip, ForcesAreSeenInFrontOfEverything) {
  Film film = oneFrame(Pose::Identity());
  const cv::Mat3b without = drawFilm(film, barrettHand());
  film.frames[0].forces = {{film.frames[0].X_WO.translation(), Vector3d(10, 0, 0)}};
  const cv::Mat3b with = drawFilm(film, barrettHand());
  EXPECT_GT(differences(without, with), 100) << "though it acts inside the object";
}

TEST(Filmstrip, RefusesBadOptionsByName) {
  const auto error = [](const FilmOptions& options) {
    return errorOf([&] { drawFilm(oneFrame(Pose::Identity()), barrettHand(), options); });
  };
  EXPECT_THAT(error({.panel_px = 10}), testing::HasSubstr("panel_px"));
  EXPECT_THAT(error({.columns = 0}), testing::HasSubstr("columns"));
  EXPECT_THAT(error({.newton_m = -1}), testing::HasSubstr("newton_m"));
}

}  // namespace
}  // namespace boxgrasp
