// 2.5D images of box faces (paper III, Fig. 4a).
#pragma once

#include <cstdint>
#include <vector>

#include "boxgrasp/projection/graspable_faces.h"

namespace boxgrasp {

struct ImageOptions {
  // Edge of a pixel; smaller: finer contours, slower.
  double pixel_m = 0.001;
  // Empty pixels around the face, room for the expansion of points and the smoothing of edges.
  int border_px = 12;
  // Faces that would need more pixels along a side get larger ones.
  int max_side_px = 2048;
  void validate() const;
};

// 8-bit depth: 255 at the face (zero depth), 1 at the far side of the box, 0 where no point fell. Row-major.
// The middle of the image is the origin of F, so that mirrored faces give mirrored images.
struct FaceImage {
  Face face;
  int width = 0, height = 0;
  double pixel_m = -1.0;               // the edge that was used
  double spacing_m = -1.0;             // of the points projected: their median nearest-neighbour distance
  std::vector<std::uint8_t> gray;      // the nearest point in each pixel
  std::vector<std::uint8_t> farthest;  // the farthest point in each pixel, in the same scale

  std::uint8_t at(int column, int row) const { return gray[static_cast<std::size_t>(row) * width + column]; }
  // Between image coordinates (column, row), where a pixel's centre is at whole numbers, and x, y in F.
  Vector2d toFace(const Vector2d& pixel) const;
  Vector2d toPixel(const Vector2d& p_F) const;
  double depthOf(double gray_value) const;  // metres below the face; pre: gray_value in [1, 255]
};

// Projects the leaf's points onto the face. Points outside the face's box count as on its border.
// `spacing_m`: the cloud's, from cleaning; -1 when unknown. Throws InputError for bad options. Pre: the
// face's sizes and depth are positive.
FaceImage projectFace(const Face& face, const PointCloud& cloud_C, const std::vector<std::uint32_t>& points,
                      double spacing_m, const ImageOptions& options = {});

}  // namespace boxgrasp
