#include "boxgrasp/decomposition/measured_lines.h"

#include <algorithm>
#include <tuple>

#include "boxgrasp/base/tolerances.h"

namespace boxgrasp {

bool MeasuredLines::mayWin(double theta) const {
  return theta < t_ && theta <= best_ + tolerance::kEqualTheta;
}

void MeasuredLines::add(const Rated& rated, const Line& line) {
  if (!mayWin(rated.theta)) return;
  const std::size_t first = countFirst(faces_[rated.face], line);
  if (first < least_ || faces_[rated.face].size() - first < least_) return;
  best_ = std::min(best_, rated.theta);
  rated_.emplace_back(rated, line);
}

std::optional<BestLine> MeasuredLines::best() const {
  const std::pair<Rated, Line>* chosen = nullptr;
  const auto place = [](const Rated& rated) { return std::tie(rated.face, rated.line); };
  for (const auto& candidate : rated_) {
    if (!mayWin(candidate.first.theta)) continue;
    if (!chosen || place(candidate.first) < place(chosen->first)) chosen = &candidate;
  }
  if (!chosen) return std::nullopt;
  return BestLine{chosen->first.theta, chosen->first.face, chosen->second};
}

}  // namespace boxgrasp
