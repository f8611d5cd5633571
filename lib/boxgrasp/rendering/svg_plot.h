// Plots as SVG text: points, lines, bars and spans on axes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "boxgrasp/geometry/pose.h"

namespace boxgrasp {

enum class SeriesKind {
  points,  // a marker each
  line,    // from point to point, with markers where one is chosen
  steps,   // a staircase: each value holds until the next x
  bars,    // from zero; several bar series stand side by side
  spans,   // upright lines from `low` to the point
};

enum class Marker { none, circle, square, diamond, cross, triangle_up, triangle_down };

// Values are drawn where they are finite and smaller than 1e100; the others are left out, and break a line.
struct Series {
  std::string name;  // in the legend; empty: not there
  SeriesKind kind = SeriesKind::line;
  std::vector<Vector2d> points;  // x, y
  std::vector<double> low;       // spans alone: the lower end of each
  Marker marker = Marker::none;
  double size_px = 7.0;      // of the marker
  int colour = -1;           // number in the palette; -1: the place of the series among all
  double opacity = 1.0;      // of everything; less where many points lie on each other
  bool dashed = false;       // lines, steps and spans
  bool second_axis = false;  // y counts on the second axis, on the right
};

struct PlotAxis {
  std::string label;  // with the unit, "training time [s]"
  // The axis reaches from the data's least to their greatest value, rounded to ticks, but at least so far.
  std::optional<double> low, high;
  // Names instead of numbers: the i-th stands at i. For x alone.
  std::vector<std::string> categories;
};

struct Plot {
  std::string title, subtitle;  // empty: none
  PlotAxis x, y, second_y;
  std::vector<Series> series;  // later ones lie over earlier ones
};

struct PlotOptions {
  int width_px = 720, height_px = 460;
  double font_px = 13.0;
  void validate() const;
};

// The least multiples of a round step (1, 2 or 5 times a power of ten) that reach from `low` or below to
// `high` or above, about as many as asked for. Pre: both finite, low <= high; equal ones are widened.
std::vector<double> niceTicks(double low, double high, int about);

// A whole SVG document without ground, for light and dark pages: its ink is a middle grey (presentation
// attribute `color`, so that a page's style may choose another), its palette that of Okabe and Ito, which the
// colour-blind can tell apart. All text is escaped. Throws InputError for bad options, or spans that have not
// as many low ends as points.
std::string svgOf(const Plot& plot, const PlotOptions& options = {});

// Throws InputError when the file cannot be written.
void writeSvg(const Plot& plot, const std::filesystem::path& file, const PlotOptions& options = {});

}  // namespace boxgrasp
