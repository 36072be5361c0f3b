// Semi-implicit (symplectic) Euler: the fixed-step method of most game and many robot simulators, for comparison.
#pragma once

#include "common/integrate/runge_kutta.hpp"

namespace ukemi::integrate {

/// v_1 = v + h a(t, q, v), q_1 = q + h v_1; order 1. The first kPositions components of the state are q, the next
/// kPositions v; the others advance by the explicit Euler rule. Dense output is linear.
/// Source: E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, 2nd ed. (2006), I.1.
struct SemiImplicitEuler {
  static constexpr const char* kName = "semi_implicit_euler";
  static constexpr int kOrder = 1, kDenseOrder = 1;
};

template <class T, int N>
class SemiImplicitEulerStep : public StepEnds<T, N> {
 public:
  using State = typename StepEnds<T, N>::State;
  static constexpr int error_order() { return 1; }

  template <class F>
  void advance(F&& f) {
    this->compute();
    constexpr int n = std::remove_cvref_t<F>::kPositions;
    State& end = this->y_end;
    end = this->y + T(this->h) * this->slope;
    end.template head<n>() = this->y.template head<n>() + T(this->h) * end.template segment<n>(n);
    f(this->t + this->h, end, this->slope_end);
  }
  template <int kControlled>
  double error(const Tolerance<kControlled>&) const {
    return 0;  // fixed steps
  }
  template <class F>
  void prepare_dense(F&&) {}
  State at(double s) const {
    const auto point = this->point_at(s);
    return this->extrapolated(this->y + T(point.fraction) * (this->computed_end() - this->y), point.excess);
  }
  T component_at(int i, double s) const { return at(s)[i]; }
};

template <class T, int N, int kCoupled>
struct StepOf<SemiImplicitEuler, T, N, kCoupled> {
  using type = SemiImplicitEulerStep<T, N>;
};

}  // namespace ukemi::integrate
