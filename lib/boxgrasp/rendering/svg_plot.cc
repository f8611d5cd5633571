#include "boxgrasp/rendering/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string_view>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

// Okabe and Ito's, without black and yellow, which do not show on all grounds.
constexpr std::array<std::string_view, 7> kPalette{"#0072B2", "#E69F00", "#009E73", "#CC79A7",
                                                   "#D55E00", "#56B4E9", "#8C8C8C"};
constexpr std::string_view kInk = "#757575";  // as far from white as from black
constexpr double kLargest = 1e100;
constexpr double kCharacter = 0.56;  // of a font's size: the mean width of a character
constexpr double kBarShare = 0.8;    // of the room between neighbouring bars

bool drawable(double value) { return std::abs(value) < kLargest; }
bool drawable(const Vector2d& p) { return drawable(p.x()) && drawable(p.y()); }

// How many bytes the UTF-8 character at the front has; 0: it is none.
std::size_t characterLength(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text.front());
  const std::size_t length = lead < 0x80   ? 1
                             : lead < 0xC2 ? 0
                             : lead < 0xE0 ? 2
                             : lead < 0xF0 ? 3
                             : lead < 0xF5 ? 4
                                           : 0;
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((static_cast<unsigned char>(text[i]) & 0xC0) != 0x80) return 0;
  }
  return length;
}

std::string_view escapedCharacter(std::string_view character) {
  if (character == "&") return "&amp;";
  if (character == "<") return "&lt;";
  if (character == ">") return "&gt;";
  if (character == "\"") return "&quot;";
  return static_cast<unsigned char>(character.front()) < 0x20 ? " " : character;
}

// As text in XML, whatever the bytes.
std::string escaped(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t length = characterLength(text);
    result += length ? escapedCharacter(text.substr(0, length)) : "?";
    text.remove_prefix(std::max<std::size_t>(1, length));
  }
  return result;
}

std::size_t charactersOf(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

struct Range {
  double low = INFINITY, high = -INFINITY;
  void extend(double value) {
    if (!drawable(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool empty() const { return low > high; }
};

// From values to pixels.
struct Scale {
  std::vector<double> ticks;
  std::vector<std::string> names;  // of the ticks
  double low = 0.0, high = 1.0;
  double low_px = 0.0, high_px = 1.0;
  double at(double value) const { return low_px + (value - low) / (high - low) * (high_px - low_px); }
};

// With as many decimals as the step needs.
std::string tickName(double value, double step) {
  const double most = std::max(std::abs(value), step);
  if (most >= 1e6 || step < 1e-5) return fmt::format("{:.6g}", value);
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  return fmt::format("{:.{}f}", value == 0 ? 0.0 : value, decimals);
}

Scale scaleOf(Range range, const PlotAxis& axis, int about) {
  if (axis.low) range.extend(*axis.low);
  if (axis.high) range.extend(*axis.high);
  if (range.empty()) range = {0.0, 1.0};
  Scale scale;
  scale.ticks = niceTicks(range.low, range.high, about);
  scale.low = scale.ticks.front();
  scale.high = scale.ticks.back();
  for (const double tick : scale.ticks)
    scale.names.push_back(tickName(tick, scale.ticks[1] - scale.ticks[0]));
  return scale;
}

Scale categoryScale(const std::vector<std::string>& categories, const Range& data) {
  Scale scale;
  scale.names = categories;
  for (std::size_t i = 0; i < categories.size(); ++i) scale.ticks.push_back(static_cast<double>(i));
  scale.low = std::min(-0.5, data.low - 0.25);
  scale.high = std::max(static_cast<double>(categories.size()) - 0.5, data.high + 0.25);
  return scale;
}

std::string_view anchorName(int anchor) { return anchor < 0 ? "start" : anchor > 0 ? "end" : "middle"; }

class SvgPlot {
 public:
  SvgPlot(const Plot& plot, const PlotOptions& options);
  std::string write();

 private:
  void layOut();
  double widest(const std::vector<std::string>& names) const;
  double textWidth(std::string_view text) const { return kCharacter * options_.font_px * charactersOf(text); }
  double lineHeight() const { return 1.5 * options_.font_px; }
  std::vector<std::vector<std::size_t>> legendRows() const;
  double legendWidth(const Series& series) const { return 2.2 * options_.font_px + textWidth(series.name); }
  const Scale& yScale(const Series& series) const { return series.second_axis ? second_ : y_; }
  Vector2d at(const Series& series, const Vector2d& p) const {
    return {x_.at(p.x()), yScale(series).at(p.y())};
  }
  std::string_view colourOf(const Series& series) const;
  Range barRange() const;
  double barWidth() const;

  void text(const Vector2d& at, std::string_view words, int anchor, std::string_view more = "");
  void titles();
  void legend();
  void swatch(const Series& series, const Vector2d& at);
  void grid();
  void xAxis();
  void yAxis(const Scale& scale, const PlotAxis& axis, bool right);
  void draw(const Series& series);
  void drawLine(const Series& series);
  void drawBars(const Series& series);
  void drawSpans(const Series& series);
  void drawMarkers(const Series& series);
  void marker(Marker shape, const Vector2d& at, double size_px);

  const Plot& plot_;
  PlotOptions options_;
  Scale x_, y_, second_;
  bool has_second_ = false, tilted_ = false;
  int bar_series_ = 0, bars_drawn_ = 0;
  double left_ = 0, right_ = 0, top_ = 0, bottom_ = 0;  // of the frame, pixels
  std::string svg_;
};

SvgPlot::SvgPlot(const Plot& plot, const PlotOptions& options) : plot_(plot), options_(options) {
  options_.validate();
  Range x, y, second;
  for (const Series& series : plot.series) {
    requireOption(series.kind != SeriesKind::spans || series.low.size() == series.points.size(),
                  "the number of low ends of the spans", series.low.size(), "that of the points");
    Range& range = series.second_axis ? second : y;
    has_second_ |= series.second_axis;
    bar_series_ += series.kind == SeriesKind::bars;
    if (series.kind == SeriesKind::bars) range.extend(0.0);
    for (const Vector2d& p : series.points) {
      if (!drawable(p)) continue;
      x.extend(p.x());
      range.extend(p.y());
    }
    for (const double low : series.low) range.extend(low);
  }
  if (bar_series_ && plot.x.categories.empty()) x = barRange();
  x_ = plot.x.categories.empty() ? scaleOf(x, plot.x, 8) : categoryScale(plot.x.categories, x);
  y_ = scaleOf(y, plot.y, 6);
  second_ = scaleOf(second, plot.second_y, static_cast<int>(y_.ticks.size()));
  layOut();
}

double SvgPlot::widest(const std::vector<std::string>& names) const {
  double width = 0.0;
  for (const std::string& name : names) width = std::max(width, textWidth(name));
  return width;
}

std::vector<std::vector<std::size_t>> SvgPlot::legendRows() const {
  std::vector<std::vector<std::size_t>> rows;
  double used = INFINITY;
  for (std::size_t i = 0; i < plot_.series.size(); ++i) {
    const Series& series = plot_.series[i];
    if (series.name.empty()) continue;
    const double width = legendWidth(series) + options_.font_px;
    if (used + width > right_ - left_) {
      rows.emplace_back();
      used = 0.0;
    }
    rows.back().push_back(i);
    used += width;
  }
  return rows;
}

void SvgPlot::layOut() {
  const double font = options_.font_px;
  left_ = widest(y_.names) + 0.8 * font + (plot_.y.label.empty() ? 0.8 * font : 2.0 * font);
  right_ = options_.width_px - (has_second_ ? widest(second_.names) + 2.8 * font : 1.5 * font);
  top_ = (plot_.title.empty() ? 0.8 * font : 2.2 * font) + (plot_.subtitle.empty() ? 0.0 : lineHeight()) +
         lineHeight() * static_cast<double>(legendRows().size());
  const double room = (right_ - left_) / std::max<double>(1.0, static_cast<double>(x_.names.size()));
  tilted_ = widest(x_.names) > 0.95 * room;
  const double names = tilted_ ? 0.64 * widest(x_.names) + 1.2 * font : 1.6 * font;
  bottom_ = options_.height_px - names - (plot_.x.label.empty() ? 0.5 * font : 1.9 * font);
  top_ = std::min(top_, bottom_ - 2 * font);
  right_ = std::max(right_, left_ + 2 * font);
  x_.low_px = left_;
  x_.high_px = right_;
  y_.low_px = second_.low_px = bottom_;
  y_.high_px = second_.high_px = top_;
}

std::string_view SvgPlot::colourOf(const Series& series) const {
  const auto place = static_cast<std::size_t>(&series - plot_.series.data());
  return kPalette[(series.colour < 0 ? place : static_cast<std::size_t>(series.colour)) % kPalette.size()];
}

// The room that all bars of one x take: a share of the smallest distance of two.
double SvgPlot::barWidth() const {
  std::vector<double> places;
  for (const Series& series : plot_.series) {
    if (series.kind != SeriesKind::bars) continue;
    for (const Vector2d& p : series.points) {
      if (drawable(p)) places.push_back(p.x());
    }
  }
  std::sort(places.begin(), places.end());
  double least = INFINITY;
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    if (places[i + 1] > places[i]) least = std::min(least, places[i + 1] - places[i]);
  }
  return kBarShare * (std::isfinite(least) ? least : 1.0);
}

Range SvgPlot::barRange() const {
  const double half = 0.5 * barWidth();
  Range range;
  for (const Series& series : plot_.series) {
    const double beside = series.kind == SeriesKind::bars ? half : 0.0;
    for (const Vector2d& p : series.points) {
      if (!drawable(p)) continue;
      range.extend(p.x() - beside);
      range.extend(p.x() + beside);
    }
  }
  return range;
}

void SvgPlot::text(const Vector2d& at, std::string_view words, int anchor, std::string_view more) {
  svg_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", at.x(), at.y(),
                      anchorName(anchor), more, escaped(words));
}

void SvgPlot::titles() {
  const double font = options_.font_px;
  if (!plot_.title.empty()) {
    text({left_, 1.4 * font}, plot_.title, -1,
         fmt::format(" font-size=\"{:.1f}\" font-weight=\"bold\"", 1.15 * font));
  }
  if (!plot_.subtitle.empty()) text({left_, (plot_.title.empty() ? 1.3 : 2.9) * font}, plot_.subtitle, -1);
}

void SvgPlot::legend() {
  const auto rows = legendRows();
  double y = top_ - lineHeight() * static_cast<double>(rows.size()) + 0.4 * options_.font_px;
  for (const auto& row : rows) {
    double x = left_;
    for (const std::size_t i : row) {
      const Series& series = plot_.series[i];
      swatch(series, {x, y});
      text({x + 2.2 * options_.font_px, y + 0.35 * options_.font_px}, series.name, -1);
      x += legendWidth(series) + options_.font_px;
    }
    y += lineHeight();
  }
}

void SvgPlot::swatch(const Series& series, const Vector2d& at) {
  const double font = options_.font_px, middle = at.x() + 0.9 * font;
  const std::string_view colour = colourOf(series), dashes = series.dashed ? " stroke-dasharray=\"6 4\"" : "";
  svg_ +=
      fmt::format("<g class=\"swatch\" fill=\"{0}\" stroke=\"{0}\" stroke-width=\"2\"{1}>", colour, dashes);
  if (series.kind == SeriesKind::bars) {
    svg_ +=
        fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" stroke=\"none\"/>",
                    at.x() + 0.3 * font, at.y() - 0.4 * font, 1.2 * font, 0.8 * font);
  } else if (series.kind == SeriesKind::spans) {
    svg_ += fmt::format("<path d=\"M{:.1f} {:.1f}v{:.1f}\"/>", middle, at.y() - 0.55 * font, 1.1 * font);
  } else if (series.kind != SeriesKind::points) {
    svg_ += fmt::format("<path d=\"M{:.1f} {:.1f}h{:.1f}\"/>", at.x(), at.y(), 1.8 * font);
  }
  marker(series.marker, {middle, at.y()}, std::max(series.size_px, 6.0));
  svg_ += "</g>\n";
}

void SvgPlot::grid() {
  svg_ += "<g class=\"grid\" stroke=\"currentColor\" stroke-opacity=\"0.22\">\n";
  for (const double tick : y_.ticks)
    svg_ += fmt::format("<path d=\"M{:.1f} {:.1f}H{:.1f}\"/>\n", left_, y_.at(tick), right_);
  for (const double tick : x_.ticks) {
    if (plot_.x.categories.empty())
      svg_ += fmt::format("<path d=\"M{:.1f} {:.1f}V{:.1f}\"/>\n", x_.at(tick), top_, bottom_);
  }
  svg_ += "</g>\n";
  svg_ += fmt::format(
      "<rect class=\"frame\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" "
      "stroke=\"currentColor\" stroke-opacity=\"0.7\"/>\n",
      left_, top_, right_ - left_, bottom_ - top_);
}

void SvgPlot::xAxis() {
  const double font = options_.font_px;
  svg_ += "<g class=\"x-ticks\">\n";
  for (std::size_t i = 0; i < x_.ticks.size(); ++i) {
    const Vector2d at(x_.at(x_.ticks[i]), bottom_ + (tilted_ ? 0.9 : 1.3) * font);
    const std::string turned =
        tilted_ ? fmt::format(" transform=\"rotate(-40 {:.1f} {:.1f})\"", at.x(), at.y()) : "";
    text(at, x_.names[i], tilted_ ? 1 : 0, turned);
  }
  svg_ += "</g>\n";
  if (!plot_.x.label.empty())
    text({0.5 * (left_ + right_), options_.height_px - 0.6 * font}, plot_.x.label, 0);
}

void SvgPlot::yAxis(const Scale& scale, const PlotAxis& axis, bool right) {
  const double font = options_.font_px, middle = 0.5 * (top_ + bottom_);
  svg_ += fmt::format("<g class=\"{}\">\n", right ? "second-y-ticks" : "y-ticks");
  for (std::size_t i = 0; i < scale.ticks.size(); ++i) {
    const double y = scale.at(scale.ticks[i]);
    if (right) svg_ += fmt::format("<path d=\"M{:.1f} {:.1f}h4\" stroke=\"currentColor\"/>", right_, y);
    text({right ? right_ + 0.5 * font : left_ - 0.5 * font, y + 0.35 * font}, scale.names[i], right ? -1 : 1);
  }
  svg_ += "</g>\n";
  if (axis.label.empty()) return;
  const double x = right ? options_.width_px - 0.6 * font : 1.1 * font;
  text({x, middle}, axis.label, 0, fmt::format(" transform=\"rotate(-90 {:.1f} {:.1f})\"", x, middle));
}

void SvgPlot::marker(Marker shape, const Vector2d& at, double size_px) {
  const double r = 0.5 * size_px;
  const auto path = [&](std::string_view form, auto... values) {
    svg_ += fmt::format("<path class=\"marker\" stroke=\"none\" d=\"M{:.1f} {:.1f}", at.x(), at.y());
    svg_ += fmt::format(fmt::runtime(form), values...) + "\"/>";
  };
  switch (shape) {
    case Marker::none:
      return;
    case Marker::circle:
      svg_ +=
          fmt::format("<circle class=\"marker\" stroke=\"none\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>",
                      at.x(), at.y(), r);
      return;
    case Marker::square:
      return path("m-{0:.1f} -{0:.1f}h{1:.1f}v{1:.1f}h-{1:.1f}z", 0.9 * r, 1.8 * r);
    case Marker::diamond:
      return path("m0 -{0:.1f}l{0:.1f} {0:.1f}l-{0:.1f} {0:.1f}l-{0:.1f} -{0:.1f}z", 1.2 * r);
    case Marker::cross:
      svg_ += fmt::format(
          "<path class=\"marker\" fill=\"none\" stroke-width=\"1.6\" stroke-dasharray=\"none\" d=\"M{0:.1f} "
          "{1:.1f}m-{2:.1f} -{2:.1f}l{3:.1f} {3:.1f}m-{3:.1f} 0l{3:.1f} -{3:.1f}\"/>",
          at.x(), at.y(), 0.8 * r, 1.6 * r);
      return;
    case Marker::triangle_up:
      return path("m0 -{0:.1f}l{1:.1f} {2:.1f}h-{3:.1f}z", 1.2 * r, 1.1 * r, 2 * r, 2.2 * r);
    case Marker::triangle_down:
      return path("m0 {0:.1f}l{1:.1f} -{2:.1f}h-{3:.1f}z", 1.2 * r, 1.1 * r, 2 * r, 2.2 * r);
  }
}

void SvgPlot::drawLine(const Series& series) {
  std::string path;
  bool broken = true;
  for (const Vector2d& p : series.points) {
    if (!drawable(p)) {
      broken = true;
      continue;
    }
    const Vector2d pixel = this->at(series, p);
    if (broken) {
      path += fmt::format("M{:.1f} {:.1f}", pixel.x(), pixel.y());
    } else if (series.kind == SeriesKind::steps) {
      path += fmt::format("H{:.1f}V{:.1f}", pixel.x(), pixel.y());
    } else {
      path += fmt::format("L{:.1f} {:.1f}", pixel.x(), pixel.y());
    }
    broken = false;
  }
  if (!path.empty()) svg_ += fmt::format("<path fill=\"none\" stroke-linejoin=\"round\" d=\"{}\"/>\n", path);
}

void SvgPlot::drawBars(const Series& series) {
  const double all = barWidth(), one = all / bar_series_;
  const double zero = yScale(series).at(0.0);
  for (const Vector2d& p : series.points) {
    if (!drawable(p)) continue;
    const double from = x_.at(p.x() - 0.5 * all + bars_drawn_ * one),
                 to = x_.at(p.x() - 0.5 * all + (bars_drawn_ + 1) * one);
    const double y = yScale(series).at(p.y());
    svg_ += fmt::format(
        "<rect class=\"bar\" stroke=\"none\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" "
        "height=\"{:.2f}\"/>\n",
        from, std::min(y, zero), 0.94 * (to - from), std::abs(zero - y));
  }
  ++bars_drawn_;
}

void SvgPlot::drawSpans(const Series& series) {
  for (std::size_t i = 0; i < series.points.size(); ++i) {
    const Vector2d& p = series.points[i];
    if (!drawable(p) || !drawable(series.low[i])) continue;
    const Vector2d upper = at(series, p), lower = at(series, {p.x(), series.low[i]});
    svg_ +=
        fmt::format("<path class=\"span\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>\n", upper.x(), upper.y(), lower.y());
  }
}

void SvgPlot::drawMarkers(const Series& series) {
  if (series.marker == Marker::none) return;
  for (const Vector2d& p : series.points) {
    if (!drawable(p)) continue;
    marker(series.marker, at(series, p), series.size_px);
    svg_ += "\n";
  }
}

void SvgPlot::draw(const Series& series) {
  svg_ += fmt::format(
      "<g class=\"series\" fill=\"{0}\" stroke=\"{0}\" stroke-width=\"2\" opacity=\"{1:.2f}\"{2}>\n",
      colourOf(series), std::clamp(series.opacity, 0.0, 1.0),
      series.dashed ? " stroke-dasharray=\"6 4\"" : "");
  if (series.kind == SeriesKind::line || series.kind == SeriesKind::steps) drawLine(series);
  if (series.kind == SeriesKind::bars) drawBars(series);
  if (series.kind == SeriesKind::spans) drawSpans(series);
  drawMarkers(series);
  svg_ += "</g>\n";
}

std::string SvgPlot::write() {
  svg_ = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "color=\"{2}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"{3:.1f}\" role=\"img\">\n",
      options_.width_px, options_.height_px, kInk, options_.font_px);
  svg_ += fmt::format("<title>{}</title>\n<g fill=\"currentColor\">\n", escaped(plot_.title));
  titles();
  grid();
  xAxis();
  yAxis(y_, plot_.y, false);
  if (has_second_) yAxis(second_, plot_.second_y, true);
  for (const Series& series : plot_.series) draw(series);
  legend();
  return std::move(svg_ += "</g>\n</svg>\n");
}

}  // namespace

void PlotOptions::validate() const {
  requireOption(width_px >= 100 && width_px <= 10'000, "width_px", width_px, "in [100, 10000]");
  requireOption(height_px >= 100 && height_px <= 10'000, "height_px", height_px, "in [100, 10000]");
  requireOption(font_px >= 4 && font_px <= 100, "font_px", font_px, "in [4, 100]");
}

std::vector<double> niceTicks(double low, double high, int about) {
  const double magnitude = std::max(std::abs(low), std::abs(high));
  if (!(high - low > 1e-9 * magnitude)) {
    const double half = magnitude > 0 ? 0.1 * magnitude : 0.5;
    low -= half;
    high += half;
  }
  const double rough = (high - low) / std::max(1, about);
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  const double share = rough / decade;
  const double step = decade * (share <= 1.2 ? 1 : share <= 2.5 ? 2 : share <= 6 ? 5 : 10);
  const double first = std::floor(low / step + 1e-9), last = std::ceil(high / step - 1e-9);
  std::vector<double> ticks;
  for (double k = first; k <= last; ++k) ticks.push_back(k * step);
  // Rounding must not leave an end uncovered.
  ticks.front() = std::min(ticks.front(), low);
  ticks.back() = std::max(ticks.back(), high);
  return ticks;
}

std::string svgOf(const Plot& plot, const PlotOptions& options) { return SvgPlot(plot, options).write(); }

void writeSvg(const Plot& plot, const std::filesystem::path& file, const PlotOptions& options) {
  const std::string svg = svgOf(plot, options);
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << svg;
  stream.close();
  if (!stream)
    throw InputError(
        fmt::format("cannot write the plot to '{}': check the folder and the free space", file.string()));
}

}  // namespace boxgrasp
