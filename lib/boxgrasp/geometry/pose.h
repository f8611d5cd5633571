// Poses and the notation of the whole library: X_AB is the pose of frame B in frame A (p_A = X_AB * p_B), p_A
// a position in A, n_A a unit vector expressed in A. Frames: C the cloud as received, B a box, F a face of a
// box, P the palm, T a fingertip.
#pragma once

#include <Eigen/Geometry>

namespace boxgrasp {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Pose = Eigen::Isometry3d;

inline Pose makePose(const Matrix3d& rotation, const Vector3d& translation) {
  Pose pose = Pose::Identity();
  pose.linear() = rotation;
  pose.translation() = translation;
  return pose;
}

}  // namespace boxgrasp
