#include "boxgrasp/synthesis/contours.h"

#include <gmock/gmock.h>

#include <numeric>

#include "boxgrasp/base/error.h"
#include "boxgrasp/geometry/polygon.h"
#include "drawings.h"

namespace boxgrasp {
namespace {

using test::Blob;
using test::drawn;
using test::drawnFlat;
using test::kPixel_m;
using test::lengthOf;

std::vector<Contour> ofKind(const std::vector<Contour>& contours, ContourKind kind) {
  std::vector<Contour> found;
  for (const auto& contour : contours) {
    if (contour.kind == kind) found.push_back(contour);
  }
  return found;
}

Vector2d leftOf(const Contour& contour, std::size_t i) {
  const std::size_t n = contour.points_F.size();
  const std::size_t before = contour.closed || i > 0 ? (i + n - 1) % n : i;
  const std::size_t behind = contour.closed || i + 1 < n ? (i + 1) % n : i;
  const Vector2d t = (contour.points_F[behind] - contour.points_F[before]).normalized();
  return {-t.y(), t.x()};
}

std::uint8_t grayAt(const FaceImage& image, const Vector2d& p_F) {
  const Vector2d pixel = image.toPixel(p_F);
  return image.at(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
}

// Steps off every point of the contour to both sides.
void expectMaterialOnTheLeft(const FaceImage& image, const Contour& contour, double step_m) {
  int wrong = 0;
  for (std::size_t i = 0; i < contour.points_F.size(); ++i) {
    const Vector2d off = step_m * leftOf(contour, i);
    wrong += grayAt(image, contour.points_F[i] + off) <= grayAt(image, contour.points_F[i] - off);
  }
  EXPECT_EQ(wrong, 0) << "of " << contour.points_F.size() << " points";
}

// For every point that surface(unit direction, height) gives, the projected image of a cloud of them.
template <typename Surface>
FaceImage projected(int points, double noise_m, const Vector2d& size, double depth_m, double spacing_m,
                    Surface&& surface) {
  std::mt19937_64 random(7);
  PointCloud cloud;
  for (int i = 0; i < points; ++i) {
    const Vector3d shake(normal(random), normal(random), normal(random));
    cloud.push(surface(random) + noise_m * shake);
  }
  Face face;
  face.size = size;
  face.depth_m = depth_m;
  std::vector<std::uint32_t> all(cloud.size());
  std::iota(all.begin(), all.end(), 0u);
  return filled(projectFace(face, cloud, all, spacing_m));
}

TEST(Contours, ADiscHasOneClosedRoundContour) {
  for (const double radius : {0.010, 0.025, 0.06}) {
    const FaceImage image = drawnFlat(161, [&](const Vector2d& p) { return p.norm() <= radius; });
    const auto contours = findContours(image);
    ASSERT_EQ(contours.size(), 1u);
    EXPECT_EQ(contours[0].kind, ContourKind::outer);
    EXPECT_TRUE(contours[0].closed);
    for (const auto& p : contours[0].points_F) EXPECT_NEAR(p.norm(), radius, 0.8 * kPixel_m);
    EXPECT_NEAR(lengthOf(contours[0]), 2 * std::numbers::pi * radius, 0.03 * 2 * std::numbers::pi * radius);
  }
}

TEST(Contours, PointsAreOnePixelApart) {
  const auto contours = findContours(drawnFlat(161, [](const Vector2d& p) { return p.norm() <= 0.05; }));
  ASSERT_EQ(contours.size(), 1u);
  const auto& points = contours[0].points_F;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR((points[(i + 1) % points.size()] - points[i]).norm(), kPixel_m, 0.02 * kPixel_m);
  }
}

TEST(Contours, EdgesOfATurnedRectangleAreFoundToHalfAPixel) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 10; ++trial) {
    const Eigen::Rotation2Dd turn(uniform(random, 0, 3));
    const Vector2d half(0.045, 0.025);
    const auto inside = [&](const Vector2d& p) {
      return ((turn * p).cwiseAbs().array() <= half.array()).all();
    };
    const auto contours = findContours(drawnFlat(141, inside));
    ASSERT_EQ(contours.size(), 1u);
    for (const auto& p : contours[0].points_F) {
      const Vector2d off = (turn * p).cwiseAbs() - half;
      const bool corner = off.minCoeff() > -0.006;
      if (corner) continue;
      EXPECT_NEAR(off.maxCoeff(), 0.0, 0.6 * kPixel_m);
    }
  }
}

TEST(Contours, TheMaterialIsOnTheLeft) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const Blob blob(0.05, 0.12, random), hole(0.015, 0.1, random);
    const FaceImage image =
        drawnFlat(221, [&](const Vector2d& p) { return blob.contains(p) && !hole.contains(p); });
    const auto contours = findContours(image);
    ASSERT_EQ(contours.size(), 2u) << "trial " << trial;
    for (const auto& contour : contours) {
      EXPECT_TRUE(contour.closed);
      expectMaterialOnTheLeft(image, contour, 0.003);
      const double area = signedArea(contour.points_F);
      EXPECT_EQ(contour.kind, area > 0 ? ContourKind::outer : ContourKind::inner);
    }
  }
}

TEST(Contours, ARingHasAnOuterAndAnInnerContour) {
  const FaceImage image =
      drawnFlat(141, [](const Vector2d& p) { return p.norm() <= 0.05 && p.norm() >= 0.03; });
  const auto contours = findContours(image);
  ASSERT_EQ(contours.size(), 2u);
  EXPECT_NEAR(lengthOf(ofKind(contours, ContourKind::outer).at(0)), 2 * std::numbers::pi * 0.05, 0.003);
  EXPECT_NEAR(lengthOf(ofKind(contours, ContourKind::inner).at(0)), 2 * std::numbers::pi * 0.03, 0.003);
}

TEST(Contours, AStepInDepthIsADepthEdgeAroundTheNearerPart) {
  for (const double radius : {0.015, 0.03}) {
    const FaceImage image = drawn(161, [&](const Vector2d& p) {
      return p.cwiseAbs().maxCoeff() > 0.06 ? std::nullopt : std::optional(p.norm() < radius ? 0.01 : 0.04);
    });
    const auto contours = findContours(image);
    ASSERT_EQ(ofKind(contours, ContourKind::outer).size(), 1u);
    const auto edges = ofKind(contours, ContourKind::depth_edge);
    ASSERT_EQ(edges.size(), 1u);
    EXPECT_TRUE(edges[0].closed);
    for (const auto& p : edges[0].points_F) EXPECT_NEAR(p.norm(), radius, kPixel_m);
    EXPECT_NEAR(lengthOf(edges[0]), 2 * std::numbers::pi * radius, 0.2 * radius);
    expectMaterialOnTheLeft(image, edges[0], 0.003);
  }
}

TEST(Contours, AnOpenDepthEdgeRunsUpToTheSilhouettesAndDoesNotTearThem) {
  const FaceImage image = drawn(161, [](const Vector2d& p) {
    return p.cwiseAbs().maxCoeff() > 0.05 ? std::nullopt
                                          : std::optional(p.x() + 0.3 * p.y() < 0 ? 0.01 : 0.05);
  });
  const auto contours = findContours(image);
  const auto outer = ofKind(contours, ContourKind::outer), edges = ofKind(contours, ContourKind::depth_edge);
  ASSERT_EQ(outer.size(), 1u);
  EXPECT_TRUE(outer[0].closed);
  EXPECT_NEAR(lengthOf(outer[0]), 0.4, 0.012);
  ASSERT_EQ(edges.size(), 1u);
  EXPECT_FALSE(edges[0].closed);
  EXPECT_NEAR(lengthOf(edges[0]), 0.1 * std::hypot(1, 0.3) - 0.010, 0.003) << "2 sigma short at each end";
  for (const auto& p : edges[0].points_F) EXPECT_NEAR(p.x() + 0.3 * p.y(), 0.0, 0.6 * kPixel_m);
  expectMaterialOnTheLeft(image, edges[0], 0.003);
}

TEST(Contours, SmallStepsAndSteadySlopesAreNoDepthEdges) {
  const auto edgesOf = [](auto&& depth) {
    const FaceImage image = drawn(161, [&](const Vector2d& p) {
      return p.cwiseAbs().maxCoeff() > 0.05 ? std::nullopt : std::optional<double>(depth(p));
    });
    return ofKind(findContours(image), ContourKind::depth_edge).size();
  };
  EXPECT_EQ(edgesOf([](const Vector2d& p) { return p.x() < 0 ? 0.040 : 0.050; }), 1u);
  EXPECT_EQ(edgesOf([](const Vector2d& p) { return p.x() < 0 ? 0.040 : 0.046; }), 0u);
  EXPECT_EQ(edgesOf([](const Vector2d& p) { return 0.01 + 0.8 * (p.x() + 0.05); }), 0u);
  EXPECT_EQ(edgesOf([](const Vector2d& p) { return 0.005 + std::abs(p.x()) * 1.8; }), 0u) << "a roof";
  std::mt19937_64 random(5);
  const auto noisyCylinder = [&](const Vector2d& p) {
    return 0.06 - std::sqrt(0.0026 - p.x() * p.x()) + 0.0005 * normal(random);
  };
  EXPECT_EQ(edgesOf(noisyCylinder), 0u) << "steep towards its silhouettes";
}

TEST(Contours, AutomaticThresholdsLeaveTheirShareOfThePixelsBelow) {
  const FaceImage image = drawn(161, [](const Vector2d& p) {
    if (p.cwiseAbs().maxCoeff() > 0.06) return std::optional<double>();
    return std::optional(p.x() < -0.02 ? 0.01 : p.x() < 0.02 ? 0.03 : 0.08);
  });
  const auto edgesWith = [&](const ContourOptions& options) {
    return ofKind(findContours(image, options), ContourKind::depth_edge).size();
  };
  EXPECT_EQ(edgesWith({}), 2u) << "flat pixels are the most, so any step is above";
  // Each step raises the gradient of about a tenth of the pixels; the larger step has 2.5 times the smaller
  // one's.
  EXPECT_EQ(edgesWith({.high_quantile = 0.98}), 1u) << "the smaller step is nowhere above the high threshold";
  EXPECT_EQ(edgesWith({.high_quantile = 0.98, .low_fraction = 1.0}), 1u);
}

TEST(Contours, AnEdgeGoesOnBelowTheHighThresholdWhereItIsLinked) {
  const FaceImage image = drawn(161, [](const Vector2d& p) {
    if (p.cwiseAbs().maxCoeff() > 0.06) return std::optional<double>();
    return std::optional(p.x() < 0 ? 0.01 : 0.01 + 0.04 + 0.5 * p.y());
  });
  const auto longestWith = [&](double low_fraction) {
    double longest = 0.0;
    for (const auto& edge : ofKind(findContours(image, {.high_quantile = 0.95, .low_fraction = low_fraction}),
                                   ContourKind::depth_edge))
      longest = std::max(longest, lengthOf(edge));
    return longest;
  };
  EXPECT_GT(longestWith(0.4), longestWith(1.0) + 0.01);
  EXPECT_GT(longestWith(1.0), 0.01);
}

// Curved surfaces fade towards their silhouettes: there automatic thresholds on the whole image lose parts of
// it.
TEST(Contours, CurvedNoisyAndSparseSurfacesHaveCompleteSilhouettes) {
  const auto onSphere = [](std::mt19937_64& random) -> Vector3d {
    const Vector3d v(normal(random), normal(random), normal(random));
    return 0.04 * v.normalized() + Vector3d(0, 0, 0.04);
  };
  const auto onCylinder = [](std::mt19937_64& random) -> Vector3d {
    const double angle = uniform(random, 0, 2 * std::numbers::pi);
    return {uniform(random, -0.05, 0.05), 0.034 * std::cos(angle), 0.034 + 0.034 * std::sin(angle)};
  };
  for (const auto& [points, noise, spacing] :
       {std::tuple{30000, 0.0, 0.0004}, {30000, 0.001, 0.0008}, {2500, 0.0005, 0.0014}}) {
    const auto sphere = ofKind(findContours(projected(points, noise, {0.08, 0.08}, 0.08, spacing, onSphere)),
                               ContourKind::outer);
    ASSERT_EQ(sphere.size(), 1u) << points << " points, noise " << noise;
    EXPECT_TRUE(sphere[0].closed);
    for (const auto& p : sphere[0].points_F) EXPECT_NEAR(p.norm(), 0.041, 0.0025 + 2 * noise);
    const auto can = ofKind(findContours(projected(points, noise, {0.1, 0.068}, 0.068, spacing, onCylinder)),
                            ContourKind::outer);
    ASSERT_EQ(can.size(), 1u);
    EXPECT_NEAR(lengthOf(can[0]), 2 * (0.102 + 0.070), 0.03);
  }
}

TEST(Contours, TheHandleOfAMugEnclosesAnInnerContour) {
  const FaceImage image = drawnFlat(201, [](const Vector2d& p) {
    const double from_handle = (p - Vector2d(0.04, 0)).norm();
    return p.cwiseAbs().cwiseQuotient(Vector2d(0.04, 0.05)).maxCoeff() <= 1 ||
           std::abs(from_handle - 0.03) < 0.005;
  });
  const auto contours = findContours(image);
  ASSERT_EQ(ofKind(contours, ContourKind::outer).size(), 1u);
  ASSERT_EQ(ofKind(contours, ContourKind::inner).size(), 1u);
  EXPECT_TRUE(ofKind(contours, ContourKind::depth_edge).empty());
}

TEST(Contours, AMirroredImageHasMirroredContours) {
  std::mt19937_64 random(3);
  const Blob blob(0.05, 0.12, random), top(0.02, 0.1, random);
  const auto shape = [&](const Vector2d& p) {
    return blob.contains(p) ? std::optional(top.contains(p) ? 0.01 : 0.05) : std::nullopt;
  };
  const auto contours = findContours(drawn(221, shape));
  const auto mirrored = findContours(drawn(221, [&](const Vector2d& p) { return shape({-p.x(), p.y()}); }));
  ASSERT_EQ(contours.size(), mirrored.size());
  const auto distanceTo = [](const std::vector<Contour>& all, ContourKind kind, const Vector2d& p) {
    double least = 1e9;
    for (const auto& contour : ofKind(all, kind)) {
      for (const auto& q : contour.points_F) least = std::min(least, (p - q).norm());
    }
    return least;
  };
  for (const auto& contour : contours) {
    for (const auto& p : contour.points_F)
      EXPECT_LT(distanceTo(mirrored, contour.kind, {-p.x(), p.y()}), 0.6 * kPixel_m);
  }
}

TEST(Contours, DegenerateImagesGiveNoContourAndNoCrash) {
  EXPECT_TRUE(findContours(FaceImage{}).empty());
  EXPECT_TRUE(findContours(test::blankImage(40, 30)).empty());
  EXPECT_TRUE(findContours(test::blankImage(1, 1)).empty());
  EXPECT_TRUE(findContours(drawnFlat(41, [](const Vector2d& p) { return p.norm() < 1e-6; })).empty())
      << "a pixel";
  for (const auto& contour :
       findContours(drawnFlat(101, [](const Vector2d& p) { return std::abs(p.y()) < 0.0016; }))) {
    EXPECT_TRUE(contour.closed) << "a thin line";
  }
}

TEST(Contours, AShapeThatFillsTheImageIsClosedOutsideOfIt) {
  const auto contours = findContours(drawnFlat(61, [](const Vector2d&) { return true; }));
  ASSERT_EQ(contours.size(), 1u);
  EXPECT_TRUE(contours[0].closed);
  EXPECT_NEAR(signedArea(contours[0].points_F), 0.061 * 0.061, 0.00005);
}

TEST(Contours, BadOptionsAreNamed) {
  ContourOptions options;
  options.canny_sigma_px = -2;
  try {
    findContours(test::blankImage(10, 10), options);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("contours.canny_sigma_px"));
    EXPECT_THAT(error.what(), testing::HasSubstr("-2"));
  }
  EXPECT_THROW(filled(test::blankImage(10, 10), {.splat_spacings = std::nan("")}), InputError);
}

}  // namespace
}  // namespace boxgrasp
