#include "boxgrasp/projection/face_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "boxgrasp/base/error.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

Face faceAt(const Pose& X_CF, const Vector2d& size = {0.08, 0.05}, double depth_m = 0.04) {
  Face face;
  face.X_CF = X_CF;
  face.size = size;
  face.depth_m = depth_m;
  return face;
}

// Points in F, up to `over` times the box's size outside of it.
std::vector<Vector3d> randomPoints(const Face& face, int n, double over, std::mt19937_64& random) {
  std::vector<Vector3d> points;
  for (int i = 0; i < n; ++i) {
    const double x = uniform(random, -0.5 - over, 0.5 + over), y = uniform(random, -0.5 - over, 0.5 + over);
    points.emplace_back(x * face.size.x(), y * face.size.y(),
                        uniform(random, -over, 1 + over) * face.depth_m);
  }
  return points;
}

PointCloud cloudOf(const std::vector<Vector3d>& points_F, const Pose& X_CF) {
  PointCloud cloud;
  for (const auto& p : points_F) cloud.push(X_CF * p);
  return cloud;
}

FaceImage project(const Face& face, const PointCloud& cloud, const ImageOptions& options = {}) {
  std::vector<std::uint32_t> all(cloud.size());
  std::iota(all.begin(), all.end(), 0u);
  return projectFace(face, cloud, all, 0.001, options);
}

TEST(FaceImage, EveryPixelHoldsItsNearestAndItsFarthestPoint) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 4; ++trial) {
    const Face face = faceAt(test::randomPose(random));
    const auto points_F = randomPoints(face, 1500, 0.0, random);
    const FaceImage image = project(face, cloudOf(points_F, face.X_CF));
    for (int row = 0; row < image.height; ++row) {
      for (int column = 0; column < image.width; ++column) {
        const Vector2d centre = image.toFace(Vector2d(column, row));
        double near = 1e9, far = -1e9;
        bool certain = true;
        for (const Vector3d& p : points_F) {
          const double off = (p.head<2>() - centre).lpNorm<Eigen::Infinity>() / image.pixel_m;
          if (std::abs(off - 0.5) < 1e-3) certain = false;
          if (off > 0.5) continue;
          near = std::min(near, p.z());
          far = std::max(far, p.z());
        }
        if (!certain) continue;
        const std::size_t pixel = static_cast<std::size_t>(row) * image.width + column;
        if (near > far) {
          EXPECT_EQ(image.gray[pixel], 0);
          EXPECT_EQ(image.farthest[pixel], 0);
          continue;
        }
        EXPECT_NEAR(image.gray[pixel], 255 - 254 * std::clamp(near / face.depth_m, 0.0, 1.0), 0.51);
        EXPECT_NEAR(image.farthest[pixel], 255 - 254 * std::clamp(far / face.depth_m, 0.0, 1.0), 0.51);
      }
    }
  }
}

TEST(FaceImage, GrayTellsTheDepth) {
  const Face face = faceAt(Pose::Identity());
  const FaceImage image =
      project(face, cloudOf({{0, 0, 0}, {0.01, 0, face.depth_m}, {0.02, 0, 0.013}}, face.X_CF));
  const auto gray = [&](double x) {
    const Vector2d pixel = image.toPixel({x, 0});
    return image.at(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
  };
  EXPECT_EQ(gray(0), 255) << "at the face";
  EXPECT_EQ(gray(0.01), 1) << "at the far side";
  EXPECT_EQ(gray(0.03), 0) << "where nothing is";
  EXPECT_DOUBLE_EQ(image.depthOf(255), 0.0);
  EXPECT_DOUBLE_EQ(image.depthOf(1), face.depth_m);
  EXPECT_NEAR(image.depthOf(gray(0.02)), 0.013, 0.51 * face.depth_m / 254);
}

TEST(FaceImage, AMirroredCloudGivesAMirroredImage) {
  std::mt19937_64 random(2);
  const Face face = faceAt(Pose::Identity(), {0.0813, 0.0507});
  const auto points = randomPoints(face, 5000, 0.0, random);
  auto mirrored = points;
  for (auto& p : mirrored) p.x() = -p.x();
  const FaceImage image = project(face, cloudOf(points, face.X_CF));
  const FaceImage mirror = project(face, cloudOf(mirrored, face.X_CF));
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      ASSERT_EQ(image.at(column, row), mirror.at(image.width - 1 - column, row))
          << "at " << column << ", " << row;
    }
  }
}

TEST(FaceImage, PointsOutsideTheBoxCountAsOnItsBorder) {
  std::mt19937_64 random(3);
  const Face face = faceAt(Pose::Identity());
  auto points = randomPoints(face, 5000, 0.3, random);
  const FaceImage image = project(face, cloudOf(points, face.X_CF));
  for (auto& p : points) {
    p = p.cwiseMin(Vector3d(0.04, 0.025, 0.04)).cwiseMax(Vector3d(-0.04, -0.025, 0));
  }
  const FaceImage clamped = project(face, cloudOf(points, face.X_CF));
  EXPECT_EQ(image.gray, clamped.gray);
  EXPECT_EQ(image.farthest, clamped.farthest);
}

TEST(FaceImage, TheMiddleIsTheOriginAndTheBorderIsEmpty) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 20; ++trial) {
    const Face face = faceAt(Pose::Identity(), {uniform(random, 0.03, 0.2), uniform(random, 0.005, 0.03)});
    const ImageOptions options{.pixel_m = uniform(random, 0.0005, 0.003)};
    const FaceImage image = project(face, cloudOf(randomPoints(face, 2000, 0.0, random), face.X_CF), options);
    EXPECT_EQ(image.toPixel({0, 0}), Vector2d(image.width - 1, image.height - 1) / 2);
    EXPECT_EQ(image.width % 2, 1);
    const Vector2d p(uniform(random), uniform(random));
    EXPECT_LT((image.toFace(image.toPixel(p)) - p).norm(), 1e-12);
    for (int row = 0; row < image.height; ++row) {
      for (int column = 0; column < image.width; ++column) {
        const int border = std::min({row, column, image.height - 1 - row, image.width - 1 - column});
        if (border >= options.border_px) continue;
        ASSERT_EQ(image.at(column, row), 0);
      }
    }
  }
}

TEST(FaceImage, AHugeFaceGetsLargerPixels) {
  const Face face = faceAt(Pose::Identity(), {5.0, 0.1}, 0.1);
  const FaceImage image =
      project(face, cloudOf({{2.5, 0.05, 0}, {-2.5, -0.05, 0.1}}, face.X_CF), {.max_side_px = 500});
  EXPECT_LE(image.width, 500);
  EXPECT_GE(image.width, 495) << "no larger pixels than needed";
  EXPECT_NEAR(image.pixel_m * (image.width - 25), 5.0, 0.05);
  EXPECT_EQ(std::count_if(image.gray.begin(), image.gray.end(), [](auto g) { return g > 0; }), 2);
}

TEST(FaceImage, NoPointsGiveAnEmptyImage) {
  const FaceImage image = project(faceAt(Pose::Identity()), {});
  EXPECT_EQ(image.gray.size(), static_cast<std::size_t>(image.width) * image.height);
  EXPECT_EQ(std::count(image.gray.begin(), image.gray.end(), 0),
            static_cast<std::ptrdiff_t>(image.gray.size()));
}

TEST(FaceImage, BadOptionsAreRefused) {
  EXPECT_THROW(project(faceAt(Pose::Identity()), {}, {.pixel_m = 0.0}), InputError);
  EXPECT_THROW(project(faceAt(Pose::Identity()), {}, {.pixel_m = std::nan("")}), InputError);
  EXPECT_THROW(project(faceAt(Pose::Identity()), {}, {.border_px = -1}), InputError);
  EXPECT_THROW(project(faceAt(Pose::Identity()), {}, {.max_side_px = 20}), InputError);
}

}  // namespace
}  // namespace boxgrasp
