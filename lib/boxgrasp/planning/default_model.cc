#include "boxgrasp/planning/default_model.h"

#include "boxgrasp/base/error.h"

namespace boxgrasp {

Model modelOrDefault(const std::optional<std::filesystem::path>& file, const HandDescription& hand) {
  if (file) return readModel(*file);
  const char* const json = hand.prismatic() ? kGripperModelJson : kDefaultModelJson;
  if (*json == '\0')
    throw InputError(
        "this build has no built-in model; name one with --model FILE (boxgrasp-trainer train makes them)");
  return parseModel(json, "the built-in model");
}

}  // namespace boxgrasp
