// A logged torque and a command that is followed late: what the rollout says of them, its derivatives, and fits.
#include <catch2/catch.hpp>
#include <numbers>

#include "common/error.hpp"
#include "common/random.hpp"
#include "identify/fit/fit.hpp"
#include "identify/logs/trial_checks.hpp"
#include "identify/trust/identification.hpp"
#include "test/joint_simulator.hpp"

using namespace ukemi;
using namespace ukemi::identify;
using test::estimate;

namespace {

const Rig kRig = test::rig();
const RolloutOptions kTight{.accuracy = 1e-13};

/// At 1 kHz: a half sine of a force from 5 ms on for 12 ms.
Trial hit(double duration, double peak) {
  Trial out;
  for (int i = 0; i <= int(std::lround(duration * 1000)); ++i) {
    const double t = i * 1e-3, s = (t - 0.005) / 0.012;
    out.t.push_back(t);
    out.force.push_back(s > 0 && s < 1 ? peak * std::sin(std::numbers::pi * s) : 0);
  }
  return out;
}

/// A trial as sensors log it: angles with a noise [rad], the torque with one of its own.
struct Sensors {
  double angle = 1e-4, torque = 5e-3, gain = 1, bias = 0;
};
Trial logged(const Rig& rig, const SeaParameters<double>& sea, Trial trial, const Sensors& with, std::uint64_t seed) {
  std::vector<double> phi, phi_m, torque;
  REQUIRE(rollout(rig, sea, {.torque_gain = with.gain, .torque_bias = with.bias}, PreparedTrial(trial), kTight, phi,
                  phi_m, &torque) == RolloutStatus::kDone);
  Random random(seed);
  trial.phi = phi, trial.torque = torque;
  for (double& x : trial.phi) x += with.angle * random.normal();
  for (double& x : trial.torque) x += with.torque * random.normal();
  trial.file = "trial_" + std::to_string(seed) + ".csv";
  return trial;
}
}  // namespace

TEST_CASE("torque: the rollout's is Eq. 2 of its own angles and rates, the limit included, exact as integrated") {
  const SeaParameters<double> p = test::truth();
  const Trial trial = hit(0.3, GENERATE(60.0, 180.0));  // the second passes the limit
  std::vector<double> phi, phi_m, torque;
  REQUIRE(rollout(kRig, p, {}, PreparedTrial(trial), kTight, phi, phi_m, &torque) == RolloutStatus::kDone);
  REQUIRE(torque.size() == trial.samples());
  // What turned the link between the hits: M ddphi = tau_SEA, by second differences of the angle.
  const double dt = 1e-3;
  for (std::size_t i = 22; i + 2 < torque.size(); ++i) {
    const double bend = -phi[i - 2] + 16 * phi[i - 1] - 30 * phi[i] + 16 * phi[i + 1] - phi[i + 2];
    const bool limited = std::abs(std::abs(torque[i]) - p.tau_max) < 2;
    if (!limited) CHECK(torque[i] == Approx(kRig.inertia * bend / (12 * dt * dt)).margin(2e-3));
    CHECK(std::abs(torque[i]) <= p.tau_max);
  }
  RolloutOptions integrated = kTight;
  integrated.linear = RolloutOptions::Linear::kIntegrated;
  std::vector<double> again;
  REQUIRE(rollout(kRig, p, {.torque_gain = 1.2, .torque_bias = 0.4}, PreparedTrial(trial), integrated, phi, phi_m,
                  &again) == RolloutStatus::kDone);
  for (std::size_t i = 0; i < torque.size(); ++i) CHECK(again[i] == Approx(1.2 * torque[i] + 0.4).margin(1e-8));
}

TEST_CASE("torque: its derivatives are the differences, through hits, the limit and friction that sticks") {
  using Jet = ceres::Jet<double, kLargeJet>;
  SeaParameters<double> p = test::truth();
  const bool rubs = GENERATE(false, true);
  if (rubs) p.friction = 0.4, p.output_friction = 0.2;
  Trial trial = hit(0.3, 150);
  trial.torque.resize(trial.samples());
  using Sea = SeaParameters<double>;
  const std::vector<double Sea::*> constants = {&Sea::k_p, &Sea::k_d, &Sea::k_sea, &Sea::c_sea, &Sea::i_motor};
  SeaParameters<Jet> jets = p.cast<Jet>();
  jets.k_p.v[0] = jets.k_d.v[1] = jets.k_sea.v[2] = jets.c_sea.v[3] = jets.i_motor.v[4] = 1;
  Nuisance<Jet> sensor{.torque_gain = Jet(1.1, 5), .torque_bias = Jet(0.2, 6)};
  std::vector<Jet> phi, phi_m, torque;
  REQUIRE(rollout(kRig, jets, sensor, PreparedTrial(trial), kTight, phi, phi_m, &torque) == RolloutStatus::kDone);
  const auto at = [&](const Sea& q, const Nuisance<double>& n) {
    std::vector<double> a, m, out;
    REQUIRE(rollout(kRig, q, n, PreparedTrial(trial), kTight, a, m, &out) == RolloutStatus::kDone);
    return out;
  };
  const Nuisance<double> n{.torque_gain = 1.1, .torque_bias = 0.2};
  for (std::size_t k = 0; k < 7; ++k) {
    const auto moved = [&](double by) {
      Sea q = p;
      Nuisance<double> m = n;
      if (k < 5) q.*constants[k] += by;
      if (k == 5) m.torque_gain += by;
      if (k == 6) m.torque_bias += by;
      return at(q, m);
    };
    const double h = 2e-4 * (k < 5 ? p.*constants[k] : 1);
    const auto [worst, size] = test::slope_error(h, moved, [&](std::size_t i) { return torque[i].v[long(k)]; });
    INFO("by " << k);
    CAPTURE(worst, size);
    CHECK(worst <= 2e-7 * size);
  }
}

TEST_CASE(
    "torque: a logged one weighs by its own noise, narrows what is known of the spring, and its sensor is found") {
  const SeaParameters<double> truth = test::truth();
  const auto trials = [&](const Sensors& with) {
    std::vector<Trial> out;
    for (std::uint64_t i = 1; i <= 3; ++i)
      out.push_back(logged(kRig, truth, hit(0.6, 30.0 + 20.0 * double(i)), with, i));
    return out;
  };
  std::vector<Trial> with = trials({}), without = with;
  CHECK(angle_per_torque(with[0]) == Approx(1e-4 / 5e-3).epsilon(0.25));
  for (Trial& t : without) t.torque.clear();
  CHECK(angle_per_torque(without[0]) == 0);
  const Fit a = fit(kRig, with, {}, {.tau_max = 20}), b = fit(kRig, without, {}, {.tau_max = 20});
  REQUIRE((a.converged && b.converged));
  for (const Fit* f : {&a, &b})
    for (const auto& [name, value] :
         {std::pair("k_p", 50.0), {"k_d", 1.0}, {"k_sea", 65.0}, {"c_sea", 1.6}, {"i_motor", 0.085}}) {
      const Estimate& e = estimate(*f, name);
      INFO(name);
      REQUIRE(e.std);
      CHECK(std::abs(e.value - value) < 3.5 * *e.std);
    }
  CHECK(*estimate(a, "k_sea").std < 0.75 * *estimate(b, "k_sea").std);
  CHECK(a.rms == Approx(1e-4).epsilon(0.1));  // the torque counted by its own noise
  CHECK(a.trials[0].rms_torque == Approx(5e-3).epsilon(0.15));

  // A sensor that reads 10 % too much, from 0.3 Nm on: named by the score tests, found where it is fitted along.
  const std::vector<Trial> off = trials({.gain = 1.1, .bias = 0.3});
  FitOptions sensor;
  sensor.terms.nuisance = {"torque_gain", "torque_bias"};
  const Fit found = fit(kRig, off, {}, {.tau_max = 20}, sensor);
  REQUIRE(found.converged);
  CHECK(std::abs(estimate(found, "torque_gain").value - 1.1) < 3.5 * *estimate(found, "torque_gain").std);
  CHECK(std::abs(estimate(found, "torque_bias").value - 0.3) < 3.5 * *estimate(found, "torque_bias").std);
  CHECK(std::abs(estimate(found, "k_sea").value - 65) < 3.5 * *estimate(found, "k_sea").std);
  CHECK_THROWS_AS(fit(kRig, without, {}, {.tau_max = 20}, sensor), InputError);  // no trial logs one
}

TEST_CASE("control delay: a command that is followed late is followed late, and the delay is found") {
  Rig rig = kRig;
  rig.drive = {.kind = Drive::Kind::kCommand};
  SeaParameters<double> truth{.k_p = 0, .k_d = 0, .k_sea = 65, .c_sea = 1.6, .i_motor = 0.085};
  truth.k_t = 1.5, truth.viscous = 0.8;
  Trial trial;
  for (int i = 0; i <= 600; ++i) {
    trial.t.push_back(i * 2e-3);
    trial.command.push_back(i % 150 < 75 ? 0.8 : -0.8);
  }
  trial.phi_ref.assign(trial.t.size(), 0.0);
  std::vector<double> prompt, late, phi_m;
  REQUIRE(rollout(rig, truth, {}, PreparedTrial(trial), kTight, prompt, phi_m) == RolloutStatus::kDone);
  truth.control_delay = 0.01;  // five samples: what is told first is there from the start
  REQUIRE(rollout(rig, truth, {}, PreparedTrial(trial), kTight, late, phi_m) == RolloutStatus::kDone);
  Trial shifted = trial;
  truth.control_delay = 0;
  for (std::size_t i = shifted.command.size(); i-- > 0;) shifted.command[i] = shifted.command[i >= 5 ? i - 5 : 0];
  std::vector<double> same;
  REQUIRE(rollout(rig, truth, {}, PreparedTrial(shifted), kTight, same, phi_m) == RolloutStatus::kDone);
  double apart = 0;
  for (std::size_t i = 0; i < late.size(); ++i) {
    CHECK(late[i] == Approx(same[i]).margin(1e-10));
    apart = std::max(apart, std::abs(late[i] - prompt[i]));
  }
  CHECK(apart > 1e-3);

  truth.control_delay = 0.0073;  // between samples
  Trial log = logged(rig, truth, trial, {.torque = 0}, 7);
  log.torque.clear(), log.phi_motor = {};
  FitOptions options;
  options.terms.free = {"k_sea", "c_sea", "i_motor"};
  options.terms.nuisance = {"k_t", "viscous_friction", "control_delay"};
  SeaParameters<double> start = truth;
  start.k_sea = 50, start.c_sea = 1, start.i_motor = 0.1, start.k_t = 1.2, start.viscous = 1, start.control_delay = 0;
  const Fit found = fit(rig, {log}, start, start, options);
  REQUIRE(found.converged);
  const Estimate& delay = estimate(found, "control_delay");
  REQUIRE(delay.std);
  CHECK(*delay.std < 5e-4);
  CHECK(std::abs(delay.value - 0.0073) < 3.5 * *delay.std);
  CHECK(std::abs(estimate(found, "k_sea").value - 65) < 3.5 * *estimate(found, "k_sea").std);
}
