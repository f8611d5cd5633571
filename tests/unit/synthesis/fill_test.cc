// filled(): the paper's erosion and dilation (III.A).
#include <gtest/gtest.h>

#include "drawings.h"

namespace boxgrasp {
namespace {

using test::blankImage;

FaceImage randomImage(int width, int height, double occupied, std::mt19937_64& random) {
  FaceImage image = blankImage(width, height);
  for (std::size_t i = 0; i < image.gray.size(); ++i) {
    if (uniform(random) >= occupied) continue;
    image.gray[i] = static_cast<std::uint8_t>(1 + uniformIndex(random, 255));
    image.farthest[i] = static_cast<std::uint8_t>(1 + uniformIndex(random, image.gray[i]));
  }
  return image;
}

int occupiedAround(const FaceImage& image, int column, int row, int radius) {
  int count = 0;
  for (int y = std::max(0, row - radius); y <= std::min(image.height - 1, row + radius); ++y) {
    for (int x = std::max(0, column - radius); x <= std::min(image.width - 1, column + radius); ++x) {
      count += (x != column || y != row) && image.at(x, y) > 0;
    }
  }
  return count;
}

// The paper's words, pixel by pixel: drop what has fewer than two neighbours, then expand the rest to their
// eight.
FaceImage filledLiterally(const FaceImage& image) {
  FaceImage result = blankImage(image.width, image.height);
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      const std::size_t from = static_cast<std::size_t>(row) * image.width + column;
      if (image.gray[from] == 0 || occupiedAround(image, column, row, 1) < 2) continue;
      for (int y = std::max(0, row - 1); y <= std::min(image.height - 1, row + 1); ++y) {
        for (int x = std::max(0, column - 1); x <= std::min(image.width - 1, column + 1); ++x) {
          const std::size_t to = static_cast<std::size_t>(y) * image.width + x;
          result.gray[to] = std::max(result.gray[to], image.gray[from]);
          auto& farthest = result.farthest[to];
          farthest = farthest == 0 ? image.farthest[from] : std::min(farthest, image.farthest[from]);
        }
      }
    }
  }
  return result;
}

TEST(Filled, DenseImagesFollowThePapersRuleToTheLetter) {
  std::mt19937_64 random(1);
  for (const double occupied : {0.01, 0.05, 0.2, 0.6, 1.0}) {
    for (const double spacing_m : {-1.0, 0.0002, 0.0005}) {
      FaceImage image = randomImage(37, 23, occupied, random);
      image.spacing_m = spacing_m;
      const FaceImage expected = filledLiterally(image), result = filled(image);
      EXPECT_EQ(result.gray, expected.gray) << "occupied: " << occupied << ", spacing: " << spacing_m;
      EXPECT_EQ(result.farthest, expected.farthest);
    }
  }
}

// The radius in pixels that a spacing asks for, by the contract.
FaceImage withRadius(FaceImage image, int radius) {
  image.spacing_m = image.pixel_m * radius / ContourOptions{}.splat_spacings;
  return image;
}

TEST(Filled, SparseImagesAreExpandedAndTakenBackByAllButOnePixel) {
  std::mt19937_64 random(2);
  for (const int radius : {2, 3, 5}) {
    const FaceImage image = withRadius(randomImage(41, 31, 0.03, random), radius);
    const FaceImage result = filled(image);
    const auto keptAt = [&](int x, int y) {
      return x >= 0 && y >= 0 && x < image.width && y < image.height && image.at(x, y) > 0 &&
             occupiedAround(image, x, y, radius) >= 2;
    };
    const auto expandedAt = [&](int x, int y) {
      for (int dy = -radius; dy <= radius; ++dy) {
        for (int dx = -radius; dx <= radius; ++dx) {
          if (keptAt(x + dx, y + dy)) return true;
        }
      }
      return false;
    };
    const auto takenBackAt = [&](int x, int y) {
      for (int dy = 1 - radius; dy < radius; ++dy) {
        for (int dx = 1 - radius; dx < radius; ++dx) {
          if (!expandedAt(x + dx, y + dy)) return false;
        }
      }
      return true;
    };
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        ASSERT_EQ(result.at(x, y) > 0, takenBackAt(x, y)) << "radius " << radius << " at " << x << ", " << y;
      }
    }
  }
}

TEST(Filled, NearAndFarAreKnownAtTheSamePixelsAndInOrder) {
  std::mt19937_64 random(3);
  for (const int radius : {1, 3}) {
    const FaceImage result = filled(withRadius(randomImage(60, 60, 0.1, random), radius));
    for (std::size_t i = 0; i < result.gray.size(); ++i) {
      ASSERT_EQ(result.gray[i] > 0, result.farthest[i] > 0);
      ASSERT_GE(result.gray[i], result.farthest[i]);
    }
  }
}

TEST(Filled, ASparseDiscIsClosedAndDoesNotGrow) {
  std::mt19937_64 random(4);
  FaceImage image = blankImage(121, 121);
  for (int i = 0; i < 600; ++i) {
    const double angle = uniform(random, 0, 2 * std::numbers::pi), r = 0.04 * std::sqrt(uniform(random));
    const Vector2d p = image.toPixel({r * std::cos(angle), r * std::sin(angle)});
    const auto at =
        static_cast<std::size_t>(std::lround(p.y())) * 121 + static_cast<std::size_t>(std::lround(p.x()));
    image.gray[at] = image.farthest[at] = 200;
  }
  image.spacing_m = 0.0015;  // the median distance to the nearest of 0.12 random points a pixel
  const FaceImage result = filled(image);
  int holes = 0, outside = 0, inner = 0;
  for (int y = 0; y < 121; ++y) {
    for (int x = 0; x < 121; ++x) {
      const double r = result.toFace({static_cast<double>(x), static_cast<double>(y)}).norm();
      inner += r < 0.036;
      holes += r < 0.036 && result.at(x, y) == 0;
      outside += r > 0.0425 && result.at(x, y) > 0;
    }
  }
  EXPECT_LT(holes, inner / 10) << "before it nine of ten pixels were empty";
  const auto contours = findContours(result);
  const auto outer = [](const Contour& contour) { return contour.kind == ContourKind::outer; };
  EXPECT_EQ(std::count_if(contours.begin(), contours.end(), outer), 1) << "one piece";
  EXPECT_EQ(outside, 0)
      << "the outline may grow by one pixel (its corner by 1.4), and half of the pixel's own size";
}

TEST(Filled, NothingAndSinglePixelsGiveNothing) {
  FaceImage image = blankImage(30, 20);
  EXPECT_EQ(filled(image).gray, image.gray);
  image.gray[305] = image.farthest[305] = 100;
  EXPECT_EQ(filled(image).gray, std::vector<std::uint8_t>(600, 0)) << "an outlier without neighbours";
}

}  // namespace
}  // namespace boxgrasp
