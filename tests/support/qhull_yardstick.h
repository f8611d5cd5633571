// qhull's 3D hull: the yardstick of the benchmarks.
#pragma once

#include <libqhull_r/qhull_ra.h>

#include <stdexcept>
#include <vector>

#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp::test {

inline std::vector<coordT> qhullCoordinates(const PointCloud& cloud) {
  std::vector<coordT> coordinates;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    coordinates.insert(coordinates.end(), {cloud.x[i], cloud.y[i], cloud.z[i]});
  return coordinates;
}

inline void buildQhull(std::vector<coordT>& coordinates) {
  qhT qhull;
  qh_zero(&qhull, stderr);
  char command[] = "qhull";
  const int points = static_cast<int>(coordinates.size() / 3);
  if (qh_new_qhull(&qhull, 3, points, coordinates.data(), false, command, nullptr, stderr) != 0)
    throw std::runtime_error("qhull failed");
  qh_freeqhull(&qhull, !qh_ALL);  // qh_ALL would leave the blocks of small pieces behind
  int pieces = 0, bytes = 0;
  qh_memfreeshort(&qhull, &pieces, &bytes);
}

}  // namespace boxgrasp::test
