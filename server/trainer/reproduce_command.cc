#include "reproduce_command.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "boxgrasp/base/durable_file.h"
#include "boxgrasp/base/error.h"
#include "boxgrasp/base/exit_code.h"
#include "interruption.h"
#include "reproduction_process.h"
#include "reproduction_report.h"

namespace boxgrasp {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 28;
constexpr std::uintmax_t kLeastSpace = 1 << 20;
constexpr const char* kList = "steps.json";

std::string lastLine(const fs::path& file) {
  std::ifstream stream(file);
  std::string last;
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty()) last = line;
  }
  return last.empty() ? "it said nothing" : last;
}

// One reproduction at a time in a folder. The lock goes with the process.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder)
      : file_(open((folder / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
    if (file_ < 0)
      throw InputError(fmt::format("{} cannot be written to: choose another --out", folder.string()));
    if (flock(file_, LOCK_EX | LOCK_NB) == 0) return;
    close(file_);
    throw InputError(fmt::format("{} is in use by another reproduction", folder.string()));
  }
  ~FolderLock() { close(file_); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int file_;
};

// A folder of our own: new, empty, or with the list that an earlier run left.
fs::path ownFolder(const fs::path& out) {
  std::error_code error;
  fs::create_directories(out, error);
  if (error || !fs::is_directory(out))
    throw InputError(fmt::format("--out {} is no folder and cannot be made: {}", out.string(),
                                 error ? error.message() : "a file is there"));
  const bool left_by_us = fs::exists(out / kList) || fs::exists(out / "lock");
  if (!fs::is_empty(out) && !left_by_us)
    throw InputError(fmt::format(
        "--out {} holds other files: name a new folder, or that of an earlier reproduction", out.string()));
  return fs::absolute(out).lexically_normal();
}

class Reproduction {
 public:
  explicit Reproduction(const ReproduceCommand& command)
      : command_(command),
        stop_(stopOnInterrupt()),
        steps_(reproductionSteps(command)),
        folder_(ownFolder(command.out)),
        lock_(folder_),
        build_(programBuild()) {}

  int run();

 private:
  fs::path file(const Step& step, const char* ending) const { return folder_ / (step.name + ending); }
  json stampOf(const Step& step) const;
  bool isDone(const Step& step) const;
  void readRecords();
  void writeAblations() const;
  void writeRecords() const;
  void prepare(const Step& step);
  void perform(const Step& step);
  void keepOutput(const Step& step);
  void announce(std::size_t i) const;
  void writeReport() const;

  ReproduceCommand command_;
  StopToken stop_;
  std::vector<Step> steps_;
  fs::path folder_;
  FolderLock lock_;
  std::string build_;
  std::map<std::string, json> records_;      // by the steps' names: steps.json
  double spent_s_ = 0.0, estimate_s_ = 0.0;  // of the steps of this run that are done
};

// As a shell takes it.
std::string commandLine(const Step& step) {
  std::string line = "boxgrasp-trainer";
  for (const std::string& word : step.arguments)
    line += word.find_first_of(" '\"$&;()") == std::string::npos ? " " + word : fmt::format(" '{}'", word);
  return line;
}

json Reproduction::stampOf(const Step& step) const {
  return {{"name", step.name}, {"command", commandLine(step)}, {"program", BOXGRASP_VERSION}};
}

bool Reproduction::isDone(const Step& step) const {
  const auto found = records_.find(step.name);
  return found != records_.end() && found->second.contains("time_s") && found->second["error"].is_null() &&
         fs::exists(file(step, ".json")) && (step.product.empty() || fs::exists(folder_ / step.product));
}

// Keeps what the same command of the same program left; other records are of no use.
void Reproduction::readRecords() {
  if (!fs::exists(folder_ / kList)) return;
  const json list = json::parse(readWhole(folder_ / kList, kMostBytes), nullptr, false);
  if (!list.is_object() || !list.contains("steps"))
    throw InputError(
        fmt::format("{} is damaged: remove it, and all is measured anew", (folder_ / kList).string()));
  for (const Step& step : steps_) {
    const json stamp = stampOf(step);
    for (const json& record : list["steps"]) {
      const bool same = record["name"] == stamp["name"] && record["command"] == stamp["command"] &&
                        record["program"] == stamp["program"];
      if (same) records_[step.name] = record;
    }
  }
}

void Reproduction::writeRecords() const {
  json list{
      {"schema", 1}, {"program", BOXGRASP_VERSION}, {"quick", command_.quick}, {"steps", json::array()}};
  for (const Step& step : steps_) {
    const auto found = records_.find(step.name);
    list["steps"].push_back(found == records_.end() ? stampOf(step) : found->second);
  }
  writeDurably(folder_ / kList, list.dump(2) + "\n");
}

void Reproduction::writeAblations() const {
  for (const Ablation& ablation : ablations())
    writeDurably(folder_ / fmt::format("ablation_{}.toml", ablation.name), ablation.toml);
}

// A product of the same command may be gone on with; others are removed.
void Reproduction::prepare(const Step& step) {
  if (records_.contains(step.name)) return;
  fs::remove(file(step, ".json"));
  if (!step.product.empty()) fs::remove(folder_ / step.product);
  records_[step.name] = stampOf(step);
  writeRecords();
}

void Reproduction::keepOutput(const Step& step) {
  const std::string printed = readWhole(file(step, ".part"), kMostBytes);
  const json output =
      step.prints_text ? json{{"schema", 1}, {"printed", printed}} : json::parse(printed, nullptr, false);
  if (output.is_discarded()) throw InputError(fmt::format("what {} printed is no JSON", step.name));
  writeDurably(file(step, ".json"), output.dump(2) + "\n");
  fs::remove(file(step, ".part"));
}

void Reproduction::perform(const Step& step) {
  prepare(step);
  const auto start = std::chrono::steady_clock::now();
  const int code = runStep(step.arguments, folder_, file(step, ".part"), file(step, ".log"), stop_);
  json& record = records_[step.name];
  record["error"] = nullptr;
  record["build"] = build_;
  // A command that does what it can, and leaves out what it cannot, says so with this code.
  if (code == kDone || (code == kNothingFound && step.prints_text))
    keepOutput(step);
  else
    record["error"] = fmt::format("exit code {}: {}", code, lastLine(file(step, ".log")));
  record["time_s"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  spent_s_ += record["time_s"].get<double>();
  estimate_s_ += step.estimate_s;
  writeRecords();
  if (record["error"].is_null()) return;
  fmt::print(stderr, "boxgrasp-trainer: {} failed: {}\n", step.name, record["error"].get<std::string>());
  if (fs::space(folder_).available < kLeastSpace)
    throw InputError(fmt::format("the disk of {} is full: free some of it, then give the same command again",
                                 folder_.string()));
}

// The time that is left goes by how the steps until now kept to their estimates.
void Reproduction::announce(std::size_t i) const {
  double left_s = 0.0;
  for (std::size_t k = i; k < steps_.size(); ++k) left_s += isDone(steps_[k]) ? 0.0 : steps_[k].estimate_s;
  const double pace = estimate_s_ > 0 ? spent_s_ / estimate_s_ : 1.0;
  fmt::print(stderr, "step {} of {}: {} ({}); about {:.0f} min left\n", i + 1, steps_.size(), steps_[i].name,
             isDone(steps_[i]) ? "done before" : fmt::format("about {:.0f} s", pace * steps_[i].estimate_s),
             pace * left_s / 60);
}

void Reproduction::writeReport() const {
  ReproducedStudy study{BOXGRASP_VERSION, build_, command_.quick, {}, {}};
  for (const Step& step : steps_) {
    const json& record = records_.at(step.name);
    ReportedStep reported{step.name,
                          step.kind,
                          step.subject,
                          record["command"],
                          record.value("build", ""),
                          record.value("time_s", 0.0),
                          {},
                          {}};
    if (!record["error"].is_null())
      reported.error = record["error"];
    else
      reported.output = json::parse(readWhole(file(step, ".json"), kMostBytes));
    study.steps.push_back(std::move(reported));
    if (step.product.ends_with(".png") && fs::exists(folder_ / step.product))
      study.pictures[step.name] = readWhole(folder_ / step.product, kMostBytes);
    if (step.product.ends_with(".svg") && fs::exists(folder_ / step.product))
      study.pictures[step.name] = readWhole(folder_ / step.product, kMostBytes);
  }
  writeDurably(folder_ / "report.html", reproductionReport(study));
}

int Reproduction::run() {
  readRecords();
  writeRecords();
  writeAblations();
  std::size_t failed = 0;
  try {
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      stop_.check();
      announce(i);
      if (!isDone(steps_[i])) perform(steps_[i]);
      failed += !records_[steps_[i].name]["error"].is_null();
    }
  } catch (const Stopped&) {
    fmt::print(stderr, "stopped; {} keeps all steps that are done: give the same command again to go on\n",
               folder_.string());
    return kInterrupted;
  }
  writeReport();
  fmt::print("report written to {}{}\n", (folder_ / "report.html").string(),
             failed ? fmt::format("; {} of {} steps failed, which it names", failed, steps_.size()) : "");
  return failed ? kNothingFound : kDone;
}

}  // namespace

int runReproduce(const ReproduceCommand& command) {
  requireOption(command.seeds >= 1 && command.seeds <= 20, "--seeds", command.seeds, "in [1, 20]");
  requireOption(command.threads >= 0, "--threads", command.threads, "at least 0");
  return Reproduction(command).run();
}

}  // namespace boxgrasp
