// How well numbers are known: their names and covariance, as [uncertainty] of a file has them.
#pragma once

#include <string>
#include <vector>

namespace ukemi {

/// A column-major matrix of doubles. Converts from and to any matrix of Eigen.
class DenseMatrix {
 public:
  DenseMatrix() = default;
  DenseMatrix(long rows, long cols) : rows_(rows), cols_(cols), data_(std::size_t(rows * cols)) {}
  template <class M>
  requires requires(const M& m) { m.eval().data(); }
  DenseMatrix(const M& m) : DenseMatrix(m.rows(), m.cols()) {
    const auto plain = m.eval();
    for (long j = 0; j < cols_; ++j)
      for (long i = 0; i < rows_; ++i) (*this)(i, j) = plain(i, j);
  }
  template <class M>
  requires requires { M::MaxRowsAtCompileTime; }
  operator M() const {
    M m(rows_, cols_);
    for (long j = 0; j < cols_; ++j)
      for (long i = 0; i < rows_; ++i) m(i, j) = (*this)(i, j);
    return m;
  }
  long rows() const { return rows_; }
  long cols() const { return cols_; }
  long size() const { return rows_ * cols_; }
  double& operator()(long i, long j) { return data_[std::size_t(j * rows_ + i)]; }
  double operator()(long i, long j) const { return data_[std::size_t(j * rows_ + i)]; }
  const double* data() const { return data_.data(); }
  double* data() { return data_.data(); }
  bool operator==(const DenseMatrix&) const = default;

 private:
  long rows_ = 0, cols_ = 0;
  std::vector<double> data_;
};

/// 97.5 % quantile of the standard normal distribution: half the width of its 95 % interval.
inline constexpr double kNormal975 = 1.959963984540054;

struct Uncertainty {
  std::vector<std::string> order;
  DenseMatrix covariance;  ///< of `order`, in SI units
};

}  // namespace ukemi
