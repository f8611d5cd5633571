// The paper's evaluation as a list of this program's own commands.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace boxgrasp {

struct ReproduceCommand {
  std::filesystem::path out;
  std::string objects = "paper";  // or "builtin", names separated by commas, or a folder of meshes in metres
  std::optional<std::filesystem::path> scenes;   // folder of clouds of whole scenes (PCD)
  std::optional<std::filesystem::path> scanned;  // folder of scanned objects' meshes, in metres
  bool quick = false;
  int seeds = 3;
  int threads = 0;
};

// One command, run in the folder of the reproduction. What it prints goes to <name>.json.
struct Step {
  std::string name;
  std::string kind;     // the report's section; see reproduction_report.h
  std::string subject;  // the object, or what a row is about
  std::vector<std::string> arguments;
  double estimate_s = 1.0;   // on two quiet cores
  std::string product;       // another file that it makes there; empty: none
  bool prints_text = false;  // instead of JSON
};

// A change of the planner's options whose effect is measured.
struct Ablation {
  std::string name, toml, meaning;
  bool of_views = false;  // matters where a side of the object is not seen
};
const std::vector<Ablation>& ablations();

// All steps, in an order in which each finds the files that it needs. Throws InputError for objects that are
// none.
std::vector<Step> reproductionSteps(const ReproduceCommand& command);

}  // namespace boxgrasp
