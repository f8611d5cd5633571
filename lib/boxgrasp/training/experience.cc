#include "boxgrasp/training/experience.h"

namespace boxgrasp {

std::string_view describe(GraspSource source) {
  switch (source) {
    case GraspSource::planner:
      return "planner";
    case GraspSource::random:
      return "random";
    case GraspSource::approach:
      return "approach";
  }
  return "unknown";
}

}  // namespace boxgrasp
