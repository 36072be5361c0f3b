// A drive that is late (DriveLag of common/sea.hpp) against what shares no code with it: the exact transfer function in
// the frequency domain, and in time the independent simulator, which keeps the history of what the drive asked for.
#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <complex>
#include <numbers>

#include "identify/rollout/rollout.hpp"
#include "test/joint_simulator.hpp"

using namespace ukemi;
using namespace ukemi::identify;
using namespace test;

namespace {

using Complex = std::complex<double>;
using Lag = DriveLag<double>;

SeaParameters<double> late(double delay, double filter) {
  SeaParameters<double> sea = truth();
  sea.control_delay = delay, sea.velocity_filter = filter;
  return sea;
}

/// What the drive makes of u, and of a rate that K_d sees, at an angular frequency [rad/s].
std::pair<Complex, Complex> response(const Lag& lag, double omega) {
  Eigen::Matrix4d a;
  for (int j = 0; j < Lag::kStates; ++j) a.col(j) = lag.derivative(0, {0, 0, 0, 0}, Lag::State::Unit(j));
  const Eigen::Matrix4cd inverse = (Complex(0, omega) * Eigen::Matrix4cd::Identity() - a).inverse();
  const Lag::State zero = Lag::State::Zero(), of_torque = lag.derivative(1, {0, 0, 0, 0}, zero),
                   of_rate = lag.derivative(0, {0, 0, 1, 0}, zero);
  Complex torque = lag.torque(1, zero), rate = lag.filtered({0, 0, 1, 0}, zero).dphi;
  for (int j = 0; j < Lag::kStates; ++j) {
    torque += lag.torque(0, Lag::State::Unit(j)) * (inverse * of_torque)[j];
    rate += lag.filtered({0, 0, 0, 0}, Lag::State::Unit(j)).dphi * (inverse * of_rate)[j];
  }
  return {torque, rate};
}

/// Largest differences of what the rollout says and the simulator, over the eight hits [rad].
double apart(const SeaParameters<double>& sea, const Effects& effects) {
  double worst = 0;
  for (const Trial& log : eight_hits(effects, 1)) {
    std::vector<double> phi, phi_m;
    REQUIRE(rollout(rig(), sea, {}, PreparedTrial(log), {}, phi, phi_m) == RolloutStatus::kDone);
    for (std::size_t i = 0; i < phi.size(); ++i) worst = std::max(worst, std::abs(phi[i] - log.phi[i]));
  }
  return worst;
}

}  // namespace

TEST_CASE("drive lag: the delay is that of exp(-s T) and the filter that of 1 / (1 + s T), at 0 and below a step too") {
  for (const double time : {0.0, 1e-7, 2e-5, 1e-4, 3e-4, 5e-4, 1e-3, 2e-3, 5e-3, 2e-2})
    for (const double omega : {1.0, 30.0, 100.0}) {
      CAPTURE(time, omega);
      // Seeded, so that the states are there at 0 too.
      SeaParameters<ceres::Jet<double, 2>> seeded = late(time, time).cast<ceres::Jet<double, 2>>();
      seeded.control_delay.v[0] = seeded.velocity_filter.v[1] = 1;
      const auto [torque, rate] = response(Lag(DriveLag<ceres::Jet<double, 2>>(seeded)), omega);
      const double x = omega * time, short_x = omega * Lag::kShortestDelay;
      const double bound = time >= Lag::kShortestDelay ? std::pow(x, 6) / 7200 : std::pow(short_x, 3) / 60;
      CHECK(std::abs(torque - std::exp(Complex(0, -x))) < 1.01 * bound + 1e-13);
      const double short_filter = omega * Lag::kShortestFilter;
      CHECK(std::abs(rate - 1.0 / Complex(1, x)) <
            (time >= Lag::kShortestFilter || time == 0 ? 1e-13 : 0.26 * short_filter * short_filter));
      if (time == 0) {
        const auto later = response(Lag(late(1e-9, 0)), omega).first;
        CHECK(std::abs((later - torque) / 1e-9 - Complex(0, -omega)) < 0.2 * short_x * short_x * omega + 1e-4);
      }
    }
  // What is not there is not late at all.
  CHECK(response(Lag(late(0, 1e-3)), 50).first == 1.0);
  CHECK(std::abs(response(Lag(late(1e-3, 0)), 50).second - 1.0) < 1e-14);
}

TEST_CASE("drive lag: eight hits are those of a simulator that keeps the drive's history, far below any noise") {
  const double delay = GENERATE(0.0, 2e-4, 1e-3, 2e-3, 5e-3), filter = GENERATE(0.0, 1e-3, 5e-3);
  const Feedback feedback = GENERATE(Feedback::kOutput, Feedback::kMotor);
  if (feedback == Feedback::kMotor && delay != 2e-3) return;
  CAPTURE(delay, filter, feedback == Feedback::kMotor);
  SeaParameters<double> sea = late(delay, filter);
  sea.feedback = feedback;
  Effects effects{.delay = delay, .filter = filter, .feedback = feedback};
  effects.angle_noise = 0;
  CHECK(apart(sea, effects) < 2e-6);
  if (delay == 0 && filter == 0) return;
  sea.control_delay = sea.velocity_filter = 0;
  CHECK(apart(sea, effects) > (feedback == Feedback::kMotor || delay + filter > 5e-4 ? 1e-3 : 2e-4));
}

TEST_CASE("drive lag: it holds where the motor sticks and slips") {
  SeaParameters<double> sea = late(2e-3, 1e-3);
  sea.friction = 0.3;
  Effects effects{.dry = 0.3, .delay = 2e-3, .filter = 1e-3};
  effects.angle_noise = 0;
  const double with_lag = apart(sea, effects);
  // The simulator turns a side to rest at the end of a step: as near as it comes without a lag.
  sea.control_delay = sea.velocity_filter = effects.delay = effects.filter = 0;
  CHECK(with_lag < 2 * apart(sea, effects));
}

TEST_CASE("drive lag: a rollout's derivatives by both are its differences, at 0 too") {
  using Jet = ceres::Jet<double, kSmallJet>;
  const double delay = GENERATE(0.0, 1e-4, 2e-3), filter = GENERATE(0.0, 3e-3);
  const std::string kind = GENERATE("gains", "friction", "controller", "command");
  CAPTURE(delay, filter, kind);
  Rig r = rig();
  Trial log = eight_hits({.angle_noise = 0}, 1)[6];
  log.phi_motor.resize(log.t.size());
  SeaParameters<double> sea = late(delay, filter);
  if (kind == "friction") sea.friction = 0.2;
  if (kind == "controller" || kind == "command") sea.k_t = 1.5, sea.viscous = 0.5;
  if (kind == "controller") r.drive = {.kind = Drive::Kind::kController, .gain = 20, .limit = 1.5};
  if (kind == "command") {
    r.drive = {.kind = Drive::Kind::kCommand};
    for (std::size_t i = 0; i < log.t.size(); ++i) log.command.push_back(i % 120 < 60 ? 0.7 : -0.4);
  }
  const PreparedTrial prepared(log);
  const RolloutOptions tight{.accuracy = 1e-13, .max_steps = 1'000'000};
  const auto run = [&]<class T>(const SeaParameters<T>& p) {
    std::vector<T> phi, phi_m;
    REQUIRE(rollout(r, p, {}, prepared, tight, phi, phi_m) == RolloutStatus::kDone);
    phi.insert(phi.end(), phi_m.begin(), phi_m.end());
    return phi;
  };
  SeaParameters<Jet> seeded = sea.cast<Jet>();
  seeded.control_delay.v[0] = seeded.velocity_filter.v[1] = seeded.k_sea.v[2] = 1;
  const std::vector<Jet> exact = run(seeded);
  const std::pair<int, double SeaParameters<double>::*> terms[] = {{0, &SeaParameters<double>::control_delay},
                                                                   {1, &SeaParameters<double>::velocity_filter},
                                                                   {2, &SeaParameters<double>::k_sea}};
  for (const auto& [slot, at] : terms) {
    CAPTURE(slot);
    // A second-order difference from within the range: at 0 there is nothing below it.
    const double h = slot == 2 ? 1e-3 : 1e-6;
    const bool edge = slot < 2 && sea.*at == 0;
    std::vector<std::vector<double>> values;
    for (const double step : edge ? std::array{1e-3, 1.0, 2.0} : std::array{-1.0, 0.0, 1.0}) {
      SeaParameters<double> p = sea;
      p.*at += step * h;
      values.push_back(run(p));
    }
    double size = 0, worst = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      const double slope = edge ? (4 * values[1][i] - 3 * values[0][i] - values[2][i]) / (2 * h)
                                : (values[2][i] - values[0][i]) / (2 * h);
      size = std::max(size, std::abs(slope));
      worst = std::max(worst, std::abs(exact[i].v[slot] - slope));
    }
    CAPTURE(worst, size);
    const bool has_a_say = slot != 1 || kind == "gains" || kind == "friction";
    CHECK((size > 1e-6) == has_a_say);
    if (has_a_say) CHECK(worst < (edge ? 1e-2 : 1e-5) * size);
    if (!has_a_say) CHECK(worst < 1e-8);
  }
}

TEST_CASE("drive lag: where the rig is linear the exact path is the integrated one") {
  using Jet = ceres::Jet<double, kSmallJet>;
  SeaParameters<double> sea = late(GENERATE(2e-4, 3e-3), 2e-3);
  const bool moving = GENERATE(false, true);
  CAPTURE(sea.control_delay, moving);
  Trial log = eight_hits({.angle_noise = 0}, 1)[7];
  if (moving)
    for (const double t : log.t)
      log.phi_ref.push_back(0.2 * std::sin(9 * t)), log.dphi_ref.push_back(1.8 * std::cos(9 * t));
  SeaParameters<Jet> seeded = sea.cast<Jet>();
  seeded.k_p.v[0] = sea.k_p, seeded.k_d.v[1] = sea.k_d, seeded.control_delay.v[2] = 1e-3,
  seeded.velocity_filter.v[3] = 1e-3;
  const PreparedTrial prepared(log);
  std::vector<Jet> exact, integrated, phi_m;
  RolloutOptions options{.accuracy = 1e-13, .max_steps = 1'000'000};
  integrate::Counters few, many;
  options.work = &few;
  REQUIRE(rollout(rig(), seeded, {.angle = Jet(0.02)}, prepared, options, exact, phi_m) == RolloutStatus::kDone);
  options.linear = RolloutOptions::Linear::kIntegrated, options.work = &many;
  REQUIRE(rollout(rig(), seeded, {.angle = Jet(0.02)}, prepared, options, integrated, phi_m) == RolloutStatus::kDone);
  CHECK(2 * few.steps < many.steps);
  double worst = 0, worst_slope = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    worst = std::max(worst, std::abs(exact[i].a - integrated[i].a));
    worst_slope = std::max(worst_slope, (exact[i].v - integrated[i].v).cwiseAbs().maxCoeff());
  }
  CHECK(worst < 1e-10);
  CHECK(worst_slope < 1e-9);
}

TEST_CASE("drive lag: a spring that softens is followed as long as it resists, then the trial is given up") {
  SeaParameters<double> sea = truth();
  Effects effects{.cubic = -60};
  effects.angle_noise = 0;
  sea.k_sea_cubic = effects.cubic;
  CHECK(apart(sea, effects) < 2e-6);
  sea.k_sea_cubic = -2000;
  std::vector<double> phi, phi_m;
  CHECK(rollout(rig(), sea, {}, PreparedTrial(shipped(8)), {}, phi, phi_m) == RolloutStatus::kEscaped);
}
