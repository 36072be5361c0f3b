// The linear algebra of CVODE for vectors of ten: what its vectors, matrices and its dense solver call, put in place of
// the library's own. It is common to every step, and some packages of the library (Debian's 6.4.1) are compiled without
// optimisation; with these a landing takes half the time. The library's own logic remains as it is packaged.
#pragma once

#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <Eigen/Core>
#include <cmath>
#include <utility>

namespace ukemi::bench {

inline constexpr int kVectorSize = 10;
using Vector = Eigen::Matrix<double, kVectorSize, 1>;

inline auto values(N_Vector v) { return Eigen::Map<Vector>(static_cast<N_VectorContent_Serial>(v->content)->data); }

/// The solver's own vectors are clones, which take these over.
inline void fit_to_size(_generic_N_Vector_Ops& ops) {
  ops.nvlinearsum = [](double a, N_Vector x, double b, N_Vector y, N_Vector z) {
    values(z) = a * values(x) + b * values(y);
  };
  ops.nvconst = [](double c, N_Vector z) { values(z).setConstant(c); };
  ops.nvprod = [](N_Vector x, N_Vector y, N_Vector z) { values(z) = values(x).cwiseProduct(values(y)); };
  ops.nvdiv = [](N_Vector x, N_Vector y, N_Vector z) { values(z) = values(x).cwiseQuotient(values(y)); };
  ops.nvscale = [](double c, N_Vector x, N_Vector z) { values(z) = c * values(x); };
  ops.nvabs = [](N_Vector x, N_Vector z) { values(z) = values(x).cwiseAbs(); };
  ops.nvinv = [](N_Vector x, N_Vector z) { values(z) = values(x).cwiseInverse(); };
  ops.nvaddconst = [](N_Vector x, double b, N_Vector z) { values(z) = values(x).array() + b; };
  ops.nvmaxnorm = [](N_Vector x) { return values(x).cwiseAbs().maxCoeff(); };
  ops.nvmin = [](N_Vector x) { return values(x).minCoeff(); };
  ops.nvwrmsnorm = [](N_Vector x, N_Vector w) {
    return std::sqrt(values(x).cwiseProduct(values(w)).squaredNorm() / kVectorSize);
  };
  ops.nvlinearcombination = [](int n, double* c, N_Vector* x, N_Vector z) {
    Vector sum = c[0] * values(x[0]);
    for (int i = 1; i < n; ++i) sum += c[i] * values(x[i]);
    values(z) = sum;
    return 0;
  };
  ops.nvscaleaddmulti = [](int n, double* a, N_Vector x, N_Vector* y, N_Vector* z) {
    for (int i = 0; i < n; ++i) values(z[i]) = a[i] * values(x) + values(y[i]);
    return 0;
  };
  ops.nvscalevectorarray = [](int n, double* c, N_Vector* x, N_Vector* z) {
    for (int i = 0; i < n; ++i) values(z[i]) = c[i] * values(x[i]);
    return 0;
  };
}

using Square = Eigen::Matrix<double, kVectorSize, kVectorSize>;
inline auto values(SUNMatrix m) { return Eigen::Map<Square>(SUNDenseMatrix_Data(m)); }
inline auto pivots(SUNLinearSolver s) {
  return Eigen::Map<Eigen::Matrix<sunindextype, kVectorSize, 1>>(
      static_cast<SUNLinearSolverContent_Dense>(s->content)->pivots);
}

inline void fit_to_size(_generic_SUNMatrix_Ops& ops) {
  ops.clone = [](SUNMatrix a) {
    SUNMatrix b = SUNDenseMatrix(kVectorSize, kVectorSize, a->sunctx);
    fit_to_size(*b->ops);
    return b;
  };
  ops.zero = [](SUNMatrix a) {
    values(a).setZero();
    return 0;
  };
  ops.copy = [](SUNMatrix a, SUNMatrix b) {
    values(b) = values(a);
    return 0;
  };
  ops.scaleaddi = [](double c, SUNMatrix a) {
    values(a) *= c;
    values(a).diagonal().array() += 1;
    return 0;
  };
}

/// LU decomposition in place with row exchanges, the diagonal inverted, and its solution.
inline void fit_to_size(_generic_SUNLinearSolver_Ops& ops) {
  ops.setup = [](SUNLinearSolver s, SUNMatrix matrix) {
    auto a = values(matrix);
    auto pivot = pivots(s);
    for (int k = 0; k < kVectorSize; ++k) {
      int row = k;
      for (int i = k + 1; i < kVectorSize; ++i)
        if (std::abs(a(i, k)) > std::abs(a(row, k))) row = i;
      if (a(row, k) == 0) return k + 1;
      if ((pivot[k] = row) != k) a.row(k).swap(a.row(row));
      const double inverse = 1 / a(k, k);
      a(k, k) = inverse;
      for (int i = k + 1; i < kVectorSize; ++i) a(i, k) *= inverse;
      for (int j = k + 1; j < kVectorSize; ++j)
        for (int i = k + 1; i < kVectorSize; ++i) a(i, j) -= a(i, k) * a(k, j);
    }
    return 0;
  };
  ops.solve = [](SUNLinearSolver s, SUNMatrix matrix, N_Vector solution, N_Vector right, double) {
    const auto a = values(matrix);
    const auto pivot = pivots(s);
    Vector x = values(right);
    for (int k = 0; k < kVectorSize; ++k) std::swap(x[k], x[pivot[k]]);
    for (int k = 0; k < kVectorSize; ++k)
      for (int i = k + 1; i < kVectorSize; ++i) x[i] -= a(i, k) * x[k];
    for (int k = kVectorSize - 1; k >= 0; --k) {
      x[k] *= a(k, k);
      for (int i = 0; i < k; ++i) x[i] -= a(i, k) * x[k];
    }
    values(solution) = x;
    return 0;
  };
}

}  // namespace ukemi::bench
