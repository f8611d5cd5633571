#include "merge_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "boxgrasp/store/experience_store.h"
#include "print_json.h"

namespace boxgrasp {

void runMerge(const MergeCommand& command) {
  const std::string settings = ExperienceStore::openForReading(command.shards.front()).settings();
  ExperienceStore out = ExperienceStore::openForWriting(command.out, settings);
  MergeCounts sum;
  for (const std::filesystem::path& shard : command.shards) {
    const MergeCounts added = out.merge(ExperienceStore::openForReading(shard));
    sum.models += added.models;
    sum.hypotheses += added.hypotheses;
    sum.labels += added.labels;
  }
  if (command.json) {
    printJson(nlohmann::ordered_json{{"schema", 1},
                                     {"store", command.out.string()},
                                     {"stores", command.shards.size()},
                                     {"models", sum.models},
                                     {"hypotheses", sum.hypotheses},
                                     {"labels", sum.labels},
                                     {"content", out.contentHash()}});
    return;
  }
  fmt::print("added {} models, {} hypotheses and {} labels of {} stores to {}\ncontent {}\n", sum.models,
             sum.hypotheses, sum.labels, command.shards.size(), command.out.string(), out.contentHash());
}

}  // namespace boxgrasp
