// The service as its users meet it: boxgrasp-server as a process, requests and answers over real LCM.
//   overhead  publish-to-answer time beyond the plan's own, for 100,000 points
//   pair      two requests at once against one, each plan on one thread
//   cores     one request on all cores against one thread
//   load      the highest steady rate at which nothing is refused, and twice that rate
//   points    time and peak memory over the size of the cloud, with a plot
//   boxes     time over the number of boxes, with a plot
//   receiver  from the death of the receiving process to the first message that its successor receives
// Prints a table; --json FILE writes the figures, --plots FOLDER the plots, --only NAME measures one part,
// --quick takes small clouds and short times. Exit code 1: a target was missed. Moves into a network of its
// own where it may (as root).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <regex>
#include <thread>

#include "boxgrasp/rendering/svg_plot.h"
#include "served.h"

namespace boxgrasp::test {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

struct CommandLine {
  fs::path json, plots, server = BOXGRASP_SERVER;
  std::string only;
  bool quick = false;
};

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// One line of the table, and one figure of the JSON.
class Report {
 public:
  // A target of NaN: none.
  void add(const std::string& part, const std::string& what, double value, const std::string& unit,
           double at_most = NAN) {
    const bool missed = value > at_most;
    missed_ |= missed;
    fmt::print("{:<9} {:<58} {:>10.4g} {:<8} {}\n", part, what, value, unit,
               std::isnan(at_most) ? "" : fmt::format("at most {:.4g}{}", at_most, missed ? ": MISSED" : ""));
    std::fflush(stdout);
    json_["figures"].push_back({{"part", part}, {"what", what}, {"value", value}, {"unit", unit}});
    if (!std::isnan(at_most)) json_["figures"].back()["at_most"] = at_most;
  }
  bool missed() const { return missed_; }
  void write(const fs::path& file) {
    if (!file.empty()) std::ofstream(file) << json_.dump(1) << "\n";
  }

 private:
  Json json_{{"schema", 1}, {"cores", std::thread::hardware_concurrency()}, {"figures", Json::array()}};
  bool missed_ = false;
};

const std::string kOneThread = "[planner]\nthreads = 1\n";

void measureOverhead(const CommandLine& line, Report& report) {
  Served bench(line.server, kOneThread);
  const PointCloud cloud = cup(line.quick ? 20'000 : 100'000);
  std::vector<double> overheads_ms, plans_ms;
  for (int i = 0; i < (line.quick ? 5 : 40); ++i) {
    const auto request = bench.request(cloud);
    const auto start = Clock::now();
    const double plan_s = bench.plan(request).time_s;
    overheads_ms.push_back(1e3 * (secondsSince(start) - plan_s));
    plans_ms.push_back(1e3 * plan_s);
  }
  report.add("overhead", "plan, median", median(plans_ms), "ms");
  report.add("overhead", "publish to answer beyond the plan, median", median(overheads_ms), "ms",
             line.quick ? NAN : 3.0);
  report.add("overhead", "publish to answer beyond the plan, 90 %", quantile(overheads_ms, 0.9), "ms");
}

// Seconds until this many new requests, sent at once, are all answered.
double togetherTime(Served& bench, const PointCloud& cloud, int count) {
  std::vector<plan_request_t> requests;
  for (int i = 0; i < count; ++i) requests.push_back(bench.request(cloud));
  bench.wire.answers.clear();
  const auto start = Clock::now();
  for (const auto& request : requests) bench.wire.send(channel::kPlanRequest, request);
  if (!bench.wire.until([&] { return bench.wire.answers.size() == requests.size(); }, 60.0))
    throw std::runtime_error("answers are missing");
  return secondsSince(start);
}

// Seconds for as many plain loops at once: what the machine gives at all.
double loopTime(int count) {
  const auto loop = [] {
    volatile double sum = 0;
    for (int i = 0; i < 100'000'000; ++i) sum = sum + i;
  };
  const auto start = Clock::now();
  std::vector<std::jthread> threads;
  for (int i = 0; i < count; ++i) threads.emplace_back(loop);
  threads.clear();
  return secondsSince(start);
}

// One and two are measured in turn, so that whatever else the machine does falls on both; and so are plain
// loops, since a busy machine has no two cores to give.
void measurePair(const CommandLine& line, Report& report) {
  Served bench(line.server, kOneThread, {"--workers", "2"});
  const PointCloud cloud = cup(line.quick ? 20'000 : 100'000);
  togetherTime(bench, cloud, 2);
  std::vector<double> ones, twos, loops;
  for (int i = 0; i < (line.quick ? 5 : 20); ++i) {
    ones.push_back(togetherTime(bench, cloud, 1));
    twos.push_back(togetherTime(bench, cloud, 2));
    loops.push_back(loopTime(2) / loopTime(1));
  }
  const double ratio = median(twos) / median(ones);
  report.add("pair", "one request, median", 1e3 * median(ones), "ms");
  report.add("pair", "two at once, median", 1e3 * median(twos), "ms");
  report.add("pair", "two at once against one", ratio, "times");
  report.add("pair", "two plain loops against one, median", median(loops), "times");
  report.add("pair", "two at once against one, beyond the loops'", ratio / median(loops), "times",
             line.quick ? NAN : 1.2);
}

void measureCores(const CommandLine& line, Report& report) {
  const PointCloud cloud = cup(line.quick ? 20'000 : 300'000);
  std::map<int, std::vector<double>> times;
  for (int round = 0; round < (line.quick ? 1 : 3); ++round) {
    for (const int threads : {1, 0}) {
      Served bench(line.server, fmt::format("[planner]\nthreads = {}\n", threads));
      for (int i = 0; i < 4; ++i) times[threads].push_back(togetherTime(bench, cloud, 1));
    }
  }
  report.add("cores", "one large request, one thread, median", 1e3 * median(times[1]), "ms");
  report.add("cores", "one large request, all cores, median", 1e3 * median(times[0]), "ms");
  report.add("cores", "all cores against one thread", median(times[0]) / median(times[1]), "times", 1.0);
}

struct Load {
  double rate = 0.0;
  int sent = 0, refused = 0;
  std::vector<double> latencies_s, refusals_s;
  double memory_before_mb = NAN, memory_after_mb = NAN;
};

// Requests at a steady rate, whether they are answered or not. The answers are counted until all are there.
Load load(Served& bench, plan_request_t request, double rate, double time_s) {
  Load result;
  result.rate = rate;
  std::map<std::string, Clock::time_point> sent_at;
  std::size_t seen = 0;
  const auto take = [&] {
    for (; seen < bench.wire.answers.size(); ++seen) {
      const plan_response_t& answer = bench.wire.answers[seen];
      const bool refused = answer.outcome == plan_response_t::OVERLOADED;
      (refused ? result.refusals_s : result.latencies_s)
          .push_back(secondsSince(sent_at.at(answer.request_id)));
      result.refused += refused;
    }
  };
  static int number = 0;
  bench.wire.answers.clear();
  bench.wire.raw.clear();
  result.memory_before_mb = bench.memory_mb("VmRSS");
  const auto start = Clock::now();
  for (; result.sent < rate * time_s; ++result.sent) {
    const auto due = start + std::chrono::duration<double>(result.sent / rate);
    bench.wire.until([&] { return take(), Clock::now() >= due; }, time_s);
    request.request_id = fmt::format("load-{}", ++number);
    sent_at[request.request_id] = Clock::now();
    bench.wire.send(channel::kPlanRequest, request);
  }
  bench.wire.until([&] { return take(), bench.wire.answers.size() == sent_at.size(); }, 30.0);
  result.memory_after_mb = bench.memory_mb("VmRSS");
  return result;
}

void reportLoad(Report& report, const std::string& name, const Load& load) {
  report.add("load", name + ": rate", load.rate, "1/s");
  report.add("load", name + ": requests", load.sent, "");
  report.add("load", name + ": refused", load.refused, "");
  report.add("load", name + ": without an answer",
             load.sent - static_cast<double>(load.latencies_s.size() + load.refusals_s.size()), "", 0.0);
  report.add("load", name + ": latency, median", 1e3 * median(load.latencies_s), "ms");
  report.add("load", name + ": latency, 99 %", 1e3 * quantile(load.latencies_s, 0.99), "ms");
}

void measureLoad(const CommandLine& line, Report& report) {
  Served bench(line.server, kOneThread, {"--workers", "2"});
  const auto request = bench.request(cup(line.quick ? 4000 : 20'000));
  const double time_s = line.quick ? 2.0 : 20.0;
  load(bench, request, 5.0, 2.0);
  // What it can do at all says where to begin; then down to the highest rate at which the queue never fills.
  Load all = load(bench, request, 500.0, 1.0);
  const auto count = static_cast<double>(all.latencies_s.size());
  double rate = 0.95 * count / quantile(all.latencies_s, 1.0);
  Load best = load(bench, request, rate, time_s);
  while (best.refused > 0 || quantile(best.latencies_s, 0.99) > 3 * median(best.latencies_s)) {
    rate *= 0.9;
    if (rate < 0.5) break;
    best = load(bench, request, rate, time_s);
  }
  reportLoad(report, "highest", best);
  report.add("load", "highest: 99 % against median",
             quantile(best.latencies_s, 0.99) / median(best.latencies_s), "times", line.quick ? NAN : 3.0);
  const Load twice = load(bench, request, 2 * best.rate, time_s);
  reportLoad(report, "twice", twice);
  report.add("load", "twice: time to a refusal, 99 %", 1e3 * quantile(twice.refusals_s, 0.99), "ms",
             line.quick ? NAN : 50.0);
  report.add("load", "twice: growth of memory", twice.memory_after_mb - twice.memory_before_mb, "MB",
             line.quick ? NAN : 8.0);
}

Series lineOf(const std::string& name, const std::vector<Vector2d>& points, Marker marker) {
  Series series;
  series.name = name;
  series.points = points;
  series.marker = marker;
  return series;
}

// A picture with logarithms on both axes: straight lines of slope 1 are linear.
Plot logPlot(const std::string& title, const std::string& x, const std::vector<Vector2d>& times,
             const std::vector<Vector2d>& memory = {}) {
  Plot plot;
  plot.title = title;
  plot.x.label = "log10 of " + x;
  plot.y.label = "log10 of the plan's time [s]";
  plot.series.push_back(lineOf("time", times, Marker::circle));
  std::vector<Vector2d> linear;
  for (const Vector2d& point : times)
    linear.push_back({point.x(), times.back().y() + point.x() - times.back().x()});
  plot.series.push_back(lineOf("linear", linear, Marker::none));
  plot.series.back().dashed = true;
  if (memory.empty()) return plot;
  plot.second_y.label = "peak memory of the server [MB]";
  plot.series.push_back(lineOf("memory", memory, Marker::square));
  plot.series.back().second_axis = true;
  return plot;
}

void writePlot(const CommandLine& line, const std::string& name, const Plot& plot) {
  if (!line.plots.empty()) writeSvg(plot, line.plots / name);
}

// The plan's own time: the least of a few, which what else the machine does disturbs least.
double planTime(Served& bench, const PointCloud& cloud) {
  double least_s = INFINITY;
  for (int i = 0; i < 3; ++i) least_s = std::min(least_s, bench.plan(bench.request(cloud)).time_s);
  return least_s;
}

void measurePoints(const CommandLine& line, Report& report) {
  constexpr double kBytesOfPoint = 12, kFixed_mb = 64;
  std::vector<Vector2d> times, memory;
  for (const int points : {1000, 10'000, 100'000, 1'000'000}) {
    if (line.quick && points > 10'000) break;
    Served bench(line.server, kOneThread, {"--workers", "1"});
    const double time_s = planTime(bench, cup(static_cast<std::size_t>(points)));
    const double peak_mb = bench.memory_mb("VmHWM");
    times.push_back({std::log10(points), std::log10(time_s)});
    memory.push_back({std::log10(points), peak_mb});
    report.add("points", fmt::format("{} points: plan", points), 1e3 * time_s, "ms");
    report.add("points", fmt::format("{} points: peak memory of the server", points), peak_mb, "MB",
               4 * kBytesOfPoint * points / (1 << 20) + kFixed_mb);
  }
  writePlot(line, "points.svg", logPlot("Time and memory over the points of a cup", "points", times, memory));
}

// Options with which even a plain object falls into very many boxes.
constexpr char kManyBoxes[] =
    "[decomposition]\ngain = \"local\"\ngain_t = 0.999\nmin_points = 20\nmin_extent_m = 0.002\n"
    "segment_fraction = 0.03\nmax_leaves = {}\n";

void measureBoxes(const CommandLine& line, Report& report) {
  const PointCloud cloud = sampleSurface(parametricObject("horse"), line.quick ? 4000 : 20'000, 1);
  std::vector<Vector2d> times;
  for (const int most : {1, 2, 5, 10, 20, 35, 50}) {
    if (line.quick && most > 5) break;
    Served bench(line.server, kOneThread + fmt::format(kManyBoxes, most));
    const plan_response_t plan = bench.plan(bench.request(cloud));
    const auto boxes =
        std::count_if(plan.boxes.begin(), plan.boxes.end(), [](const box_t& box) { return box.leaf; });
    const double time_s = planTime(bench, cloud);
    times.push_back({std::log10(boxes), std::log10(time_s)});
    report.add("boxes", fmt::format("{} boxes: plan", boxes), 1e3 * time_s, "ms");
  }
  writePlot(line, "boxes.svg", logPlot("Time over the boxes of a horse of 20,000 points", "boxes", times));
}

// Sends an answered request, which needs no plan any more, until it is answered again: nobody hears the first
// ones.
double deafTime(Served& bench, const plan_request_t& answered) {
  bench.wire.until([] { return false; }, 0.2);  // what came of the last time
  bench.wire.answers.clear();
  const pid_t victim = bench.receiver();
  if (victim <= 0) throw std::runtime_error("there is no receiver to kill");
  kill(victim, SIGKILL);
  const auto start = Clock::now();
  const auto heard = [&] {
    bench.wire.send(channel::kPlanRequest, answered);
    return !bench.wire.answers.empty();
  };
  if (!bench.wire.until(heard, 20.0, 1)) throw std::runtime_error("no receiver takes the killed one's place");
  return secondsSince(start);
}

void measureReceiver(const CommandLine& line, Report& report) {
  Served bench(line.server, kOneThread);
  const plan_request_t request = bench.request(cup(1000));
  bench.plan(request);
  std::vector<double> times_ms;
  for (int i = 0; i < (line.quick ? 3 : 30); ++i) times_ms.push_back(1e3 * deafTime(bench, request));
  report.add("receiver", "killed to the first message received, median", median(times_ms), "ms");
  report.add("receiver", "killed to the first message received, longest", quantile(times_ms, 1.0), "ms",
             line.quick ? NAN : 200.0);
}

int measureAll(const CommandLine& line) {
  const std::vector<std::pair<std::string, void (*)(const CommandLine&, Report&)>> parts{
      {"overhead", measureOverhead}, {"pair", measurePair},     {"cores", measureCores},
      {"load", measureLoad},         {"points", measurePoints}, {"boxes", measureBoxes},
      {"receiver", measureReceiver}};
  Report report;
  for (const auto& [name, measure] : parts) {
    if (line.only.empty() || line.only == name) measure(line, report);
  }
  report.write(line.json);
  return report.missed() ? 1 : 0;
}

}  // namespace
}  // namespace boxgrasp::test

int main(int argc, char** argv) {
  boxgrasp::test::CommandLine line;
  CLI::App app{"Measures boxgrasp-server over real LCM."};
  app.add_option("--json", line.json, "file for the figures");
  app.add_option("--plots", line.plots, "folder for the plots (SVG)");
  app.add_option("--server", line.server, "the program to measure");
  app.add_option("--only", line.only, "one part: overhead, pair, cores, load, points, boxes or receiver");
  app.add_flag("--quick", line.quick, "small clouds and short times: shows that it works, not how fast");
  CLI11_PARSE(app, argc, argv);
  boxgrasp::test::enterOwnNetwork();
  try {
    return boxgrasp::test::measureAll(line);
  } catch (const std::exception& error) {
    fmt::print(stderr, "service_benchmark: {}\n", error.what());
    return 3;
  }
}
