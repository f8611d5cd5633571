// boxgrasp-trainer: labels grasps, trains and publishes models.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/exit_code.h"
#include "boxgrasp/base/stop_token.h"
#include "draw_command.h"
#include "evaluate_command.h"
#include "keygen_command.h"
#include "label_command.h"
#include "merge_command.h"
#include "objects_command.h"
#include "publish_command.h"
#include "quality_command.h"
#include "rates_command.h"
#include "reproduce_command.h"
#include "sample_command.h"
#include "show_command.h"
#include "spread_command.h"
#include "stability_command.h"
#include "summary_command.h"
#include "train_command.h"
#include "work_command.h"

namespace {

using namespace boxgrasp;

std::string commandLine(int argc, char** argv) {
  std::string line = "boxgrasp-trainer";
  for (int i = 1; i < argc; ++i) line += fmt::format(" {}", argv[i]);
  return line;
}

void addStudy(CLI::App& app, StudyCommand& command) {
  app.add_option(
      "--store", command.store,
      "simulated labels, from boxgrasp-trainer label; without it s is computed from planned contacts");
  app.add_option("--meshes", command.meshes, "the store's objects: 'builtin', or a folder of meshes")
      ->capture_default_str();
  app.add_option("--views", command.views, "as when the store was labelled")->capture_default_str();
  app.add_option("--objects", command.objects, "names of the objects to learn from; all if none is given");
  app.add_option("--points", command.points, "points sampled on each object, without a store")
      ->capture_default_str();
  app.add_option(
         "--target", command.target,
         "'s': Eq. 6, as in the paper; 'hold': probability to be held in lift and shake; 'both': their "
         "product")
      ->capture_default_str();
  app.add_option(
      "--inputs", command.inputs,
      "'paper': q1 to q9; 'relative': these without their units; 'all': all that is measured, and its "
      "places among an object's grasps; or a list of features, separated by commas; if none is given, "
      "all with a store, else relative");
  app.add_option("--hidden", command.hidden,
                 "nodes of each hidden layer (the paper: 8); 0 for a linear model")
      ->capture_default_str();
  app.add_option("--ensemble", command.networks, "networks whose outputs are averaged (the paper: 1)")
      ->capture_default_str();
  app.add_option("--starts", command.starts, "first weights to try for each network")->capture_default_str();
  app.add_option("--repeats", command.repeats, "repeats of the leave-one-object-out validation")
      ->capture_default_str();
  app.add_option("--seed", command.seed, "seed of sampling, validation and first weights")
      ->capture_default_str();
  app.add_option("--threads", command.threads, "0 = all cores; the result does not depend on it")
      ->capture_default_str();
  app.add_option("--hand", command.hand, "hand description file (TOML); the Barrett hand if none is given");
}

void addWork(CLI::App& app, WorkCommand& command) {
  addStudy(app, command.study);
  app.add_option("--outcomes", command.outcomes,
                 "what robots reported: outcomes.db in the server's state folder")
      ->required();
  app.add_option("--keep", command.keep, "folder for every candidate and its comparison")
      ->capture_default_str();
  app.add_option("--state-dir", command.state_dir, "of the server, for the weights of the models it uses");
  app.add_option("--key", command.key, "to publish with; without one nothing is published");
  app.add_option("--lcm-url", command.lcm_url, "LCM's address, where the server is")->capture_default_str();
  app.add_option("--after", command.after, "train after this many new outcomes; 0: not for outcomes")
      ->capture_default_str();
  app.add_option("--every-h", command.every_h, "train at least this often, hours; 0: not by the clock")
      ->capture_default_str();
  app.add_option("--held-out-one-in", command.held_out_one_in,
                 "one object and one request in so many is kept out of training, to judge by")
      ->capture_default_str();
  app.add_flag("--once", command.once, "train now, and end");
}

void addTrain(CLI::App& app, TrainCommand& command) {
  addStudy(app, command.study);
  app.add_option("--labels", command.labels, "without a store: 'analytic' = s (Eq. 6) of planned contacts")
      ->capture_default_str();
  app.add_option("--out", command.out, "the model file to write")->required();
  app.add_option("--report", command.report, "what was learnt as a page, HTML");
  app.add_flag("--recollections", command.study.recollections,
               "remember the objects too, for planners with recall.enabled; needs --store");
  app.add_flag("--sweep", command.sweep, "networks of all sizes in the report (Fig. 7)");
  app.add_flag("--json", command.json, "print the metrics as JSON");
}

void addEvaluate(CLI::App& app, EvaluateCommand& command) {
  addStudy(app, command.study);
  app.add_flag("--sweep", command.sweep, "1 to 30 hidden nodes, 2 and 3 layers (Fig. 7)");
  app.add_option("--plot", command.plot, "reliability of the scores, SVG; for --target hold");
  app.add_flag("--json", command.json, "print the results as JSON");
}

void addSample(CLI::App& app, SampleCommand& command) {
  app.add_option("object", command.object, "name of a parametric object");
  app.add_option("--out", command.out, "the file to write: .pcd, .ply or .xyz");
  app.add_option("--points", command.points, "points on its surface")->capture_default_str();
  app.add_option("--scale", command.scale, "size relative to the natural one")->capture_default_str();
  app.add_flag("--json", command.json, "print what was written, or the names, as JSON");
  app.add_option("--noise-m", command.noise_m, "standard deviation of the noise on every coordinate, metres")
      ->capture_default_str();
  app.add_option("--seed", command.seed, "seed of points and noise")->capture_default_str();
  app.add_flag("--list", command.list, "print the names of the objects");
}

void addQuality(CLI::App& app, QualityCommand& command) {
  app.add_option("contacts", command.contacts, "JSON file: a grasp, a list of grasps, or a list of contacts")
      ->required();
  app.add_option("--friction", command.friction,
                 "Coulomb coefficient of all contacts; else the file's, else 0.4");
  app.add_option("--edges", command.edges, "edges of the friction cones; else the file's, else 8");
  app.add_option("--norm", command.norm, "'l1': all normal forces sum to 1; 'linf': each is at most 1")
      ->capture_default_str();
  app.add_flag("--json", command.json, "print the values as JSON");
}

void addKeygen(CLI::App& app, KeygenCommand& command) {
  app.add_option("--out", command.out, "file for the secret key; the public one goes beside it, with '.pub'")
      ->capture_default_str();
  app.add_flag("--json", command.json, "print the public key and the files as JSON");
}

void addPublish(CLI::App& app, PublishCommand& command) {
  app.add_option("model", command.model, "the model file")->required();
  app.add_option("--key", command.key, "secret key file, from boxgrasp-trainer keygen")->required();
  app.add_option("--lcm-url", command.server.lcm_url, "LCM's address, where the server is")
      ->capture_default_str();
  app.add_option("--timeout-s", command.server.timeout_s, "give up after this many seconds without an answer")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_flag("--json", command.json, "print the answer as JSON");
}

void addStability(CLI::App& app, StabilityCommand& command) {
  app.add_option("--objects", command.objects, "'builtin', or a folder of meshes and clouds")
      ->capture_default_str();
  app.add_flag("--quick", command.quick, "fewer levels of damage");
  app.add_flag("--beyond", command.beyond, "outliers and uneven density too, which the paper did not try");
  app.add_option("--csv", command.csv,
                 "the table as a file; rows that it already has are not measured again");
  app.add_option("--curves", command.curves,
                 "folder for boxes and volume over t, a CSV and an SVG an object");
  app.add_option("--points", command.points, "points sampled on each mesh")->capture_default_str();
  app.add_option("--seed", command.seed, "seed of points and damage")->capture_default_str();
  app.add_option("--threads", command.threads, "0 = all cores; the result does not depend on it")
      ->capture_default_str();
  app.add_flag("--json", command.json, "print the table as JSON");
}

void addShow(CLI::App& app, ShowCommand& command) {
  app.add_option("grasp", command.grasp, "its id, such as mug@1.00/whole/planner/17")->required();
  app.add_option("--store", command.store, "file of labels; without it the object is planned anew");
  app.add_option("--objects", command.objects, "where the object is: 'builtin', or a folder of meshes")
      ->capture_default_str();
  app.add_option("--out", command.out, "the picture to write, PNG")->capture_default_str();
  app.add_option("--perturbation", command.perturbation, "which label of the store; 0: as planned")
      ->capture_default_str();
}

void addSpread(CLI::App& app, SpreadCommand& command) {
  app.add_option("--object", command.object, "name of a parametric object, or a mesh file in metres")
      ->capture_default_str();
  app.add_option("--scale", command.scale, "size relative to the natural one")->capture_default_str();
  app.add_option("--random", command.random, "random grasps")->capture_default_str();
  app.add_option("--out", command.out, "the plot to write, SVG")->required();
  app.add_option("--seed", command.seed, "seed of the random grasps")->capture_default_str();
  app.add_option("--threads", command.threads, "0 = all cores; the result does not depend on it")
      ->capture_default_str();
  app.add_flag("--json", command.json, "print the summary as JSON");
}

void addRates(CLI::App& app, RatesCommand& command) {
  app.add_option("--objects", command.objects, "'builtin', 'paper' (its Table I), or a folder of meshes")
      ->capture_default_str();
  app.add_option("--scales", command.scales, "sizes relative to the natural one")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--seen", command.seen,
                 "plan on the 'whole' surface, one depth camera's 'view', or a 'pair'")
      ->capture_default_str();
  app.add_option("--views", command.views, "cameras around each object, unless it is seen whole")
      ->capture_default_str();
  app.add_option("--protocol", command.protocol, "lift, lift_shake, six_pushes or six_gravities")
      ->capture_default_str();
  app.add_option(
      "--store", command.store,
      "labels: rank by networks learnt from them without the object at hand; else the built-in model");
  app.add_option("--meshes", command.meshes, "the store's objects: 'builtin', 'paper', or a folder of meshes")
      ->capture_default_str();
  app.add_option("--config", command.config, "the planner's options (TOML)");
  app.add_option("--hand", command.hand, "hand description file (TOML); the Barrett hand if none is given");
  app.add_option("--random", command.random, "random grasps of each object")->capture_default_str();
  app.add_option("--limit", command.limit, "hypotheses tried of each plan, evenly chosen; 0: all")
      ->capture_default_str();
  app.add_flag("--answers-only", command.answers_only, "try the planner's first five alone");
  app.add_option("--seeds", command.seeds, "plans of each sight, with other points and noise")
      ->capture_default_str();
  app.add_option("--seed", command.seed, "of the first of them, and of the random grasps")
      ->capture_default_str();
  app.add_option("--threads", command.threads, "0 = all cores; the result does not depend on it")
      ->capture_default_str();
  app.add_flag("--json", command.json, "print the table as JSON");
}

void addDraw(CLI::App& app, DrawCommand& command) {
  app.add_option("object", command.object, "one of the objects");
  app.add_option("--objects", command.objects, "'builtin', 'paper', names, or a folder of meshes")
      ->capture_default_str();
  app.add_option("--scene", command.scene, "a cloud of a whole scene, instead of an object");
  app.add_option("--store", command.store,
                 "labels: rank by networks learnt from them without the object; else the built-in model");
  app.add_option("--meshes", command.meshes, "the store's objects: 'builtin', 'paper', or a folder of meshes")
      ->capture_default_str();
  app.add_option("--out", command.out, "the picture to write, PNG")->required();
  app.add_option("--grasps", command.grasps, "grasps that are drawn, the best first")->capture_default_str();
  app.add_option("--threads", command.threads, "0 = all cores; the result does not depend on it")
      ->capture_default_str();
  app.add_flag("--json", command.json, "print what was planned as JSON");
}

void addConstellations(CLI::App& app, ConstellationsCommand& command) {
  app.add_option("object", command.object, "one of the objects")->required();
  app.add_option("--objects", command.objects, "'builtin', 'paper', names, or a folder of meshes")
      ->capture_default_str();
  app.add_option("--out", command.out, "the picture to write, PNG")->required();
  app.add_option("--gains", command.gains, "values of t")->delimiter(',')->capture_default_str();
  app.add_option("--points", command.points, "points sampled on the object")->capture_default_str();
  app.add_option("--seed", command.seed, "of these points")->capture_default_str();
  app.add_option("--threads", command.threads, "0 = all cores; the result does not depend on it")
      ->capture_default_str();
  app.add_flag("--json", command.json, "print boxes and volumes over t as JSON");
}

void addReproduce(CLI::App& app, ReproduceCommand& command) {
  app.add_option("--out", command.out,
                 "folder for the report and all numbers; that of an earlier run goes on")
      ->required();
  app.add_option("--objects", command.objects,
                 "'paper' (its Table I), 'builtin', names, or a folder of meshes in metres")
      ->capture_default_str();
  app.add_option("--scenes", command.scenes, "folder of clouds of whole scenes (PCD) to draw grasps in");
  app.add_option("--scanned", command.scanned, "folder of scanned objects' meshes, in metres, to be tried");
  app.add_flag("--quick", command.quick, "three objects and little of everything, to see that all works");
  app.add_option("--seeds", command.seeds, "repetitions with other points and noise")->capture_default_str();
  app.add_option("--threads", command.threads, "0 = all cores; the numbers do not depend on it")
      ->capture_default_str();
}

void addLabel(CLI::App& app, LabelCommand& command) {
  app.add_option("--objects", command.objects, "'builtin', 'paper' (its Table I), or a folder of meshes")
      ->capture_default_str();
  app.add_option("--out", command.out, "the experience store to write, or to go on with")->required();
  app.add_option("--scales", command.scales, "sizes relative to the natural one")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--unit-m", command.unit_m, "unit of the meshes in metres: 0.001 for millimetres")
      ->capture_default_str();
  app.add_option("--target-size-m", command.target_size_m, "longest side of every mesh; 0: as in its file")
      ->capture_default_str();
  app.add_option("--views", command.views, "depth cameras around each object, besides its whole surface")
      ->capture_default_str();
  app.add_flag("--pairs", command.pairs, "each camera's view with that of another, too");
  app.add_option("--perturbations", command.perturbations, "perturbed trials of each hypothesis")
      ->capture_default_str();
  app.add_option("--last-stage", command.last_stage, "close, lift, shake or push")->capture_default_str();
  app.add_flag("--protocols", command.protocols, "the published tests too: six pushes, six gravities");
  app.add_option("--sources", command.sources, "where grasps come from: planner, random, approach")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--limit", command.limit, "hypotheses of each model and source, evenly chosen; 0: all")
      ->capture_default_str();
  app.add_option("--random", command.random, "random grasps of each model")->capture_default_str();
  app.add_option("--hand", command.hand, "hand description file (TOML); the Barrett hand if none is given");
  app.add_option("--only", command.only, "the object of this name alone");
  app.add_option("--shard", command.shard, "i/n: every n-th object and scale, from the i-th on (from 0)");
  app.add_option("--seed", command.seed, "of sampling, cameras and perturbations")->capture_default_str();
  app.add_option("--threads", command.threads, "0 = all cores; the labels do not depend on it")
      ->capture_default_str();
  app.add_flag("--json", command.json, "print the counts as JSON");
}

void addMerge(CLI::App& app, MergeCommand& command) {
  app.add_option("out", command.out, "the store to add to; it is made where there is none")->required();
  app.add_option("shards", command.shards, "the stores to add")->required();
  app.add_flag("--json", command.json, "print the counts as JSON");
}

void addSummary(CLI::App& app, SummaryCommand& command) {
  app.add_option("store", command.store, "the experience store")->required();
  app.add_flag("--json", command.json, "print the summary as JSON");
}

void addObjectSet(CLI::App& app, ObjectsCommand& command) {
  app.add_option("--objects", command.objects, "'builtin', 'paper' (its Table I), or a folder of meshes")
      ->capture_default_str();
  app.add_option("--scales", command.scales, "sizes relative to the natural one")->capture_default_str();
  app.add_option("--unit-m", command.unit_m, "unit of the meshes in metres: 0.001 for millimetres")
      ->capture_default_str();
  app.add_option("--target-size-m", command.target_size_m, "longest side of every mesh; 0: as in its file")
      ->capture_default_str();
}

void addObjectRows(CLI::App& app, ObjectsCommand& command) {
  addObjectSet(app, command);
  app.add_flag("--json", command.json, "print the rows as JSON");
}

void addObjectsFetch(CLI::App& app, ObjectsCommand& command) {
  app.add_option("folder", command.folder, "where the meshes go")->capture_default_str();
}

void addObjectsView(CLI::App& app, ObjectsCommand& command) {
  addObjectSet(app, command);
  app.add_option("name", command.name, "one of the objects")->required();
  app.add_option("--out", command.out, "the picture to write, PNG")->capture_default_str();
}

// The commands below a program or another command: what each takes from the line, and what it does.
class Commands {
 public:
  explicit Commands(CLI::App& parent) : parent_(parent) { parent_.require_subcommand(1); }

  // `run` returns an exit code, or nothing where the only one is kDone.
  template <typename Command, typename Run>
  void add(const char* name, const char* what, void (*addOptions)(CLI::App&, Command&), Run run) {
    CLI::App* app = parent_.add_subcommand(name, what);
    const auto command = std::make_shared<Command>();
    addOptions(*app, *command);
    runs_.emplace_back(app, [command, run] {
      if constexpr (std::is_void_v<decltype(run(*command))>) {
        run(*command);
        return int{kDone};
      } else {
        return int{run(*command)};
      }
    });
  }

  // Runs the one that the parsed line names.
  int runNamed() const {
    const auto named =
        std::find_if(runs_.begin(), runs_.end(), [](const auto& one) { return one.first->parsed(); });
    return named->second();
  }

 private:
  CLI::App& parent_;
  std::vector<std::pair<CLI::App*, std::function<int()>>> runs_;
};

// Commands of their own below `objects`.
void addObjects(CLI::App& app, std::optional<Commands>& commands) {
  commands.emplace(app);
  commands->add("list", "print the names of a set", addObjectRows, listObjects);
  commands->add("check", "load each object and say what is wrong with it", addObjectRows, checkObjects);
  commands->add("fetch", "take meshes from Debian's packages", addObjectsFetch, fetchObjects);
  commands->add("view", "draw an object and what a depth camera sees of it", addObjectsView, viewObject);
}

void addLearning(Commands& commands, const std::string& command_line) {
  commands.add("label", "try planned grasps in the simulator and keep the results", addLabel, runLabel);
  commands.add("merge", "make one experience store of several", addMerge, runMerge);
  commands.add("summary", "print what an experience store holds", addSummary, runSummary);
  commands.add("train", "learn from labels and write a model file", addTrain,
               [command_line](const TrainCommand& command) { runTrain(command, command_line); });
  commands.add("evaluate", "measure how well learning ranks grasps of objects never seen", addEvaluate,
               runEvaluate);
  commands.add("keygen", "make a key for publishing models", addKeygen, runKeygen);
  commands.add("publish", "sign a model, send it to the server, and wait for its answer", addPublish,
               runPublish);
  commands.add("work", "retrain in the background with what robots report, and publish what is better",
               addWork, runWork);
}

void addStudies(Commands& commands) {
  commands.add("sample", "write a point cloud of a parametric object", addSample, runSample);
  commands.add("objects", "list, check, fetch and view objects", addObjects,
               [](const std::optional<Commands>& below) { return below->runNamed(); });
  commands.add("quality", "print epsilon, nu and force closure of contacts", addQuality, runQuality);
  commands.add("show", "draw a simulated grasp as a filmstrip", addShow, runShow);
  commands.add("draw", "draw the best grasps of an object or in a scene", addDraw, runDraw);
  commands.add("constellations", "draw an object's boxes for several t and splits (Fig. 3)",
               addConstellations, runConstellations);
  commands.add("stability", "measure how much of a decomposition survives noise and missing points (Table I)",
               addStability, runStability);
  commands.add("spread", "plot the planner's grasps among random ones on the axes epsilon and nu (Fig. 5)",
               addSpread, runSpread);
  commands.add("rates", "simulate how often the planner's grasps are held, and random ones", addRates,
               runRates);
  commands.add("reproduce", "run the paper's whole evaluation, and write a report beside its numbers",
               addReproduce, runReproduce);
}

int failed(const std::exception& error, int code) {
  fmt::print(stderr, "boxgrasp-trainer: {}{}\n", code == kInternalError ? "internal error: " : "",
             error.what());
  return code;
}

int run(const Commands& commands) {
  try {
    return commands.runNamed();
  } catch (const Stopped&) {
    fmt::print(stderr, "boxgrasp-trainer: stopped; nothing was written\n");
    return kInterrupted;
  } catch (const InputError& error) {
    return failed(error, kBadInput);
  } catch (const NotReachable& error) {
    return failed(error, kNotReachable);
  } catch (const TransportError& error) {
    return failed(error, kNotReachable);
  } catch (const NoAnswer& error) {
    return failed(error, kDeadlinePassed);
  } catch (const std::exception& error) {
    return failed(error, kInternalError);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Trains the networks that rank Boxgrasp's grasps."};
  app.set_version_flag("--version", BOXGRASP_VERSION);
  Commands commands(app);
  addLearning(commands, commandLine(argc, argv));
  addStudies(commands);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kUsage;
  }
  return run(commands);
}
