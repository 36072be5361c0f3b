// The rig where it is linear: no hit, no limit reached, no side that turns to or from rest, no stiffening spring. There
//
//     dz/dt = A z + b(t),   z = [phi_1, phi_m, dphi_1, dphi_m, ...],   b linear in time,
//
// behind them the states of a drive that is late, is followed exactly, and so are its derivatives where T is a Jet:
// exp(A h) by scaling and squaring, once for a trial's sampling interval and for what else comes again at every sample,
// and its action on a state by the Taylor series where samples are uneven. Tests: test/unit/one_link.cpp against the
// integrated path and closed forms.
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
  static constexpr int kDriven = N > 4 ? 3 : 2;  ///< states from kRates on that b drives
  using State = Eigen::Matrix<T, kStates, 1>;
  using Matrix = Eigen::Matrix<T, kStates, kStates>;
  static constexpr int kBlock = 16;  ///< samples that are read off one state

  /// `a` is A, `h` the interval between samples [s].
  LinearFlow(const Matrix& a, double h) : a_(a), h_(h), rate_(rate_of(a)), step_(exponential(h)) {
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
  /// An upper bound of the size of A's eigenvalues [1/s].
  double rate() const { return rate_; }
  /// The same of another matrix: the largest row sum of |A| with rates counted in units that even it out.
  static double rate_of(const Matrix& a) {
    double w = 1;
    for (int i = 2; i < 4; ++i)
      for (int j = 0; j < 2; ++j) w = std::max(w, std::sqrt(std::abs(value_of(a(i, j)))));
    Eigen::Array<double, kStates, 1> unit;
    for (int i = 0; i < kStates; ++i) unit[i] = i < 2 ? 1 : w;
    if constexpr (kStates > 4) {  // row and column of each made alike, in turn (Osborne 1960)
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

  /// How much work `advance` by h is, in series of terms.
  double work(double h) const { return rate_ * h > kLong ? kLong + std::log2(rate_ * h) : 1 + rate_ * h; }

  /// z a time h later, for b = 0.
  State advance(const State& z, double h) const {
    if (rate_ * h > kLong) return product(exponential(h), z);
    return advance(z, State::Zero(), State::Zero(), h);
  }
  /// The same for b = b0 + b1 t, t from here on.
  State advance(State z, const State& b0, const State& b1, double h) const {
    const int parts = std::max(1, int(std::ceil(rate_ * h)));
    const double d = h / parts;
    for (int p = 0; p < parts; ++p) {
      State term = z;
      double size = 1;
      for (int k = 1; size > kNothing; ++k) {
        term = applied(term);
        if (k == 1) term += b0 + b1 * T(p * d);
        if (k == 2) term += b1 * T(d);
        scale(term, d / k);
        z += term;
        size *= std::max(rate_ * d, kSlow) / k;
      }
    }
    return z;
  }

  /// A time `length` at once: exp(A length), and what the b of each driven state adds, a constant one of 1 and one that
  /// grows from 0 by 1/s. By the series over a short part, then by doubling it.
  struct Leap {
    double length;
    Matrix step;
    Eigen::Matrix<T, kStates, kDriven> constant, growing;

    State after(const State& z, const State& b0, const State& b1) const {
      return product(step, z) + constant * b0.template segment<kDriven>(kRates) +
             growing * b1.template segment<kDriven>(kRates);
    }
  };
  Leap leap(double length) const {
    const int doublings = doublings_to(length);
    double d = std::ldexp(length, -doublings);
    const State zero = State::Zero();
    Leap out{length, exponential(d), {}, {}};
    for (int j = 0; j < kDriven; ++j) {
      out.constant.col(j) = advance(zero, State::Unit(kRates + j), zero, d);
      out.growing.col(j) = advance(zero, zero, State::Unit(kRates + j), d);
    }
    for (int s = 0; s < doublings; ++s, d *= 2) {
      for (int j = 0; j < kDriven; ++j) {
        out.growing.col(j) += product(out.step, State(out.growing.col(j))) + State(out.constant.col(j) * T(d));
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
  /// Of a part within which the series is short.
  int doublings_to(double h) const { return std::max(0, int(std::ceil(std::log2(std::max(rate_ * h, 1e-300))))); }

  // Written out: an expression of Jets makes a temporary of each.
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

  static constexpr double kLong = 4;         ///< |A h| beyond which squaring is cheaper than so many series
  static constexpr double kNothing = 1e-19;  ///< a term of the series so small, derivatives included
  static constexpr double kSlow = 1e-3;      ///< |A h| below which a reference that moves sets the number of terms

  /// A z: the first two rows of A say that the angles' rates are the rates.
  State applied(const State& z) const {
    State out;
    out[0] = z[2], out[1] = z[3];
    for (int i = 2; i < kStates; ++i) out[i] = dot(a_.row(i), z);
    return out;
  }
  static void scale(State& z, double x) {
    for (int i = 0; i < kStates; ++i) z[i] *= x;
  }

  Matrix a_;
  double h_, rate_;
  Matrix step_, block_;
  State rows_[2][kBlock];
};

}  // namespace ukemi::identify
