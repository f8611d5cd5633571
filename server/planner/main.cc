// boxgrasp-server: plans grasps for point clouds that arrive over LCM.
#include <malloc.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/exit_code.h"
#include "boxgrasp/messaging/lcm_bus.h"
#include "boxgrasp/planning/default_model.h"
#include "boxgrasp/planning/planner_config.h"
#include "daemon.h"
#include "logging.h"

namespace {

using namespace boxgrasp;

struct CommandLine {
  std::optional<std::filesystem::path> config, model, hand;
  std::optional<std::string> lcm_url, state_dir, trusted_keys, http, metrics;
  std::string log_level = "info";
  std::optional<int> workers, queue;
};

void addOptions(CLI::App& app, CommandLine& line) {
  app.add_option("--lcm-url", line.lcm_url,
                 "LCM's address, as udpm://239.255.76.67:7667?ttl=0 or tcpq://HOST:PORT");
  app.add_option("--config", line.config, "configuration (TOML); deploy/boxgrasp.toml explains every key");
  app.add_option("--model", line.model,
                 "model that ranks the grasps until one is published; the built-in one if none is given");
  app.add_option("--hand", line.hand, "hand description (TOML); the Barrett hand if none is given");
  app.add_option("--state-dir", line.state_dir, "folder for published models and robots' outcomes");
  app.add_option("--trusted-keys", line.trusted_keys,
                 "folder with the public keys (*.pub) of those who may publish models");
  app.add_option("--http", line.http,
                 "address of a page that shows the latest plans, as 127.0.0.1:8080; read-only");
  app.add_option("--metrics", line.metrics, "address of the metrics for Prometheus, as 127.0.0.1:9464");
  app.add_option("--log-level", line.log_level, "debug, info, warning or error")->capture_default_str();
  app.add_option("--workers", line.workers, "plans that run at the same time");
  app.add_option("--queue", line.queue, "requests that wait; one more is answered 'overloaded'");
}

void run(const CommandLine& line) {
  spdlog::set_level(logLevel(line.log_level));
  PlannerOptions planner_options;
  ServerOptions options;
  if (line.config) {
    ConfigFile file(*line.config);
    planner_options = readPlannerOptions(file);
    options = readServerOptions(file);
    file.finish();
    for (const std::string& key : file.changed()) spdlog::info("{} sets {}", line.config->string(), key);
  }
  options.lcm_url = line.lcm_url.value_or(options.lcm_url);
  options.state_dir = line.state_dir.value_or(options.state_dir);
  options.trusted_keys = line.trusted_keys.value_or(options.trusted_keys);
  options.http = line.http.value_or(options.http);
  options.metrics = line.metrics.value_or(options.metrics);
  options.workers = line.workers.value_or(options.workers);
  options.queue = line.queue.value_or(options.queue);
  options.validate();
  const HandDescription hand = handOrBarrett(line.hand);
  GraspPlanner planner(hand, modelOrDefault(line.model, hand), planner_options);
  spdlog::info("boxgrasp-server " BOXGRASP_VERSION ", model {} ({}), hand {}", planner.model().version,
               planner.model().name, planner.hand().name);
  serve(std::move(planner), options);
}

// What a large cloud takes goes back to the system once it is planned. glibc would raise this threshold with
// the first such cloud, keep its memory, and break up what it keeps. Below it stay the arrays of ordinary
// clouds: fresh pages for each of them would cost 300,000 points a quarter of their plan.
void giveBackLargeMemory() { mallopt(M_MMAP_THRESHOLD, 3 << 20); }

}  // namespace

int main(int argc, char** argv) {
  giveBackLargeMemory();
  logToStderr(isJournalOnStderr());
  CLI::App app{"Plans grasps for a Barrett hand from point clouds that arrive over LCM."};
  app.set_version_flag("--version", BOXGRASP_VERSION);
  CommandLine line;
  addOptions(app, line);
  try {
    app.parse(argc, argv);
    run(line);
    return kDone;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kUsage;
  } catch (const InputError& error) {
    spdlog::error("{}", error.what());
    return kBadInput;
  } catch (const TransportError& error) {
    spdlog::error("{}", error.what());
    return kNotReachable;
  } catch (const std::exception& error) {
    spdlog::error("internal error: {}", error.what());
    return kInternalError;
  }
}
