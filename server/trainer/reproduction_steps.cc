#include "reproduction_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "boxgrasp/base/error.h"
#include "tried_object.h"

namespace boxgrasp {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

constexpr const char* kStore = "labels.db";

// How much is measured: chosen so that two quiet cores need less than two hours, or five minutes.
struct Sizes {
  std::string scales;
  int label_limit, random, sweep_repeats, repeats, views, hypotheses;
  double share;  // of the time estimates for the whole
};
const Sizes kWhole{"0.75,1,1.25", 60, 2000, 10, 3, 2, 40, 1.0};
const Sizes kQuick{"1", 20, 60, 1, 1, 1, 10, 0.2};

// Files are named after objects and scenes, which may be called anything.
std::string inFileNames(std::string name) {
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '.') c = '_';
  }
  return name;
}

std::string inWords(const std::string& seen) {
  return seen == "whole" ? "whole surface" : seen == "view" ? "one view" : "two views";
}

class Plan {
 public:
  explicit Plan(const ReproduceCommand& command)
      : command_(command),
        sizes_(command.quick ? kQuick : kWhole),
        seeds_(command.quick ? 1 : command.seeds),
        set_(setOf(command)),
        sources_(sourcesOf(set_, {1.0})) {}

  std::vector<Step> steps() {
    addLabels();
    addRates();
    addLearning();
    addStability();
    addConstellations();
    addObjects();
    addScenes();
    addScanned();
    addAblations();
    return std::move(steps_);
  }

 private:
  // Objects of a quick run: one of one box, two of several.
  static std::string setOf(const ReproduceCommand& command) {
    if (parametricSet(command.objects, {1.0})) {
      const bool choose = command.quick && (command.objects == "paper" || command.objects == "builtin");
      return choose ? "mug,radio,toy_dog" : command.objects;
    }
    return fs::absolute(command.objects).lexically_normal().string();
  }

  void add(Step step) {
    step.estimate_s *= sizes_.share;
    if (std::find(step.arguments.begin(), step.arguments.end(), "--threads") == step.arguments.end() &&
        step.arguments.front() != "summary")
      step.arguments.insert(step.arguments.end(), {"--threads", std::to_string(command_.threads)});
    steps_.push_back(std::move(step));
  }

  std::string count(int number) const { return std::to_string(number); }
  double objects() const { return static_cast<double>(sources_.size()); }

  void addLabels();
  void addRates();
  void addRatesRow(const std::string& name, const std::string& subject, const std::string& set,
                   const std::string& seen, const std::string& protocol, int seeds, Words more);
  void addLearning();
  void addStability();
  void addConstellations();
  void addObjects();
  void addScenes();
  void addScanned();
  void addAblations();

  const ReproduceCommand& command_;
  const Sizes& sizes_;
  int seeds_;
  std::string set_;
  std::vector<ObjectSource> sources_;
  std::vector<Step> steps_;
};

void Plan::addLabels() {
  const double models = 3 * objects();
  add({"label",
       "label",
       "",
       {"label", "--objects", set_, "--out", kStore, "--scales", sizes_.scales, "--last-stage", "shake",
        "--limit", count(sizes_.label_limit), "--perturbations", "0"},
       4 * models,
       kStore,
       true});
  add({"summary", "summary", "", {"summary", kStore, "--json"}, 5, "", false});
}

void Plan::addRatesRow(const std::string& name, const std::string& subject, const std::string& set,
                       const std::string& seen, const std::string& protocol, int seeds, Words more) {
  Words arguments{"rates",      "--objects",         set,          "--seen",   seen,
                  "--views",    count(sizes_.views), "--protocol", protocol,   "--seeds",
                  count(seeds), "--store",           kStore,       "--meshes", set_,
                  "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  add({name, "rates", subject, arguments, objects() * (3 + seeds * (seen == "whole" ? 1 : sizes_.views)), "",
       false});
}

void Plan::addRates() {
  addRatesRow("rates_baseline", "whole surface, with all hypotheses and random grasps", set_, "whole",
              "lift_shake", 1, {"--limit", count(sizes_.hypotheses), "--random", count(sizes_.hypotheses)});
  for (const char* protocol : {"lift_shake", "six_pushes"}) {
    for (const char* seen : {"whole", "view", "pair"}) {
      addRatesRow(fmt::format("rates_{}_{}", seen, protocol), inWords(seen), set_, seen, protocol, seeds_,
                  {"--answers-only"});
    }
  }
}

void Plan::addScanned() {
  if (!command_.scanned) return;
  const std::string set = fs::absolute(*command_.scanned).lexically_normal();
  for (const char* seen : {"whole", "view"})
    addRatesRow(fmt::format("scanned_{}", seen), fmt::format("scanned objects, {}", inWords(seen)), set, seen,
                "lift_shake", seeds_, {"--answers-only"});
}

void Plan::addAblations() {
  const auto addOne = [&](const std::string& name, const std::string& meaning, const char* seen,
                          const Words& more) {
    Words arguments{"rates", "--objects", set_, "--seen", seen, "--views", "1", "--answers-only", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    add({name, "ablation", meaning, arguments, 1.5 * objects(), "", false});
  };
  for (const char* seen : {"whole", "view"})
    addOne(fmt::format("ablation_default_{}", seen), "as shipped", seen, {});
  for (const Ablation& ablation : ablations())
    addOne("ablation_" + ablation.name, ablation.meaning, ablation.of_views ? "view" : "whole",
           {"--config", fmt::format("ablation_{}.toml", ablation.name)});
}

void Plan::addLearning() {
  const Words common{"evaluate", "--store", kStore, "--meshes", set_, "--json"};
  const auto with = [&](Words more) {
    more.insert(more.begin(), common.begin(), common.end());
    return more;
  };
  Words paper = with(
      {"--inputs", "paper", "--hidden", "8", "--ensemble", "1", "--repeats", count(sizes_.sweep_repeats)});
  if (!command_.quick) paper.push_back("--sweep");
  add({"evaluate_paper", "evaluate", "the paper's network: q1 to q9, 8 hidden nodes", paper, 400, "", false});
  add({"evaluate_best", "evaluate", "our network: all inputs", with({"--repeats", count(sizes_.repeats)}),
       300, "", false});
}

void Plan::addStability() {
  for (int seed = 1; seed <= seeds_; ++seed) {
    Words arguments{"stability", "--objects", set_, "--seed", count(seed), "--json"};
    if (command_.quick) arguments.insert(arguments.end(), {"--quick", "--points", "2000"});
    add({fmt::format("stability_{}", seed), "stability", fmt::format("seed {}", seed), arguments,
         20 * objects(), "", false});
  }
}

void Plan::addConstellations() {
  const auto indexOf = [&](const char* name, std::size_t otherwise) {
    const auto found = std::ranges::find(sources_, name, &ObjectSource::name);
    return found == sources_.end() ? otherwise : static_cast<std::size_t>(found - sources_.begin());
  };
  std::set<std::size_t> chosen{indexOf("mug", sources_.size() - 1)};
  if (!command_.quick) chosen.insert(indexOf("duck", 0));
  for (const std::size_t i : chosen) {
    const std::string& name = sources_[i].name;
    const std::string stem = "constellations_" + inFileNames(name);
    Words arguments{"constellations", name, "--objects", set_, "--out", stem + ".png", "--json"};
    if (command_.quick) arguments.insert(arguments.end(), {"--points", "2000", "--gains", "0.8,0.9,0.95"});
    add({stem, "constellations", name, arguments, 30, stem + ".png", false});
  }
}

void Plan::addObjects() {
  for (const ObjectSource& source : sources_) {
    const std::string spread = "spread_" + inFileNames(source.name),
                      grasps = "grasps_" + inFileNames(source.name), plot = spread + ".svg",
                      picture = grasps + ".png";
    add({spread,
         "spread",
         source.name,
         {"spread", "--object", source.file.empty() ? source.name : source.file.string(), "--random",
          count(sizes_.random), "--out", plot, "--json"},
         60,
         plot,
         false});
    add({grasps,
         "grasps",
         source.name,
         {"draw", source.name, "--objects", set_, "--store", kStore, "--meshes", set_, "--out", picture,
          "--json"},
         20,
         picture,
         false});
  }
}

void Plan::addScenes() {
  if (!command_.scenes) return;
  if (!fs::is_directory(*command_.scenes))
    throw InputError(
        fmt::format("--scenes is '{}', but must be a folder of clouds (PCD)", command_.scenes->string()));
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::absolute(*command_.scenes)))
    if (entry.path().extension() == ".pcd") files.push_back(entry.path().lexically_normal());
  std::sort(files.begin(), files.end());
  if (command_.quick && files.size() > 1) files.resize(1);
  for (const fs::path& file : files) {
    const std::string name = "scene_" + inFileNames(file.stem());
    add({name,
         "scene",
         file.stem(),
         {"draw", "--scene", file, "--out", name + ".png", "--json"},
         15,
         name + ".png",
         false});
  }
}

}  // namespace

const std::vector<Ablation>& ablations() {
  static const std::vector<Ablation> all{
      {"no_pinches", "[triplets]\npinches = false\n", "the paper's triplets alone, without two-sided pinches",
       false},
      {"leaf_boxes", "[faces]\ninner_boxes = false\n", "faces of leaf boxes alone, as in the paper", false},
      {"bound_split", "[decomposition]\nsplit = \"bound\"\n", "the older splits", false},
      {"robust_split", "[decomposition]\nsplit = \"robust\"\n", "the splits of many votes", false},
      {"local_gain", "[decomposition]\ngain = \"local\"\n", "t measured on each box and its halves", false},
      {"linear_depth", "[planner]\ndepth_model = \"linear\"\n", "the paper's linear depth of the fingers",
       false},
      {"no_force_closure", "[planner]\nforce_closure = \"ignore\"\n",
       "grasps without force closure are ranked too", false},
      {"snap", "[shapes]\nsnap = true\n", "fingers on round faces put through the axis", false},
      {"concave", "[planner]\nconcavity_weight = 1.0\n", "concave places preferred", false},
      {"meet_surface", "[contacts]\nmeet_surface = true\n",
       "fingers closed until they meet the surface in space", false},
      {"edges", "[faces]\nedges = \"always\"\n", "approaches over the edges of boxes too", false},
      {"no_edges", "[faces]\nedges = \"never\"\n", "no approach over the edges of boxes", true},
      {"no_guessed_faces", "[planner]\nguessed_faces = false\n", "no approach to the side that was guessed",
       true},
      {"no_completion", "[completion]\nenabled = false\n", "the hidden side is not guessed", true}};
  return all;
}

std::vector<Step> reproductionSteps(const ReproduceCommand& command) { return Plan(command).steps(); }

}  // namespace boxgrasp
