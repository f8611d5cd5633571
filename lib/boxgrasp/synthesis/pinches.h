// Pinches: two fingers side by side against the thumb.
#pragma once

#include <vector>

#include "boxgrasp/synthesis/triplets.h"

namespace boxgrasp {

// Triples that the paper's triplets (III.B) leave out, because normals n, n, -n do not positively span the
// plane: parallel sides between two fingers that push the same way and a thumb that pushes back. They are all
// that a pen, a handle or a card has to offer. Beyond the paper.
//
// A pinch is a Triplet whose regions are those of one finger, the other finger and the thumb. Seen along the
// thumb's normal n, both fingers' regions lie ahead of the thumb's, with normals within the friction cone of
// -n; across n, the fingers' points are `spacing_m` apart and the thumb's point is midway between them, in
// the middle of where the regions leave room for all three. Points keep the end margin from the ends of a
// side; regions that continue each other are one side, and both fingers may press on one region that is long
// enough. The focus is midway between the thumb and the fingers, its area that of the strip from side to side
// over the room that was left.
//
// In the order of the regions; the pinches with the largest areas where there are more than max_triplets.
// O(n^3) at worst. Throws InputError for bad options, Stopped when told to stop. Pre: spacing_m > 0.
std::vector<Triplet> findPinches(const std::vector<Region>& regions, const FaceImage& filled_image,
                                 double spacing_m, const TripletOptions& options = {},
                                 const StopToken& stop = {});

}  // namespace boxgrasp
