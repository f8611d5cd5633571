// Finger points on a round outline, where the shape below the face is known (cylinders seen along the axis,
// spheres).
#pragma once

#include <vector>

#include "boxgrasp/synthesis/triplets.h"

namespace boxgrasp {

// In the plane of F.
struct Circle {
  Vector2d center_F{0, 0};
  double radius_m = 0.0;
};

// Moves triplets of points on chords of the circle's outline onto the circle, their normals to its centre.
// Points of the paper's triplets move straight outwards, and the circle's centre becomes their focus. Of
// pinches, the thumb's point moves straight outwards, and the two fingers' to where they stand opposite, as
// far apart as before. A triplet stays as it is where a point is not on the outline (more than a chord's
// sagitta inside, or off it outside, or with another normal), or where the moved normals would not hold: no
// longer spanning, or a finger pushing outside the friction cone. Depths are measured anew. Returns how many
// were moved.
std::size_t snapToCircle(const Circle& circle, const FaceImage& filled_image, const TripletOptions& options,
                         std::vector<Triplet>& triplets);

}  // namespace boxgrasp
