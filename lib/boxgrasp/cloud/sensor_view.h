// What a sensor saw in every direction, to judge what it would have seen. Internal to this room.
#pragma once

#include <vector>

#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

// A depth image of cleaned points, made from where the sensor stood.
class SensorView {
 public:
  // `X_CS`: the sensor, looking along z at the object; `pitch_m`: the width of a pixel there. Pre: seen_C is
  // not empty.
  SensorView(const PointCloud& seen_C, const PointCloud& others_C, const Pose& X_CS, double pitch_m);

  enum class Verdict { seen, hidden, contradicted };
  struct Judgement {
    Verdict verdict = Verdict::contradicted;
    double behind_m = 0.0;  // how far behind the nearest seen surface
    double off_m = 0.0;     // how far off the readings along the line of sight, where seen
    bool at_rim = false;    // not behind a reading, but beside one: a sensor's outlines are ragged
  };
  // How far p lies behind the nearest surface seen in its direction; 0 beside all that was seen.
  double behind(const Vector3d& p_C) const;

  // Whether a surface at p would lie where one was seen, behind one, or where the sensor looked through.
  Judgement judge(const Vector3d& p_C, double tolerance_m) const;

 private:
  struct Pixel {
    bool read = false;                               // the object has a reading here
    float nearest = INFINITY, farthest = -INFINITY;  // of the object's readings around; what lies far behind
                                                     // the nearest was seen from elsewhere
    float other = INFINITY;                          // the nearest of anything else
  };
  struct Ray {
    int column = -1, row = -1;  // outside of the image where negative
    double depth_m = 0.0;
  };
  Ray rayTo(const Vector3d& p_C) const;
  std::size_t indexOf(const Ray& ray) const {
    return static_cast<std::size_t>(ray.row) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(ray.column);
  }
  void spread();

  Pose X_SC_;     // S: the sensor, looking along z at the object
  double pixel_;  // width in units of the image plane at z = 1
  Vector2d corner_;
  int width_ = 0, height_ = 0;
  std::vector<Pixel> pixels_;
};

// What several sensors saw: a surface is where one of them saw it, unless another looked through there.
SensorView::Judgement judge(const std::vector<SensorView>& views, const Vector3d& p_C, double tolerance_m);

}  // namespace boxgrasp
