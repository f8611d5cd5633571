// Contours of a face image (paper III.A, first part).
#pragma once

#include <vector>

#include "boxgrasp/projection/face_image.h"

namespace boxgrasp {

struct ContourOptions {
  // Pixels with fewer occupied neighbours are outliers and removed (III.A).
  int min_neighbours = 2;
  // Points are expanded by this many point spacings, at least to their 8 neighbours (III.A), and all but one
  // pixel of it is taken back. Random samplings have gaps of several spacings; larger values close larger
  // gaps and fill narrow notches; 0: the paper's rule.
  double splat_spacings = 2.0;
  // Smoothing of the edge detector (III.A, footnote 1); smaller: sharper corners, more noise.
  double canny_sigma_px = 2.5;
  // Automatic thresholds for depth edges: the high one leaves this share of the object's pixels below.
  double high_quantile = 0.7;
  // The low threshold is this share of the high one; smaller: longer, noisier depth edges.
  double low_fraction = 0.4;
  // Depth edges with a smaller step are texture of the surface, not a place for a finger.
  double min_depth_step_m = 0.008;
  // Shorter contours are dropped.
  int min_points = 10;
  void validate() const;
};

enum class ContourKind { outer, inner, depth_edge };

// Ordered points of one contour in the plane of F (metres), one pixel apart along it; the material (the
// nearer surface) lies to the left of the way from one point to the next, left as seen in the coordinates of
// F (normal = (-ty, tx) for the direction t). So outer contours have a positive signed area, inner ones a
// negative one. A closed contour does not repeat its first point.
struct Contour {
  ContourKind kind = ContourKind::outer;
  bool closed = false;
  std::vector<Vector2d> points_F;
};

// The image with outliers removed and gaps filled (III.A, first paragraph): what the edges are found in. With
// the radius r = max(1, ceil(splat_spacings * spacing / pixel)): a pixel stays when at least min_neighbours
// others within r columns and rows are occupied, is expanded to all pixels within r, and r - 1 of that is
// taken back. r = 1 is the paper's rule. Where expanded pixels overlap, `gray` takes the nearest depth and
// `farthest` the farthest; both are occupied at the same pixels.
FaceImage filled(const FaceImage& image, const ContourOptions& options = {});

// The edges of a filled image in the sense of Canny (maxima of the gradient of the smoothed image, III.A),
// linked into ordered contours, with sub-pixel positions. Two signals are in the image, and each is searched
// for itself, because the automatic thresholds of one image for both lose the weaker parts of the silhouette
// where the surface is curved, and junctions tear it.
//
// Silhouettes are edges of the occupied area, a step of known height. Their threshold is the half level of
// the smoothed area, which is where the gradient of a smoothed step is greatest. They are complete and
// closed, always. Parts narrower than about 1.5 sigma vanish.
//
// Depth edges are edges of the depth inside the silhouettes, smoothed over the occupied pixels only, with
// automatic thresholds as in Matlab's edge(): 64 bins of gradient magnitude, hysteresis along the linked
// edge. They keep 2 sigma clear of the silhouettes, and only places with a step in depth (beyond the slope of
// the surface on either side) count. At junctions an edge goes straight on.
//
// Order: silhouettes, then depth edges, each from the top of the image.
std::vector<Contour> findContours(const FaceImage& filled_image, const ContourOptions& options = {});

}  // namespace boxgrasp
