// One step of an explicit Runge-Kutta method, with its error estimate and its dense output.
//
// What every kind of step offers to the driver (hybrid.hpp): t, h, y, y_end, slope, slope_end; `advance` computes the
// step of length h; `error` its size over the tolerance (0 where the method has no estimate: fixed steps);
// `prepare_dense`, `at`, `component_at` its interior; `move_end` makes up what its end is off by; `choose` says what to
// try next; `forget` drops what was kept of a field that has changed.
//
// An accepted step owns its interior: `at(s)` holds for 0 <= s <= 1, from its start to its end, wherever that was moved
// to, and throws std::logic_error outside: a polynomial beyond its step means nothing.
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

/// How large an error of each controlled component may be: accuracy (unit + |y|), the larger |y| of the step's ends.
template <int kControlled>
struct Tolerance {
  double accuracy;                            ///< relative
  Eigen::Array<double, kControlled, 1> unit;  ///< size below which a component need not be relatively exact
};

/// Size of a vector of errors over its tolerances, the worst of its values and its derivatives: root mean square over
/// the controlled components. Derivatives count kDerivativeEase times more loosely: a field at rest has no error in its
/// values whatever the step, while its derivatives may be beyond the method's stability.
inline constexpr double kDerivativeEase = 1e3;
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
      const double e = of([slot](const T& x) { return derivative_of(x, slot); }) / kDerivativeEase;
      if (!(e <= worst)) worst = e;  // also where it is NaN
    }
  return worst;
}

/// What all steps share: their ends, and where in the computed length a place of the step lies.
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
  /// After a whole accepted step: the length to try next. Methods that change over (automatic.hpp) decide here.
  double choose(double h_next) { return h_next; }
  /// True where the last step was taken by an implicit method that stands in for an explicit one.
  static constexpr bool implicit() { return false; }
  /// The field has jumped: nothing that was evaluated of it holds.
  void forget() {}
  /// Moves the end by `shift` (much smaller than h) along the field, to where an event lies; slope_end is to be set
  /// anew. [s]
  void move_end(double shift) {
    computed_end_ = y_end, computed_slope_ = slope_end;
    moved_ = true;
    for (int c = 0; c < N; ++c) add_scaled(y_end[c], shift, slope_end[c]);
    h += shift;
  }
  /// Where a time of the step lies in it, 0..1; rounding of the time is forgiven. Throws std::logic_error outside.
  double place_of(double time) const {
    constexpr double kRounding = 1e-9;  // in parts of the step
    const double s = h > 0 ? (time - t) / h : 0;
    if (!(s >= -kRounding && s <= 1 + kRounding)) outside();
    return std::clamp(s, 0.0, 1.0);
  }

 protected:
  /// Begins a computation of length h.
  void compute() { whole_ = h, moved_ = false; }
  const State& computed_end() const { return moved_ ? computed_end_ : y_end; }
  Time whole() const { return whole_; }

  /// A place of the step: where in the computed length, 0..1, and how long after its end [s].
  struct Place {
    Time share, beyond;
  };
  Place place(const Time& s) const {
    if constexpr (kIsPack<T>) {
      return {s, Time(0)};  // lanes are never moved
    } else {
      if (!(s >= 0 && s <= 1)) outside();
      if (!moved_) return {s, 0};
      const double from_start = s * h;
      return from_start <= whole_ ? Place{from_start / whole_, 0} : Place{1, from_start - whole_};
    }
  }
  /// Beyond the computed end the step goes on along the field.
  State extended(State x, const Time& beyond) const {
    if constexpr (!kIsPack<T>)
      if (beyond > 0)
        for (int c = 0; c < N; ++c) add_scaled(x[c], beyond, computed_slope_[c]);
    return x;
  }
  [[noreturn, gnu::cold]] static void outside() {
    throw std::logic_error("bug: dense output was asked for outside of its step");
  }

 private:
  Time whole_{0};                        ///< the length that was computed
  bool moved_ = false;                   ///< the end is not where it was computed
  State computed_end_, computed_slope_;  ///< where it was, and f there, if so
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

  /// |h lambda| of the first components between the last two stages, which stand at the same time (Hairer, Wanner,
  /// IV.2).
  double stiffness(int components) const {
    double change = 0, distance = 0;
    for (int i = 0; i < components; ++i) {
      const double dk = value_of(k_[kLast][i]) - value_of(k_[kLast - 1][i]), dy = value_of(y_end[i]) - before_last(i);
      change += dk * dk, distance += dy * dy;
    }
    return distance > 0 ? h * std::sqrt(change / distance) : 0;
  }

  /// Evaluates the further stages that dense output needs, once a step.
  template <class F>
  void prepare_dense(F&& f) {
    if (dense_ready_) return;
    const Time moved = h;
    h = this->whole();
    stages<Tableau::kStages, Tableau::kDenseStages>(f);
    h = moved;
    dense_ready_ = true;
  }

  /// y(t + s h), 0 <= s <= 1; `prepare_dense` first.
  State at(const Time& s) const {
    const auto place = this->place(s);
    State sum;
    for (int c = 0; c < N; ++c) sum[c] = T(0);
    for_weights(place.share, [&](int i, const Time& b) {
      for (int c = 0; c < N; ++c) add_scaled(sum[c], b, k_[i][c]);
    });
    State out = y;
    for (int c = 0; c < N; ++c) add_scaled(out[c], this->whole(), sum[c]);
    return this->extended(out, place.beyond);
  }
  /// One component of `at`.
  T component_at(int index, const Time& s) const {
    const auto place = this->place(s);
    if constexpr (!kIsPack<T>)
      if (place.beyond > 0) return at(s)[index];
    T sum(0);
    for_weights(place.share, [&](int i, const Time& b) { add_scaled(sum, b, k_[i][index]); });
    T out = y[index];
    add_scaled(out, this->whole(), sum);
    return out;
  }

 private:
  std::array<State, Tableau::kDenseStages> k_;
  State stage_;
  bool dense_ready_ = false;

  /// The state that the last stage but one was evaluated at, one component of it.
  double before_last(int i) const {
    double x = 0;
    for (int j = 0; j < kLast - 1; ++j) x += Tableau::a[kLast - 1][j] * value_of(k_[j][i]);
    return value_of(y[i]) + h * x;
  }

  /// Evaluates k_[kFirst] .. k_[kEnd - 1].
  template <int kFirst, int kEnd, class F>
  void stages(F& f) {
    if constexpr (kFirst < kEnd) {
      constexpr auto kRow = [](int j) { return Tableau::a[kFirst][j]; };
      State& at_stage = kFirst == kLast ? y_end : stage_;
      if constexpr (kDerivatives < T >> 0) {
        const State sum = combined<kRow, kFirst - 1>();
        at_stage = y;
        for (int c = 0; c < N; ++c) add_scaled(at_stage[c], h, sum[c]);
      } else {
        at_stage = y + T(h) * combined<kRow, kFirst - 1>();
      }
      f(t + Time(Tableau::c[kFirst]) * h, at_stage, k_[kFirst]);
      stages<kFirst + 1, kEnd>(f);
    }
  }

  /// sum_j w(j) k_j, j <= kJ, as one expression: a single pass, with the zeros of the tableau left out. With
  /// derivatives, weights that carry none.
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

  template <class Use>
  static void for_weights(const Time& s, Use&& use) {
    for (int i = 0; i < Tableau::kDenseStages; ++i) {
      Time b(0);
      for (int d = Tableau::kDenseDegree - 1; d >= 0; --d) b = b * s + Time(Tableau::p[i][d]);
      use(i, b * s);
    }
  }
};

/// The kind of step that a method takes; components beyond the first kCoupled feed nothing back.
template <class Method, class T, int N, int kCoupled = N>
struct StepOf {
  using type = Step<Method, T, N>;
};

}  // namespace ukemi::integrate
