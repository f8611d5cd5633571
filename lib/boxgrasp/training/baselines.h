// Grasps that a planner has to beat: chance, and approach-and-close along the normals of boxes. Both know
// nothing of fingers, so they are tried with TrialOptions::back_up_on_touch: the hand closes where it meets
// the object.
#pragma once

#include <cstdint>
#include <vector>

#include "boxgrasp/decomposition/box_tree.h"
#include "boxgrasp/training/experience.h"

namespace boxgrasp {

// The greatest height above the palm that a fingertip reaches in closing, metres.
double fingerReachHeight(const HandDescription& hand);

// n random grasps with the hand wide open. For each, independently: a point of the surface, uniform by area;
// a direction of approach, uniform over the half-sphere in front of that point; the palm facing the point, at
// a distance uniform from 0 to fingerReachHeight(); the roll about the approach uniform, and the spread
// uniform over the hand's range. The way in begins where neither palm nor fingers can be at the object. The
// i-th grasp depends on the seed and i alone, so a longer list begins with the shorter one. Throws InputError
// for n < 0, or a mesh without a triangle of positive area.
std::vector<HypothesisRecord> randomHypotheses(const HandDescription& hand, const TriangleMesh& mesh_O, int n,
                                               std::uint64_t seed);

// Approach-and-close (paper, ref. [11]): the palm comes along the normal through the centre of each graspable
// face of each leaf box, the hand open, in four rolls a quarter turn apart, the first with the thumb's
// direction along the face's shorter edge, and with the two usual spreads: fingers parallel, and all three a
// third of a turn apart. It goes on until it touches, at most to the middle of the box. In order of face,
// spread, roll. The tree is that of the cloud; faces are judged by graspableFaces with its defaults.
std::vector<HypothesisRecord> approachHypotheses(const HandDescription& hand, const BoxTree& tree_O,
                                                 const PointCloud& cloud_O);

// What the simulator is to try; gravity pulls along -z of O.
TrialInput trialInput(const HypothesisRecord& hypothesis);

}  // namespace boxgrasp
