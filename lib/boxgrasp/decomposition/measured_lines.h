// The lines of a node's faces that were measured on all points so far, and the best of them.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "boxgrasp/decomposition/splits.h"

namespace boxgrasp {

// A line with its Theta, or a lower bound of that.
struct Rated {
  double theta;
  int face;
  std::size_t line;
};

class MeasuredLines {
 public:
  MeasuredLines(const FaceProjections& faces, const DecompositionOptions& options)
      : faces_(faces), least_(leastPoints(faces[0].size(), options.min_point_fraction)), t_(options.gain_t) {}

  // Whether a line with this Theta or bound can still be chosen.
  bool mayWin(double theta) const;

  // Keeps a line whose Theta was measured, unless it has too few points on a side.
  void add(const Rated& rated, const Line& line);

  // Of the lines within tolerance::kEqualTheta of the least Theta the first.
  std::optional<BestLine> best() const;

 private:
  const FaceProjections& faces_;
  std::size_t least_;
  double t_;
  double best_ = std::numeric_limits<double>::infinity();
  std::vector<std::pair<Rated, Line>> rated_;
};

}  // namespace boxgrasp
