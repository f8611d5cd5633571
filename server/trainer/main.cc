// boxgrasp-trainer: labels grasps, trains and publishes models.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/exit_code.h"
#include "quality_command.h"
#include "sample_command.h"
#include "train_command.h"

namespace {

using namespace boxgrasp;

std::string commandLine(int argc, char** argv) {
  std::string line = "boxgrasp-trainer";
  for (int i = 1; i < argc; ++i) line += fmt::format(" {}", argv[i]);
  return line;
}

void addTrain(CLI::App& app, TrainCommand& command) {
  app.add_option("--labels", command.labels,
                 "where the labels come from: 'analytic' = s (Eq. 6) of planned contacts")
      ->capture_default_str();
  app.add_option("--out", command.out, "the model file to write")->required();
  app.add_option("--hidden", command.hidden, "nodes of each hidden layer")->capture_default_str();
  app.add_option("--objects", command.objects, "parametric objects to train on; all if none is given");
  app.add_option("--features", command.features,
                 "'relative': measures without their units; 'raw': as in the paper")
      ->capture_default_str();
  app.add_option("--points", command.points, "points sampled on each object")->capture_default_str();
  app.add_option("--repeats", command.repeats, "repeats of the leave-one-object-out validation")
      ->capture_default_str();
  app.add_option("--seed", command.seed, "seed of sampling, validation and first weights")
      ->capture_default_str();
  app.add_option("--threads", command.threads, "0 = all cores; the result does not depend on it")
      ->capture_default_str();
  app.add_option("--hand", command.hand, "hand description file (TOML); the Barrett hand if none is given");
  app.add_flag("--json", command.json, "print the metrics as JSON");
}

void addSample(CLI::App& app, SampleCommand& command) {
  app.add_option("object", command.object, "name of a parametric object");
  app.add_option("--out", command.out, "the file to write: .pcd, .ply or .xyz");
  app.add_option("--points", command.points, "points on its surface")->capture_default_str();
  app.add_option("--scale", command.scale, "size relative to the natural one")->capture_default_str();
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

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Trains the networks that rank Boxgrasp's grasps."};
  app.set_version_flag("--version", BOXGRASP_VERSION);
  app.set_help_all_flag("--help-all", "print the help of every command");
  app.require_subcommand(1);
  TrainCommand train;
  SampleCommand sample;
  CLI::App* train_app = app.add_subcommand("train", "learn from labels and write a model file");
  CLI::App* sample_app = app.add_subcommand("sample", "write a point cloud of a parametric object");
  QualityCommand quality;
  CLI::App* quality_app = app.add_subcommand("quality", "print epsilon, nu and force closure of contacts");
  addQuality(*quality_app, quality);
  addTrain(*train_app, train);
  addSample(*sample_app, sample);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kUsage;
  }
  try {
    if (train_app->parsed()) runTrain(train, commandLine(argc, argv));
    if (sample_app->parsed()) runSample(sample);
    if (quality_app->parsed()) runQuality(quality);
    return kDone;
  } catch (const InputError& error) {
    fmt::print(stderr, "boxgrasp-trainer: {}\n", error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    fmt::print(stderr, "boxgrasp-trainer: internal error: {}\n", error.what());
    return kInternalError;
  }
}
