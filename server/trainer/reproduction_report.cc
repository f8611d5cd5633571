#include "reproduction_report.h"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <cmath>

#include "boxgrasp/rendering/svg_plot.h"
#include "html_text.h"

namespace boxgrasp {
namespace {

using nlohmann::json;

constexpr std::string_view kStyle =
    ":root{color-scheme:light}body{font:16px/1.5 system-ui,sans-serif;max-width:64em;margin:0 "
    "auto;padding:1em;color:#222;"
    "background:#fff;overflow-wrap:anywhere}h1{font-size:1.6em;line-height:1.2}h2{margin-top:2.2em;border-"
    "top:2px solid #ddd;"
    "padding-top:.6em}table{border-collapse:collapse;font-size:.9em}td,th{padding:.25em .7em;text-align:left;"
    "border-bottom:1px solid "
    "#ddd;vertical-align:top;overflow-wrap:normal}td.n,th.n{text-align:right;white-space:nowrap}"
    ".wide{overflow-x:auto;margin:1em "
    "0}.met{color:#06633a;font-weight:600}.missed{color:#a33a00;font-weight:600}"
    "figure{margin:1.2em "
    "0}figcaption{font-size:.9em;color:#444}img,svg{max-width:100%;height:auto}pre,code{font-size:13px}"
    "pre{overflow-x:auto;background:#f4f4f4;padding:.6em}nav{columns:2 20em;margin:1em 0}nav a{display:block}"
    ".note{background:#fff6e5;padding:.5em "
    ".8em}.grid{display:grid;grid-template-columns:repeat(auto-fill,minmax(17em,1fr));"
    "gap:1em}.grid figure{margin:0}";

struct Contents {
  const char *id, *title;
};
constexpr std::array<Contents, 12> kContents{{{"summary", "Summary: the paper, ours, the goals"},
                                              {"robot", "What a robot would meet"},
                                              {"failures", "What the failures have in common"},
                                              {"ablation", "What each part is worth"},
                                              {"stability", "Table I: stability of decompositions"},
                                              {"constellations", "Fig. 3: constellations over t"},
                                              {"spread", "Fig. 5: among random grasps"},
                                              {"counts", "Fig. 6: counts"},
                                              {"hidden", "Fig. 7: hidden nodes"},
                                              {"spans", "Fig. 8: spans for each object"},
                                              {"grasps", "Fig. 9: high-ranked grasps"},
                                              {"commands", "Commands and times"}}};

double numberAt(const json& output, const std::string& pointer) {
  const json::json_pointer at(pointer);
  if (!output.contains(at) || !output[at].is_number()) return NAN;
  return output[at].get<double>();
}

struct MeanAndSpread {
  double mean = NAN, spread = NAN;  // spread: the standard deviation; of one value none
};

MeanAndSpread meanOf(const std::vector<double>& values) {
  if (values.empty()) return {};
  double sum = 0.0, squares = 0.0;
  for (const double value : values) sum += value;
  const double n = static_cast<double>(values.size()), mean = sum / n;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {mean, values.size() > 1 ? std::sqrt(squares / (n - 1)) : NAN};
}

std::string number(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "&ndash;";
}

std::string spreadText(const MeanAndSpread& values, int digits) {
  if (!std::isfinite(values.spread)) return number(values.mean, digits);
  return fmt::format("{} &plusmn; {}", number(values.mean, digits), number(values.spread, digits));
}

double medianOf(std::vector<double> values) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
}

// --- pieces of a page

std::string cell(const std::string& html) { return fmt::format("<td>{}</td>", html); }
std::string numberCell(const std::string& html) { return fmt::format("<td class=\"n\">{}</td>", html); }

// One number of a step, in the unit of the cell: `factor` times what the step printed.
std::string valueCell(const ReportedStep& step, const std::string& pointer, int digits, double factor = 1.0) {
  return fmt::format("<td class=\"n\" data-from=\"{}#{}\" data-factor=\"{}\">{}</td>", escaped(step.name),
                     escaped(pointer), factor, number(factor * numberAt(step.output, pointer), digits));
}

std::string row(const std::vector<std::string>& cells) {
  std::string html = "<tr>";
  for (const std::string& one : cells) html += one;
  return html + "</tr>\n";
}

// A heading that begins with '#' is that of a column of numbers.
std::string table(const std::vector<std::string>& headings, const std::string& rows) {
  std::string head;
  for (const std::string& heading : headings) {
    const bool numbers = heading.starts_with("#");
    head += fmt::format("<th{}>{}</th>", numbers ? " class=\"n\"" : "", heading.substr(numbers));
  }
  return fmt::format(
      "<div class=\"wide\"><table><thead><tr>{}</tr></thead><tbody>\n{}</tbody></table></div>\n", head, rows);
}

std::string paragraph(const std::string& html) { return "<p>" + html + "</p>\n"; }

std::string figure(const std::string& content, const std::string& caption) {
  return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", content, caption);
}

std::string base64(const std::string& bytes) {
  constexpr int kVariant = sodium_base64_VARIANT_ORIGINAL;
  std::string text(sodium_base64_encoded_len(bytes.size(), kVariant), '\0');
  sodium_bin2base64(text.data(), text.size(), reinterpret_cast<const unsigned char*>(bytes.data()),
                    bytes.size(), kVariant);
  text.pop_back();  // its end of a C string
  return text;
}

std::string image(const std::string& png, const std::string& what) {
  return fmt::format("<img alt=\"{}\" loading=\"lazy\" src=\"data:image/png;base64,{}\">", escaped(what),
                     base64(png));
}

std::string commandsOf(const std::vector<const ReportedStep*>& steps) {
  if (steps.empty()) return {};
  std::string lines;
  for (const ReportedStep* step : steps) lines += escaped(step->command) + "\n";
  return fmt::format("<details><summary>{} command{} behind this</summary><pre>{}</pre></details>\n",
                     steps.size(), steps.size() == 1 ? "" : "s", lines);
}

Series lineSeries(const std::string& name, int colour, bool second, bool dashed) {
  Series series;
  series.name = name;
  series.colour = colour;
  series.marker = second ? Marker::none : Marker::circle;
  series.second_axis = second;
  series.dashed = dashed;
  return series;
}

// --- the study

class Report {
 public:
  explicit Report(const ReproducedStudy& study) : study_(study) {}
  std::string html() const;

 private:
  std::vector<const ReportedStep*> all(const std::string& kind) const;  // also those that failed
  std::vector<const ReportedStep*> good(const std::string& kind) const;
  const ReportedStep* find(const std::string& name) const;  // if it ended well
  std::string section(std::size_t i, const std::string& content, const std::vector<std::string>& kinds) const;
  std::string picture(const std::string& step) const;

  std::string summary() const;
  std::string rates() const;
  std::string failures() const;
  std::string ablation() const;
  std::string stability() const;
  std::string constellations() const;
  std::string spread() const;
  std::string counts() const;
  std::string hidden() const;
  std::string spans() const;
  std::string grasps() const;
  std::string commands() const;

  std::vector<double> stabilityMeans(const std::string& split, const char* field) const;
  std::vector<double> percentiles() const;
  std::string goalRow(const std::string& what, const std::string& paper, const std::string& step,
                      double goal) const;

  const ReproducedStudy& study_;
};

std::vector<const ReportedStep*> Report::all(const std::string& kind) const {
  std::vector<const ReportedStep*> steps;
  for (const ReportedStep& step : study_.steps) {
    if (step.kind == kind) steps.push_back(&step);
  }
  return steps;
}

std::vector<const ReportedStep*> Report::good(const std::string& kind) const {
  std::vector<const ReportedStep*> steps = all(kind);
  std::erase_if(steps, [](const ReportedStep* step) { return !step->error.empty(); });
  return steps;
}

const ReportedStep* Report::find(const std::string& name) const {
  for (const ReportedStep& step : study_.steps) {
    if (step.name == name && step.error.empty()) return &step;
  }
  return nullptr;
}

std::string Report::section(std::size_t i, const std::string& content,
                            const std::vector<std::string>& kinds) const {
  std::string html =
      fmt::format("<section id=\"{}\"><h2>{}</h2>\n{}", kContents[i].id, kContents[i].title, content);
  std::vector<const ReportedStep*> steps;
  for (const std::string& kind : kinds) {
    for (const ReportedStep* step : all(kind)) {
      steps.push_back(step);
      if (!step->error.empty())
        html +=
            fmt::format("<p class=\"note\">{} failed: {}</p>\n", escaped(step->name), escaped(step->error));
    }
  }
  return html + commandsOf(steps) + "</section>\n";
}

std::string Report::picture(const std::string& step) const {
  const auto found = study_.pictures.find(step);
  if (found == study_.pictures.end()) return {};
  return found->second.starts_with("<") ? found->second : image(found->second, step);
}

// --- Table I

std::vector<double> Report::stabilityMeans(const std::string& split, const char* field) const {
  std::vector<double> values;
  for (const ReportedStep* step : good("stability"))
    values.push_back(numberAt(step->output, fmt::format("/means/{}/{}", split, field)));
  return values;
}

// The number of each seed's run at one place.
std::vector<double> overSeeds(const std::vector<const ReportedStep*>& steps, const std::string& pointer) {
  std::vector<double> values;
  for (const ReportedStep* step : steps) values.push_back(numberAt(step->output, pointer));
  return values;
}

std::string Report::stability() const {
  const auto steps = good("stability");
  if (steps.empty()) return {};
  std::string rows;
  const json& first = steps.front()->output["rows"];
  for (std::size_t i = 0; i + 2 < first.size(); i += 3) {
    std::vector<std::string> cells{cell(escaped(first[i]["object"]))};
    for (std::size_t k = i; k < i + 3; ++k) {
      const std::string at = fmt::format("/rows/{}/", k);
      if (k < i + 2) cells.push_back(valueCell(*steps.front(), at + "paper_percent", 1));
      cells.push_back(numberCell(spreadText(meanOf(overSeeds(steps, at + "similar_percent")), 1)));
      cells.push_back(valueCell(*steps.front(), at + "boxes", 0));
    }
    rows += row(cells);
  }
  std::vector<std::string> means{cell("<b>mean</b>")};
  for (const auto& [split, paper] : {std::pair{"old", "66.3"}, {"new", "72.9"}, {"robust", ""}}) {
    if (*paper) means.push_back(numberCell(paper));
    means.push_back(numberCell(spreadText(meanOf(stabilityMeans(split, "similar_percent")), 1)));
    means.push_back(numberCell(number(meanOf(stabilityMeans(split, "boxes")).mean, 2)));
  }
  return table({"object", "#old, paper %", "#old, ours %", "#boxes", "#new, paper %", "#new, ours %",
                "#boxes", "#robust, ours %", "#boxes"},
               rows + row(means)) +
         paragraph(fmt::format(
             "Share of damaged clouds whose decomposition is similar to that of the whole cloud, t = 0.9; "
             "mean and standard deviation over {} seeds; boxes of the whole cloud.",
             steps.size())) +
         paragraph(
             "<b>Why they differ.</b> The paper names neither the amounts of noise and removal nor the unit "
             "of D and V in "
             "Eq. 2. Ours: noise up to 1.9 % of the object's size in 19 levels, removal up to 70 % of the "
             "points in 14; D and V "
             "are measured in the largest extent of the whole cloud's root box, so that the thresholds 0.1 "
             "and 0.9 mean "
             "the same for objects of every size. With this scale volumes are well below 1 and the bound 0.9 "
             "on V never "
             "decides: the bound on D does. Our objects are parametric likenesses of theirs. An object that "
             "is one box is trivially similar, so boxes stand "
             "beside each share.");
}

// --- Fig. 3

Plot constellationPlot(const ReportedStep& step) {
  Plot plot;
  plot.title = "Boxes and volume of the " + step.subject;
  plot.x.label = "gain t";
  plot.y.label = "boxes";
  plot.y.low = plot.second_y.low = 0.0;
  plot.second_y.label = "volume of all boxes / of the root";
  int colour = 0;
  for (const char* split : {"old", "new", "robust"}) {
    Series boxes = lineSeries(fmt::format("boxes, {}", split), colour, false, false);
    Series volume = lineSeries(fmt::format("volume, {}", split), colour++, true, true);
    for (const json& point : step.output["splits"][split]) {
      boxes.points.emplace_back(point["t"].get<double>(), point["boxes"].get<double>());
      volume.points.emplace_back(point["t"].get<double>(), point["volume"].get<double>());
    }
    plot.series.push_back(boxes);
    plot.series.push_back(volume);
  }
  return plot;
}

std::string keptConstellations(const ReportedStep& step) {
  std::vector<std::string> cells{cell(escaped(step.subject))};
  for (const char* split : {"old", "new", "robust"}) {
    const json& curve = step.output["splits"][split];
    const auto kept = std::count_if(curve.begin(), curve.end(),
                                    [](const json& p) { return p["similar_to_last"].get<bool>(); });
    cells.push_back(numberCell(fmt::format("{} of {}", kept, curve.size() - 1)));
  }
  return row(cells);
}

std::string Report::constellations() const {
  std::string html, rows;
  for (const ReportedStep* step : good("constellations")) {
    html += figure(picture(step->name),
                   fmt::format("Leaf boxes of the {}, t growing to the right; rows: old, new, robust split.",
                               escaped(step->subject)));
    html += figure(svgOf(constellationPlot(*step), {.width_px = 760, .height_px = 400}),
                   "Boxes (full lines) and volume (dashed) over t.");
    rows += keptConstellations(*step);
  }
  return html + table({"object", "#old", "#new", "#robust"}, rows) +
         paragraph(
             "Steps from one t to the next that keep the constellation (Eq. 2). <b>Why they differ.</b> The "
             "paper shows "
             "pictures without numbers (its duck keeps one constellation over several t, and its cup parts "
             "with the "
             "handle); shapes and steps of t are ours.");
}

// --- Fig. 5

std::vector<double> Report::percentiles() const {
  std::vector<double> values;
  for (const ReportedStep* step : good("spread")) {
    const double percentile = numberAt(step->output, "/sources/2/best/percentile_s");
    if (std::isfinite(percentile)) values.push_back(percentile);
  }
  return values;
}

std::string Report::spread() const {
  std::string rows;
  for (const ReportedStep* step : good("spread")) {
    std::vector<std::string> cells{cell(escaped(step->subject))};
    for (const char* source : {"0", "1", "2"}) {
      cells.push_back(valueCell(*step, fmt::format("/sources/{}/grasps", source), 0));
      cells.push_back(valueCell(*step, fmt::format("/sources/{}/force_closures", source), 0));
    }
    cells.push_back(valueCell(*step, "/sources/1/best/percentile_s", 2));
    cells.push_back(valueCell(*step, "/sources/2/best/percentile_s", 2));
    cells.push_back(valueCell(*step, "/sources/2/median_percentile_s", 1));
    rows += row(cells);
  }
  const auto steps = good("spread");
  const auto bunny = std::find_if(steps.begin(), steps.end(),
                                  [](const ReportedStep* step) { return step->subject == "bunny"; });
  const std::string shown = bunny != steps.end() ? (*bunny)->name : steps.empty() ? "" : steps.front()->name;
  return figure(picture(shown),
                "Grasps on the axes &epsilon; and &nu; (no units: forces sum to 1, torques over the object's "
                "largest distance).") +
         table({"object", "#random", "#closed", "#[11]", "#closed", "#ours", "#closed",
                "#best of [11], percentile", "#our best, percentile", "#our median, percentile"},
               rows) +
         paragraph(
             "Percentiles of s (Eq. 6) among the random grasps; closed: in force closure. \"Our best\" is "
             "the best of all "
             "hypotheses as simulated, as in the paper's figure. <b>Why they differ.</b> The paper plots one "
             "object (the bunny) "
             "without numbers. The random grasps are ours: palms turned towards the object, which GraspIt! "
             "would have "
             "chosen otherwise; &epsilon; and &nu; come from our own contacts.");
}

// --- Fig. 6

std::string Report::counts() const {
  const ReportedStep* step = find("summary");
  if (!step) return {};
  std::string rows;
  const json& models = step->output["models"];
  for (std::size_t i = 0; i < models.size(); ++i) {
    std::vector<std::string> cells{cell(escaped(models[i]["model"]))};
    for (const char* field : {"leaves", "projections", "triplets", "configurations", "hypotheses"})
      cells.push_back(valueCell(*step, fmt::format("/models/{}/{}", i, field), 0));
    rows += row(cells);
  }
  const double n = numberAt(step->output, "/totals/models");
  const auto per42 = [&](const char* field) {
    return number(42 / n * numberAt(step->output, fmt::format("/totals/{}", field)), 0);
  };
  std::string totals = row(
      {cell("all models"), valueCell(*step, "/totals/models", 0), valueCell(*step, "/totals/projections", 0),
       valueCell(*step, "/totals/triplets", 0), valueCell(*step, "/totals/configurations", 0)});
  totals += row({cell("for 42 models"), numberCell("42"), numberCell(per42("projections")),
                 numberCell(per42("triplets")), numberCell(per42("configurations"))});
  totals +=
      row({cell("paper"), numberCell("42"), numberCell("570"), numberCell("5951"), numberCell("&ndash;")});
  return table({"", "#models", "#projections", "#triplets", "#configurations"}, totals) +
         fmt::format("<details><summary>Each model</summary>{}</details>",
                     table({"model", "#boxes", "#projections", "#triplets", "#configurations", "#hypotheses"},
                           rows)) +
         paragraph(
             "<b>Why they differ.</b> The paper took 14 objects in 3 sizes, and does not list them apart "
             "from pictures; we take all "
             "objects of the run in each size, and also give the counts for 42 such models. We plan on faces "
             "of the inner boxes of the "
             "tree too, and pinches besides the paper's triplets (see the ablation), so there is more to "
             "choose from.");
}

// --- Fig. 7 and Fig. 8

Plot hiddenPlot(const json& sweep) {
  Plot plot;
  plot.title = "Hidden nodes";
  plot.x.label = "hidden nodes";
  plot.y.label = "S_net (Eq. 7)";
  plot.second_y.label = "training time [s]";
  plot.second_y.low = 0.0;
  Series success = lineSeries("S_net", 0, false, false), time = lineSeries("training time", 1, true, true);
  for (const json& point : sweep) {
    if (point["hidden"].size() != 1 || !point["s_net"].is_number()) continue;
    success.points.emplace_back(point["hidden"][0].get<double>(), point["s_net"].get<double>());
    time.points.emplace_back(point["hidden"][0].get<double>(), point["time_s"].get<double>());
  }
  plot.series = {success, time};
  return plot;
}

std::string Report::hidden() const {
  const ReportedStep* step = find("evaluate_paper");
  if (!step) return {};
  if (!step->output.contains("sweep")) return paragraph("Not part of a quick run.");
  std::string rows;
  const json& sweep = step->output["sweep"];
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    std::string layers;
    for (const json& nodes : sweep[i]["hidden"])
      layers += fmt::format("{}{}", layers.empty() ? "" : " x ", nodes.get<int>());
    rows += row({cell(layers), valueCell(*step, fmt::format("/sweep/{}/s_net", i), 4),
                 valueCell(*step, fmt::format("/sweep/{}/span_fraction", i), 1, 100),
                 valueCell(*step, fmt::format("/sweep/{}/time_s", i), 2)});
  }
  return figure(svgOf(hiddenPlot(sweep), {.width_px = 760, .height_px = 380}),
                "Success on objects left out (full line) and training time (dashed).") +
         fmt::format("<details><summary>Each network</summary>{}</details>",
                     table({"hidden nodes", "#S_net", "#span %", "#training s"}, rows)) +
         paragraph(
             "The paper: S_net = 0.078 at most, with 8 nodes, and no gain by a second or third layer. <b>Why "
             "they differ.</b> S_net "
             "depends on how much s varies on an object; our s comes from another simulator and other "
             "shapes, "
             "so its size cannot be compared, its course over the nodes can.");
}

Plot spanPlotOf(const ReportedStep& step) {
  Plot plot;
  plot.title = step.subject;
  plot.y.label = "S_net and mean s";
  Series span, value, best, worst;
  span.kind = SeriesKind::spans;
  span.name = "possible S_net";
  value.kind = best.kind = worst.kind = SeriesKind::points;
  value.name = "S_net";
  value.marker = Marker::square;
  best.name = "mean s, best tenth";
  best.marker = Marker::triangle_up;
  worst.name = "mean s, worst tenth";
  worst.marker = Marker::triangle_down;
  for (const json& object : step.output["objects"]) {
    const double x = static_cast<double>(plot.x.categories.size());
    const auto at = [&](const char* field) { return numberAt(object, fmt::format("/{}", field)); };
    plot.x.categories.push_back(object["object"]);
    span.points.emplace_back(x, at("ceiling"));
    span.low.push_back(at("floor"));
    value.points.emplace_back(x, at("s_net"));
    best.points.emplace_back(x, at("best_tenth"));
    worst.points.emplace_back(x, at("worst_tenth"));
  }
  plot.series = {span, value, best, worst};
  return plot;
}

std::string Report::spans() const {
  std::string html, rows;
  for (const ReportedStep* step : good("evaluate")) {
    html += figure(svgOf(spanPlotOf(*step), {.width_px = 860, .height_px = 440}),
                   escaped(step->subject) + "; each object ranked by networks that never saw it.");
    std::vector<std::string> cells{cell(escaped(step->subject))};
    for (const char* ranking : {"network", "recalled", "best_of_q1_to_q9", "random"})
      cells.push_back(valueCell(*step, fmt::format("/{}/span_fraction", ranking), 1, 100));
    cells.push_back(valueCell(*step, "/network/span_fraction_deviation", 1, 100));
    cells.push_back(valueCell(*step, "/network/top_1_held", 1, 100));
    rows += row(cells);
  }
  return html +
         table({"", "#network, % of the span", "#corrected by recollections",
                "#best single measure of q1 to q9", "#random", "#&plusmn; over repeats", "#top-1 held, %"},
               rows) +
         paragraph(
             "The span reaches from the worst ranking (0 %) to the perfect one (100 %). <b>Why they "
             "differ.</b> The paper gives a plot "
             "without numbers; our labels come from a dynamic simulator instead of GraspIt!, and s is "
             "normalised over all "
             "sizes of an object as in Eq. 6. Recollections: what networks misjudged in the same place on "
             "other "
             "objects whose boxes lie alike (the paper's wish, V).");
}

// --- Fig. 9, and scenes

std::string Report::grasps() const {
  std::string html = "<div class=\"grid\">";
  for (const ReportedStep* step : good("grasps"))
    html += figure(picture(step->name),
                   fmt::format("{}: {} grasps", escaped(step->subject), numberAt(step->output, "/grasps")));
  html += "</div>\n" + paragraph(
                           "Boxes, and the two grasps that networks rank first that never saw the object. "
                           "<b>Why they differ.</b> The paper chose "
                           "some good ones by eye; these are the first of each ranking.");
  if (good("scene").empty()) return html;
  html += "<h3>Scenes of a depth camera</h3><div class=\"grid\">";
  for (const ReportedStep* step : good("scene"))
    html += figure(picture(step->name),
                   fmt::format("{}: {} objects, {} grasps in the answer", escaped(step->subject),
                               numberAt(step->output, "/objects"), numberAt(step->output, "/grasps")));
  return html + "</div>\n";
}

// --- rates

std::size_t countAt(const ReportedStep& step, const std::string& pointer) {
  const double value = numberAt(step.output, pointer);
  return std::isfinite(value) ? static_cast<std::size_t>(value) : 0;
}

double shareAt(const ReportedStep& step, const std::string& column) {
  const std::size_t of = countAt(step, fmt::format("/all/{}/of", column));
  return of ? static_cast<double>(countAt(step, fmt::format("/all/{}/held", column))) /
                  static_cast<double>(of)
            : NAN;
}

// Share held with its range: "84.3 (80 to 88)".
std::string shareText(const ReportedStep& step, const std::string& column) {
  const ShareRange range = wilson(countAt(step, fmt::format("/all/{}/held", column)),
                                  countAt(step, fmt::format("/all/{}/of", column)));
  return fmt::format("{} ({} to {})", number(100 * shareAt(step, column), 1), number(100 * range.low, 0),
                     number(100 * range.high, 0));
}

std::string seedsText(const ReportedStep& step) {
  std::vector<double> shares;
  for (const json& share : step.output["first_by_seed"]) shares.push_back(100 * share.get<double>());
  return spreadText(meanOf(shares), 1);
}

std::string rateRow(const ReportedStep& step) {
  return row({cell(escaped(step.subject)), cell(escaped(step.output["protocol"])),
              numberCell(shareText(step, "first")), valueCell(step, "/all/first/held", 0),
              valueCell(step, "/all/first/of", 0), numberCell(shareText(step, "any_of_five")),
              numberCell(seedsText(step))});
}

std::string objectRates(const ReportedStep& step) {
  std::string rows;
  const json& objects = step.output["objects"];
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const std::string at = fmt::format("/objects/{}/", i);
    rows += row({cell(escaped(objects[i]["object"])), valueCell(step, at + "first/held", 0),
                 valueCell(step, at + "first/of", 0), valueCell(step, at + "any_of_five/held", 0)});
  }
  return fmt::format("<details><summary>{}, {}: each object</summary>{}</details>\n", escaped(step.subject),
                     escaped(step.output["protocol"]),
                     table({"object", "#first held", "#of plans", "#any of five held"}, rows));
}

std::string baselines(const ReportedStep& step) {
  std::string rows;
  for (const auto& [column, name] : {std::pair{"first", "first of the ranking"},
                                     {"top", "all of the first five"},
                                     {"hypotheses", "hypotheses, unranked"},
                                     {"best_tenth", "their best tenth by simulated s"},
                                     {"worst_tenth", "their worst tenth"},
                                     {"random", "random poses"},
                                     {"random_clear", "random poses without a touch on the way"}}) {
    const std::string key = column == std::string("top") ? "first_five" : column;
    rows += row(
        {cell(name), numberCell(shareText(step, key)), valueCell(step, fmt::format("/all/{}/of", key), 0)});
  }
  return table({"grasps on the whole surface, lift and shake", "#held, % (95 % range)", "#tried"}, rows);
}

std::string Report::rates() const {
  std::string rows, details, base;
  for (const ReportedStep* step : good("rates")) {
    if (step->name == "rates_baseline") {
      base = baselines(*step);
      continue;
    }
    rows += rateRow(*step);
    details += objectRates(*step);
  }
  return table({"the planner sees", "protocol", "#top-1 held, % (95 % range)", "#held", "#of plans",
                "#any of first five, %", "#top-1 over seeds, %"},
               rows) +
         details + base +
         paragraph(
             "Plans executed in the dynamic simulator: the hand comes in, closes, lifts, and shakes "
             "(lift_shake), or is pushed from six "
             "sides in free space (six_pushes). Every object is ranked by networks that never saw it in any "
             "size. A plan without a "
             "grasp counts as not held. Ranges are Wilson's over plans, which treat plans of one object as "
             "independent: with few objects "
             "the true range is wider. <b>Beside others.</b> The paper executes no grasp. Learnt planners "
             "publish 87.5 % and 94.8 % "
             "in six_pushes as means over hands, on other objects and in another simulator.");
}

std::string Report::failures() const {
  std::string html;
  for (const ReportedStep* step : good("rates")) {
    const json& endings = step->output["all"]["first"]["endings"];
    std::vector<std::pair<std::size_t, std::string>> words;
    for (const auto& [word, count] : endings.items()) {
      if (word != "held") words.emplace_back(count.get<std::size_t>(), word);
    }
    std::sort(words.rbegin(), words.rend());
    std::string listed;
    for (const auto& [count, word] : words)
      listed += fmt::format("{}{} {}", listed.empty() ? "" : ", ", count, escaped(word));
    std::vector<std::pair<std::size_t, std::string>> worst;
    for (const json& object : step->output["objects"]) {
      const std::size_t of = object["first"]["of"].get<std::size_t>(),
                        held = object["first"]["held"].get<std::size_t>();
      if (of > held) worst.emplace_back(of - held, object["object"]);
    }
    std::sort(worst.rbegin(), worst.rend());
    std::string names;
    for (std::size_t i = 0; i < std::min<std::size_t>(3, worst.size()); ++i)
      names += fmt::format("{}{} ({})", i ? ", " : "", escaped(worst[i].second), worst[i].first);
    html += row({cell(escaped(step->subject)), cell(escaped(step->output["protocol"])),
                 cell(listed.empty() ? "none" : listed), cell(names.empty() ? "none" : names)});
  }
  return table({"the planner sees", "protocol", "how first grasps that were not held ended",
                "objects with most of them"},
               html) +
         paragraph(
             "<i>no grasp</i>: the plan was empty; <i>missed</i>: the hand closed on nothing; "
             "<i>collided</i>: it touched on the way in; "
             "<i>unstable</i>, <i>lost in lift</i>, <i>lost in shake</i>: the object slipped away in that "
             "stage.");
}

std::string Report::ablation() const {
  std::string rows;
  for (const ReportedStep* step : good("ablation")) {
    const std::string seen = step->output.value("seen", "");
    const ReportedStep* base = find("ablation_default_" + seen);
    const double change = base ? 100 * (shareAt(*step, "first") - shareAt(*base, "first")) : NAN;
    const std::string what = step->name.substr(std::string("ablation_").size());
    rows += row({cell(escaped(what)), cell(escaped(step->subject)), cell(escaped(seen)),
                 numberCell(shareText(*step, "first")),
                 numberCell(std::isfinite(change) ? fmt::format("{:+.1f}", change) : "&ndash;"),
                 valueCell(*step, "/all/first/held", 0), valueCell(*step, "/all/first/of", 0),
                 numberCell(shareText(*step, "any_of_five"))});
  }
  return table({"configuration", "what it is", "seen", "#top-1 held, % (95 % range)", "#points", "#held",
                "#of", "#any of five, %"},
               rows) +
         paragraph(
             "One change of the configuration each (ablation_*.toml beside this report), lift and shake, one "
             "plan an object. Ranked by the shipped "
             "model, which has seen parametric objects: the differences count, not the heights. Where ranges "
             "overlap widely, a difference may be luck.");
}

// --- summary

std::string verdict(double ours, double goal) {
  if (!std::isfinite(ours)) return "<span class=\"missed\">not measured</span>";
  if (ours >= goal) return "<span class=\"met\">met</span>";
  return fmt::format("<span class=\"missed\">{:.1f} points short</span>", goal - ours);
}

std::string Report::goalRow(const std::string& what, const std::string& paper, const std::string& step,
                            double goal) const {
  const ReportedStep* found = find(step);
  const double ours = found ? 100 * shareAt(*found, "first") : NAN;
  const bool may_be_less =
      found && ours >= goal &&
      100 * wilson(countAt(*found, "/all/first/held"), countAt(*found, "/all/first/of")).low < goal;
  const std::string doubt = may_be_less ? ", but its range reaches below" : "";
  return row({cell(what), numberCell(paper),
              numberCell(found ? shareText(*found, "first") + " %" : "&ndash;"),
              numberCell(fmt::format("{} %", goal)), cell(verdict(ours, goal) + doubt)});
}

std::string Report::summary() const {
  const auto plain = [](const std::string& what, const std::string& paper, const std::string& ours) {
    return row({cell(what), numberCell(paper), numberCell(ours), numberCell("&ndash;"), cell("")});
  };
  const auto means = [&](const char* split) { return meanOf(stabilityMeans(split, "similar_percent")); };
  const MeanAndSpread robust = means("robust");
  std::string rows =
      goalRow("Top-1 held, lift and shake, whole surface", "&ndash;", "rates_whole_lift_shake", 85);
  rows += goalRow("Top-1 held, lift and shake, one view", "&ndash;", "rates_view_lift_shake", 70);
  rows += goalRow("Top-1 held, six pushes, whole surface (others: 87.5 and 94.8)", "&ndash;",
                  "rates_whole_six_pushes", 95);
  rows += plain("Table I, similar, old split", "66.3 %", spreadText(means("old"), 1) + " %");
  rows += plain("Table I, similar, new split", "72.9 %", spreadText(means("new"), 1) + " %");
  rows += row({cell(fmt::format("Table I, similar, robust split ({} boxes on average)",
                                number(meanOf(stabilityMeans("robust", "boxes")).mean, 1))),
               numberCell("&ndash;"), numberCell(spreadText(robust, 1) + " %"), numberCell("90 %"),
               cell(verdict(robust.mean, 90))});
  const std::vector<double> best = percentiles();
  rows += plain("Fig. 5, percentile of our best among random grasps, median over objects (least)", "&ndash;",
                fmt::format("{} ({})", number(medianOf(best), 2),
                            number(best.empty() ? NAN : *std::min_element(best.begin(), best.end()), 2)));
  for (const char* name : {"evaluate_paper", "evaluate_best"}) {
    if (const ReportedStep* step = find(name))
      rows += row({cell("Fig. 8, share of the span: " + escaped(step->subject)), numberCell("&ndash;"),
                   valueCell(*step, "/network/span_fraction", 1, 100), numberCell("&ndash;"),
                   cell("50: chance")});
  }
  if (const ReportedStep* step = find("scanned_whole"))
    rows += plain("Top-1 held, scanned objects, whole surface", "&ndash;", shareText(*step, "first") + " %");
  if (const ReportedStep* step = find("scanned_view"))
    rows += plain("Top-1 held, scanned objects, one view", "&ndash;", shareText(*step, "first") + " %");
  return table({"", "#paper", "#ours", "#goal", "verdict"}, rows) +
         paragraph("Shares held stand with their 95 % range; &plusmn; is the standard deviation over seeds.");
}

// --- the rest

std::string Report::commands() const {
  std::string rows;
  double total_s = 0.0;
  std::size_t others = 0;
  for (const ReportedStep& step : study_.steps) {
    total_s += step.time_s;
    others += step.build != study_.build;
    rows += row({cell(escaped(step.name)), numberCell(number(step.time_s, 1)),
                 cell("<code>" + escaped(step.command) + "</code>")});
  }
  std::string html = paragraph(fmt::format(
      "{} steps, {} minutes in all, program {}, build {}. Each ran in the folder of this report; what it "
      "printed is in &lt;step&gt;.json there.",
      study_.steps.size(), number(total_s / 60, 1), escaped(study_.program), escaped(study_.build)));
  if (others)
    html += fmt::format(
        "<p class=\"note\">{} of them were run by another build of this version; steps.json says "
        "which.</p>\n",
        others);
  return html + table({"step", "#time [s]", "command"}, rows);
}

std::string Report::html() const {
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\">"
      "<title>Boxgrasp: the paper's evaluation</title><style>{}</style></head><body>\n<h1>Learning of 2D "
      "Grasping Strategies from Box-Based 3D Object "
      "Approximations: the evaluation, run anew</h1>\n",
      kStyle);
  if (study_.quick)
    page +=
        "<p class=\"note\">A quick run: few objects, levels and seeds. It shows that all works; its numbers "
        "say little.</p>\n";
  page += "<nav aria-label=\"Contents\">";
  for (const Contents& one : kContents) page += fmt::format("<a href=\"#{}\">{}</a>", one.id, one.title);
  page += "</nav>\n" + section(0, summary(), {});
  page += section(1, rates(), {"label", "rates"}) + section(2, failures(), {}) +
          section(3, ablation(), {"ablation"});
  page += section(4, stability(), {"stability"}) + section(5, constellations(), {"constellations"}) +
          section(6, spread(), {"spread"});
  page += section(7, counts(), {"summary"}) + section(8, hidden(), {}) + section(9, spans(), {"evaluate"});
  return page + section(10, grasps(), {"grasps", "scene"}) + section(11, commands(), {}) + "</body></html>\n";
}

}  // namespace

ShareRange wilson(std::size_t held, std::size_t of) {
  if (of == 0) return {};
  constexpr double z = 1.959963984540054;
  const double n = static_cast<double>(of), p = static_cast<double>(held) / n;
  const double middle = (p + z * z / (2 * n)) / (1 + z * z / n);
  const double half = z / (1 + z * z / n) * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

std::string reproductionReport(const ReproducedStudy& study) { return Report(study).html(); }

}  // namespace boxgrasp
