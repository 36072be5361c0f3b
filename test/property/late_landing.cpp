// Landings of a drive that is late against a fixed-step integration that keeps the history of what the drive asked for:
// the classical Runge-Kutta method at 2e-6 s, contacts and limits as they are at each stage. The mechanics are those of
// test/property/two_link.hpp (two_link.cpp holds them against a build of its own); drive, delay and steps are not.
#include <catch2/catch.hpp>
#include <cmath>

#include "landing/derivatives/gradient.hpp"
#include "landing/lanes/batch.hpp"
#include "landing/run/simulate.hpp"
#include "test/paper.hpp"
#include "test/property/two_link.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace test;

namespace {

Scene short_paper() {
  Scene scene = test::paper();
  scene.t_end = 0.9;
  return scene;
}
SeaParameters<double> late(double delay, double filter, Feedback feedback) {
  SeaParameters<double> sea = test::table2_sea();
  sea.control_delay = delay, sea.velocity_filter = filter, sea.feedback = feedback;
  return sea;
}
const Motion kHeld{-0.785398, -0.785398, 1}, kMoving{-0.3, -1.2, 0.25}, kGains{-0.3, -1.2, 0.25, {}, 0.6, 1.5};

/// Largest |ddr_0| from the first touchdown on.
class Fixed {
  enum { kFiltered = kMechanical, kAll };
  static constexpr double kStep = 2e-6;  // [s]
  using State = Eigen::Matrix<double, kAll, 1>;

 public:
  Fixed(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion)
      : scene_(scene), sea_(sea), motion_(motion), link_(scene.robot) {}

  double peak() {
    State y = released();
    bool touched = false;
    double largest = 0;
    for (double t = 0; t < *scene_.t_end; t += kStep) {
      if (!touched && lowest(y) < 0) touched = true, start_ = t;
      history_.emplace_back(asked(t, y, touched));
      const auto after = [&](double part) {
        const double h = part * kStep;
        const auto f = [&](double c, const State& x) { return field(t + c * h, x, c * part, touched); };
        const State a = f(0, y), b = f(0.5, y + h / 2 * a), c = f(0.5, y + h / 2 * b), d = f(1, y + h * c);
        return State(y + h / 6 * (a + 2 * b + 2 * c + d));
      };
      const State end = after(1);
      // The acceleration jumps where a point touches: there, and at every step.
      for (int j = 0; j < kPoints; ++j)
        if (const double from = height(link_, pose(y), j), to = height(link_, pose(end), j); from >= 0 && to < 0) {
          const double part = from / (from - to) * (1 + 1e-6) + 1e-9;
          largest = std::max(largest, acceleration(t + part * kStep, after(part), part, touched));
        }
      if (touched) largest = std::max(largest, acceleration(t, y, 0, touched));
      y = end;
      ++steps_;
    }
    return largest;
  }

 private:
  static Pose<double> pose(const State& y) {
    return {y[kX],
            y[kY],
            y[kVx],
            y[kVy],
            std::sin(y[kTheta0]),
            std::cos(y[kTheta0]),
            std::sin(y[kTheta1]),
            std::cos(y[kTheta1]),
            y[kOmega0],
            y[kOmega1]};
  }
  State released() const {
    State y = State::Zero();
    y[kTheta0] = scene_.drop.pitch, y[kTheta1] = scene_.drop.pitch + motion_.phi_i, y[kPhiM] = motion_.phi_i;
    y[kVx] = scene_.drop.forward_speed;
    y[kY] = scene_.drop.height - lowest(y);
    return y;
  }
  double lowest(const State& y) const {
    double least = 1e300;
    for (int j = 0; j < kPoints; ++j) least = std::min(least, height(link_, pose(y), j));
    return least;
  }
  /// Eq. 3 of what is measured now, with the gains of the landing motion once it plays.
  double asked(double t, const State& y, bool landing) const {
    const bool motor = sea_.feedback == Feedback::kMotor;
    const double angle = motor ? y[kPhiM] : y[kTheta1] - y[kTheta0], now = motor ? y[kOmegaM] : y[kOmega1] - y[kOmega0];
    Reference<double> r{motion_.phi_i, 0};
    if (landing) {
      const double s = std::min(1.0, (t - start_) / motion_.duration), range = motion_.phi_f - motion_.phi_i;
      r.phi += range * s * s * s * (10 + s * (6 * s - 15));
      r.dphi = range / motion_.duration * 30 * s * s * (1 - s) * (1 - s);
    }
    const double rate = sea_.velocity_filter > 0 ? y[kFiltered] : now;
    return (landing ? motion_.gain_p : 1) * sea_.k_p * (r.phi - angle) +
           (landing ? motion_.gain_d : 1) * sea_.k_d * (r.dphi - rate);
  }
  /// What was asked for `part` of a step after now, less the delay.
  double driving(double t, const State& y, double part, bool landing) const {
    if (sea_.control_delay == 0) return asked(t, y, landing);
    const double back = double(steps_) + part - sea_.control_delay / kStep;
    if (back <= 0) return history_.front();
    const auto i = std::size_t(back);
    return history_[i] + (history_[std::min(i + 1, history_.size() - 1)] - history_[i]) * (back - double(i));
  }
  State field(double t, const State& y, double part, bool landing) const {
    const Pose<double> p = pose(y);
    Loads<double> load;
    for (int j = 0; j < kPoints; ++j)
      if (const double h = height(link_, p, j); scene_.contacts[std::size_t(j)] && h < 0)
        load.add(link_, p, j, -scene_.floor->damping_tangential * velocity_x(link_, p, j),
                 std::max(0.0, -scene_.floor->stiffness * h - scene_.floor->damping_normal * velocity_y(link_, p, j)));
    const double rate = y[kOmega1] - y[kOmega0];
    const double tau = std::clamp(sea_.k_sea * (y[kPhiM] - y[kTheta1] + y[kTheta0]) + sea_.c_sea * (y[kOmegaM] - rate),
                                  -sea_.tau_max, sea_.tau_max);
    const Accelerations<double> acc = solve(link_, p, tau, load);
    State dy;
    dy << y[kVx], y[kVy], y[kOmega0], y[kOmega1], y[kOmegaM], acc.x, acc.y, acc.theta0, acc.theta1,
        (driving(t, y, part, landing) - tau) / sea_.i_motor,
        sea_.velocity_filter > 0
            ? ((sea_.feedback == Feedback::kMotor ? y[kOmegaM] : rate) - y[kFiltered]) / sea_.velocity_filter
            : 0;
    return dy;
  }

  double acceleration(double t, const State& y, double part, bool landing) const {
    const State dy = field(t, y, part, landing);
    return thigh_acceleration(link_, pose(y), {dy[kVx], dy[kVy], dy[kOmega0], dy[kOmega1]}).norm();
  }

  const Scene& scene_;
  const SeaParameters<double>& sea_;
  const Motion& motion_;
  TwoLinkDynamics<double> link_;
  std::vector<double> history_;  ///< a step each
  long steps_ = 0;
  double start_ = 0;  ///< of the motion [s]
};

}  // namespace

TEST_CASE("late landing: a delay and a filter land as in an integration that keeps the history of the drive") {
  const double delay = GENERATE(0.0, 2e-4, 1e-3, 5e-3), filter = GENERATE(0.0, 5e-3);
  const Motion motion = GENERATE(kHeld, kMoving, kGains);
  const Feedback feedback = GENERATE(Feedback::kOutput, Feedback::kMotor);
  if (feedback == Feedback::kMotor && (delay != 1e-3 || filter == 0)) return;
  CAPTURE(delay, filter, motion.phi_i, motion.gain_p, feedback == Feedback::kMotor);
  const Scene scene = short_paper();
  const SeaParameters<double> sea = late(delay, filter, feedback);
  const Landing landing = simulate(scene, sea, motion);
  REQUIRE(landing.end != End::kFailed);
  CHECK(landing.energy_residual < 1e-6);  // the work of the drive that is late is what moves the motor
  const double peak = Fixed(scene, sea, motion).peak();
  CHECK(landing.peak == Approx(peak).epsilon(2e-4));
  // The fast path, another method and the lanes follow the same landing.
  CHECK(peak_acceleration(scene, sea, motion).peak == Approx(landing.peak).epsilon(1e-6));
  CHECK(peak_acceleration(scene, sea, motion, {.accuracy = 1e-10, .method = Method::kDormandPrince54}).peak ==
        Approx(landing.peak).epsilon(1e-6));
  std::vector<BatchCase> cases(5, BatchCase{&scene, &sea, motion});
  std::vector<LandingPeak> peaks(cases.size());
  batch_peaks(cases, peaks, {.accuracy = 1e-6});
  for (const LandingPeak& p : peaks) CHECK(p.peak == Approx(landing.peak).epsilon(1e-3));
}

TEST_CASE("late landing: the gradient of its peak by the motion is the differences'") {
  const Scene scene = short_paper();
  const SeaParameters<double> sea = late(2e-3, 3e-3, Feedback::kOutput);
  const SimulateOptions tight{.accuracy = 1e-12};
  const auto peaks = quintic_peaks(scene, sea, kMoving, tight, 1);
  REQUIRE(peaks.peaks.size() == 1);
  CHECK(peaks.peaks[0].value == Approx(peak_acceleration(scene, sea, kMoving, tight).peak).epsilon(1e-9));
  double Motion::*const at[] = {&Motion::phi_i, &Motion::phi_f, &Motion::duration};
  for (int k = 0; k < kQuinticParameters; ++k) {
    constexpr double kStep = 1e-6;
    Motion up = kMoving, down = kMoving;
    up.*at[k] += kStep, down.*at[k] -= kStep;
    const double slope =
        (peak_acceleration(scene, sea, up, tight).peak - peak_acceleration(scene, sea, down, tight).peak) / (2 * kStep);
    INFO(k << ": " << slope);
    CHECK(peaks.peaks[0].d[k] == Approx(slope).epsilon(1e-4).margin(1e-3));
  }
}

TEST_CASE("late landing: lanes mix drives that are late with others, and none changes another") {
  const Scene scene = short_paper();
  const SeaParameters<double> sea[] = {late(0, 0, Feedback::kOutput), late(1e-3, 0, Feedback::kOutput),
                                       late(0, 4e-3, Feedback::kOutput), late(3e-3, 1e-3, Feedback::kOutput)};
  std::vector<BatchCase> cases;
  for (int i = 0; i < 12; ++i) cases.push_back({&scene, &sea[i % 4], i % 3 ? kMoving : kHeld});
  std::vector<LandingPeak> together(cases.size()), alone(1);
  batch_peaks(cases, together, {.accuracy = 1e-6});
  for (std::size_t i = 0; i < cases.size(); ++i) {
    CAPTURE(i);
    CHECK(together[i].peak == Approx(peak_acceleration(scene, *cases[i].sea, cases[i].motion).peak).epsilon(1e-3));
    batch_peaks(std::span(&cases[i], 1), alone, {.accuracy = 1e-6});
    CHECK(alone[0].peak == together[i].peak);
  }
}

TEST_CASE("landing: a spring that softens is followed as long as it resists, alone and among others") {
  const Scene scene = short_paper();
  SeaParameters<double> sea = late(0, 0, Feedback::kOutput);
  const double linear = peak_acceleration(scene, sea, kMoving).peak;
  sea.k_sea_cubic = -5;
  const Landing softer = simulate(scene, sea, kMoving);
  CHECK(softer.end != End::kFailed);
  CHECK(softer.peak != linear);
  sea.k_sea_cubic = -5000;
  const Landing broken = simulate(scene, sea, kMoving);
  CHECK(broken.end == End::kFailed);
  CHECK(std::string(reason(broken)).find("no longer resists") != std::string::npos);
  const BatchCase one{&scene, &sea, kMoving};
  LandingPeak peak;
  batch_peaks(std::span(&one, 1), std::span(&peak, 1), {});
  CHECK(peak.failure == Failure::kGivesWay);
}
