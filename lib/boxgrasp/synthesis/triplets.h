// Triplets of regions and the finger points on them (paper III.B).
#pragma once

#include <array>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/geometry/polygon.h"
#include "boxgrasp/synthesis/regions.h"

namespace boxgrasp {

struct TripletOptions {
  // Coulomb coefficient of finger on object; 0.4 is wood or plastic on either.
  double friction = 0.4;
  // Finger points keep half a finger's width from the ends of their region, or are the middle of a shorter
  // one.
  double end_margin_m = 0.0115;
  // Per face; those with the largest focus areas stay.
  std::size_t max_triplets = 2000;
  // Also pinch parallel sides with two fingers side by side against the thumb (pinches.h), which the paper's
  // rule that the normals span the plane leaves out. false: the paper's triplets alone.
  bool pinches = true;
  void validate() const;
};

// Three regions on which three fingers can hold: p_F are the finger points, focus_F the point where their
// friction cones meet.
struct Triplet {
  std::array<int, 3> regions{-1, -1, -1};
  Vector2d focus_F{0, 0};
  double focus_area_m2 = -1.0;  // of the intersection of the three regions' union friction cones
  std::array<Vector2d, 3> points_F{};
  std::array<Vector2d, 3> normals_F{};  // unit, into the material
  std::array<double, 3> turn_rad{};     // of the contour along the points' regions: positive where convex
  std::array<double, 3> nearest_depth_m{
      -1, -1, -1};  // depth of the surface's upper edge at each point (d_i of Eq. 4): 2 pixels inside
                    // the contour, or where the surface begins along the normal
  std::array<double, 3> farthest_depth_m{
      -1, -1, -1};  // depth down to which points of the box lie within 4 mm of the point, in the image
};

// Every triple of regions is considered once, and is a triplet or counts under the first reason against it.
struct TripletCounts {
  std::size_t considered = 0, not_spanning = 0, cones_apart = 0, focus_outside = 0, over_limit = 0;
};

struct Triplets {
  std::vector<Triplet> triplets;
  TripletCounts counts;
};

// True when the three unit normals positively span the plane: every gap between neighbouring directions is
// below 180 degrees.
bool positivelySpan(const std::array<Vector2d, 3>& normals);

// The union of the friction cones of all points of a region, cut with `bounds` (a convex polygon).
Polygon unionCone(const Region& region, double friction, const Polygon& bounds);

// All triplets of regions, in the order of their indices, that satisfy both criteria of III.B, with the exact
// centroid of the intersection polygon as focus, projected back to the regions; the focus lies strictly
// inside the triangle of the points. `filled_image` is the one that the regions were found in; it gives the
// depths. Throws InputError for bad options, Stopped when told to stop.
Triplets findTriplets(const std::vector<Region>& regions, const FaceImage& filled_image,
                      const TripletOptions& options = {}, const StopToken& stop = {});

// Keeps the `most` triplets with the largest focus areas, the earlier of equals, in the order of their
// regions; returns how many were left out.
std::size_t keepLargest(std::vector<Triplet>& triplets, std::size_t most);

// Fills in the depths at the points of the triplets.
void measureDepths(const FaceImage& filled_image, std::vector<Triplet>& triplets);

}  // namespace boxgrasp
