#include "boxgrasp/rendering/canvas.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "boxgrasp/rendering/hand_mesh.h"
#include "error_of.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

using namespace test;

constexpr Colour kRed{200, 0, 0}, kBlue{0, 0, 200};

// Looks along -z of C, x to the right and y up; 100 pixels show 0.1 m.
Camera fromAbove() {
  Camera camera;
  camera.height_m = 0.1;
  return camera;
}

bool isRed(const cv::Vec3b& bgr) { return bgr[2] > 50 && bgr[0] == 0; }
bool isBlue(const cv::Vec3b& bgr) { return bgr[0] > 50 && bgr[2] == 0; }

TEST(Canvas, ShowsPointsWhereTheCameraSeesThem) {
  Canvas canvas(100, 100, fromAbove());
  canvas.point({0.02, 0.03, 0}, kRed);
  EXPECT_TRUE(isRed(canvas.image()(20, 70))) << "20 mm to the right of the middle, 30 mm above it";
  EXPECT_TRUE(canvas.pixel({0.02, 0.03, 0.7}).isApprox(Vector2d(70, 20)));
  canvas.point({5, 5, 0}, kRed);  // outside of the picture: nowhere
  EXPECT_EQ(cv::countNonZero(canvas.image().reshape(1) != 255), 3);
}

TEST(Canvas, NearerThingsHideFartherOnesInAnyOrder) {
  const std::array<Vector3d, 3> far{{{-0.04, -0.04, 0}, {0.04, -0.04, 0}, {0, 0.04, 0}}};
  std::array<Vector3d, 3> near = far;
  for (Vector3d& corner : near) corner.z() = 0.01;
  for (const bool near_first : {true, false}) {
    Canvas canvas(100, 100, fromAbove());
    canvas.triangle(near_first ? near : far, near_first ? kBlue : kRed);
    canvas.triangle(near_first ? far : near, near_first ? kRed : kBlue);
    EXPECT_TRUE(isBlue(canvas.image()(50, 50))) << "drawn " << (near_first ? "first" : "last");
  }
}

TEST(Canvas, FramingShowsAllCornersWithoutWaste) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 50; ++i) {
    std::vector<Vector3d> corners;
    for (int k = 0; k < 12; ++k) corners.push_back(randomPose(random).translation());
    const Vector3d forward = randomPose(random).linear().col(2), up = randomPose(random).linear().col(2);
    const Canvas canvas(150, 100, framing(corners, forward, up, 1.5));
    Eigen::AlignedBox2d seen;
    for (const Vector3d& corner : corners) seen.extend(canvas.pixel(corner));
    EXPECT_TRUE(Eigen::AlignedBox2d(Vector2d(0, 0), Vector2d(150, 100)).contains(seen));
    EXPECT_TRUE(seen.sizes().x() > 130 || seen.sizes().y() > 85) << seen.sizes().transpose();
    EXPECT_TRUE(seen.center().isApprox(Vector2d(75, 50), 1e-9)) << seen.center().transpose();
  }
}

TEST(Canvas, PicturesGoToFilesAsTheyAreAndNowhereWithAMessage) {
  Canvas canvas(40, 30, fromAbove());
  canvas.segment({-0.01, 0, 0}, {0.01, 0.005, 0}, kRed, 2);
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "boxgrasp_canvas_test.png";
  writePng(canvas.image(), file);
  const cv::Mat3b read = cv::imread(file.string());
  EXPECT_EQ(cv::norm(read, canvas.image(), cv::NORM_INF), 0);
  std::filesystem::remove(file);
  EXPECT_THAT(errorOf([&] { writePng(canvas.image(), "/nowhere/at/all.png"); }),
              testing::HasSubstr("/nowhere/at/all.png"));
}

double distanceToSegment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

TEST(HandMesh, LinksAreCapsulesAndThePalmIsACylinder) {
  const HandDescription& hand = barrettHand();
  const HandJoints joints{0.7, {0.3, 1.0, 2.0}};
  const HandGeometry geometry = forwardKinematics(hand, joints);
  const std::vector<DrawnPart> parts = handMesh(hand, joints);
  ASSERT_EQ(parts.size(), geometry.links.size() + 1);
  EXPECT_EQ(parts[0].finger, -1);
  for (const Vector3d& p : parts[0].mesh.vertices) {
    EXPECT_TRUE(p.z() == 0 || p.z() == -hand.palm_thickness) << p.transpose();
    EXPECT_LE(p.head<2>().norm(), hand.palm_radius + 1e-12);
  }
  for (std::size_t i = 0; i < geometry.links.size(); ++i) {
    const Capsule& link = geometry.links[i];
    EXPECT_EQ(parts[i + 1].finger, link.finger);
    for (const Vector3d& p : parts[i + 1].mesh.vertices)
      EXPECT_NEAR(distanceToSegment(p, link.a, link.b), link.radius, 1e-9) << link.name;
  }
}

}  // namespace
}  // namespace boxgrasp
