// Hours at half load: plans, some of them asked for twice, outcomes, bytes that are no message, and a model
// published each minute; meanwhile the memory, descriptors and threads of the server and its receiver are
// noted. Exit code 1: something grew, or an answer is missing. --json FILE writes all samples, --plot FILE a
// picture (SVG).
#include <CLI/CLI.hpp>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "boxgrasp/base/random.h"
#include "boxgrasp/messaging/publication.h"
#include "boxgrasp/registry/model_registry.h"
#include "boxgrasp/rendering/svg_plot.h"
#include "served.h"
#include "test_model.h"

namespace boxgrasp::test {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

struct CommandLine {
  double minutes = 60.0, warm_up_minutes = 3.0;
  fs::path json, plot, server = BOXGRASP_SERVER;
};

struct Sample {
  double time_s = 0.0, server_mb = NAN, receiver_mb = NAN;
  double descriptors = 0.0, threads = 0.0;  // of both together
};

double descriptorsOf(pid_t process) {
  std::error_code error;
  const fs::directory_iterator files(fmt::format("/proc/{}/fd", process), error);
  return error ? NAN : static_cast<double>(std::distance(files, fs::directory_iterator()));
}

Sample sampleOf(const Served& served, pid_t server, double time_s) {
  const pid_t receiver = served.receiver();
  return {time_s, processStatus(server, "VmRSS") / 1024, processStatus(receiver, "VmRSS") / 1024,
          descriptorsOf(server) + descriptorsOf(receiver),
          processStatus(server, "Threads") + processStatus(receiver, "Threads")};
}

// A user of everything the server does.
class Load {
 public:
  Load(Served& served, const SigningKey& key) : served_(served), key_(key) {
    for (const char* name : {"paper_cup", "mug", "bottle", "teapot"}) {
      for (const std::size_t points : {2000, 8000, 20'000})
        clouds_.push_back(sampleSurface(parametricObject(name), points, 1));
    }
  }

  // Plans a second when two are always asked for.
  double capacity(double time_s) {
    const auto begin = Clock::now();
    const auto passed = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
    const auto answered = answers_;
    while (passed() < time_s) {
      if (waiting_.size() < 2) plan();
      served_.wire.until([&] { return takeAnswers() > 0; }, 1.0);
    }
    const double rate = static_cast<double>(answers_ - answered) / passed();
    settle();
    return rate;
  }

  // One request, and now and then what else there is.
  void step() {
    ++steps_;
    plan();
    if (steps_ % 10 == 0) served_.wire.send(channel::kPlanRequest, last_);
    if (steps_ % 25 == 0) served_.wire.send(channel::kPlanRequest, cancel_t{0, "no plan request"});
    takeAnswers();
  }

  void publishModel() {
    Model model = linearModel();
    model.name = fmt::format("soak {}", ++models_);
    model.created = modelTime(begin_ + models_ * std::int64_t{1'000'000});
    model.ensemble.networks[0].layers[0].weights(0, 0) = 0.2 + 1e-6 * static_cast<double>(models_);
    TemporaryFolder folder;
    writeModel(model, folder / "model.json");
    std::ifstream stream(folder / "model.json");
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    const model_reply_t reply = served_.wire.publish(publication(bytes, key_));
    served_.wire.publications.clear();
    if (reply.outcome != model_reply_t::IN_SERVICE)
      throw std::runtime_error("a model is refused: " + reply.message);
  }

  // Waits for what is under way.
  void settle() {
    served_.wire.until([&] { return takeAnswers(), waiting_.empty(); }, 30.0);
  }

  std::int64_t answers() const { return answers_; }
  std::int64_t reports() const { return reports_; }
  std::int64_t models() const { return models_; }
  std::size_t missing() const { return waiting_.size(); }
  std::int64_t refused() const { return refused_; }

 private:
  void plan() {
    last_ = served_.request(clouds_[uniformIndex(random_, clouds_.size())]);
    waiting_.insert(last_.request_id);
    served_.wire.send(channel::kPlanRequest, last_);
  }

  // Each grasp that was planned first in an answer is reported.
  std::size_t takeAnswers() {
    const auto answers = std::exchange(served_.wire.answers, {});
    served_.wire.raw.clear();
    std::size_t fresh = 0;
    for (const plan_response_t& answer : answers) {
      if (waiting_.erase(answer.request_id) == 0) continue;
      ++fresh;
      refused_ += answer.outcome == plan_response_t::OVERLOADED;
      if (answer.grasps.empty()) continue;
      ++reports_;
      const auto robot = fmt::format("robot {}", uniformIndex(random_, 3));
      served_.wire.send(
          channel::kGraspOutcome,
          grasp_outcome_t{
              utimeNow(), answer.request_id, 0, robot, uniformIndex(random_, 2) == 0, "soak", 0, {}});
    }
    answers_ += static_cast<std::int64_t>(fresh);
    return fresh;
  }

  Served& served_;
  const SigningKey& key_;
  std::vector<PointCloud> clouds_;
  std::mt19937_64 random_{1};
  plan_request_t last_;
  std::set<std::string> waiting_;
  const std::int64_t begin_ = utimeNow() - 86'400'000'000;
  std::int64_t steps_ = 0, answers_ = 0, reports_ = 0, models_ = 0, refused_ = 0;
};

// The largest value of the first and of the second half of the time after the warm-up.
std::pair<double, double> halves(const std::vector<Sample>& samples, double warm_up_s,
                                 double Sample::*figure) {
  const double middle_s = (warm_up_s + samples.back().time_s) / 2;
  std::pair<double, double> most{0.0, 0.0};
  for (const Sample& sample : samples) {
    if (sample.time_s < warm_up_s) continue;
    double& half = sample.time_s < middle_s ? most.first : most.second;
    half = std::fmax(half, sample.*figure);
  }
  return most;
}

class Growth {
 public:
  Growth(const std::vector<Sample>& samples, double warm_up_s) : samples_(samples), warm_up_s_(warm_up_s) {}

  void check(const std::string& what, double Sample::*figure, double allowed) {
    const auto [first, second] = halves(samples_, warm_up_s_, figure);
    const bool grew = second > first + allowed;
    grew_ |= grew;
    fmt::print("{:<26} {:>10.1f} {:>10.1f}  at most {:.0f} more{}\n", what, first, second, allowed,
               grew ? ": GREW" : "");
    json_.push_back({{"what", what}, {"first_half", first}, {"second_half", second}, {"allowed", allowed}});
  }
  bool grew() const { return grew_; }
  const Json& json() const { return json_; }

 private:
  const std::vector<Sample>& samples_;
  const double warm_up_s_;
  bool grew_ = false;
  Json json_ = Json::array();
};

Plot plotOf(const std::vector<Sample>& samples, double rate) {
  Plot plot;
  plot.title = "What the server takes at half load";
  plot.subtitle = fmt::format("{:.1f} plans a second", rate);
  plot.x.label = "time [min]";
  plot.y.label = "memory [MB]";
  plot.second_y.label = "descriptors, threads (both processes)";
  plot.y.low = plot.second_y.low = 0.0;
  const auto add = [&](const std::string& name, double Sample::*figure, bool second) {
    Series series;
    series.name = name;
    series.second_axis = second;
    series.dashed = second;
    for (const Sample& sample : samples) series.points.push_back({sample.time_s / 60, sample.*figure});
    plot.series.push_back(series);
  };
  add("memory, server", &Sample::server_mb, false);
  add("memory, receiver", &Sample::receiver_mb, false);
  add("descriptors", &Sample::descriptors, true);
  add("threads", &Sample::threads, true);
  return plot;
}

Json jsonOf(const std::vector<Sample>& samples) {
  Json list = Json::array();
  for (const Sample& sample : samples)
    list.push_back({{"time_s", sample.time_s},
                    {"server_mb", sample.server_mb},
                    {"receiver_mb", sample.receiver_mb},
                    {"descriptors", sample.descriptors},
                    {"threads", sample.threads}});
  return list;
}

std::vector<Sample> soak(const CommandLine& line, Served& served, Load& load, double rate) {
  const double time_s = 60 * line.minutes, sample_pause_s = std::max(1.0, time_s / 500);
  double next_sample_s = 0, next_model_s = 30;
  std::vector<Sample> samples;
  const auto begin = Clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  for (std::int64_t sent = 0; passed() < time_s; ++sent) {
    served.wire.until([&] { return passed() >= static_cast<double>(sent) / rate; }, 1 / rate);
    load.step();
    if (passed() >= next_model_s) {
      load.publishModel();
      next_model_s += 60;
    }
    if (passed() < next_sample_s) continue;
    samples.push_back(sampleOf(served, served.process().id(), passed()));
    next_sample_s += sample_pause_s;
  }
  load.settle();
  return samples;
}

int soakFor(const CommandLine& line) {
  TemporaryFolder folder;
  const SigningKey key = SigningKey::generate();
  fs::create_directory(folder / "keys");
  key.write(folder / "soak");
  fs::copy_file(folder / "soak.pub", folder / "keys" / "soak.pub");
  Served served(line.server, "[planner]\nthreads = 1\n",
                {"--state-dir", folder / "state", "--trusted-keys", folder / "keys"});
  Load load(served, key);
  const double rate = load.capacity(10.0) / 2;
  const std::vector<Sample> samples = soak(line, served, load, rate);

  served.wire.freshStatus();
  const status_t& status = served.wire.status;
  fmt::print(
      "{:.1f} minutes at {:.1f} plans a second: {} answers, {} overloaded, {} missing, {} outcomes, {} "
      "models, {} refused messages\n",
      line.minutes, rate, load.answers(), load.refused(), load.missing(), load.reports(), load.models(),
      status.refused);
  fmt::print("{:<26} {:>10} {:>10}\n", "most in", "1st half", "2nd half");
  Growth growth(samples, std::min(60 * line.warm_up_minutes, 30 * line.minutes));
  growth.check("memory of the server, MB", &Sample::server_mb, 8);
  growth.check("memory of the receiver, MB", &Sample::receiver_mb, 8);
  growth.check("descriptors", &Sample::descriptors, 0);
  growth.check("threads", &Sample::threads, 0);
  const bool passed = !growth.grew() && load.missing() == 0;
  if (!line.plot.empty()) writeSvg(plotOf(samples, rate), line.plot);
  const Json json{{"schema", 1},
                  {"passed", passed},
                  {"minutes", line.minutes},
                  {"plans_per_s", rate},
                  {"answers", load.answers()},
                  {"overloaded", load.refused()},
                  {"missing", load.missing()},
                  {"outcomes", load.reports()},
                  {"models", load.models()},
                  {"growth", growth.json()},
                  {"samples", jsonOf(samples)}};
  if (!line.json.empty()) std::ofstream(line.json) << json.dump(1) << "\n";
  return passed ? 0 : 1;
}

}  // namespace
}  // namespace boxgrasp::test

int main(int argc, char** argv) {
  boxgrasp::test::CommandLine line;
  CLI::App app{"Runs boxgrasp-server at half load, and watches what it takes of the machine."};
  app.add_option("--minutes", line.minutes, "how long")->capture_default_str();
  app.add_option("--json", line.json, "file for the samples");
  app.add_option("--plot", line.plot, "file for the plot (SVG)");
  app.add_option("--server", line.server, "the program to watch");
  CLI11_PARSE(app, argc, argv);
  boxgrasp::test::enterOwnNetwork();
  try {
    return boxgrasp::test::soakFor(line);
  } catch (const std::exception& error) {
    fmt::print(stderr, "soak: {}\n", error.what());
    return 3;
  }
}
