#include "boxgrasp/training/normal_equations.h"

#include <cassert>

#include "boxgrasp/base/simd.h"

namespace boxgrasp {
namespace {

using Eigen::Index;

constexpr int kColumns = 4, kRows = NormalEquations::kTile;

}  // namespace

// sums[c * stride + r] += sum over the rows n of a of a[n][c] * b[n][r], for 4 x 8 sums that stay in
// registers.
BOXGRASP_SIMD void addTile(const double* a, const double* b, Index n, Index stride, double* sums) {
  typedef double Lanes __attribute__((vector_size(8 * kRows), aligned(8)));
  Lanes sum[kColumns];
  for (int c = 0; c < kColumns; ++c) sum[c] = *reinterpret_cast<const Lanes*>(sums + c * stride);
  for (Index i = 0; i < n; ++i, a += stride, b += stride) {
    const Lanes row = *reinterpret_cast<const Lanes*>(b);
    for (int c = 0; c < kColumns; ++c) sum[c] += a[c] * row;
  }
  for (int c = 0; c < kColumns; ++c) *reinterpret_cast<Lanes*>(sums + c * stride) = sum[c];
}

NormalEquations::NormalEquations(Index parameters)
    : parameters_(parameters),
      matrix_(Eigen::MatrixXd::Zero(padded(parameters), padded(parameters))),
      vector_(Eigen::VectorXd::Zero(padded(parameters))) {}

void NormalEquations::add(const Block& jacobian, const Eigen::VectorXd& residuals) {
  assert(jacobian.cols() == vector_.size() && jacobian.rows() == residuals.size());
  const Index size = vector_.size();
  for (Index c = 0; c < size; c += kColumns) {
    for (Index r = c / kRows * kRows; r < size; r += kRows) {
      addTile(jacobian.data() + c, jacobian.data() + r, jacobian.rows(), size, matrix_.data() + c * size + r);
    }
  }
  for (Index n = 0; n < residuals.size(); ++n) {
    vector_ += residuals[n] * jacobian.row(n).transpose();
    squared_residuals_ += residuals[n] * residuals[n];
  }
}

}  // namespace boxgrasp
