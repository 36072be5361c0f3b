// One step of an explicit embedded pair, with its error estimate and its dense output.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <utility>

#include "common/integrate/tableaus.hpp"
#include "common/scalar.hpp"

namespace ukemi::integrate {

/// The stages of one attempted step from (t, y) over h. `k[0]` = f(t, y) must be set before `advance`.
template <class Tableau, class T, int N>
class Step {
 public:
  using State = Eigen::Matrix<T, N, 1>;
  static constexpr int kLast = Tableau::kStages - 1;

  double t = 0;  ///< start of the step [s]
  double h = 0;  ///< length of the step [s]
  State y;       ///< state at the start
  State y_end;   ///< state at the end, of order Tableau::kOrder
  std::array<State, Tableau::kDenseStages> k;

  const State& slope() const { return k[0]; }          ///< f at the start
  const State& slope_end() const { return k[kLast]; }  ///< f at the end

  /// Computes every stage and `y_end`; f(t, y) -> dy/dt.
  template <class F>
  void advance(F&& f) {
    dense_ready_ = Tableau::kDenseStages == Tableau::kStages;
    stages<1>(f);
  }

  /// The error norm of the step over the first `controlled` components, at most 1 where it is acceptable; tolerance(i,
  /// a, b) is that of component i between values a and b. Derivatives count too, kDerivativeEase times more loosely: a
  /// field at rest has no error in its values whatever the step, while its derivatives may be beyond the method's
  /// stability.
  static constexpr double kDerivativeEase = 1e3;
  template <class Tolerance>
  double error(int controlled, Tolerance&& tolerance) const {
    const auto of = [&](auto&& pick) {
      std::array<double, Tableau::kEstimates> norm{};
      for (int i = 0; i < controlled; ++i) {
        const double inverse = 1 / tolerance(i, pick(y[i]), pick(y_end[i]));
        [&]<std::size_t... Q>(std::index_sequence<Q...>) {
          ((norm[Q] += square(estimate<Q>(i, pick, std::make_index_sequence<Tableau::kStages>{}) * inverse)), ...);
        }
        (std::make_index_sequence<Tableau::kEstimates>{});
      }
      for (double& n : norm) n = h * std::sqrt(n / controlled);
      return Tableau::error_norm(norm);
    };
    double worst = of([](const T& x) { return value_of(x); });
    if constexpr (kDerivatives < T >> 0)
      for (int slot = 0; slot < kDerivatives<T>; ++slot) {
        const double e = of([slot](const T& x) { return derivative_of(x, slot); }) / kDerivativeEase;
        if (!(e <= worst)) worst = e;  // also where it is NaN
      }
    return worst;
  }

  /// Evaluates the further stages that dense output needs, once a step.
  template <class F>
  void prepare_dense(F&& f) {
    if (dense_ready_) return;
    stages<Tableau::kStages>(f);
    dense_ready_ = true;
  }

  /// y(t + s h), 0 <= s <= 1; `prepare_dense` first.
  State at(double s) const {
    State sum = State::Zero();
    for_weights(s, [&](int i, double b) {
      for (int c = 0; c < N; ++c) add_scaled(sum[c], b, k[i][c]);
    });
    State out = y;
    for (int c = 0; c < N; ++c) add_scaled(out[c], h, sum[c]);
    return out;
  }
  /// One component of `at`.
  T component_at(int index, double s) const {
    T sum(0);
    for_weights(s, [&](int i, double b) { add_scaled(sum, b, k[i][index]); });
    T out = y[index];
    add_scaled(out, h, sum);
    return out;
  }

 private:
  bool dense_ready_ = false;

  static double square(double x) { return x * x; }

  template <int kStage, class F>
  void stages(F& f) {
    constexpr int kEnd = kStage < Tableau::kStages ? Tableau::kStages : Tableau::kDenseStages;
    if constexpr (kStage < kEnd) {
      const State sum = weighted<kStage>(std::make_index_sequence<kStage>{});
      if constexpr (kStage == kLast) {
        y_end = y;
        for (int i = 0; i < N; ++i) add_scaled(y_end[i], h, sum[i]);
        k[kStage] = f(t + h, y_end);
      } else {
        State at_stage = y;
        for (int i = 0; i < N; ++i) add_scaled(at_stage[i], h, sum[i]);
        k[kStage] = f(t + Tableau::c[kStage] * h, at_stage);
      }
      stages<kStage + 1 == kEnd ? Tableau::kDenseStages : kStage + 1>(f);
    }
  }

  // Sums over the stages, component by component, with the zeros of the tableau left out at compile time.
  template <int kStage, std::size_t... J>
  State weighted(std::index_sequence<J...>) const {
    State sum;
    for (int i = 0; i < N; ++i) {
      T x(0);
      (
          [&] {
            if constexpr (Tableau::a[kStage][J] != 0) add_scaled(x, Tableau::a[kStage][J], k[J][i]);
          }(),
          ...);
      sum[i] = x;
    }
    return sum;
  }
  template <std::size_t kEstimate, class Pick, std::size_t... J>
  double estimate(int i, Pick&& pick, std::index_sequence<J...>) const {
    double x = 0;
    (
        [&] {
          if constexpr (Tableau::e[kEstimate][J] != 0) x += Tableau::e[kEstimate][J] * pick(k[J][i]);
        }(),
        ...);
    return x;
  }

  template <class Use>
  static void for_weights(double s, Use&& use) {
    for (int i = 0; i < Tableau::kDenseStages; ++i) {
      double b = 0;
      for (int d = Tableau::kDenseDegree - 1; d >= 0; --d) b = b * s + Tableau::p[i][d];
      use(i, b * s);
    }
  }
};

}  // namespace ukemi::integrate
