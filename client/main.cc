// boxgrasp: the command line of the grasp planner.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/exit_code.h"
#include "boxgrasp/messaging/plan_conversion.h"
#include "commands.h"
#include "plan_json.h"
#include "remote.h"

namespace {

using namespace boxgrasp;

void addCloudOptions(CLI::App& app, PlanCommand& command) {
  app.add_option("file", command.file, "point cloud (PCD, PLY, XYZ) or mesh (OFF, OBJ, STL, PLY)")
      ->required();
  app.add_option("--scale", command.read.scale,
                 "multiplies every coordinate; 0.001 for a file in millimetres")
      ->check(CLI::PositiveNumber);
  app.add_option("--samples", command.read.mesh_samples, "points sampled on a mesh")->capture_default_str();
  app.add_option("--seed", command.read.seed, "of that sampling")->capture_default_str();
  app.add_option("--frame", command.frame, "name of the cloud's frame")->capture_default_str();
  app.add_option("--gravity", command.gravity, "direction of gravity in the cloud's frame, as 0,0,-1")
      ->delimiter(',');
  app.add_option("--object", command.object, "plan this object of a scene alone, 0 the largest; -1: all")
      ->capture_default_str()
      ->check(CLI::Range(-1, 1'000'000));
  app.add_option("--top", command.top, "grasps in the answer; 0: all")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  app.add_option("--friction", command.friction, "Coulomb coefficient of finger on object")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--deadline-s", command.deadline_s, "give up after this many seconds")
      ->check(CLI::PositiveNumber);
}

void addLocalOptions(CLI::App& app, PlanCommand& command) {
  app.add_option("--config", command.config,
                 "configuration of the plan made here; deploy/boxgrasp.toml explains it");
  app.add_option("--model", command.model, "model file for the plan made here; else the built-in one");
  app.add_option("--hand", command.hand, "hand description for the plan made here; else the Barrett hand");
}

void addOutputOptions(CLI::App& app, std::string& lcm_url, bool& json) {
  app.add_option("--lcm-url", lcm_url, "LCM's address, where the server is")->capture_default_str();
  app.add_flag("--json", json, "print JSON");
}

CLI::App* addPlanCommand(CLI::App& app, const std::string& name, const std::string& what,
                         PlanCommand& command) {
  CLI::App* sub = app.add_subcommand(name, what);
  addCloudOptions(*sub, command);
  addLocalOptions(*sub, command);
  addOutputOptions(*sub, command.lcm_url, command.json);
  sub->add_flag("--local", command.local, "plan in this process, without a server");
  sub->add_option("--picture", command.picture, "also draw the plan into this PNG file");
  sub->add_option("--html", command.html, "also write the plan as an interactive 3D page, one HTML file");
  return sub;
}

// A problem that ended the command: as words on stderr, and as JSON where that was asked for.
int fail(const PlanCommand& command, bool json, const std::string& outcome, const std::string& message,
         int code) {
  if (json) {
    Json answer = planJson(refusal(plan_response_t::BAD_INPUT, message, "", command.frame));
    answer["outcome"] = outcome;
    fmt::print("{}\n", jsonText(answer));
  }
  fmt::print(stderr, "boxgrasp: {}\n", message);
  return code;
}

// What reading a plan's options alone cannot refuse.
void checkTogether(const PlanCommand& command) {
  const bool plans_here = command.local || command.draws();
  if (!plans_here && (command.config || command.model || command.hand))
    throw CLI::ValidationError("--config, --model and --hand",
                               "are for plans made here; add --local, or give them to boxgrasp-server");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Ranked grasps of a Barrett hand for a point cloud."};
  app.set_version_flag("--version", BOXGRASP_VERSION);
  app.require_subcommand(1);
  PlanCommand command;
  const CLI::App* plan = addPlanCommand(app, "plan", "print ranked grasps", command);
  const CLI::App* explain =
      addPlanCommand(app, "explain", "print where grasp candidates were lost, and why", command);
  const CLI::App* show =
      addPlanCommand(app, "show", "draw the plan, made in this process, into --picture or --html", command);
  CLI::App* status = app.add_subcommand("status", "print how the server is");
  addOutputOptions(*status, command.lcm_url, command.json);
  try {
    app.parse(argc, argv);
    if (show->parsed()) {
      command.local = true;
      if (!command.draws()) throw CLI::RequiredError("--picture or --html");
    }
    if (!status->parsed()) checkTogether(command);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kUsage;
  }
  try {
    if (plan->parsed()) return runPlan(command);
    if (explain->parsed()) return runExplain(command);
    if (show->parsed()) return runShow(command);
    return runStatus(command.lcm_url, command.json);
  } catch (const InputError& error) {
    return fail(command, command.json, "bad_input", error.what(), kBadInput);
  } catch (const NotReachable& error) {
    return fail(command, command.json, "not_reachable", error.what(), kNotReachable);
  } catch (const TransportError& error) {
    return fail(command, command.json, "not_reachable", error.what(), kNotReachable);
  } catch (const NoAnswer& error) {
    return fail(command, command.json, "deadline", error.what(), kDeadlinePassed);
  } catch (const std::exception& error) {
    return fail(command, command.json, "internal_error", fmt::format("internal error: {}", error.what()),
                kInternalError);
  }
}
