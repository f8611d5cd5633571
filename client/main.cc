// boxgrasp: the command line of the grasp planner.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/exit_code.h"
#include "boxgrasp/messaging/plan_conversion.h"
#include "boxgrasp/models_request_t.hpp"
#include "commands.h"
#include "doctor_command.h"
#include "export_command.h"
#include "feedback_command.h"
#include "hand_command.h"
#include "log_commands.h"
#include "models_command.h"
#include "monitor_command.h"
#include "plan_json.h"
#include "remote.h"

namespace {

using namespace boxgrasp;

void addCloudOptions(CLI::App& app, PlanCommand& command, const std::string& file) {
  app.add_option("file", command.file, file)->required();
  app.add_option("--scale", command.read.scale,
                 "multiplies every coordinate; 0.001 for a file in millimetres")
      ->check(CLI::PositiveNumber);
  app.add_option("--samples", command.read.mesh_samples, "points sampled on a mesh")->capture_default_str();
  app.add_option("--seed", command.read.seed, "of that sampling")->capture_default_str();
  app.add_option("--frame", command.frame, "name of the cloud's frame")->capture_default_str();
  app.add_option("--gravity", command.gravity, "direction of gravity in the cloud's frame, as 0,0,-1")
      ->delimiter(',');
  app.add_option("--viewpoint", command.viewpoints,
                 "where the sensor stood in the cloud's frame, metres, as X Y Z; else what the file says; "
                 "once for each "
                 "sensor where several views were joined")
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

void addRobotOptions(CLI::App& app, RobotFlags& robot) {
  app.add_option(
         "--table", robot.table,
         "plane on which the objects stand, in the cloud's frame: a point and the normal, as X Y Z NX NY NZ; "
         "else it is looked for")
      ->delimiter(',');
  app.add_option("--answer-frame", robot.answer_frame, "answer in the frame of the cloud or of the robot")
      ->transform(CLI::Transformer(
          std::map<std::string, AnswerFrame>{{"cloud", AnswerFrame::cloud}, {"robot", AnswerFrame::robot}}));
  app.add_option("--camera-pose", robot.camera_pose,
                 "the cloud's frame in the robot's: position and quaternion, as X Y Z QW QX QY QZ")
      ->delimiter(',');
  app.add_option("--approach", robot.approach,
                 "come along this direction, in the robot's frame, as X Y Z ...")
      ->delimiter(',');
  app.add_option("--approach-cone-rad", robot.approach_cone_rad, "... or lean from it by so much at most")
      ->capture_default_str();
  app.add_option("--workspace", robot.workspace,
                 "keep the palm in this box of the robot's frame: two corners, as X Y Z X Y Z")
      ->delimiter(',');
  app.add_option("--forbidden", robot.forbidden,
                 "keep the hand out of this box of the robot's frame, as X Y Z X Y Z; any number of times")
      ->delimiter(',');
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
  addCloudOptions(*sub, command, "point cloud (PCD, PLY, XYZ) or mesh (OFF, OBJ, STL, PLY)");
  addRobotOptions(*sub, command.robot);
  addLocalOptions(*sub, command);
  addOutputOptions(*sub, command.lcm_url, command.json);
  sub->add_option(
      "--request-id", command.request_id,
      "the name under which the server remembers this plan, for feedback; a new one if none is given");
  sub->add_flag("--local", command.local, "plan in this process, without a server");
  sub->add_option("--picture", command.picture, "also draw the plan into this PNG file");
  sub->add_option("--html", command.html, "also write the plan as an interactive 3D page, one HTML file");
  return sub;
}

CLI::App* addExport(CLI::App& app, ExportCommand& command) {
  CLI::App* sub = app.add_subcommand("export", "write grasps in the formats of other programs");
  addCloudOptions(*sub, command.plan, "plan, as `boxgrasp plan --json` prints it; or what can be planned on");
  addRobotOptions(*sub, command.plan.robot);
  addLocalOptions(*sub, command.plan);
  sub->add_option("--lcm-url", command.plan.lcm_url, "LCM's address, where the server is")
      ->capture_default_str();
  sub->add_flag("--local", command.plan.local, "plan in this process, without a server");
  sub->add_option("--format", command.format, "csv, graspnet (17 numbers a grasp) or isaac_grasp (YAML)")
      ->capture_default_str()
      ->check(CLI::IsMember({"csv", "graspnet", "isaac_grasp"}));
  sub->add_option("--out", command.out, "file; stdout if none is given; *.npy: graspnet as numpy saves it");
  sub->add_flag("--tool", command.tool, "poses of the robot's tool instead of the palm");
  sub->add_option("--joint-names", command.joint_names, "names of the joints, in the order of the plan's")
      ->delimiter(',');
  return sub;
}

CLI::App* addHand(CLI::App& app, HandCommand& command) {
  CLI::App* all = app.add_subcommand("hand", "look at hand descriptions");
  all->require_subcommand(1);
  CLI::App* sub =
      all->add_subcommand("check", "say what is wrong with a hand description, or what the hand can do");
  sub->add_option("file", command.file, "hand description (TOML)")->required();
  sub->add_option("--picture", command.picture,
                  "also draw the hand open, half closed and closed into this file, .png or .svg");
  sub->add_flag("--json", command.json, "print JSON");
  return all;
}

// The commands below `models`.
struct ModelsApps {
  CLI::App *all, *list, *show, *compare, *pin, *unpin, *roll_back;
};

ModelsApps addModels(CLI::App& app, ModelsCommand& command, PlanCommand& output) {
  CLI::App* all = app.add_subcommand("models", "see and choose the models that the server ranks with");
  all->require_subcommand(1);
  const auto add = [&](const char* name, const char* what) {
    CLI::App* sub = all->add_subcommand(name, what);
    addOutputOptions(*sub, output.lcm_url, output.json);
    return sub;
  };
  const auto order = [&](const char* name, const char* what) {
    CLI::App* sub = add(name, what);
    sub->add_option("--key", command.key, "secret key file that the server trusts")->required();
    return sub;
  };
  const ModelsApps apps{all,
                        add("list", "print all models; * is in service"),
                        add("show", "print what a model was made of, and its metrics"),
                        add("compare", "print two models side by side"),
                        order("pin", "use one model, whatever is published"),
                        order("unpin", "use the newest model that was not rejected"),
                        order("rollback", "reject the model in service, and use the one before it")};
  for (CLI::App* sub : {apps.show, apps.compare, apps.pin})
    sub->add_option("version", command.version, "the model's version")->required();
  apps.compare->add_option("other", command.other, "the other's version")->required();
  return apps;
}

int runModels(const ModelsApps& apps, const ModelsCommand& command, const PlanCommand& output) {
  const auto run = [&](int action) { return runModelsOrder(command, action, output.lcm_url, output.json); };
  if (apps.show->parsed()) return runModelsShow(command, output.lcm_url, output.json);
  if (apps.compare->parsed()) return runModelsCompare(command, output.lcm_url, output.json);
  if (apps.pin->parsed()) return run(models_request_t::PIN);
  if (apps.unpin->parsed()) return run(models_request_t::UNPIN);
  if (apps.roll_back->parsed()) return run(models_request_t::ROLL_BACK);
  return runModelsList(output.lcm_url, output.json);
}

CLI::App* addDoctor(CLI::App& app, DoctorCommand& command, PlanCommand& output) {
  CLI::App* sub = app.add_subcommand(
      "doctor", "say what is wrong with network, server, model, keys and store, and how to mend it");
  sub->add_option("--state-dir", command.state_dir, "the server's folder for models and outcomes")
      ->capture_default_str();
  sub->add_option("--trusted-keys", command.trusted_keys, "the server's folder of public keys")
      ->capture_default_str();
  sub->add_option("--model", command.model, "model file to look at; else the built-in one");
  addOutputOptions(*sub, output.lcm_url, output.json);
  return sub;
}

CLI::App* addFeedback(CLI::App& app, FeedbackCommand& command, PlanCommand& output) {
  CLI::App* sub = app.add_subcommand("feedback", "tell the server what became of a grasp");
  sub->add_option("request_id", command.request_id, "of the plan, as `boxgrasp plan` says it")->required();
  sub->add_option("index", command.grasp_index, "of the grasp in the answer, from 0")
      ->required()
      ->check(CLI::NonNegativeNumber);
  sub->add_flag("--succeeded,!--failed", command.succeeded, "whether the object was held to the end")
      ->required();
  sub->add_option("--what", command.what, "what happened, in words");
  sub->add_option("--robot", command.robot, "who reports; this machine's name if none is given");
  sub->add_option("--forces-n", command.forces_n, "forces at the fingers, newtons")->delimiter(',');
  addOutputOptions(*sub, output.lcm_url, output.json);
  return sub;
}

CLI::App* addMonitor(CLI::App& app, MonitorCommand& command) {
  CLI::App* sub =
      app.add_subcommand("monitor", "show what is said on the bus: rates, sizes, losses, latest values");
  sub->add_option("--channel", command.channels, "channels to listen to; '*' stands for any text")
      ->capture_default_str();
  sub->add_option("--seconds", command.seconds, "end after so long; else when interrupted")
      ->check(CLI::PositiveNumber);
  sub->add_flag("--once", command.once, "listen for a while, and print one table");
  addOutputOptions(*sub, command.lcm_url, command.json);
  return sub;
}

struct LogApps {
  CLI::App *record, *replay;
};

LogApps addLogs(CLI::App& app, LogCommand& command) {
  const auto add = [&](const char* name, const char* what) {
    CLI::App* sub = app.add_subcommand(name, what);
    sub->add_option("file", command.file, "LCM event log; lcm-logplayer plays it, lcm-logger makes such ones")
        ->required();
    sub->add_option("--channel", command.channels, "channels; '*' stands for any text")
        ->capture_default_str();
    addOutputOptions(*sub, command.lcm_url, command.json);
    return sub;
  };
  const LogApps apps{add("record", "write what is said on the bus into a file"),
                     add("replay", "say what is in such a file again")};
  apps.record->add_option("--seconds", command.seconds, "end after so long; else when interrupted")
      ->check(CLI::PositiveNumber);
  apps.replay->add_option("--speed", command.speed, "times as fast as it was recorded")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  return apps;
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
  DoctorCommand doctor_command;
  const CLI::App* doctor = addDoctor(app, doctor_command, command);
  CLI::App* status = app.add_subcommand("status", "print how the server is");
  addOutputOptions(*status, command.lcm_url, command.json);
  ModelsCommand models_command;
  const ModelsApps models = addModels(app, models_command, command);
  FeedbackCommand feedback_command;
  const CLI::App* feedback = addFeedback(app, feedback_command, command);
  HandCommand hand_command;
  const CLI::App* hand = addHand(app, hand_command);
  ExportCommand export_command;
  const CLI::App* exporting = addExport(app, export_command);
  MonitorCommand monitor_command;
  const CLI::App* monitor = addMonitor(app, monitor_command);
  LogCommand log_command;
  const LogApps logs = addLogs(app, log_command);
  try {
    app.parse(argc, argv);
    command.json |= monitor_command.json || log_command.json || hand_command.json;
    if (show->parsed()) {
      command.local = true;
      if (!command.draws()) throw CLI::RequiredError("--picture or --html");
    }
    checkTogether(exporting->parsed() ? export_command.plan : command);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kUsage;
  }
  try {
    if (plan->parsed()) return runPlan(command);
    if (explain->parsed()) return runExplain(command);
    if (show->parsed()) return runShow(command);
    if (models.all->parsed()) return runModels(models, models_command, command);
    if (hand->parsed()) return runHandCheck(hand_command);
    if (exporting->parsed()) return runExport(export_command);
    if (monitor->parsed()) return runMonitor(monitor_command);
    if (logs.record->parsed()) return runRecord(log_command);
    if (logs.replay->parsed()) return runReplay(log_command);
    if (doctor->parsed()) return runDoctor(doctor_command, command.lcm_url, command.json);
    if (feedback->parsed()) return runFeedback(feedback_command, command.lcm_url, command.json);
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
