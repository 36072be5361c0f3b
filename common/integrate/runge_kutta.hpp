// One step of an explicit Runge-Kutta method, with its error estimate and its dense output.
//
// What every kind of step offers to the driver (hybrid.hpp): t, h, y, y_end, slope, slope_end; `advance` computes the
// step of length h; `error` its error over the tolerance (0 where the method has no estimate: fixed steps);
// `prepare_dense`, `at`, `component_at` its interior; `move_end` moves its end to an event; `choose` gives the length
// to try next; `invalidate` drops cached evaluations of a field that has changed.
//
// `at(s)` of an accepted step is valid for 0 <= s <= 1, from its start to its end (moved or not), and throws
// std::logic_error outside: the polynomial is not to be extrapolated.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "common/integrate/tableaus.hpp"
#include "common/scalar.hpp"

namespace ukemi::integrate {

/// Tolerated error of each controlled component: accuracy (unit + |y|), with the larger |y| of the step's ends.
template <int kControlled>
struct Tolerance {
  double accuracy;                            ///< relative
  Eigen::Array<double, kControlled, 1> unit;  ///< size below which a component need not be relatively exact
};

/// Error over tolerance, root mean square over the controlled components; the largest of values and of each derivative.
/// The tolerance of derivatives is kDerivativeFactor times larger: a field at rest has no error in its
/// values whatever the step, while its derivatives may be beyond the method's stability.
inline constexpr double kDerivativeFactor = 1e3;
template <class State, int kControlled>
double error_size(const State& error, const State& a, const State& b, const Tolerance<kControlled>& tolerance) {
  using T = typename State::Scalar;
  using Values = Eigen::Array<double, kControlled, 1>;
  const auto of = [&](auto&& pick) {
    const auto values = [&](const State& x) {
      Values v;
      for (int i = 0; i < kControlled; ++i) v[i] = pick(x[i]);
      return v;
    };
    const Values size = tolerance.unit + values(a).abs().max(values(b).abs());
    return std::sqrt((values(error) / size).square().sum() / kControlled) / tolerance.accuracy;
  };
  double worst = of([](const T& x) { return value_of(x); });
  if constexpr (kDerivatives < T >> 0)
    for (int slot = 0; slot < kDerivatives<T>; ++slot) {
      const double e = of([slot](const T& x) { return derivative_of(x, slot); }) / kDerivativeFactor;
      if (!(e <= worst)) worst = e;  // also where it is NaN
    }
  return worst;
}

/// Base of all steps: their ends, and the position of a point of the step in the computed length.
template <class T, int N>
struct StepEnds {
  using State = Eigen::Matrix<T, N, 1>;
  using Time = TimeOf<T>;
  Time t{0};        ///< start of the step [s]
  Time h{0};        ///< length of the step [s]
  State y;          ///< state at the start
  State y_end;      ///< state at the end
  State slope;      ///< f at the start; set before `advance`
  State slope_end;  ///< f at the end

  /// Begins the next step where this one ends.
  void next() { t += h, y = y_end, slope = slope_end; }
  /// After a whole accepted step: the length to try next. Methods that switch (automatic.hpp) decide here.
  double choose(double h_next) { return h_next; }
  /// True where an automatic method took the last step implicitly.
  static constexpr bool implicit() { return false; }
  /// The field has jumped: its cached evaluations are invalid.
  void invalidate() {}
  /// Moves the end by `shift` (much smaller than h) along the field, to an event; set slope_end afterwards [s].
  void move_end(double shift) {
    computed_end_ = y_end, computed_slope_ = slope_end;
    moved_ = true;
    for (int c = 0; c < N; ++c) add_scaled(y_end[c], shift, slope_end[c]);
    h += shift;
  }
  /// Fraction s of the step at a time [s], clamped to 0..1 within rounding. Throws std::logic_error outside.
  double place_of(double time) const {
    constexpr double kRounding = 1e-9;  // in fractions of the step
    const double s = h > 0 ? (time - t) / h : 0;
    if (!(s >= -kRounding && s <= 1 + kRounding)) throw_outside();
    return std::clamp(s, 0.0, 1.0);
  }

 protected:
  /// Begins a computation of length h.
  void compute() { computed_h_ = h, moved_ = false; }
  const State& computed_end() const { return moved_ ? computed_end_ : y_end; }
  Time computed_h() const { return computed_h_; }

  /// A point of the step: fraction of the computed length, 0..1, and time after its end [s].
  struct Point {
    Time fraction, excess;
  };
  Point point_at(const Time& s) const {
    if constexpr (kIsPack<T>) {
      return {s, Time(0)};  // lanes are never moved
    } else {
      if (!(s >= 0 && s <= 1)) throw_outside();
      if (!moved_) return {s, 0};
      const double from_start = s * h;
      return from_start <= computed_h_ ? Point{from_start / computed_h_, 0} : Point{1, from_start - computed_h_};
    }
  }
  /// After the computed end the step continues linearly along the field.
  State extrapolated(State x, const Time& excess) const {
    if constexpr (!kIsPack<T>)
      if (excess > 0)
        for (int c = 0; c < N; ++c) add_scaled(x[c], excess, computed_slope_[c]);
    return x;
  }
  [[noreturn, gnu::cold]] static void throw_outside() {
    throw std::logic_error("bug: dense output was asked for outside of its step");
  }

 private:
  Time computed_h_{0};                   ///< the length h that was computed
  bool moved_ = false;                   ///< whether `move_end` moved the end
  State computed_end_, computed_slope_;  ///< computed end and f there, if so
};

/// The stages of one attempted step from (t, y) over h.
template <class Tableau, class T, int N>
class Step : public StepEnds<T, N> {
  using Ends = StepEnds<T, N>;

 public:
  using State = typename Ends::State;
  using Time = typename Ends::Time;
  using Ends::h, Ends::t, Ends::y, Ends::y_end, Ends::slope, Ends::slope_end;
  static constexpr int kLast = Tableau::kStages - 1;
  static constexpr int error_order() { return Tableau::kErrorOrder; }

  /// Computes every stage and `y_end`; f(t, y, dy) sets dy/dt.
  template <class F>
  void advance(F&& f) {
    this->compute();
    dense_ready_ = Tableau::kDenseStages == Tableau::kStages;
    k_[0] = slope;
    stages<1, Tableau::kStages>(f);
    slope_end = k_[kLast];
  }

  /// The Q-th estimate of the error, without its factor h.
  template <std::size_t Q = 0>
  State error_rate() const {
    return combined<[](int j) { return Tableau::e[Q][j]; }, kLast>();
  }
  /// The error over its tolerance.
  template <int kControlled>
  double error(const Tolerance<kControlled>& tolerance) const {
    std::array<double, Tableau::kEstimates> size{};
    [&]<std::size_t... Q>(std::index_sequence<Q...>) {
      ((size[Q] = std::abs(h) * error_size(error_rate<Q>(), y, y_end, tolerance)), ...);
    }
    (std::make_index_sequence<Tableau::kEstimates>{});
    return Tableau::error_norm(size, tolerance.accuracy);
  }

  /// |h lambda| of the first components, estimated from the last two stages, which are at the same time (Hairer,
  /// Wanner, IV.2).
  double stiffness(int components) const {
    double change = 0, distance = 0;
    for (int i = 0; i < components; ++i) {
      const double dk = value_of(k_[kLast][i]) - value_of(k_[kLast - 1][i]),
                   dy = value_of(y_end[i]) - second_last_state(i);
      change += dk * dk, distance += dy * dy;
    }
    return distance > 0 ? h * std::sqrt(change / distance) : 0;
  }

  /// Evaluates the additional stages of dense output, once a step.
  template <class F>
  void prepare_dense(F&& f) {
    if (dense_ready_) return;
    const Time moved = h;
    h = this->computed_h();
    stages<Tableau::kStages, Tableau::kDenseStages>(f);
    h = moved;
    dense_ready_ = true;
  }

  /// y(t + s h), 0 <= s <= 1; `prepare_dense` first.
  State at(const Time& s) const {
    const auto point = this->point_at(s);
    State sum;
    for (int c = 0; c < N; ++c) sum[c] = T(0);
    for_weights(point.fraction, [&](int i, const Time& b) {
      for (int c = 0; c < N; ++c) add_scaled(sum[c], b, k_[i][c]);
    });
    State out = y;
    for (int c = 0; c < N; ++c) add_scaled(out[c], this->computed_h(), sum[c]);
    return this->extrapolated(out, point.excess);
  }
  /// One component of `at`.
  T component_at(int index, const Time& s) const {
    const auto point = this->point_at(s);
    if constexpr (!kIsPack<T>)
      if (point.excess > 0) return at(s)[index];
    T sum(0);
    for_weights(point.fraction, [&](int i, const Time& b) { add_scaled(sum, b, k_[i][index]); });
    T out = y[index];
    add_scaled(out, this->computed_h(), sum);
    return out;
  }

 private:
  std::array<State, Tableau::kDenseStages> k_;
  State stage_;
  bool dense_ready_ = false;

  /// Component i of the state at which the last stage but one was evaluated.
  double second_last_state(int i) const {
    double x = 0;
    for (int j = 0; j < kLast - 1; ++j) x += Tableau::a[kLast - 1][j] * value_of(k_[j][i]);
    return value_of(y[i]) + h * x;
  }

  /// Evaluates k_[kFirst] .. k_[kEnd - 1].
  template <int kFirst, int kEnd, class F>
  void stages(F& f) {
    if constexpr (kFirst < kEnd) {
      constexpr auto kRow = [](int j) { return Tableau::a[kFirst][j]; };
      State& stage_state = kFirst == kLast ? y_end : stage_;
      if constexpr (kDerivatives < T >> 0) {
        const State sum = combined<kRow, kFirst - 1>();
        stage_state = y;
        for (int c = 0; c < N; ++c) add_scaled(stage_state[c], h, sum[c]);
      } else {
        stage_state = y + T(h) * combined<kRow, kFirst - 1>();
      }
      f(t + Time(Tableau::c[kFirst]) * h, stage_state, k_[kFirst]);
      stages<kFirst + 1, kEnd>(f);
    }
  }

  /// sum_j w(j) k_j, j <= kJ, as one expression: a single pass without the zeros of the tableau. The weights
  /// carry no derivatives.
  template <auto kWeight, int kJ>
  auto combined() const {
    if constexpr (kDerivatives < T >> 0) {
      State sum;
      for (int c = 0; c < N; ++c) {
        T x = k_[0][c] * kWeight(0);
        [&]<std::size_t... J>(std::index_sequence<J...>) {
          ((kWeight(J + 1) != 0 ? add_scaled(x, kWeight(J + 1), k_[J + 1][c]) : void()), ...);
        }
        (std::make_index_sequence<std::size_t(kJ)>{});
        sum[c] = x;
      }
      return sum;
    } else if constexpr (kJ == 0)
      return T(kWeight(0)) * k_[0];
    else if constexpr (kWeight(kJ) == 0)
      return combined<kWeight, kJ - 1>();
    else
      return combined<kWeight, kJ - 1>() + T(kWeight(kJ)) * k_[kJ];
  }

  template <class Visit>
  static void for_weights(const Time& s, Visit&& visit) {
    for (int i = 0; i < Tableau::kDenseStages; ++i) {
      Time b(0);
      for (int d = Tableau::kDenseDegree - 1; d >= 0; --d) b = b * s + Time(Tableau::p[i][d]);
      visit(i, b * s);
    }
  }
};

/// The kind of step that a method takes; components beyond the first kCoupled feed nothing back.
template <class Method, class T, int N, int kCoupled = N>
struct StepOf {
  using type = Step<Method, T, N>;
};

}  // namespace ukemi::integrate
