// Every numerical tolerance of the library, with its meaning. Lengths in metres, angles in radians.
#pragma once

namespace boxgrasp::tolerance {

inline constexpr double kFlatExtent =
    1e-4;  // an extent of a box below this counts as this: 0.1 mm, under any sensor's noise
inline constexpr double kCoincident = 1e-7;        // points nearer than this are one point
inline constexpr double kUnitVector = 1e-9;        // how far from 1 the norm of a unit vector may be
inline constexpr double kAngle = 1e-9;             // angles closer than this are equal
inline constexpr double kSymmetricFingers = 5e-4;  // two finger points this near to mirror images count as
                                                   // such: well under a fingertip's accuracy
inline constexpr double kEqualTheta = 1e-9;  // cuts whose Theta (a ratio of areas) differs by less are equal
inline constexpr double kWrenchRank =
    1e-9;  // wrenches whose smallest dimension, over the largest, is below this are flat
inline constexpr double kWrenchMargin =
    1e-9;  // the origin this near to the hull of wrenches, over the largest, is on it

}  // namespace boxgrasp::tolerance
