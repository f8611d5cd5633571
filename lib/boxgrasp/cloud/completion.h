// Guessing the side of an object that the sensor did not see, from its symmetry.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/cloud/scene.h"
#include "boxgrasp/geometry/viewpoints.h"

namespace boxgrasp {

struct CompletionOptions {
  // Off: grasps are planned on what was seen alone, and most objects seen from one side have none.
  bool enabled = true;
  // Surfaces nearer than this along the line of sight are one: above the sensor's noise, below the thickness
  // of what is grasped.
  double tolerance_m = 0.006;
  // Mirrors are tried at azimuths this far apart (7.5 degrees), and refined from there.
  double azimuth_step_rad = 0.131;
  // A mirror is not used when more than this share of what it moves would have been seen and was not. Lower
  // trusts nothing but perfect symmetry.
  double max_contradicted = 0.3;
  // The same for a level mirror, which what lies on a table mostly has, and what stands on it often has not.
  double max_contradicted_level = 0.1;
  // Nothing is guessed when more than this share of the points is hidden from where the sensor stood: they
  // were seen from elsewhere too, and what is missing is not what this place says. One camera's clouds have
  // 0.11 at most, whole surfaces 0.4, and both views of two cameras told as one 0.35.
  double max_hidden = 0.25;
  void validate() const;
};

// Where the sensors stood, and what else they saw: nothing can be guessed where one looked through.
struct Observation {
  const Viewpoints& viewpoints_C;  // not empty
  std::optional<Vector3d> up_C;    // unit; unknown: the axes of the cloud's box are tried
  const PointCloud& others_C;      // what they saw beside the object, table included
};

struct Completion {
  PointCloud guessed_C;  // none of them within a spacing of a seen point
  std::vector<Plane>
      mirrors;  // through which they were guessed; upright ones, the surer first, then a level one
  std::size_t contradicted = 0;  // mirrored points left out: a sensor would have seen them
  std::string why_not;           // for users, where it was tried and nothing was guessed
};

// The unseen side of one object by mirror symmetry in an upright plane, in a second one across the first,
// and, where up is known, in a level one: most things that are handled have such planes (Thrun and Wegbreit,
// "Shape from symmetry", ICCV 2005; Bohg et al., "Mind the gap", ICRA 2011). A mirrored point is evidence for
// its mirror where a surface was seen, is possible where it is hidden behind what was seen, and contradicts
// it where a sensor saw through: the mirror with most evidence is taken, the tightest where there is none. A
// rigid motion of cloud, viewpoints and up moves the result with it. `spacing_m`: between points of the
// cloud. Nothing is guessed when no mirror is possible, when a sensor is said to have stood within the
// object, and when the cloud was not seen from the viewpoints alone. Pre: finite, not empty. Throws Stopped.
Completion completed(const PointCloud& seen_C, double spacing_m, const Observation& observation,
                     const CompletionOptions& options = {}, const StopToken& stop = {});

}  // namespace boxgrasp
