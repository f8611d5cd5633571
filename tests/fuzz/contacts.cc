// Files of contacts for `boxgrasp-trainer quality` (JSON). What it prints goes nowhere.
#include <cstdio>

#include "fuzz_target.h"
#include "quality_command.h"

namespace boxgrasp::fuzz {

void feed(Bytes bytes) {
  static const Folder folder;
  static FILE* const nowhere = std::freopen("/dev/null", "w", stdout);
  promise(nowhere != nullptr);
  QualityCommand command;
  command.contacts = folder.file("contacts.json", bytes);
  for (const bool json : {false, true}) {
    command.json = json;
    accepts([&] { runQuality(command); });
  }
}

std::vector<std::string> seeds() {
  const std::string contacts =
      R"([{"position_mm": [30, 0, 0], "inward_normal": [-1, 0, 0], "mu": 0.5}, {"position_mm": [-30, 0, 0], "inward_normal": [1, 0, 0]}])";
  return {
      contacts,
      R"({"cases": [{"name": "a", "mu": 0.5, "cone_edges": 8, "cog_mm": [0, 0, 1], "torque_scale_mm": 30, "contacts": )" +
          contacts + "}]}",
      R"({"cases": {"cases": {"cases": []}}})"};
}

}  // namespace boxgrasp::fuzz
