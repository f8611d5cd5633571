// Trained models as files.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "boxgrasp/ranking/network.h"

namespace boxgrasp {

struct Model {
  static constexpr int kFormatVersion = 1;
  std::string version;                     // "<8 hex digits of the content's BLAKE2b hash>", set by writeModel and readModel
  std::string name;                        // e.g. "analytic-s"
  std::string trained_on;                  // in words: labels, objects, what they are not
  std::string command;                     // the command that makes it again
  std::string data_hash;                   // BLAKE2b of the training data, hex
  std::uint64_t seed = 0;
  std::string created;                     // ISO 8601, UTC
  std::vector<std::string> features;       // names of the inputs in order: q1 .. q9
  std::map<std::string, double> metrics;   // e.g. "s_net", "s_net_fraction"
  Network network;
};

// Reads and checks a model file (JSON). Throws InputError naming the file and what is wrong: unreadable, truncated, unknown format version,
// wrong shape, non-finite number, content that does not match its version.
Model readModel(const std::filesystem::path& file);
Model parseModel(const std::string& json, const std::string& name_for_errors);

// Writes atomically (temporary file, fsync, rename) and returns the model with its version filled in. Throws InputError.
Model writeModel(const Model& model, const std::filesystem::path& file);
std::string modelVersion(const Model& model);

}  // namespace boxgrasp
