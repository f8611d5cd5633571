#include "boxgrasp/wrench/positive_span.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>

#include "boxgrasp/base/tolerances.h"

namespace boxgrasp {
namespace {

constexpr double kRounding = 1e-12;  // of tableau entries; the columns' entries are at most 1
constexpr int kMaxPivots = 10000;    // a few dozen are usual; the target is not degenerate, so none repeats

// Phase one of the simplex method for W x = b, x >= 0. The tableau has the six equations, signed so that the
// last column, b, is not negative, and below them the sum of the equations that are not solved yet: its last
// entry is what remains unexplained of b.
class Feasibility {
 public:
  Feasibility(const WrenchMatrix& columns, const Wrench& target) : tableau_(7, columns.cols() + 1) {
    tableau_.topLeftCorner(6, columns.cols()) = columns;
    tableau_.topRightCorner<6, 1>() = target;
    for (int i = 0; i < 6; ++i) {
      if (target[i] < 0.0) tableau_.row(i) *= -1.0;
    }
    tableau_.row(6) = tableau_.topRows<6>().colwise().sum();
  }

  double residual() {
    for (int pivots = 0; pivots < kMaxPivots; ++pivots) {
      Eigen::Index column;
      if (tableau_.row(6).head(rhs()).maxCoeff(&column) <= kRounding) break;
      const int row = leaving(column);
      if (row < 0) break;
      pivot(row, column);
    }
    return tableau_(6, rhs());
  }

 private:
  Eigen::Index rhs() const { return tableau_.cols() - 1; }
  double ratio(int row, Eigen::Index column) const { return tableau_(row, rhs()) / tableau_(row, column); }

  int leaving(Eigen::Index column) const {
    int best = -1;
    for (int i = 0; i < 6; ++i) {
      if (tableau_(i, column) <= kRounding) continue;
      if (best < 0 || ratio(i, column) < ratio(best, column)) best = i;
    }
    return best;
  }

  void pivot(int row, Eigen::Index column) {
    tableau_.row(row) /= tableau_(row, column);
    const Eigen::Matrix<double, 7, 1> factors = tableau_.col(column);
    for (int i = 0; i < 7; ++i) {
      if (i != row) tableau_.row(i) -= factors[i] * tableau_.row(row);
    }
  }

  Eigen::Matrix<double, 7, Eigen::Dynamic, Eigen::RowMajor> tableau_;
};

// Clearly so: the pivots of W W^T, which are squares, are far above rounding.
bool clearlyHasFullRank(const WrenchMatrix& wrenches) {
  constexpr double kClear = 1e-6;
  const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> squares(wrenches * wrenches.transpose());
  const Wrench pivots = squares.vectorD();
  return pivots.minCoeff() > kClear * pivots.maxCoeff();
}

bool hasFullRank(const WrenchMatrix& wrenches) {
  if (wrenches.cols() < 7) return false;
  if (clearlyHasFullRank(wrenches)) return true;
  Eigen::ColPivHouseholderQR<WrenchMatrix> qr(wrenches);
  return qr.setThreshold(tolerance::kWrenchRank).rank() == 6;
}

}  // namespace

// With any weights c > 0: if -W c = W x for an x >= 0, then the combination x + c, all positive, is zero, and
// the converse holds for any such combination, scaled up. Weights without a pattern keep -W c off the faces
// of the cones that the simplex method walks through, even for symmetric grasps.
bool positivelySpan(const std::vector<Wrench>& wrenches) {
  if (wrenches.empty()) return false;
  WrenchMatrix columns = Eigen::Map<const WrenchMatrix>(wrenches.front().data(), 6, wrenches.size());
  if (!hasFullRank(columns)) return false;
  columns /= columns.cwiseAbs().maxCoeff();
  Wrench target = Wrench::Zero();
  for (Eigen::Index i = 0; i < columns.cols(); ++i) target -= (2.0 + std::sin(i + 1.0)) * columns.col(i);
  return Feasibility(columns, target).residual() <= tolerance::kWrenchMargin * columns.cols();
}

}  // namespace boxgrasp
