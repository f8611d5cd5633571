// Trained models as files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "boxgrasp/ranking/ensemble.h"
#include "boxgrasp/ranking/recollections.h"

namespace boxgrasp {

struct Model {
  static constexpr int kFormatVersion = 2;
  std::string version;     // "<8 hex digits of the content's BLAKE2b hash>", set by writeModel and readModel
  std::string name;        // e.g. "analytic-s"
  std::string trained_on;  // in words: labels, objects, what they are not
  std::string command;     // the command that makes it again
  std::string data_hash;   // BLAKE2b of the training data, hex
  std::uint64_t seed = 0;
  std::string created;                    // ISO 8601, UTC
  std::vector<std::string> features;      // names of the inputs in order, e.g. q1 .. q9
  std::map<std::string, double> metrics;  // e.g. "s_net", "s_net_fraction"
  Ensemble ensemble;
  std::vector<Recollection> recollections;  // of what it was trained on, where that was asked for
};

// Reads and checks a model file (JSON, at most 32 MiB). Throws InputError naming the file, the key and what
// is wrong: unreadable, truncated, unknown format version, missing or unknown key, wrong shape, non-finite
// number, content that does not match its version. What is accepted has exactly the content that was written.
Model readModel(const std::filesystem::path& file);
Model parseModel(const std::string& json, const std::string& name_for_errors);

// Writes atomically (temporary file, fsync, rename) and returns the model with its version filled in. Every
// number is written so that it reads back to the bit. Throws InputError for a model that readModel would
// refuse, or a file that cannot be written; then what was there before is untouched.
Model writeModel(const Model& model, const std::filesystem::path& file);

// The first 8 hex digits of the hash of the model's canonical JSON (compact, keys sorted) without its
// version.
std::string modelVersion(const Model& model);

// BLAKE2b with a digest of 256 bits, as 64 hex digits.
std::string blake2bHex(std::string_view bytes);

}  // namespace boxgrasp
