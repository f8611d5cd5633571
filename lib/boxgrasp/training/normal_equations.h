// The normal equations of least squares, block by block.
#pragma once

#include <Eigen/Core>

namespace boxgrasp {

// Sums J^T J and J^T r over blocks of rows of J, so that J itself is never held. Every element is summed in
// the order of the rows, so the result has the same bits on every machine.
class NormalEquations {
 public:
  static constexpr Eigen::Index kTile = 8;
  // A block's columns are padded with zeros to a multiple of kTile.
  using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  explicit NormalEquations(Eigen::Index parameters);
  static Eigen::Index padded(Eigen::Index parameters) { return (parameters + kTile - 1) / kTile * kTile; }

  // Pre: jacobian has padded(parameters) columns and as many rows as there are residuals.
  void add(const Block& jacobian, const Eigen::VectorXd& residuals);

  // Only the lower triangle is set.
  auto matrix() const { return matrix_.topLeftCorner(parameters_, parameters_); }
  auto vector() const { return vector_.head(parameters_); }
  double squaredResiduals() const { return squared_residuals_; }

 private:
  Eigen::Index parameters_;
  Eigen::MatrixXd
      matrix_;  // column c holds, from row c on, the products of column c with the columns after it
  Eigen::VectorXd vector_;
  double squared_residuals_ = 0.0;
};

}  // namespace boxgrasp
