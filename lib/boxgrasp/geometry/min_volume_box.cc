#include "boxgrasp/geometry/min_volume_box.h"

#include "boxgrasp/geometry/canonical_frame.h"

namespace boxgrasp {

void MinVolumeBoxOptions::validate() const {}

OrientedBox minVolumeBox(const PointCloud& cloud_C, const MinVolumeBoxOptions&, const StopToken& stop) {
  stop.check();
  return boxAround(cloud_C, canonicalFrame(cloud_C).linear());
}

}  // namespace boxgrasp
