// A trial as a film: what hand and object did, at the moments that matter.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "boxgrasp/rendering/filmstrip.h"
#include "boxgrasp/simulation/trial.h"

namespace boxgrasp {

// Looks on at one trial. The observer refers to the recorder, which must outlive it.
class TrialRecorder {
 public:
  TrialObserver observer();

  // The last moment of every phase that was reached, and some moments before it; without title. Empty where
  // nothing was seen. `center_O`: the object's centre of mass, whose slip in the palm frames tell.
  Film film(const TriangleMesh& mesh_O, const Vector3d& center_O, const TrialInput& input) const;

 private:
  static constexpr std::size_t kPhases = 7;
  std::array<std::vector<TrialMoment>, kPhases> moments_;  // by phase
};

}  // namespace boxgrasp
