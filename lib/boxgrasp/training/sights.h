// What the planner gets to see of an object: its whole surface, what one depth camera sees, or two together.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "boxgrasp/planning/plan.h"
#include "boxgrasp/training/experience.h"

namespace boxgrasp {

struct SightOptions {
  // Of the cloud of the whole surface. More cost planning time, and change boxes little.
  std::size_t points = 30'000;
  int cameras = 0;         // evenly around the object (objects/depth_camera.h)
  std::uint64_t seed = 1;  // of surface points and of the cameras' noise
};

// "whole"; "view0", "view1" .. for as many cameras; "pair0", "pair1" ..: that camera's view with the one a
// quarter of the ring further on.
std::string wholeName();
std::vector<std::string> viewNames(int cameras);
std::vector<std::string> pairNames(int cameras);

// The cloud that `key.view` names, in O, of the object alone on a table; with the cameras' places.
// Throws InputError for a view that these cameras have not; Stopped.
PlanRequest sightOf(const TriangleMesh& mesh_O, const ModelKey& key, const SightOptions& options,
                    const StopToken& stop = {});

// A seed of its own for each model, purpose and grasp, so that no two are disturbed alike.
std::uint64_t derivedSeed(std::uint64_t seed, const ModelKey& key, std::string_view purpose, int index);

}  // namespace boxgrasp
