// LU factorisation of a small dense matrix, compiled once for the kernels of all sizes.
#pragma once

#include <memory>

namespace ukemi::integrate {

class DenseLu {
 public:
  DenseLu();
  ~DenseLu();
  /// Factorises the n x n matrix, stored by columns; partial pivoting.
  void compute(const double* matrix, int n);
  /// Replaces x, of n numbers, by the solution of A u = x.
  void solve(double* x) const;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

}  // namespace ukemi::integrate
