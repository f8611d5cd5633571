// A grasp as a strip of pictures: hand and object at some moments, seen from two sides.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "boxgrasp/geometry/triangle_mesh.h"
#include "boxgrasp/hand/kinematics.h"

namespace boxgrasp {

struct FilmForce {
  Vector3d p_W = Vector3d::Zero();
  Vector3d force_W = Vector3d::Zero();  // on the object, newtons
};

struct FilmFrame {
  std::string caption, remark;  // a line each
  Pose X_WP = Pose::Identity(), X_WO = Pose::Identity();
  std::vector<Capsule> links_W;
  std::vector<FilmForce> forces;
};

struct Film {
  std::string title, subtitle;
  TriangleMesh object_O;
  std::vector<FilmFrame> frames;
  // The frame in which the hand holds the object. Views are chosen for it; before it they stand still,
  // after it they go with the palm, without turning.
  std::size_t grasped = 0;
  Vector3d up_W = Vector3d::UnitZ();  // unit
};

struct FilmOptions {
  int panel_px = 260;       // side of one picture
  int columns = 6;          // frames side by side
  double newton_m = 0.003;  // length of an arrow for each newton: 15 N, the most a finger presses, is 45 mm
  void validate() const;
};

// Two directions in which to look at the hand, unit, in W: the first across the plane in which its thumb
// closes, where most is seen, the second about a quarter turn from it. Both a little from above.
std::array<Vector3d, 2> filmViews(const Pose& X_WP, const Vector3d& up_W);

// Forces are arrows that end where they act, drawn over everything. Throws InputError for bad options. Pre:
// `grasped` is one of the frames.
cv::Mat3b drawFilm(const Film& film, const HandDescription& hand, const FilmOptions& options = {});

}  // namespace boxgrasp
