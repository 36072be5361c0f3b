// Friction that sticks on the rig (identify/rig/one_link.hpp, identify/rollout/roll.hpp): closed forms, an independent
// simulation, the exact path against the integrated one, derivatives through events against differences, no creep.
#include <catch2/catch.hpp>
#include <numbers>

#include "identify/rollout/rollout.hpp"
#include "test/joint_simulator.hpp"

using namespace ukemi;
using namespace ukemi::identify;

namespace {

const Rig kRig{.length = 0.3, .inertia = 0.024225, .tau_max = {}, .gear_ratio = {}, .feedback = {}};
const RolloutOptions kTight{.accuracy = 1e-13};

SeaParameters<double> rubbing() {
  SeaParameters<double> p{.k_p = 50, .k_d = 1, .k_sea = 65, .c_sea = 0.6, .i_motor = 0.085};
  p.friction = 0.7, p.friction_asymmetry = 0.2, p.viscous = 0.05;
  p.output_friction = 0.3, p.output_friction_asymmetry = -0.15, p.output_viscous = 0.02;
  return p;
}

/// Samples at 1 kHz with a hit, with a reference that moves and jumps in steps of a sample, or with one that bends.
Trial driven(const std::string& kind, double duration = 0.6) {
  Trial out;
  for (int i = 0; i <= int(std::lround(duration * 1000)); ++i) {
    const double t = i * 1e-3, s = (t - 0.005) / 0.02;
    out.t.push_back(t);
    if (kind == "hit") out.force.push_back(s > 0 && s < 1 ? 60 * std::sin(std::numbers::pi * s) : 0);
    if (kind != "hit") out.phi_ref.push_back(0.2 * std::sin(9 * t) + (kind == "sampled" && t > 0.3 ? 0.1 : 0));
    if (kind == "smooth") out.dphi_ref.push_back(1.8 * std::cos(9 * t));
  }
  out.phi_motor.resize(out.t.size());
  return out;
}

struct Rolled {
  std::vector<double> phi, phi_m;
};
Rolled rolled(const SeaParameters<double>& p, const Trial& trial, const RolloutOptions& options = kTight,
              const Nuisance<double>& nuisance = {}, const Rig& rig = kRig) {
  Rolled out;
  REQUIRE(rollout(rig, p, nuisance, PreparedTrial(trial), options, out.phi, out.phi_m) == RolloutStatus::kDone);
  return out;
}
double apart(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

}  // namespace

TEST_CASE("sticking: a sliding link stops where its energy is rubbed off, and stays") {
  SeaParameters<double> p{.k_p = 0, .k_d = 0, .k_sea = 0, .c_sea = 0, .i_motor = 0.085};
  p.output_friction = 0.3, p.output_friction_asymmetry = 0.25;
  Trial trial;
  for (int i = 0; i <= 300; ++i) trial.t.push_back(i * 1e-3);
  for (const double rate : {2.0, -1.5}) {
    const double level = 0.3 * (rate > 0 ? 1.25 : 0.75), brake = level / kRig.inertia, stop = std::abs(rate) / brake;
    const std::vector<double> phi = rolled(p, trial, kTight, {.rate = rate}).phi;
    for (std::size_t i = 0; i < phi.size(); ++i) {
      const double t = std::min(trial.t[i], stop);
      CHECK(std::abs(phi[i] - (rate * t - std::copysign(brake, rate) * t * t / 2)) < 1e-14);
    }
    CHECK(phi[250] == phi[300]);
  }
}

TEST_CASE("sticking: a spring on a rubbing mass swings by 2 L/K less each half turn, then sticks off its rest") {
  SeaParameters<double> p{.k_p = 40, .k_d = 0, .k_sea = 0, .c_sea = 0, .i_motor = 0.1, .feedback = Feedback::kMotor};
  p.friction = 1.3;
  const double w = std::sqrt(p.k_p / p.i_motor), step = 2 * p.friction / p.k_p, from = 0.5;
  Trial trial;  // sampled where it turns
  for (int i = 0; i <= 40; ++i) trial.t.push_back(i * std::numbers::pi / w), trial.phi_ref.push_back(0);
  trial.phi_motor.resize(trial.t.size());
  const std::vector<double> phi = rolled(p, trial, kTight, {.angle = from}).phi_m;
  int turns = 0;
  for (double left = from; left > step / 2; left -= step) ++turns;
  for (std::size_t i = 0; i < phi.size(); ++i) {
    const int n = std::min(int(i), turns);
    INFO("turn " << i);
    CHECK(phi[i] == Approx((n % 2 ? -1 : 1) * (from - n * step)).margin(1e-11));
  }
  CHECK(phi[30] == phi[40]);
  CHECK(std::abs(phi[40]) > 0.001);
}

TEST_CASE("sticking: under less than breakaway torque nothing creeps for an hour") {
  SeaParameters<double> p = rubbing();
  p.feedback = GENERATE(Feedback::kOutput, Feedback::kMotor);
  Trial trial;
  for (int i = 0; i <= 36'000; ++i) {
    trial.t.push_back(0.1 * i);
    trial.phi_ref.push_back(0.1 + 0.009 * std::sin(0.37 * i));  // 0.45 Nm of 0.56
  }
  trial.phi_motor.resize(trial.t.size());
  const Rolled r = rolled(p, trial, {});
  for (std::size_t i = 0; i < r.phi.size(); ++i) {
    if (r.phi[i] == 0.1 && r.phi_m[i] == 0.1) continue;
    FAIL("it moved by " << r.phi[i] - 0.1 << " after " << trial.t[i] << " s");
  }
  // A little more, and it goes.
  for (double& x : trial.phi_ref) x = 0.1;
  trial.phi_ref[20'000] = 0.1 + 0.7 * 1.2 / 50 + 1e-3;
  CHECK(rolled(p, trial, {}).phi_m.back() > 0.1);
}

TEST_CASE("sticking: the motor of an independent simulation sticks and slips alike") {
  using namespace test;
  SeaParameters<double> p{kTruth[0], kTruth[1], kTruth[2], kTruth[3], kTruth[4], 20};
  p.friction = 0.6, p.viscous = 0.1, p.breakaway = GENERATE(0.0, 0.5), p.spring_loss = GENERATE(0.0, 0.08);
  Trial trial = driven("hit");
  const std::vector<double> other = joint_angle(
      trial.t, trial.force, {.viscous = p.viscous, .dry = p.friction, .breakaway = p.breakaway, .loss = p.spring_loss});
  const std::vector<double> phi = rolled(p, trial).phi;
  CHECK(*std::max_element(phi.begin(), phi.end()) > 0.05);
  CHECK(apart(phi, other) < 2e-6);  // that one ends its slips within 2e-5 s
}

TEST_CASE("sticking: a loss with the spring's torque is found beside dry friction, from an independent simulation") {
  using namespace test;
  FitOptions options;
  options.terms.nuisance = {"friction", "spring_loss"};
  const Fit f = fit(rig(), eight_hits({.dry = 0.2, .loss = 0.08, .angle_noise = 1e-4}, 31), {}, truth(), options);
  REQUIRE(f.converged);
  for (const auto& [name, value] : {std::pair("friction", 0.2), {"spring_loss", 0.08}})
    for (const Estimate* e : f.globals())
      if (e->name == name) {
        INFO(name << " " << e->value);
        REQUIRE(e->std);
        CHECK(std::abs(e->value - value) < 3.5 * *e->std);
        CHECK(*e->std < 0.1 * value);
      }
}

TEST_CASE("sticking: the exact path is the integrated one") {
  const std::string kind = GENERATE("hit", "sampled", "smooth");
  SeaParameters<double> p = rubbing();
  p.feedback = GENERATE(Feedback::kOutput, Feedback::kMotor);
  CAPTURE(kind, int(p.feedback));
  RolloutOptions integrated = kTight;
  integrated.linear = RolloutOptions::Linear::kIntegrated;
  const Trial trial = driven(kind);
  const Rolled a = rolled(p, trial), b = rolled(p, trial, integrated);
  CHECK(*std::max_element(a.phi.begin(), a.phi.end()) > 0.05);
  CHECK(apart(a.phi, b.phi) < 1e-10);
  CHECK(apart(a.phi_m, b.phi_m) < 1e-10);
}

TEST_CASE("sticking: derivatives through slip, stick and a command's limit are the differences") {
  using Jet = ceres::Jet<double, kLargeJet>;
  const std::string kind =
      GENERATE("hit", "sampled", "smooth", "controller", "command", "stiffening", "stribeck", "loss");
  CAPTURE(kind);
  Rig rig = kRig;
  Trial trial = driven(kind == "stiffening" || kind == "stribeck" || kind == "loss" ? "hit"
                       : kind == "controller" || kind == "command"                  ? "sampled"
                                                                                    : kind);
  SeaParameters<double> p = rubbing();
  if (kind == "controller") {
    rig.drive = {.kind = Drive::Kind::kController, .gain = 20, .limit = 1.5, .feedback = Feedback::kMotor};
    p.k_t = 2.5;
  } else if (kind == "command") {
    rig.drive = {.kind = Drive::Kind::kCommand};
    for (const double t : trial.t) trial.command.push_back(1.2 * std::cos(25 * t));
    p.k_t = 2.5;
  }
  if (kind == "stiffening") p.k_sea_cubic = 400;
  if (kind == "stribeck") p.breakaway = 0.4, p.stribeck_speed = 0.3;
  if (kind == "loss") p.spring_loss = 0.08;
  using Sea = SeaParameters<double>;
  std::vector<std::pair<const char*, double Sea::*>> terms = {
      {"k_p", &Sea::k_p},
      {"k_d", &Sea::k_d},
      {"k_sea", &Sea::k_sea},
      {"c_sea", &Sea::c_sea},
      {"i_motor", &Sea::i_motor},
      {"friction", &Sea::friction},
      {"friction_asymmetry", &Sea::friction_asymmetry},
      {"viscous_friction", &Sea::viscous},
      {"output_friction", &Sea::output_friction},
      {"output_friction_asymmetry", &Sea::output_friction_asymmetry},
      {"output_viscous", &Sea::output_viscous},
      {"k_t", &Sea::k_t},
  };
  SeaParameters<Jet> jets = p.cast<Jet>();
  jets.k_p.v[0] = 1, jets.k_d.v[1] = 1, jets.k_sea.v[2] = 1, jets.c_sea.v[3] = 1, jets.i_motor.v[4] = 1;
  jets.friction.v[5] = 1, jets.friction_asymmetry.v[6] = 1, jets.viscous.v[7] = 1, jets.output_friction.v[8] = 1;
  jets.output_friction_asymmetry.v[9] = 1, jets.output_viscous.v[10] = 1, jets.k_t.v[11] = 1;
  if (kind == "stribeck") {
    terms.insert(terms.end(), {{"breakaway", &Sea::breakaway}, {"stribeck_speed", &Sea::stribeck_speed}});
    jets.breakaway.v[12] = jets.stribeck_speed.v[13] = 1;
  }
  if (kind == "loss") terms.emplace_back("spring_loss", &Sea::spring_loss), jets.spring_loss.v[12] = 1;
  std::vector<Jet> phi, phi_m;
  REQUIRE(rollout(rig, jets, {}, PreparedTrial(trial), kTight, phi, phi_m) == RolloutStatus::kDone);
  phi.insert(phi.end(), phi_m.begin(), phi_m.end());
  const auto at = [&](double Sea::*member, double value) {
    Sea q = p;
    q.*member = value;
    Rolled r = rolled(q, trial, kTight, {}, rig);
    r.phi.insert(r.phi.end(), r.phi_m.begin(), r.phi_m.end());
    return r.phi;
  };
  for (std::size_t k = 0; k < terms.size(); ++k) {
    INFO("derivative by " << terms[k].first);
    const double value = p.*terms[k].second, h = 2e-4 * (value == 0 ? 1 : std::abs(value));
    const auto [worst, size] = test::slope_error(
        h, [&](double by) { return at(terms[k].second, value + by); },
        [&](std::size_t i) { return phi[i].v[long(k)]; });
    CAPTURE(worst, size);
    CHECK(worst <= 1e-7 * std::max(size, 1e-3));
  }
}
