#include <algorithm>
#include <optional>
#include <queue>
#include <tuple>

#include "boxgrasp/base/parallel.h"
#include "boxgrasp/decomposition/face_search.h"
#include "boxgrasp/decomposition/splits.h"

namespace boxgrasp {
namespace {

// Of the bounds of blocks, and of lines that are about to be measured: a measurement costs as much as ten of
// those.
constexpr int kBlockDepth = 2, kLineDepth = 4;

// Lines of one face that were not yet measured, and a lower bound of their Theta.
struct Bounded {
  double theta;
  int face;
  LineBlock block;
  int depth;  // of the bound

  // The most promising first; of equals in a fixed order.
  bool operator<(const Bounded& other) const {
    const auto key = [](const Bounded& b) {
      return std::tie(b.theta, b.face, b.block.first_from, b.block.first_to);
    };
    return key(other) < key(*this);
  }
};

// Best first: what may hold the best line is halved until it is one line, and that is measured. Nothing that
// cannot win is.
class BestFirst {
 public:
  BestFirst(const FaceProjections& faces, const DecompositionOptions& options) : measured_(faces, options) {
    const std::array<std::span<const float>, 3> coordinates{faces[1].y, faces[0].x, faces[0].y};
    parallelFor(3, options.threads, [&](std::size_t i) { values_[i] = BlockedValues(coordinates[i]); });
    parallelFor(3, options.threads, [&](std::size_t f) {
      searches_[f].emplace(faces[f], values_[(f + 1) % 3], values_[(f + 2) % 3], options);
    });
  }

  std::optional<BestLine> run(const StopToken& stop) {
    for (int f = 0; f < 3; ++f) {
      for (const LineBlock& block : blocksOf(searches_[f]->cuts())) bound(f, block, kBlockDepth);
    }
    for (; !queue_.empty() && measured_.mayWin(queue_.top().theta); stop.check()) {
      const Bounded next = queue_.top();
      queue_.pop();
      if (next.block.size() > 1) {
        for (const LineBlock& half : halvesOf(next.block)) bound(next.face, half, kBlockDepth);
      } else if (next.depth < kLineDepth) {
        bound(next.face, next.block, kLineDepth);
      } else {
        measure(next);
      }
    }
    return measured_.best();
  }

 private:
  void bound(int face, const LineBlock& block, int depth) {
    const double theta = searches_[face]->bound(block, depth);
    if (measured_.mayWin(theta)) queue_.push({theta, face, block, depth});
  }

  void measure(const Bounded& bounded) {
    FaceSearch& search = *searches_[bounded.face];
    const std::size_t index = search.cuts().index(bounded.block.first_from, bounded.block.first_to);
    const Line& line = search.cuts().lines[index].line;
    measured_.add({search.theta(line, measured_), bounded.face, index}, line);
  }

  std::array<BlockedValues, 3> values_;
  std::array<std::optional<FaceSearch>, 3> searches_;
  MeasuredLines measured_;
  std::priority_queue<Bounded> queue_;
};

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
  std::array<std::vector<Vector2d>, 2> sides;
  for (std::size_t i = 0; i < face.size(); ++i)
    sides[line.isFirst(face.x[i], face.y[i]) ? 0 : 1].push_back(face.point(i));
  const double first = signedArea(convexHull(std::move(sides[0])));
  return (first + signedArea(convexHull(std::move(sides[1])))) / face.area;
}

std::optional<BestLine> bestHullLine(const FaceProjections& faces, const DecompositionOptions& options,
                                     const StopToken& stop) {
  return options.exhaustive ? bestByTryingAll(faces, options, stop) : BestFirst(faces, options).run(stop);
}

}  // namespace boxgrasp
