// The rig where it is linear: no hit, no limit reached, no stick-slip transition, no stiffening spring. There
//
//     dz/dt = A z + b(t),   z = [phi_1, phi_m, dphi_1, dphi_m, ...],   b linear in time,
//
// then the states of a late drive, is solved exactly, and so are its derivatives where T is a Jet: exp(A h) by scaling
// and squaring, once for a trial's sampling interval and for other lengths that recur at every sample, and its action
// on a state by the Taylor series for uneven samples. Test: test/unit/one_link.cpp against integration, closed forms.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/scalar.hpp"

namespace ukemi::identify {

template <class T, int N>
class LinearFlow {
 public:
  static constexpr int kStates = N, kRates = 2;
  static constexpr int kDriven = N > 4 ? 3 : 2;  ///< number of states from kRates on that b drives
  using State = Eigen::Matrix<T, kStates, 1>;
  using Matrix = Eigen::Matrix<T, kStates, kStates>;
  static constexpr int kBlock = 16;  ///< samples computed from one state

  /// `a` is A, `h` the interval between samples [s].
  LinearFlow(const Matrix& a, double h) : a_(a), h_(h), rate_bound_(rate_bound_of(a)), step_(exponential(h)) {
    Matrix power = step_;
    for (int j = 0; j < kBlock; ++j) {
      for (int i = 0; i < 2; ++i) rows_[i][j] = power.row(i).transpose();
      if (j + 1 < kBlock) power = product(power, step_);
    }
    block_ = power;
  }

  double h() const { return h_; }
  const Matrix& step() const { return step_; }  ///< exp(A h)
  /// z n intervals later, for b = 0; n <= kBlock.
  State after(int n, State z) const {
    if (n == kBlock) return product(block_, z);
    for (int i = 0; i < n; ++i) z = product(step_, z);
    return z;
  }
  /// out = rest + angle i (0: phi_1, 1: phi_m) j + 1 intervals after z, for b = 0; j < kBlock.
  UKEMI_INLINE void angle(T& out, const T& rest, int i, int j, const State& z) const {
    const State& row = rows_[i][j];
    if constexpr (kDerivatives < T >> 0) {  // in registers: the innermost loop of a fit
      auto v = rest.v;
      double a = rest.a;
      for (int k = 0; k < kStates; ++k) a += row[k].a * z[k].a, v += row[k].a * z[k].v + z[k].a * row[k].v;
      out.a = a, out.v = v;
    } else {
      out = rest + row.dot(z);
    }
  }
  /// Upper bound of the magnitude of A's eigenvalues [1/s].
  double rate_bound() const { return rate_bound_; }
  /// That of any matrix: the largest row sum of |A|, balanced by scaling the rates.
  static double rate_bound_of(const Matrix& a) {
    double w = 1;
    for (int i = 2; i < 4; ++i)
      for (int j = 0; j < 2; ++j) w = std::max(w, std::sqrt(std::abs(value_of(a(i, j)))));
    Eigen::Array<double, kStates, 1> unit;
    for (int i = 0; i < kStates; ++i) unit[i] = i < 2 ? 1 : w;
    if constexpr (kStates > 4) {  // balances row and column sums in turn (Osborne 1960)
      constexpr int kSweeps = 4;
      for (int n = 0; n < kSweeps * kStates; ++n) {
        const int i = n % kStates;
        double row = 0, column = 0;
        for (int j = 0; j < kStates; ++j)
          if (j != i) row += std::abs(value_of(a(i, j))) * unit[j], column += std::abs(value_of(a(j, i))) / unit[j];
        if (row > 0 && column > 0) unit[i] = std::sqrt(row / column);
      }
    }
    double norm = 0;
    for (int i = 0; i < kStates; ++i) {
      double row = 0;
      for (int j = 0; j < kStates; ++j) row += std::abs(value_of(a(i, j))) * unit[j] / unit[i];
      norm = std::max(norm, row);
    }
    return norm;
  }

  /// Cost of `advance` by h, in Taylor series.
  double cost(double h) const {
    return rate_bound_ * h > kLongStep ? kLongStep + std::log2(rate_bound_ * h) : 1 + rate_bound_ * h;
  }

  /// z a time h later, for b = 0.
  State advance(const State& z, double h) const {
    if (rate_bound_ * h > kLongStep) return product(exponential(h), z);
    return advance(z, State::Zero(), State::Zero(), h);
  }
  /// z a time h later, for b = b0 + b1 t, t from the start.
  State advance(State z, const State& b0, const State& b1, double h) const {
    const int substeps = std::max(1, int(std::ceil(rate_bound_ * h)));
    const double d = h / substeps;
    for (int p = 0; p < substeps; ++p) {
      State term = z;
      double size = 1;
      for (int k = 1; size > kTermTolerance; ++k) {
        term = times_a(term);
        if (k == 1) term += b0 + b1 * T(p * d);
        if (k == 2) term += b1 * T(d);
        scale(term, d / k);
        z += term;
        size *= std::max(rate_bound_ * d, kMinRate) / k;
      }
    }
    return z;
  }

  /// Exact discretisation over a time `length` [s]: exp(A length), and the responses to b of each driven state: a unit
  /// step, and a ramp of slope 1/s. By the series over a short interval, then by doubling.
  struct Propagator {
    double length;
    Matrix step;
    Eigen::Matrix<T, kStates, kDriven> constant, ramp;

    State after(const State& z, const State& b0, const State& b1) const {
      return product(step, z) + constant * b0.template segment<kDriven>(kRates) +
             ramp * b1.template segment<kDriven>(kRates);
    }
  };
  Propagator propagator(double length) const {
    const int doublings = doublings_to(length);
    double d = std::ldexp(length, -doublings);
    const State zero = State::Zero();
    Propagator out{length, exponential(d), {}, {}};
    for (int j = 0; j < kDriven; ++j) {
      out.constant.col(j) = advance(zero, State::Unit(kRates + j), zero, d);
      out.ramp.col(j) = advance(zero, zero, State::Unit(kRates + j), d);
    }
    for (int s = 0; s < doublings; ++s, d *= 2) {
      for (int j = 0; j < kDriven; ++j) {
        out.ramp.col(j) += product(out.step, State(out.ramp.col(j))) + State(out.constant.col(j) * T(d));
        out.constant.col(j) += product(out.step, State(out.constant.col(j)));
      }
      out.step = product(out.step, out.step);
    }
    return out;
  }

  /// exp(A h): scaling, Taylor series, squaring (Moler, Van Loan 2003, method 3).
  Matrix exponential(double h) const {
    const int squarings = doublings_to(h);
    const double d = std::ldexp(h, -squarings);
    Matrix sum;
    for (int j = 0; j < kStates; ++j) sum.col(j) = advance(State(State::Unit(j)), State::Zero(), State::Zero(), d);
    for (int s = 0; s < squarings; ++s) sum = product(sum, sum);
    return sum;
  }

 private:
  /// Number of halvings of h until the series is short.
  int doublings_to(double h) const { return std::max(0, int(std::ceil(std::log2(std::max(rate_bound_ * h, 1e-300))))); }

  // Written out: expressions of Jets make temporaries.
  template <class Row>
  static T dot(const Row& r, const State& z) {
    T sum(0);
    for (int i = 0; i < kStates; ++i) add_product(sum, r[i], z[i]);
    return sum;
  }
  UKEMI_INLINE static State product(const Matrix& m, const State& z) {
    State out = State::Zero();
    for (int j = 0; j < kStates; ++j)
      for (int i = 0; i < kStates; ++i) add_product(out[i], m(i, j), z[j]);
    return out;
  }
  static Matrix product(const Matrix& m, const Matrix& n) {
    Matrix out;
    for (int j = 0; j < kStates; ++j) out.col(j) = product(m, State(n.col(j)));
    return out;
  }

  static constexpr double kLongStep = 4;           ///< |A h| beyond which squaring is cheaper than substeps
  static constexpr double kTermTolerance = 1e-19;  ///< relative size of a negligible term, derivatives included
  static constexpr double kMinRate = 1e-3;         ///< lower bound of |A h| for the number of terms: a reference moves

  /// A z; the first two rows of A are d phi/dt = dphi.
  State times_a(const State& z) const {
    State out;
    out[0] = z[2], out[1] = z[3];
    for (int i = 2; i < kStates; ++i) out[i] = dot(a_.row(i), z);
    return out;
  }
  static void scale(State& z, double x) {
    for (int i = 0; i < kStates; ++i) z[i] *= x;
  }

  Matrix a_;
  double h_, rate_bound_;
  Matrix step_, block_;
  State rows_[2][kBlock];
};

}  // namespace ukemi::identify
