// Grasp regions: straight pieces of contour where a finger may press (paper III.A, second part).
#pragma once

#include <vector>

#include "boxgrasp/synthesis/contours.h"

namespace boxgrasp {

// What the bound on the total curvature holds for. With sign: bends to both sides cancel, so that waves
// shorter than a region do not break it. Absolute: they add up; stricter.
enum class CurvatureSum { absolute, with_sign };

struct RegionOptions {
  // Neighbours in each direction for the k-angular bending (Eq. 3), in contour points; more: less noise,
  // blunter corners.
  int k = 5;
  // Standard deviation of the Gaussian along the contour, in contour points.
  double smoothing_sigma = 2.5;
  // t_kappa: bound on the curvature at any point (III.A).
  double max_curvature_rad = 0.4;
  // T_kappa: bound on the sum of curvature over a region (III.A); smaller: bent contours give more and
  // shorter regions.
  double max_total_curvature_rad = 4.0;
  CurvatureSum sum = CurvatureSum::with_sign;
  // l_min: about the width of a Barrett finger (III.A).
  double min_length_m = 0.020;
  // l_max: longer straight pieces are broken up evenly (III.A); smaller: more regions and hypotheses, slower.
  double max_length_m = 0.050;
  void validate() const;
};

// One region: the chord from a to b, with the material on its left; in the plane of F, metres.
struct Region {
  Vector2d a_F{0, 0}, b_F{0, 0};
  Vector2d normal_F{0, 0};  // unit, into the material
  ContourKind kind = ContourKind::outer;
  int contour = -1;
  double turn_rad = 0.0;  // of the contour along the region: positive where the material is convex
  double length() const { return (b_F - a_F).norm(); }
};

// The signed k-angular bending at every point (Eq. 3, of the normalised vectors), smoothed: positive where
// the material is convex. Open contours: the first and the last k points have no value and repeat that of
// their neighbour. On contours of fewer than 2k + 1 points k is as large as fits; of fewer than three points
// the curvature is 0. A circle of radius R points has k / R.
std::vector<double> curvature(const Contour& contour, const RegionOptions& options = {});

// The regions of all contours, in the order of the contours. A region is a stretch of contour points, of
// which every one has a curvature of at most max_curvature_rad, whose sum is at most max_total_curvature_rad,
// and whose length along the contour is in [min_length_m, max_length_m]. Each run of low curvature is broken
// into as few pieces as satisfy the bounds, each with the same share of the run's length or bending,
// whichever binds: straight parts give long regions, bent ones short ones, and neither the direction nor the
// start of a contour matters. A closed contour of low curvature all along starts at its point farthest from
// the mean of its points.
std::vector<Region> findRegions(const std::vector<Contour>& contours, const RegionOptions& options = {});

}  // namespace boxgrasp
