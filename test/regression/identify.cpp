// The shipped simulated trials (truth: Table 2) and, where UKEMI_LAB_DATA is set, a measured arm.
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "identify/logs/hits.hpp"
#include "identify/logs/trial_checks.hpp"
#include "test/impact.hpp"

using namespace ukemi;
using namespace ukemi::identify;
using namespace test;

namespace {

void check_truth(const Fit& f, double standard_errors) {
  REQUIRE(f.converged);
  CHECK(f.identifiable);
  for (std::size_t i = 0; i < kConstants; ++i) {
    const Estimate& e = f.parameters[i];
    INFO(e.name << " " << e.value << " +- " << e.std.value_or(-1));
    REQUIRE(e.std.has_value());
    CHECK(std::abs(e.value - kTruth[i]) < standard_errors * *e.std);
    CHECK(e.ci_low < e.value);
    CHECK(e.value < e.ci_high);
  }
}

}  // namespace

TEST_CASE("eight trials: every constant within 3 standard errors of the truth, residual at the noise") {
  const Fit f = fit(rig(), shipped(), std::nullopt, limited());
  check_truth(f, 3);
  for (const Estimate& e : f.parameters) CHECK(*e.std < 1e-3 * e.value);  // 0.01 to 0.1 %
  CHECK(f.rms == Approx(5e-4).epsilon(0.03));
  CHECK(f.warnings.empty());
  // Correlations mostly in pairs: K_p with K_SEA, K_d with C_SEA.
  CHECK(f.correlation(0, 2) > 0.5);
  CHECK(f.correlation(1, 3) > 0.5);

  const Fit p = predict(rig(), {read_trial(UKEMI_DATASETS "/impact_validation/trial_9.csv")}, f.sea);
  CHECK(p.rms == Approx(5e-4).epsilon(0.05));
}

TEST_CASE(
    "eight trials driven by the continuous half-sine: the sampled force is not the true one, the fit still holds") {
  check_truth(fit(rig(), shipped("impact_continuous"), std::nullopt, limited()), 4);
}

TEST_CASE("twenty random starts up to 3x off in each constant end at one minimum") {
  const auto logs = shipped();
  const double cost = fit(rig(), logs, std::nullopt, limited()).cost;
  for (std::uint64_t i = 0; i < 20; ++i) {
    Random random(77, i);
    std::array<double, kConstants> u = kTruth;
    for (double& x : u) x *= random.factor(3);
    const Fit f = fit(rig(), logs, limited(u), limited());
    INFO("start " << i << " after " << f.starts << " starts");
    CHECK(f.converged);
    CHECK(std::abs(f.cost - cost) <= 1e-8 * cost);
  }
}

TEST_CASE("a start at 0 is moved off it") {
  const Fit f = fit(rig(), shipped(), limited(), limited());
  check_truth(f, 3);
  CHECK(f.warnings.size() == 5);
}

TEST_CASE("a bound at 0 is reached and reported: a rig without proportional gain") {
  // Simulated here: the rollout itself with k_p = 0, and noise that pulls the estimate below 0 in about half of the
  // draws.
  const SeaParameters<double> sluggish = limited({0, 3, 65, 1.6, 0.085});
  const std::vector<Trial> exact = simulated({shipped(4)}, sluggish);
  int at_bound = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Fit f = fit(rig(), noisy(exact, seed), sluggish, limited());
    REQUIRE(f.converged);
    const Estimate& k_p = f.parameters[0];
    INFO("seed " << seed << " k_p " << k_p.value);
    CHECK(k_p.value >= 0);
    CHECK(k_p.std.has_value() == !k_p.at_bound);
    if (!k_p.at_bound) continue;
    ++at_bound;
    CHECK(k_p.value == 0);
  }
  CHECK(at_bound > 0);
  CHECK(at_bound < 8);
}

TEST_CASE("constants that are not free stay, bounds hold") {
  FitOptions o;
  o.terms.free = {"k_p", "k_sea", "i_motor"};
  o.terms.lower["k_sea"] = 70;
  const SeaParameters<double> start = truth();
  const Fit f = fit(rig(), shipped(), start, limited(), o);
  CHECK(f.sea.k_d == 1);
  CHECK(f.sea.c_sea == 1.6);
  CHECK(f.sea.k_sea == 70);
  CHECK(f.parameters[2].at_bound);
  CHECK(f.covariance.rows() == 3);
}

TEST_CASE("a pulse of fewer than 8 samples is warned of") {
  Trial log = shipped(8), coarse;  // 10 ms, logged at 1 kHz
  CHECK(shortest_pulse(log) >= 8);
  coarse.file = "coarse";
  for (std::size_t i = 0; i < log.samples(); i += 2) {
    coarse.t.push_back(log.t[i]), coarse.force.push_back(log.force[i]), coarse.phi.push_back(log.phi[i]);
  }
  const SeaParameters<double> start = truth();
  const Fit f = fit(rig(), {coarse}, start, limited());
  REQUIRE_FALSE(f.warnings.empty());
  CHECK(f.warnings.front().find("coarse: a pulse of") == 0);
}

TEST_CASE("no hit at all: nothing is determined, and the fit says so") {
  Trial log = shipped(1);
  std::fill(log.force.begin(), log.force.end(), 0.0);
  Random noise(5);
  for (double& x : log.phi) x = 5e-4 * noise.normal();
  const SeaParameters<double> start = truth();
  const Fit f = fit(rig(), {log}, start, limited());
  CHECK_FALSE(f.identifiable);
  for (const Estimate& e : f.parameters) CHECK_FALSE(e.std.has_value());
}

TEST_CASE("a hit that makes the rig escape is a rejected rollout with a reason") {
  Trial log = shipped(8);
  for (double& x : log.force) x *= 10;
  const Fit f = predict(rig(), {log}, truth());
  CHECK_FALSE(f.converged);
  CHECK(f.trials[0].status == RolloutStatus::kEscaped);
  CHECK(f.message.find("the link escapes") != std::string::npos);
}

TEST_CASE("outliers: Huber's loss keeps the constants, weights by trial keep a noisy trial from ruling") {
  auto logs = shipped();
  Random random(3);
  for (std::size_t i = 0; i < logs[2].samples(); i += 25) logs[2].phi[i] += random.uniform(-0.05, 0.05);
  FitOptions robust;
  robust.huber = 1e-3;
  robust.restarts = 0;
  const SeaParameters<double> start = limited({60, 1.2, 80, 1.2, 0.1});
  const Fit plain = fit(rig(), logs, start, limited(), FitOptions{.restarts = 0}),
            huber = fit(rig(), logs, start, limited(), robust);
  REQUIRE(huber.converged);
  double worst_plain = 0, worst_huber = 0;
  for (std::size_t i = 0; i < kConstants; ++i) {
    worst_plain = std::max(worst_plain, std::abs(plain.parameters[i].value / kTruth[i] - 1));
    worst_huber = std::max(worst_huber, std::abs(huber.parameters[i].value / kTruth[i] - 1));
  }
  CHECK(worst_huber < 5e-3);
  CHECK(worst_huber < 0.5 * worst_plain);
  FitOptions weighted{.restarts = 0};
  weighted.weights = FitOptions::Weights::kTrial;
  const Fit by_trial = fit(rig(), logs, start, limited(), weighted);
  CHECK(by_trial.converged);
  CHECK(std::abs(by_trial.sea.k_sea / 65 - 1) < std::abs(plain.sea.k_sea / 65 - 1));
}

TEST_CASE("nuisance terms: an offset start and dry friction are found") {
  // Simulated here from the rollout itself: friction 0.2 Nm, the link 0.02 rad off its reference and moving.
  SeaParameters<double> sea = truth();
  sea.friction = 0.2;
  const std::vector<Trial> logs = noisy(simulated(shipped(), sea, {.angle = 0.02, .rate = -0.1}), 11);
  FitOptions o;
  o.restarts = 0;
  o.terms.nuisance = {"friction", "initial_angle", "initial_rate"};
  const SeaParameters<double> start = limited({55, 1.2, 70, 1.4, 0.09});
  const Fit f = fit(rig(), logs, start, limited(), o);
  check_truth(f, 3.5);
  CHECK(f.sea.friction == Approx(0.2).epsilon(0.02));
  REQUIRE(f.nuisance.size() == 17);
  for (const Estimate& e : f.nuisance) {
    INFO(e.name << " " << e.value << " +- " << e.std.value_or(-1));
    REQUIRE(e.std.has_value());
    const double expected = e.name == "friction" ? 0.2 : e.name == "initial_angle" ? 0.02 : -0.1;
    CHECK(std::abs(e.value - expected) < 4 * *e.std);
  }
}

TEST_CASE(
    "nuisance terms: sensor gains, offsets and a shifted force log are found, a trial each where they are a trial's") {
  // Simulated here from the rollout itself. The force stands in a log of its own, at 2.5 kHz, and comes late.
  std::vector<Trial> logs = shipped();
  std::map<std::string, std::vector<double>> expected;
  expected["force_gain"] = {1.03};
  for (std::size_t m = 0; m < logs.size(); ++m) {
    Trial& log = logs[m];
    const std::vector<double> force = log.force;
    log.force.clear();
    for (double t = log.t.front(); t < log.t.back(); t += 4e-4) {
      const auto i = std::min<std::size_t>(log.t.size() - 2, std::size_t((t - log.t[0]) / 1e-3));
      log.force_t.push_back(t);
      log.force.push_back(force[i] + (force[i + 1] - force[i]) * (t - log.t[i]) / (log.t[i + 1] - log.t[i]));
    }
    Random draw(12, m);
    const Nuisance<double> nuisance{.force_gain = 1.03,
                                    .force_bias = draw.uniform(-2, 2),
                                    .time_shift = draw.uniform(-4e-3, 4e-3),
                                    .encoder_offset = draw.uniform(-0.02, 0.02)};
    expected["force_bias"].push_back(nuisance.force_bias);
    expected["time_shift"].push_back(nuisance.time_shift);
    expected["encoder_offset"].push_back(nuisance.encoder_offset);
    log.phi = simulated({log}, truth(), nuisance)[0].phi;
    for (double& x : log.phi) x += kNoise * draw.normal();
  }
  FitOptions o;
  o.restarts = 0;
  o.terms.nuisance = {"force_gain", "force_bias", "time_shift", "encoder_offset"};
  const SeaParameters<double> start = limited({55, 1.2, 70, 1.4, 0.09});
  const Fit f = fit(rig(), logs, start, limited(), o);
  check_truth(f, 3.5);
  REQUIRE(f.nuisance.size() == 25);
  for (const Estimate& e : f.nuisance) {
    const double value = expected.at(e.name).at(std::size_t(std::max(e.trial, 0)));
    INFO(e.name << " " << e.value << " +- " << e.std.value_or(-1) << ", truth " << value);
    REQUIRE(e.std.has_value());
    CHECK(std::abs(e.value - value) < 4 * *e.std);
    if (e.name == "time_shift") CHECK(*e.std < 1e-4);
  }
}

TEST_CASE("nuisance terms: a spring that stiffens is told from one that does not") {
  SeaParameters<double> sea = truth();
  sea.k_sea_cubic = 400;
  const std::vector<Trial> logs = noisy(simulated(shipped(), sea), 13);
  const SeaParameters<double> start = truth();
  FitOptions o;
  o.restarts = 0;
  CHECK(fit(rig(), logs, start, limited(), o).rms > 6e-4);
  o.terms.nuisance = {"stiffening"};
  const Fit f = fit(rig(), logs, start, limited(), o);
  check_truth(f, 3.5);
  CHECK(f.rms == Approx(5e-4).epsilon(0.03));
  CHECK(std::abs(f.nuisance.at(0).value - 400) < 4 * *f.nuisance[0].std);
  CHECK(f.sea.k_sea_cubic == f.nuisance[0].value);
}

TEST_CASE("a prior counts like a measurement: it holds a constant that the trials do not tell, and only that") {
  const std::vector<Trial> logs{shipped(1)};
  FitOptions o;
  o.restarts = 0;
  const SeaParameters<double> start = truth();
  const Fit free = fit(rig(), logs, start, limited(), o);
  o.terms.priors = {{"k_sea", 66, 1e-3}};
  const Fit held = fit(rig(), logs, start, limited(), o);
  CHECK(held.sea.k_sea == Approx(66).margin(5e-3));
  CHECK(*held.parameters[2].std == Approx(1e-3).epsilon(0.1));
  CHECK(*held.parameters[3].std < *free.parameters[3].std);
  o.terms.priors = {{"k_sea", 66, 1e3}};
  CHECK(fit(rig(), logs, start, limited(), o).sea.k_sea == Approx(free.sea.k_sea).epsilon(1e-4));
}

TEST_CASE("exploring starts lists every minimum, the same whatever the threads") {
  const std::vector<Trial> all = shipped();
  const std::vector<Trial> logs(all.begin(), all.begin() + 3);
  FitOptions o;
  o.explore = 12;
  o.threads = 1;
  const Fit a = fit(rig(), logs, std::nullopt, limited(), o);
  o.threads = 2;
  const Fit b = fit(rig(), logs, std::nullopt, limited(), o);
  CHECK(a.starts == 12);
  REQUIRE(!a.minima.empty());
  REQUIRE(a.minima.size() == b.minima.size());
  int found = 0;
  for (std::size_t i = 0; i < a.minima.size(); ++i) {
    CHECK(a.minima[i].cost == b.minima[i].cost);
    CHECK(a.minima[i].found == b.minima[i].found);
    if (i > 0) CHECK(a.minima[i].cost > a.minima[i - 1].cost);
    found += a.minima[i].found;
  }
  CHECK(found > 6);
  CHECK(found <= 12);
  CHECK(a.minima[0].cost == a.cost);
  check_truth(a, 4);
}

TEST_CASE("a measured arm: K_SEA within 15 % of its nominal 1.813 Nm/rad") {
  const auto arm = measured_arm();
  if (!arm) return;
  FitOptions o;
  o.terms.nuisance = {"friction", "initial_angle"};
  const Fit f = fit(arm->rig, arm->log, std::nullopt, arm->base, o);
  INFO("k_sea " << f.sea.k_sea << " rms " << f.rms);
  CHECK(f.converged);
  CHECK(f.sea.k_sea == Approx(1.813).epsilon(0.15));
  CHECK(f.rms < 0.0065);
  CHECK(f.sea.friction == Approx(0.07).epsilon(0.3));
}
