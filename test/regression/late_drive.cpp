// Drives that are late, springs that soften and limits that are met, each fitted to the logs of the independent
// simulator: true constants within their errors, draw for draw.
#include <algorithm>
#include <catch2/catch.hpp>

#include "common/drive_stability.hpp"
#include "identify/trust/diagnostics.hpp"
#include "test/joint_simulator.hpp"

using namespace ukemi;
using namespace ukemi::identify;
using namespace test;

namespace {

constexpr std::array<double, kConstants> kOther = {30, 0.6, 120, 0.8, 0.03};
constexpr double kErrors = 3.5;  // a constant may be off by so many of its own

void check_near(const Fit& f, const std::string& name, double truth) {
  const Estimate& e = estimate(f, name);
  INFO(name << " " << e.value << " +- " << e.std.value_or(-1) << ", truth " << truth);
  REQUIRE(e.std);
  CHECK(std::abs(e.value - truth) < kErrors * *e.std);
}
void check_constants(const Fit& f, const std::array<double, kConstants>& truth) {
  REQUIRE(f.converged);
  for (std::size_t k = 0; k < kConstants; ++k) check_near(f, kConstantNames[k], truth[k]);
}
FitOptions with(std::vector<std::string> terms) {
  FitOptions o;
  o.restarts = 0;
  o.terms.nuisance = std::move(terms);
  return o;
}
/// Off the truth by a fifth, either way.
SeaParameters<double> off(const std::array<double, kConstants>& truth) {
  std::array<double, kConstants> u = truth;
  for (std::size_t k = 0; k < kConstants; ++k) u[k] *= k % 2 ? 0.8 : 1.2;
  return limited(u);
}

}  // namespace

TEST_CASE("late drives: constants, delay and filter are within their errors, on twenty draws of many drives") {
  const double delays[] = {5e-4, 1e-3, 2e-3, 5e-3}, filters[] = {0, 1e-3, 5e-3};
  int unclaimed = 0;
  for (int d = 0; d < 20; ++d) {
    const auto& constants = d % 2 ? kOther : kTruth;
    Effects effects{.delay = delays[d % 4], .filter = filters[d % 3], .feedback = Feedback(d % 5 == 4)};
    effects.angle_noise = 5e-4;
    SeaParameters<double> truth = limited(constants);
    truth.control_delay = effects.delay, truth.velocity_filter = effects.filter, truth.feedback = effects.feedback;
    CAPTURE(d, effects.delay, effects.filter, constants[0], d % 5 == 4);
    REQUIRE(growth_rate(truth, rig().inertia) < 0);
    SeaParameters<double> base = limited();
    base.feedback = effects.feedback;
    std::vector<std::string> terms{"control_delay"};
    if (effects.filter > 0) terms.push_back("velocity_filter");
    const Fit f = fit(rig(), eight_hits(effects, 700 + std::uint64_t(d), constants), off(constants), base, with(terms));
    REQUIRE(f.converged);
    // Short delays take from K_d what it has, K_p T_d: where one ends at its bound, 0, the fit claims no error for it,
    // and counts it in the others'. Where nothing tells them apart it claims none at all.
    const auto all = f.globals();
    if (std::any_of(all.begin(), all.end(), [](const Estimate* e) { return !e->std; })) {
      ++unclaimed;
      for (std::size_t k = 0; k < kConstants; ++k)
        if (estimate(f, kConstantNames[k]).std) check_near(f, kConstantNames[k], constants[k]);
      continue;
    }
    check_constants(f, constants);
    check_near(f, "control_delay", effects.delay);
    if (effects.filter > 0) check_near(f, "velocity_filter", effects.filter);
    CHECK(f.rms == Approx(5e-4).epsilon(0.03));
    CHECK(f.sea.control_delay == estimate(f, "control_delay").value);
  }
  INFO(unclaimed << " draws without an error of every term");
  CHECK(unclaimed <= 10);  // half: the rest must be judged
}

TEST_CASE("late drives: a delay that is known and stands in the rig leaves the constants right") {
  Effects effects{.delay = 2e-3};
  effects.angle_noise = 5e-4;
  const std::vector<Trial> logs = eight_hits(effects, 41, kOther);
  Rig known = rig();
  known.drive.control_delay = 2e-3;
  check_constants(fit(known, logs, off(kOther), known.mounted(limited()), with({})), kOther);
  const Fit without = fit(rig(), logs, off(kOther), limited(), with({}));
  REQUIRE(without.converged);
  CHECK(std::abs(without.sea.k_sea - kOther[2]) > 10 * *estimate(without, "k_sea").std);
  // The same where each trial has a rig of its own that states it, and the common one does not.
  std::vector<Trial> own = logs;
  for (Trial& t : own) t.rig = known;
  check_constants(fit(rig(), own, off(kOther), limited(), with({})), kOther);
}

TEST_CASE("a spring that softens, and a limit that the hits meet, are found") {
  Effects effects{.cubic = -60};
  effects.angle_noise = 5e-4;
  const Fit softer = fit(rig(), eight_hits(effects, 51), off(kTruth), limited(), with({"stiffening"}));
  check_constants(softer, kTruth);
  check_near(softer, "stiffening", -60);
  effects.cubic = 0;
  const std::vector<Trial> logs = eight_hits(effects, 52);
  const auto from = [&](double tau_max) {
    SeaParameters<double> start = off(kTruth);
    start.tau_max = tau_max;
    return fit(rig(), logs, start, start, with({"tau_max"}));
  };
  const Fit limit = from(24);
  check_constants(limit, kTruth);
  check_near(limit, "tau_max", 20);
  CHECK(limit.sea.tau_max == estimate(limit, "tau_max").value);
  // Without a value to start with there is nothing to say; one that no hit meets is not determined.
  CHECK_THROWS_WITH(from(std::numeric_limits<double>::infinity()),
                    Catch::Matchers::Contains("tau_max") && Catch::Matchers::Contains("to start with"));
  CHECK_FALSE(estimate(from(200), "tau_max").std);
}

TEST_CASE("late drives: a long log is tested for every term, a delay that is not there among them") {
  Effects effects{.viscous = 0.1};
  effects.angle_noise = 5e-4;
  Trial log;
  log.file = "long";
  for (int i = 0; i <= 4000; ++i) {
    log.t.push_back(i / 500.0);
    const double s = std::fmod(log.t.back(), 1) / 0.03;
    log.force.push_back(s > 0 && s < 1 ? (i % 1000 < 500 ? 60 : -60) * std::sin(std::numbers::pi * s) : 0);
  }
  log.phi = joint_angle(log.t, log.force, effects);
  Random random(5);
  for (double& x : log.phi) x += effects.angle_noise * random.normal();
  const FitOptions options = with({"viscous_friction"});
  const Fit f = fit(rig(), {log}, truth(), limited(), options);
  INFO(f.message << " " << f.rms);
  REQUIRE(f.converged);
  const ResidualTests tests = test_residuals({rig(), {log}, options}, f);
  REQUIRE(tests.score);
  const auto& terms = tests.score->shared;
  CHECK(std::any_of(terms.begin(), terms.end(), [](const auto& t) { return t.name == "control_delay"; }));
  CHECK_FALSE(tests.model_rejected());
}
