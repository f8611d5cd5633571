// Names of labelled grasps, for people, files and commands: "mug@1.00/whole/planner/17".
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "boxgrasp/training/experience.h"

namespace boxgrasp {

struct GraspId {
  ModelKey model;
  GraspSource source = GraspSource::planner;
  int index = 0;  // among the hypotheses of this model and source
  auto operator<=>(const GraspId&) const = default;
};

// "<object>@<scale>/<view>/<source>/<index>". The scale has two decimals where these give it to the bit, else
// as many as it needs, so that parsing gives the same id again. The object may hold '/' and '@', the view
// no '/'.
std::string formatGraspId(const GraspId& id);
std::string formatModelKey(const ModelKey& key);  // the part up to the view

// Throws InputError that shows the text and an id as it should be.
GraspId parseGraspId(std::string_view text);
ModelKey parseModelKey(std::string_view text);

// The source of this name (describe(GraspSource)); nullopt for none.
std::optional<GraspSource> parseGraspSource(std::string_view name);

}  // namespace boxgrasp
