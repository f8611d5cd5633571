#include "stability_command.h"

#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "boxgrasp/base/error.h"
#include "boxgrasp/cloud/read_cloud.h"
#include "boxgrasp/objects/parametric.h"
#include "boxgrasp/rendering/svg_plot.h"
#include "boxgrasp/training/stability.h"
#include "print_json.h"
#include "progress_bar.h"
#include "tried_object.h"

namespace boxgrasp {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct Rule {
  const char* name;
  SplitRule split;
};
constexpr std::array<Rule, 3> kRules{
    {{"old", SplitRule::bound}, {"new", SplitRule::hull}, {"robust", SplitRule::robust}}};

// Table I, per cent, old and new; the means over its 17 objects are 66.3 and 72.9.
const std::map<std::string, std::array<double, 2>> kPaper{
    {"bunny", {78.62, 94.00}},    {"car", {100.00, 100.00}},   {"cup", {77.78, 97.78}},
    {"duck", {61.59, 91.67}},     {"goblet", {21.21, 22.77}},  {"goose", {24.28, 46.00}},
    {"heart", {100.00, 100.0}},   {"homer", {55.07, 66.67}},   {"horse", {53.99, 30.33}},
    {"human", {19.93, 58.00}},    {"mug", {80.43, 62.67}},     {"paper_cup", {100.00, 74.24}},
    {"pen", {91.67, 92.00}},      {"pillow", {91.67, 100.00}}, {"radio", {84.62, 100.00}},
    {"squirrel", {59.42, 75.00}}, {"toy_dog", {27.54, 28.33}}};
constexpr std::array<double, 2> kPaperMeans{66.3, 72.9};

// What is measured, given by name and loaded when its turn comes.
struct Source {
  std::string name;
  std::optional<fs::path> file;

  PointCloud load(const StabilityCommand& command) const {
    if (!file) return sampleSurface(parametricObject(name), command.points, command.seed);
    ReadOptions options;
    options.mesh_samples = command.points;
    options.seed = command.seed;
    return readCloud(*file, options).cloud_C;
  }
};

bool holdsPoints(const fs::path& file) {
  constexpr std::array kEndings{".off", ".obj", ".stl", ".ply", ".pcd", ".xyz"};
  std::string ending = file.extension();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

// 'builtin' are the 17 of the paper here.
std::vector<Source> sourcesIn(const std::string& objects) {
  std::vector<Source> sources;
  if (const auto parametric = parametricSet(objects == "builtin" ? "paper" : objects, {1.0})) {
    for (const ObjectSource& source : *parametric) sources.push_back({source.name, std::nullopt});
    return sources;
  }
  if (!fs::is_directory(objects))
    throw InputError(fmt::format("--objects is '{}', but must be 'builtin' or a folder of meshes", objects));
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(objects)) {
    if (entry.is_regular_file() && holdsPoints(entry.path()))
      sources.push_back({entry.path().stem().string(), entry.path()});
  }
  if (sources.empty()) throw InputError(fmt::format("the folder '{}' has no meshes or clouds", objects));
  std::sort(sources.begin(), sources.end(), [](const Source& a, const Source& b) { return a.name < b.name; });
  return sources;
}

StabilityOptions optionsOf(const StabilityCommand& command, SplitRule split) {
  StabilityOptions options;
  if (command.quick) options.noise_levels = 5, options.removal_levels = 4;
  if (command.beyond) options.outlier_levels = options.fading_levels = command.quick ? 3 : 7;
  options.seed = command.seed;
  options.threads = command.threads;
  options.decomposition.split = split;
  return options;
}

// One row of the table; shares are per cent, -100 where nothing was tried.
struct Row {
  std::string object, rule;
  std::size_t boxes = 0;
  double similar = -1, noise = -1, removal = -1, outliers = -1, fading = -1;
  double boxes_mean = -1;  // over all trials

  double paper() const {
    const auto found = kPaper.find(object);
    if (found == kPaper.end() || rule == "robust") return -1;
    return found->second[rule == "new"];
  }
};

Row rowOf(const std::string& object, const Rule& rule, const StabilityReport& report) {
  const auto percent = [&](Damage damage) { return 100 * report.similarShare(damage); };
  Row row{object, rule.name, report.boxes, 100 * report.similarShare()};
  row.noise = percent(Damage::noise);
  row.removal = percent(Damage::removal);
  row.outliers = percent(Damage::outliers);
  row.fading = percent(Damage::fading);
  row.boxes_mean = 0.0;
  for (const StabilityTrial& trial : report.trials)
    row.boxes_mean += static_cast<double>(trial.boxes) / static_cast<double>(report.trials.size());
  return row;
}

// Rows on disk, so that an interrupted run goes on where it was. Rows count only for the settings that gave
// them, which stand in each.
class Table {
 public:
  Table(const StabilityCommand& command)
      : file_(command.csv),
        settings_(fmt::format("{},{},{},{}", command.points, command.seed, command.quick ? "quick" : "full",
                              command.beyond ? "beyond" : "paper")) {
    if (file_ && fs::exists(*file_)) read();
  }

  const Row* find(const std::string& object, const std::string& rule) const {
    const auto found = std::find_if(rows_.begin(), rows_.end(),
                                    [&](const Row& row) { return row.object == object && row.rule == rule; });
    return found == rows_.end() ? nullptr : &*found;
  }

  void add(const Row& row) {
    rows_.push_back(row);
    if (!file_) return;
    const bool fresh = !fs::exists(*file_);
    std::ofstream stream(*file_, std::ios::app);
    if (fresh) stream << kHeader << "\n";
    stream << fmt::format("{},{},{},{},{},{},{},{},{},{}", settings_, row.object, row.rule, row.boxes,
                          row.boxes_mean, row.similar, row.noise, row.removal, row.outliers, row.fading)
           << std::endl;
    if (!stream) throw InputError(fmt::format("cannot write '{}'", file_->string()));
  }

 private:
  static constexpr const char* kHeader =
      "points,seed,levels,damage,object,split,boxes,boxes_mean,similar_percent,noise_percent,removal_percent,"
      "outliers_percent,fading_percent";

  void read() {
    std::ifstream stream(*file_);
    std::string line;
    if (!std::getline(stream, line) || line != kHeader) {
      throw InputError(
          fmt::format("'{}' is no table of this command: name another file or remove it", file_->string()));
    }
    while (std::getline(stream, line)) {
      if (!line.starts_with(settings_ + ",")) continue;
      std::istringstream fields(line.substr(settings_.size() + 1));
      Row row;
      char comma;
      std::getline(fields, row.object, ',');
      std::getline(fields, row.rule, ',');
      fields >> row.boxes >> comma >> row.boxes_mean >> comma >> row.similar >> comma >> row.noise >> comma >>
          row.removal >> comma >> row.outliers >> comma >> row.fading;
      if (fields) rows_.push_back(row);
    }
  }

  std::optional<fs::path> file_;
  std::string settings_;
  std::vector<Row> rows_;
};

std::vector<Row> measureAll(const StabilityCommand& command, const std::vector<Source>& sources) {
  Table table(command);
  std::vector<Row> rows;
  ProgressBar progress("decompositions of objects");
  for (const Source& source : sources) {
    std::optional<PointCloud> cloud;
    for (const Rule& rule : kRules) {
      if (!table.find(source.name, rule.name)) {
        if (!cloud) cloud = source.load(command);
        table.add(rowOf(source.name, rule, measureStability(*cloud, optionsOf(command, rule.split))));
      }
      rows.push_back(*table.find(source.name, rule.name));
      progress.update(rows.size(), sources.size() * kRules.size());
    }
  }
  return rows;
}

std::string cell(const Row& row) {
  const std::string paper = row.paper() < 0 ? "" : fmt::format(" ({:.1f})", row.paper());
  return fmt::format("{:>6.1f}{:<9} {:>5} {:>5.1f}", row.similar, paper, row.boxes, row.boxes_mean);
}

struct Means {
  double similar = 0, boxes = 0, single = 0;  // single: objects of one box alone
};

Means meansOf(const std::vector<Row>& rows, const std::string& rule) {
  Means means;
  const double share = static_cast<double>(kRules.size()) / static_cast<double>(rows.size());
  for (const Row& row : rows) {
    if (row.rule != rule) continue;
    means.similar += share * row.similar;
    means.boxes += share * static_cast<double>(row.boxes);
    means.single += row.boxes == 1;
  }
  return means;
}

void printTable(const std::vector<Row>& rows, const StabilityCommand& command) {
  const StabilityOptions options = optionsOf(command, SplitRule::hull);
  fmt::print(
      "Similar decompositions, per cent (the paper's), boxes of the whole cloud, and mean boxes of the "
      "damaged.\n"
      "t = {:.2f}; {} levels of noise to {:.1f} % of the object's size, {} of point removal to {:.0f} %; Eq. "
      "2 in "
      "units of that size.\n\n{:<14}",
      options.decomposition.gain_t, options.noise_levels, 100 * options.max_noise, options.removal_levels,
      100 * options.max_removal, "object");
  for (const Rule& rule : kRules) fmt::print("{:<31}", rule.name);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i % kRules.size() == 0) fmt::print("\n{:<14}", rows[i].object);
    fmt::print("{:<31}", cell(rows[i]));
  }
  fmt::print("\n{:<14}", "mean");
  for (std::size_t r = 0; r < kRules.size(); ++r) {
    const Means means = meansOf(rows, kRules[r].name);
    const std::string paper = r < kPaperMeans.size() ? fmt::format(" ({:.1f})", kPaperMeans[r]) : "";
    fmt::print("{:<31}", fmt::format("{:>6.1f}{:<9} {:>5.2f}", means.similar, paper, means.boxes));
  }
  fmt::print("\n{:<14}", "one box alone");
  for (const Rule& rule : kRules)
    fmt::print("{:<31}", fmt::format("{} objects", meansOf(rows, rule.name).single));
  fmt::print("\n");
}

json asJson(const std::vector<Row>& rows) {
  json result{{"schema", 1}, {"rows", json::array()}, {"means", json::object()}};
  for (const Row& row : rows) {
    const auto share = [](double percent) { return percent < 0 ? json() : json(percent); };
    result["rows"].push_back({{"object", row.object},
                              {"split", row.rule},
                              {"boxes", row.boxes},
                              {"boxes_mean", row.boxes_mean},
                              {"similar_percent", share(row.similar)},
                              {"noise_percent", share(row.noise)},
                              {"removal_percent", share(row.removal)},
                              {"outliers_percent", share(row.outliers)},
                              {"fading_percent", share(row.fading)},
                              {"paper_percent", share(row.paper())}});
  }
  for (const Rule& rule : kRules) {
    const Means means = meansOf(rows, rule.name);
    result["means"][rule.name] = {{"similar_percent", means.similar}, {"boxes", means.boxes}};
  }
  return result;
}

Plot plotOf(const std::string& object, const std::vector<std::vector<GainPoint>>& curves) {
  Plot plot;
  plot.title = "Constellations of the " + object + " over t";
  plot.x.label = "gain t";
  plot.y.label = "boxes";
  plot.second_y.label = "volume of all boxes / volume of the root box";
  plot.y.low = plot.second_y.low = 0.0;
  for (std::size_t r = 0; r < kRules.size(); ++r) {
    Series boxes, volume;
    boxes.name = fmt::format("boxes, {}", kRules[r].name);
    boxes.kind = SeriesKind::steps;
    volume.name = fmt::format("volume, {}", kRules[r].name);
    volume.dashed = volume.second_axis = true;
    boxes.colour = volume.colour = static_cast<int>(r);
    for (const GainPoint& point : curves[r]) {
      boxes.points.emplace_back(point.t, point.boxes);
      volume.points.emplace_back(point.t, point.volume);
    }
    plot.series.push_back(boxes);
    plot.series.push_back(volume);
  }
  return plot;
}

// Fig. 3 for one object: boxes, volume, and whether the next t keeps the constellation.
void writeCurves(const Source& source, const StabilityCommand& command) {
  std::vector<double> gains;
  const int steps = command.quick ? 6 : 15;
  for (int i = 0; i < steps; ++i) gains.push_back(0.70 + 0.29 * i / (steps - 1));
  const PointCloud cloud = source.load(command);
  std::vector<std::vector<GainPoint>> curves;
  std::ofstream csv(*command.curves / (source.name + ".csv"));
  csv << "split,t,boxes,volume,similar_to_last\n";
  for (const Rule& rule : kRules) {
    DecompositionOptions options = optionsOf(command, rule.split).decomposition;
    options.threads = command.threads;
    curves.push_back(constellationsOver(gains, cloud, options));
    for (const GainPoint& point : curves.back())
      csv << fmt::format("{},{:.4f},{},{:.5f},{}\n", rule.name, point.t, point.boxes, point.volume,
                         point.similar_to_last ? 1 : 0);
  }
  if (!csv.flush()) throw InputError(fmt::format("cannot write into '{}'", command.curves->string()));
  writeSvg(plotOf(source.name, curves), *command.curves / (source.name + ".svg"));
}

void writeAllCurves(const StabilityCommand& command, const std::vector<Source>& sources) {
  fs::create_directories(*command.curves);
  ProgressBar progress("constellations over t");
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (!fs::exists(*command.curves / (sources[i].name + ".svg"))) writeCurves(sources[i], command);
    progress.update(i + 1, sources.size());
  }
}

}  // namespace

void runStability(const StabilityCommand& command) {
  requireOption(command.points >= 100, "--points", command.points, "at least 100");
  requireOption(command.threads >= 0, "--threads", command.threads, "at least 0");
  const std::vector<Source> sources = sourcesIn(command.objects);
  const std::vector<Row> rows = measureAll(command, sources);
  if (command.curves) writeAllCurves(command, sources);
  if (command.json)
    printJson(asJson(rows));
  else
    printTable(rows, command);
}

}  // namespace boxgrasp
