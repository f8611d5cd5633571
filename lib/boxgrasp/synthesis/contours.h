// Contours of a face image (paper III.A, first part).
#pragma once

#include <vector>

#include "boxgrasp/projection/face_image.h"

namespace boxgrasp {

struct ContourOptions {
  int min_neighbours = 2;           // pixels with fewer occupied neighbours are outliers and removed (III.A)
  double splat_spacings = 0.75;     // points are expanded by this many point spacings, at least to their 8 neighbours (III.A): larger
                                    // expansions close gaps in sparse clouds, and all but one pixel of them is taken back
  double canny_sigma_px = 2.5;      // smoothing of the edge detector (III.A, footnote 1)
  double high_quantile = 0.7;       // automatic thresholds: the high one leaves this share of the pixels below,
  double low_fraction = 0.4;        // the low one is this share of the high one
  double min_depth_step_m = 0.008;  // inner edges with a smaller step in depth are texture of the surface, not a place for a finger
  int min_points = 10;              // shorter contours are dropped
  void validate() const;
};

enum class ContourKind { outer, inner, depth_edge };

// Ordered points of one contour in the plane of F (metres); the material (the nearer surface) lies to the left of the way from one
// point to the next, left as seen in the coordinates of F (normal = (-ty, tx) for the direction t).
struct Contour {
  ContourKind kind = ContourKind::outer;
  bool closed = false;
  std::vector<Vector2d> points_F;
};

// The image with outliers removed and gaps filled (III.A, first paragraph): what the edges are found in.
FaceImage filled(const FaceImage& image, const ContourOptions& options = {});

// Canny edges of a filled image, linked into ordered contours: outer and inner ones, and those where the depth jumps.
std::vector<Contour> findContours(const FaceImage& filled_image, const ContourOptions& options = {});

}  // namespace boxgrasp
