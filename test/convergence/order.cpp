// What common/integrate promises: each pair's order on smooth problems, inside a step, and THROUGH events; and that the
// event driver misses no dip, handles coincident events, and ends on whatever cannot be integrated.
#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <functional>
#include <numbers>

#include "common/integrate/automatic.hpp"
#include "common/integrate/hybrid.hpp"
#include "common/integrate/method.hpp"
#include "common/integrate/semi_implicit_euler.hpp"
#include "common/jet.hpp"
#include "common/random.hpp"

using namespace ukemi;
using namespace ukemi::integrate;

namespace {

constexpr std::uint64_t kSeed = 20240602;
constexpr double kInfinite = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();
template <int N>
using Vec = Eigen::Matrix<double, N, 1>;

/// A function of time and state as a step sees it; its Jacobian by central differences, for the linearly implicit
/// methods where no exact one is at hand (they keep their order with it on these smooth fields; see KeplerField).
template <int N, class F>
struct AsField {
  static constexpr int kPositions = N / 2;
  F f;
  void operator()(double t, const Vec<N>& y, Vec<N>& dy) const { dy = f(t, y); }
  template <class Matrix>
  void linearize(double t, const Vec<N>& y, Matrix& jacobian, Vec<N>& rate) const {
    constexpr double kH = 1e-6;
    for (int i = 0; i < N; ++i) {
      const Vec<N> e = kH * Vec<N>::Unit(i);
      jacobian.col(i) = (f(t, y + e) - f(t, y - e)) / (2 * kH);
    }
    rate = (f(t + kH, y) - f(t - kH, y)) / (2 * kH);
  }
};
template <int N, class F>
AsField<N, F> as_field(F f) {
  return {f};
}

/// n equal steps from (t, y) to t_end.
template <class Method, int N, class Field>
Vec<N> fixed_steps(double t, const Vec<N>& y, double t_end, int n, const Field& f) {
  typename StepOf<Method, double, N>::type step;
  step.t = t, step.h = 0, step.y_end = y;
  f(t, y, step.slope_end);
  for (int i = 0; i < n; ++i) {
    step.next();
    step.t = t + i * (t_end - t) / n, step.h = (t_end - t) / n;
    step.advance(f);
  }
  return step.y_end;
}

/// Slope of log(error) over log(h), by least squares.
double slope(const std::vector<double>& h, const std::vector<double>& error) {
  const auto n = Eigen::Index(h.size());
  Eigen::VectorXd x(n), y(n);
  for (Eigen::Index i = 0; i < n; ++i) x[i] = std::log(h[std::size_t(i)]), y[i] = std::log(error[std::size_t(i)]);
  x.array() -= x.mean(), y.array() -= y.mean();
  return x.dot(y) / x.squaredNorm();
}

/// Kepler's problem, nonlinear and smooth: an orbit of eccentricity 0.2, period 2 pi, in the exact position at time t.
constexpr double kEccentricity = 0.2;
template <class T>
Eigen::Matrix<T, 4, 1> kepler_field(const Eigen::Matrix<T, 4, 1>& y) {
  using std::sqrt;
  const T r2 = y[0] * y[0] + y[1] * y[1], r3 = r2 * sqrt(r2);
  return {y[2], y[3], -y[0] / r3, -y[1] / r3};
}
Vec<4> kepler(double, const Vec<4>& y) { return kepler_field(y); }
template <class Matrix>
void kepler_jacobian(const Vec<4>& y, Matrix& jacobian) {
  using Dual = ceres::Jet<double, 4>;
  Eigen::Matrix<Dual, 4, 1> x;
  for (int i = 0; i < 4; ++i) x[i] = Dual(y[i], i);
  const Eigen::Matrix<Dual, 4, 1> dx = kepler_field(x);
  for (int i = 0; i < 4; ++i) jacobian.row(i) = dx[i].v.transpose();
}
struct KeplerField {
  static constexpr int kPositions = 2;
  void operator()(double, const Vec<4>& y, Vec<4>& dy) const { dy = kepler_field(y); }
  template <class Matrix>
  void linearize(double, const Vec<4>& y, Matrix& jacobian, Vec<4>& rate) const {
    kepler_jacobian(y, jacobian);
    rate.setZero();
  }
};
Vec<4> orbit(double t) {
  double anomaly = t;  // E - e sin E = t
  for (int i = 0; i < 50; ++i)
    anomaly -= (anomaly - kEccentricity * std::sin(anomaly) - t) / (1 - kEccentricity * std::cos(anomaly));
  const double s = std::sin(anomaly), c = std::cos(anomaly), b = std::sqrt(1 - kEccentricity * kEccentricity),
               rate = 1 / (1 - kEccentricity * c);
  return {c - kEccentricity, b * s, -s * rate, b * c * rate};
}

/// A weight on one spring above y = 0 and on another below, whose force jumps there as a floor's does; a third state,
/// z' = z y', makes it nonlinear. Above: y'' = -w0^2 (y - c0), below: y'' = -w1^2 (y - c1).
class TwoSprings {
 public:
  static constexpr int kControlled = 3, kPositions = 1, kGuards = 1;
  using State = Vec<3>;
  bool above = true;

  void derivative(double, const State& y, State& dy) const {
    const int i = above ? 0 : 1;
    dy = State(y[1], -kRate[i] * kRate[i] * (y[0] - kCentre[i]), y[2] * y[1]);
  }
  template <class Matrix>
  void linearize(double, const State& y, Matrix& jacobian, State& rate) const {
    const int i = above ? 0 : 1;
    jacobian << 0, 1, 0, -kRate[i] * kRate[i], 0, 0, 0, y[2], y[1];
    rate.setZero();
  }
  void guards(double, const State& y, const State& dy, Guards<1>& out) const {
    const double side = above ? 1 : -1;
    out.set(0, side * y[0], side * dy[0]);
  }
  double tolerance_unit(int) const { return 1; }

  static State start() { return {0, 1, 1}; }
  /// Exactly: each half is an arc of a sine about its centre, symmetric in time, and passes y = 0 with speed 1 each
  /// way.
  static double half(int i) {
    const double to_turn = std::atan2(1 / kRate[i], std::abs(kCentre[i]));
    return 2 * to_turn / kRate[i];
  }
  static State exact(double t) {
    const double period = half(0) + half(1);
    t -= period * std::floor(t / period);
    const int i = t < half(0) ? 0 : 1;
    const double u = kRate[i] * (i == 0 ? t : t - half(0)), v = i == 0 ? 1 : -1, c = kCentre[i];
    const double y = c - c * std::cos(u) + v / kRate[i] * std::sin(u);
    return {y, c * kRate[i] * std::sin(u) + v * std::cos(u), std::exp(y)};
  }
  /// Time of the n-th crossing, from 1.
  static double crossing(int n) { return (n + 1) / 2 * half(0) + n / 2 * half(1); }

 private:
  static constexpr double kRate[2] = {1.0, 2.5}, kCentre[2] = {-0.8, 0.3};
};

/// The orbit with a clock that changes its rate as the body passes three directions: the field jumps there, the path
/// stays.
struct Stages {
  static constexpr int kControlled = 4, kPositions = 2, kGuards = 3;
  static constexpr std::array<double, kGuards + 1> kRate{1, 1.3, 0.7, 1.2};
  using State = Vec<4>;
  double start;  ///< place on the orbit at t = 0; the stages end 0.9, 1.9, 2.9 further on, the run at 4
  int stage = 0;

  void derivative(double, const State& y, State& dy) const { dy = kRate[std::size_t(stage)] * kepler(0, y); }
  template <class Matrix>
  void linearize(double, const State& y, Matrix& jacobian, State& rate) const {
    kepler_jacobian(y, jacobian);
    jacobian *= kRate[std::size_t(stage)];
    rate.setZero();
  }
  void guards(double, const State& y, const State& dy, Guards<kGuards>& out) const {
    out = {};
    for (int i = stage; i < kGuards; ++i) out.set(i, before(i, y), before(i, dy));
  }
  double tolerance_unit(int) const { return 1; }

  double place(int i) const { return i < kGuards ? start + 0.9 + i : start + 4; }
  /// r sin(angle still to go to direction i), linear in the position.
  double before(int i, const State& y) const {
    const Vec<4> there = orbit(place(i));
    return (y[0] * there[1] - y[1] * there[0]) / there.head<2>().norm();
  }
  /// Time at place(i).
  double passes(int i) const {
    return (i == 0 ? 0.9 : passes(i - 1) * kRate[std::size_t(i)] + place(i) - place(i - 1)) / kRate[std::size_t(i)];
  }
  double until() const { return passes(kGuards); }
};

/// Any field, with the guards side_i (y_i + offset_i); the tool of the tests on single events.
template <int N>
struct Forced {
  static constexpr int kControlled = N, kPositions = N / 2, kGuards = N;
  using State = Vec<N>;
  std::function<State(double, const State&)> field;
  State side = State::Ones(), offset = State::Zero();

  void derivative(double t, const State& y, State& dy) const { dy = field(t, y); }
  template <class Matrix>
  void linearize(double t, const State& y, Matrix& jacobian, State& rate) const {
    as_field<N>(field).linearize(t, y, jacobian, rate);
  }
  void guards(double, const State& y, const State& dy, Guards<N>& out) const {
    for (int i = 0; i < N; ++i) out.set(i, side[i] * (y[i] + offset[i]), side[i] * dy[i]);
  }
  double tolerance_unit(int) const { return 1; }
};

/// y'' = -y with the guard y + 1 - depth: negative only about the trough, for a time 2 sqrt(2 depth).
struct Oscillator {
  static constexpr int kControlled = 2, kPositions = 1, kGuards = 1;
  using State = Vec<2>;
  double depth, side = 1;
  void derivative(double, const State& y, State& dy) const { dy = State(y[1], -y[0]); }
  template <class Matrix>
  void linearize(double, const State&, Matrix& jacobian, State& rate) const {
    jacobian << 0, 1, -1, 0;
    rate.setZero();
  }
  void guards(double, const State& y, const State& dy, Guards<1>& out) const {
    out.set(0, side * (y[0] + 1 - depth), side * dy[0]);
  }
  double tolerance_unit(int) const { return 1; }
};

}  // namespace

#define TABLEAUS RungeKutta4, DormandPrince54, DormandPrince853
#define ADAPTIVE DormandPrince54, DormandPrince853, Rodas5P
#define EVERY_METHOD SemiImplicitEuler, RungeKutta4, DormandPrince54, DormandPrince853, Rodas5P

namespace {

/// Where to look for a method's order: a step at which the leading term of its error rules and is far above rounding.
template <class Method>
constexpr double kStep = std::is_same_v<Method, Rodas5P> ? 0.025
                         : Method::kOrder == 1           ? 0.002
                         : Method::kOrder == 8           ? 0.16
                         : Method::kOrder == 4           ? 0.03
                                                         : 0.04;
template <class Method>
constexpr double kStart = Method::kOrder == 8 ? 2 : 0;

}  // namespace

TEMPLATE_TEST_CASE("order: the coefficients are consistent", "", TABLEAUS) {
  for (int i = 0; i < TestType::kDenseStages; ++i) {
    double row = 0;
    for (int j = 0; j < i; ++j) row += TestType::a[i][j];
    INFO("stage " << i);
    CHECK(row == Approx(TestType::c[i]).margin(1e-13));
    // Dense output ends on the step's own end, and leaves with the slope of its start.
    double at_end = 0;
    for (int d = 0; d < TestType::kDenseDegree; ++d) at_end += TestType::p[std::size_t(i)][std::size_t(d)];
    CHECK(at_end == Approx(i < TestType::kStages ? TestType::a[TestType::kStages - 1][i] : 0).margin(2e-13));
    CHECK(TestType::p[std::size_t(i)][0] == Approx(i == 0 ? 1 : 0).margin(2e-13));
  }
  for (int q = 0; q < TestType::kEstimates; ++q) {  // no error estimate for a constant field
    double sum = 0;
    for (int i = 0; i < TestType::kStages; ++i) sum += TestType::e[std::size_t(q)][std::size_t(i)];
    CHECK(sum == Approx(0).margin(1e-13));
  }
}

namespace {

/// y' = t^degree, with its exact time derivative.
struct Polynomial {
  static constexpr int kPositions = 0;
  int degree;
  void operator()(double t, const Vec<1>&, Vec<1>& dy) const { dy[0] = std::pow(t, degree); }
  template <class Matrix>
  void linearize(double t, const Vec<1>&, Matrix& jacobian, Vec<1>& rate) const {
    jacobian.setZero();
    rate[0] = degree == 0 ? 0 : degree * std::pow(t, degree - 1);
  }
};
Polynomial as_polynomial(int degree) { return {degree}; }

}  // namespace

TEMPLATE_TEST_CASE("order: a step is exact on polynomials below the order, dense output below its own", "", RungeKutta4,
                   DormandPrince54, DormandPrince853, Rodas5P) {
  constexpr double kBegin = 0.3, kLength = 0.9;
  for (int degree = 0; degree <= TestType::kOrder; ++degree) {
    INFO("y' = t^" << degree);
    const auto f = as_polynomial(degree);
    const auto y = [&](double t) { return std::pow(t, degree + 1) / (degree + 1); };
    typename StepOf<TestType, double, 1>::type step;
    step.t = kBegin, step.h = kLength, step.y[0] = y(kBegin);
    f(step.t, step.y, step.slope);
    step.advance(f);
    step.prepare_dense(f);
    const double error = std::abs(step.y_end[0] - y(kBegin + kLength));
    if (degree < TestType::kOrder)
      CHECK(error <= 5e-14);
    else
      CHECK(error > 1e-8);  // and no further: the order is not higher than stated
    double inside = 0;
    for (double s = 0; s <= 1; s += 0.0625) {
      inside = std::max(inside, std::abs(step.at(s)[0] - y(kBegin + s * kLength)));
      CHECK(step.component_at(0, s) == step.at(s)[0]);
    }
    if (degree < TestType::kDenseOrder)
      CHECK(inside <= 5e-13);  // powers of s with weights up to 1e3 cancel
    else
      CHECK(inside > 1e-8);
  }
}

TEMPLATE_TEST_CASE("order: fixed steps converge with the order on a smooth nonlinear problem", "", EVERY_METHOD) {
  const double start = kStart<TestType>, end = start + 4;
  std::vector<double> h, error;
  for (int i = 0; i < 5; ++i) {
    const int n = int(4 / kStep<TestType> * (TestType::kOrder == 8 ? 0.64 : 1.9) * std::pow(1.25, i));
    h.push_back((end - start) / n);
    error.push_back((fixed_steps<TestType>(start, orbit(start), end, n, KeplerField{}) - orbit(end)).norm());
  }
  INFO("observed " << slope(h, error));
  CHECK(slope(h, error) == Approx(TestType::kOrder).margin(0.1));
  CHECK(error.back() > 5e-13);  // above rounding
}

TEMPLATE_TEST_CASE("order: dense output converges with its local order inside a step", "", RungeKutta4, DormandPrince54,
                   DormandPrince853, Rodas5P) {
  const auto f = as_field<1>([](double t, const Vec<1>& y) { return Vec<1>(y[0] * std::cos(t)); });
  const auto exact = [](double t) { return std::exp(std::sin(t)); };
  constexpr double kBegin = 0.3;
  std::vector<double> h, error;
  for (int i = 0; i < 5; ++i) {
    const double length = (TestType::kOrder == 8 ? 0.26 : 0.05) * std::pow(0.8, i);
    typename StepOf<TestType, double, 1>::type step;
    step.t = kBegin, step.h = length, step.y[0] = exact(kBegin);
    f(kBegin, step.y, step.slope);
    step.advance(f);
    step.prepare_dense(f);
    double worst = 0;
    for (double s : {0.1, 0.25, 0.4, 0.6, 0.75, 0.9})
      worst = std::max(worst, std::abs(step.at(s)[0] - exact(kBegin + s * length)));
    h.push_back(length), error.push_back(worst);
    CHECK(step.at(0)[0] == step.y[0]);
    CHECK(std::abs(step.at(1)[0] - step.y_end[0]) <= 5e-13 * length);
  }
  INFO("observed " << slope(h, error));
  CHECK(slope(h, error) == Approx(TestType::kDenseOrder + 1).margin(0.1));
}

TEMPLATE_TEST_CASE("order: it is kept through events", "", RungeKutta4, DormandPrince54, DormandPrince853, Rodas5P) {
  // Steps of equal length but for the ones that end on an event or begin after it. Their shares of h are irregular and
  // with them each single error, by up to the events' share of all steps; a fit over many h averages that out.
  std::vector<double> h, error;
  for (int i = 0; i < 60; ++i) {
    const double length = kStep<TestType> * std::pow(TestType::kOrder == 8 ? 2.4 : 4, -i / 59.0);
    Stages system{kStart<TestType>};
    const double until = system.until();
    Integrator<TestType, Stages> run(system, 0, orbit(system.start),
                                     {.accuracy = 1e6, .first_step = length, .max_step = length});
    double late = 0;
    for (;;) {
      const Outcome o = run.step(until);
      REQUIRE(o.status <= Status::kEvent);
      CHECK(run.step().h <= length * 1.002);  // the last one may be a thousandth longer
      if (o.event >= 0) {
        REQUIRE(!o.immediate);
        REQUIRE(o.event == system.stage);
        late = std::max(late, std::abs(run.time() - system.passes(system.stage++)));
        run.refresh();
      }
      if (o.status == Status::kReached) break;
    }
    CHECK(system.stage == Stages::kGuards);
    CHECK(run.counters().events == Stages::kGuards);
    CHECK(run.counters().rejected == 0);
    h.push_back(length), error.push_back((run.state() - orbit(system.start + 4)).norm());
    CHECK(late < 3 * error.back());
  }
  INFO("observed " << slope(h, error));
  CHECK(slope(h, error) == Approx(TestType::kOrder).margin(0.1));
  CHECK(error.back() > 1e-13);  // above rounding
}

TEST_CASE("order: semi-implicit Euler keeps its order through events") {
  // It needs q' = v, so here the field jumps in the acceleration, as it does on a floor.
  std::vector<double> h, error;
  for (int i = 0; i < 30; ++i) {
    const double length = 2e-3 * std::pow(4, -i / 29.0), until = 7.3;
    TwoSprings system;
    Integrator<SemiImplicitEuler, TwoSprings> run(system, 0, TwoSprings::start(),
                                                  {.first_step = length, .max_step = length});
    int events = 0;
    for (Outcome o{Status::kStepped}; o.status != Status::kReached;) {
      o = run.step(until);
      REQUIRE(o.status <= Status::kEvent);
      if (o.event < 0) continue;
      ++events;
      system.above = !system.above;
      run.refresh();
    }
    CHECK(events >= 3);
    h.push_back(length), error.push_back((run.state() - TwoSprings::exact(until)).norm());
  }
  INFO("observed " << slope(h, error));
  CHECK(slope(h, error) == Approx(1).margin(0.1));
}

TEMPLATE_TEST_CASE("dense output: a step owns its interior, to an end that an event has moved, and no farther", "",
                   DormandPrince54, DormandPrince853, Rodas5P, (Automatic<DormandPrince54, Rodas5P>)) {
  for (const double accuracy : {1e-2, 1e-4, 1e-6, 1e-9}) {
    TwoSprings system;
    Integrator<TestType, TwoSprings> run(system, 0, TwoSprings::start(), {.accuracy = accuracy, .first_step = 0.5});
    double at_ends = 0, inside = 0, gap = 0;
    int events = 0;
    for (;;) {
      const Outcome o = run.step(30);
      REQUIRE(o.status <= Status::kEvent);
      const auto& step = run.dense();
      const auto error = [&](double s) { return (step.at(s) - TwoSprings::exact(step.t + s * step.h)).norm(); };
      at_ends = std::max({at_ends, (step.y - TwoSprings::exact(step.t)).norm(), error(1)});
      for (int i = 1; i < 20; ++i) inside = std::max(inside, error(i / 20.0));
      gap = std::max(gap, (step.at(1) - step.y_end).norm());
      CHECK(step.component_at(0, 1) == step.at(1)[0]);
      CHECK(step.place_of(step.t + step.h) == Approx(1));
      for (const double s : {-1e-6, 1 + 1e-6, kNan}) CHECK_THROWS_AS(step.at(s), std::logic_error);
      if (step.h > 0) CHECK_THROWS_AS(step.place_of(step.t + 1.001 * step.h), std::logic_error);
      if (o.event >= 0) {
        system.above = !system.above, ++events;
        run.refresh();
      }
      if (o.status == Status::kReached) break;
    }
    INFO("accuracy " << accuracy << ": at the ends " << at_ends << ", inside " << inside << ", gap " << gap);
    CHECK(events > 10);
    CHECK(gap <= 1e-8);                            // the field's curvature over a ten thousandth of a step
    CHECK(inside <= 3 * at_ends + 10 * accuracy);  // no step errs inside by more than it may at its end
  }
}

TEST_CASE("dense output: a Jacobian does not outlive the field it was taken of") {
  // The trough of an oscillator, on the guard's zero at no speed: an event of length zero. Beyond it time and state are
  // the same, the field is another.
  Oscillator system{0.5, -1};
  Integrator<Rodas5P, Oscillator> run(system, 0, {-0.5, 0}, {.accuracy = 1e-6, .first_step = 0.1});
  const Outcome o = run.step(1);
  REQUIRE(o.event == 0);
  REQUIRE(run.step().h == 0);
  REQUIRE(run.time() == 0);
  REQUIRE(run.counters().jacobians == 1);
  system.side = 1;
  run.refresh();
  REQUIRE(run.step(1).status <= Status::kEvent);
  CHECK(run.time() > 0);
  CHECK(run.counters().jacobians == 2);
}

TEMPLATE_TEST_CASE("order: it is lost where the same jumps are not located", "", ADAPTIVE) {
  // What the events are for: the same field with its jumps inside steps is of about first order with either pair.
  std::vector<double> h, error;
  for (int i = 0; i < 60; ++i) {
    const int n = int(20 * std::pow(10, i / 59.0));
    const Stages exact{0.0};
    const auto field = as_field<4>([](double, const Vec<4>& y) {
      Stages system{0.0};
      while (system.stage < Stages::kGuards && system.before(system.stage, y) < 0) ++system.stage;
      Vec<4> dy;
      system.derivative(0, y, dy);
      return dy;
    });
    h.push_back(exact.until() / n);
    error.push_back((fixed_steps<TestType>(0, orbit(0), exact.until(), n, field) - orbit(4)).norm());
  }
  INFO("observed " << slope(h, error));
  CHECK(slope(h, error) < 2);
  CHECK(error.back() > 1e-5);
}

TEMPLATE_TEST_CASE("order: with adaptive steps the error of event times follows the tolerance", "", ADAPTIVE) {
  std::vector<double> accuracy, error;
  for (double tolerance = 1e-5; tolerance > 1e-12; tolerance /= std::sqrt(10.0)) {
    TwoSprings system;
    Integrator<TestType, TwoSprings> run(system, 0, TwoSprings::start(), {.accuracy = tolerance});
    double late = 0;
    for (int events = 0; events < 7;) {
      const Outcome o = run.step(kInfinite);
      REQUIRE(o.status <= Status::kEvent);
      if (o.event < 0) continue;
      late = std::max(late, std::abs(run.time() - TwoSprings::crossing(++events)));
      system.above = !system.above;
      run.refresh();
    }
    INFO("tolerance " << tolerance << ", largest error " << late);
    CHECK(late < 30 * tolerance);
    accuracy.push_back(tolerance), error.push_back(late);
  }
  INFO("observed " << slope(accuracy, error));
  CHECK(slope(accuracy, error) == Approx(1).margin(0.15));
}

TEMPLATE_TEST_CASE("events: a dip inside one step is found, a near miss is none", "", ADAPTIVE) {
  // y'' = -y from a random phase; the guard y + 1 - depth is negative only about the trough, for a time 2 sqrt(2
  // depth).
  INFO("seed " << kSeed);
  int inside = 0;
  for (double depth : {1e-2, 1e-4, 1e-6, 1e-8, -1e-8, -1e-6, -1e-4}) {
    for (std::uint64_t i = 0; i < 200; ++i) {
      Random r(kSeed, i);
      const double phase = r.uniform(0.2, 2.9);  // the trough is at t = pi - phase
      CAPTURE(depth, phase);
      Oscillator system{depth};
      Integrator<TestType, Oscillator> run(system, 0, {std::cos(phase), -std::sin(phase)},
                                           {.accuracy = 1e-11, .first_step = r.uniform(0.01, 0.5)});
      std::vector<double> found;
      double last = 0;
      for (;;) {
        const Outcome o = run.step(4);
        REQUIRE(o.status <= Status::kEvent);
        if (o.event >= 0) {
          found.push_back(run.time());
          system.side *= -1;
          run.refresh();
        }
        if (o.status == Status::kReached) break;
        if (o.status == Status::kStepped && last < std::numbers::pi - phase && run.time() > std::numbers::pi - phase)
          ++inside;
        last = run.time();
      }
      if (depth < 0) {
        CHECK(found.empty());
      } else {
        const double half = std::acos(1 - depth);  // the field's error of 1e-11 moves these by 1e-11 / slope
        REQUIRE(found.size() == 2);
        CHECK(found[0] == Approx(std::numbers::pi - phase - half).margin(1e-9 / half * 0.1));
        CHECK(found[1] == Approx(std::numbers::pi - phase + half).margin(1e-9 / half * 0.1));
      }
    }
  }
  CHECK(inside > 100);  // the near misses did come inside steps
}

TEMPLATE_TEST_CASE("events: a dip and its end both inside one long step", "", ADAPTIVE) {
  // y = (t - 0.6)^2 - depth, a quadratic: one step of length 1 would be exact and end well above zero.
  for (double depth : {1e-2, 1e-5, 1e-8, 1e-11}) {
    CAPTURE(depth);
    Forced<1> system{[](double t, const Vec<1>&) { return Vec<1>(2 * (t - 0.6)); }};
    Integrator<TestType, Forced<1>> run(system, 0, Vec<1>(0.36 - depth), {.first_step = 1});
    std::vector<double> found;
    for (Outcome o{Status::kStepped}; o.status != Status::kReached;) {
      o = run.step(1);
      REQUIRE(o.status <= Status::kEvent);
      if (o.event < 0) continue;
      found.push_back(run.time());
      system.side *= -1;
      run.refresh();
    }
    REQUIRE(found.size() == 2);
    const double half = std::sqrt(depth);
    CHECK(found[0] == Approx(0.6 - half).margin(1e-15 / half));
    CHECK(found[1] == Approx(0.6 + half).margin(1e-15 / half));
  }
}

TEMPLATE_TEST_CASE("events: guards that vanish together all change, at one time", "", ADAPTIVE) {
  // Three weights, two alike and one of twice the size: all fall through zero at t = 1 and rise through it at t = 3.
  Forced<3> system{[](double t, const Vec<3>&) -> Vec<3> { return Vec<3>(1, 1, 2) * (t - 2); }};
  Integrator<TestType, Forced<3>> run(system, 0, Vec<3>(1.5, 1.5, 3), {.first_step = 0.7});
  int events = 0;
  const auto follow = [&](double t_stop, double event_time) {
    for (Outcome o{Status::kStepped}; o.status != Status::kReached;) {
      o = run.step(t_stop);
      REQUIRE(o.status <= Status::kEvent);
      if (o.event < 0) continue;
      ++events;
      CHECK(run.time() == Approx(event_time).margin(1e-13));
      system.side[o.event] *= -1;
      run.refresh();
    }
  };
  follow(2, 1);
  CHECK(system.side == Vec<3>(-1, -1, -1));
  follow(4, 3);
  CHECK(system.side == Vec<3>(1, 1, 1));
  CHECK(events % 2 == 0);
  CHECK(events <= 18);  // six; and each guard may change there and back once more within rounding of the instant
}

TEMPLATE_TEST_CASE("events: infinitely many in finite time end the run", "", ADAPTIVE) {
  // A ball of restitution e dropped from 1 m at g = 2: it lands at t = 1 and is at rest at (1 + e) / (1 - e).
  const double restitution = GENERATE(0.0, 0.5, 0.9);
  CAPTURE(restitution);
  Forced<2> ball{[](double, const Vec<2>& y) -> Vec<2> { return {y[1], -2}; }};
  ball.offset = {0, 1e3};  // the speed is no guard
  Integrator<TestType, Forced<2>> run(ball, 0, Vec<2>(1, 0), {.first_step = 0.1, .max_step = 0.1});
  Outcome o{Status::kStepped};
  int calls = 0;
  for (; calls < 20000 && o.status <= Status::kEvent && o.status != Status::kReached; ++calls) {
    o = run.step(100);
    if (o.event < 0) continue;
    REQUIRE(o.event == 0);
    Vec<2> y = run.state();
    y[1] *= -restitution;
    run.refresh(y);
  }
  CAPTURE(calls, run.time(), int(o.status), run.state().transpose());
  CHECK(o.status == Status::kStuck);
  // Hops shorter than 1e-6 of a part of a step are taken as none, so it may end that much early.
  CHECK(run.time() == Approx((1 + restitution) / (1 - restitution)).margin(0.1 * 1e-6 / (1 - restitution)));
  CHECK(std::abs(run.state()[0]) < 1e-9);
}

// The explicit ones only: here the Jacobian of a linearly implicit step is a difference that looks beyond the state.
TEMPLATE_TEST_CASE("control: a field that is not finite ends the run with a reason", "", DormandPrince54,
                   DormandPrince853) {
  SECTION("where it starts") {
    Forced<1> system{[](double, const Vec<1>&) { return Vec<1>(kNan); }};
    Integrator<TestType, Forced<1>> run(system, 0, Vec<1>(1), {});
    CHECK(run.step(1).status == Status::kNotFinite);
    CHECK(run.time() == 0);
    CHECK(run.state()[0] == 1);
  }
  SECTION("further on: the last good state is kept") {
    Forced<1> system{[](double t, const Vec<1>&) { return Vec<1>(t < 0.5 ? 1 : kNan); }};
    Integrator<TestType, Forced<1>> run(system, 0, Vec<1>(1), {.first_step = 0.01});
    Outcome o{Status::kStepped};
    for (int n = 0; n < 10000 && o.status == Status::kStepped; ++n) o = run.step(1);
    CHECK(o.status == Status::kTooSmall);
    CHECK(run.time() == Approx(0.5).epsilon(1e-12));
    CHECK(run.time() < 0.5);
    CHECK(run.state()[0] == Approx(1 + run.time()).epsilon(1e-14));
  }
  SECTION("a solution that reaches infinity") {
    Forced<1> system{[](double, const Vec<1>& y) -> Vec<1> { return y.array().square(); }};  // y = 1 / (1 - t)
    Integrator<TestType, Forced<1>> run(system, 0, Vec<1>(1), {.accuracy = 1e-10});
    Outcome o{Status::kStepped};
    for (int n = 0; n < 100000 && o.status == Status::kStepped; ++n) o = run.step(2);
    CHECK((o.status == Status::kTooSmall || o.status == Status::kNotFinite));
    CHECK(run.time() == Approx(1).epsilon(1e-8));
    CHECK(run.state().allFinite());
  }
}

TEMPLATE_TEST_CASE("control: it holds the error near the tolerance and spends steps accordingly", "", ADAPTIVE) {
  long before = 0;
  for (double tolerance : {1e-4, 1e-6, 1e-8, 1e-10}) {
    Forced<4> system{[](double t, const Vec<4>& y) { return kepler(t, y); }};
    system.offset.setConstant(100);  // no guard
    Integrator<TestType, Forced<4>> run(system, 0, orbit(0), {.accuracy = tolerance});
    Outcome o{Status::kStepped};
    while (o.status == Status::kStepped) o = run.step(5);
    REQUIRE(o.status == Status::kReached);
    CHECK(run.time() == 5);
    const double error = (run.state() - orbit(5)).norm();
    CAPTURE(tolerance, error, run.counters().steps);
    CHECK(error < 300 * tolerance);  // local errors, grown along the orbit
    CHECK(run.counters().steps > before);
    before = run.counters().steps;
  }
}
