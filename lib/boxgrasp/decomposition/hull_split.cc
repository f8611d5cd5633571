#include <algorithm>
#include <optional>
#include <tuple>

#include "boxgrasp/base/parallel.h"
#include "boxgrasp/decomposition/face_search.h"
#include "boxgrasp/decomposition/sides.h"
#include "boxgrasp/decomposition/splits.h"

namespace boxgrasp {
namespace {

constexpr std::size_t kSpread = 128;  // points in the inside of the face that first bounds are taken from
constexpr std::size_t kMeasureCost = 600;  // to measure a line costs as much as this many points in a sweep

using FaceSearches = std::array<std::optional<FaceSearch>, 3>;

// The lines that may win, the most promising first.
std::vector<Rated> running(const FaceSearches& searches, const MeasuredLines& measured) {
  std::vector<Rated> lines;
  for (int f = 0; f < 3; ++f) {
    const std::vector<double>& bounds = searches[f]->bounds();
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      if (measured.mayWin(bounds[i])) lines.push_back({bounds[i], f, i});
    }
  }
  std::sort(lines.begin(), lines.end(), [](const Rated& a, const Rated& b) {
    return std::tie(a.theta, a.face, a.line) < std::tie(b.theta, b.face, b.line);
  });
  return lines;
}

void measure(const Rated& bounded, FaceSearches& searches, MeasuredLines& measured) {
  FaceSearch& search = *searches[bounded.face];
  measured.add({search.take(bounded.line, measured), bounded.face, bounded.line}, search.line(bounded.line));
}

// Bounds the lines by more and more points, as long as that costs less than to measure those that may win.
void narrow(FaceSearches& searches, MeasuredLines& measured, int threads) {
  for (std::size_t spread = kSpread, fans = 0, lines = 1; fans * spread < lines * kMeasureCost; spread *= 4) {
    parallelFor(3, threads, [&](std::size_t f) { searches[f]->bound(spread, measured); });
    const std::vector<Rated> left = running(searches, measured);
    if (left.empty()) return;
    measure(left.front(), searches, measured);
    lines = left.size();
    fans = 0;
    for (const auto& search : searches) fans += search->fans(measured);
    fans *= 4;
  }
}

std::optional<BestLine> bestByBounds(const FaceProjections& faces, const DecompositionOptions& options,
                                     const StopToken& stop) {
  FaceSearches searches;
  parallelFor(3, options.threads, [&](std::size_t f) { searches[f].emplace(faces[f], options); });
  MeasuredLines measured(faces, options);
  narrow(searches, measured, options.threads);
  for (const Rated& bounded : running(searches, measured)) {
    stop.check();
    if (!measured.mayWin(bounded.theta)) break;
    measure(bounded, searches, measured);
  }
  return measured.best();
}

std::optional<BestLine> bestByTryingAll(const FaceProjections& faces, const DecompositionOptions& options,
                                        const StopToken& stop) {
  MeasuredLines measured(faces, options);
  for (int f = 0; f < 3; ++f) {
    std::vector<Vector2d> points;
    for (std::size_t i = 0; i < faces[f].size(); ++i) points.push_back(faces[f].point(i));
    const CutLines cuts = cutLines(convexHull(std::move(points)), options);
    for (std::size_t i = 0; i < cuts.lines.size(); ++i) {
      stop.check();
      measured.add({plainTheta(faces[f], cuts.lines[i].line), f, i}, cuts.lines[i].line);
    }
  }
  return measured.best();
}

}  // namespace

double plainTheta(const FaceProjection& face, const Line& line) {
  std::vector<Vector2d> points;
  for (std::size_t i = 0; i < face.size(); ++i) points.push_back(face.point(i));
  Sides sides;
  part(points, line, sides);
  return thetaOf(hullsOf(std::move(sides)), face);
}

std::optional<BestLine> bestHullLine(const FaceProjections& faces, const DecompositionOptions& options,
                                     const StopToken& stop) {
  return options.exhaustive ? bestByTryingAll(faces, options, stop) : bestByBounds(faces, options, stop);
}

}  // namespace boxgrasp
