// Estimation terms that this file adds, and nothing else knows of: one whose derivative is a difference, one whose
// derivative is exact. Each is an entry in the table that is handed to the fit.
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/trust/identification.hpp"
#include "test/impact.hpp"

using namespace ukemi;
using namespace ukemi::identify;
using namespace test;

namespace {

/// A load cell whose gain rises with the force: F = F_log (1 + q F_log).
RigTerm curvature() {
  RigTerm t{{.name = "force_curvature", .unit = "1/N", .words = "rise of the load cell's gain", .size = 1e-4}};
  t.change = [](double q, Rig&, SeaParameters<double>&, Trial& log) {
    for (double& f : log.force) f *= 1 + q * f;
  };
  return t;
}
/// The torque limit as a term.
RigTerm limit() {
  return {{.name = "torque_limit", .unit = "Nm", .lower = 1, .upper = 100, .absent = 20, .size = 20},
          input_field([](auto& in) { return &in.sea.tau_max; })};
}

/// A further term of the options' table.
void add(const RigTerm& term, FitOptions& options) {
  std::vector<RigTerm> table = *options.terms.table;
  table.push_back(term);
  options.terms.table = std::make_shared<const std::vector<RigTerm>>(table);
}

constexpr double kCurvature = 2e-4;  // 6 % at 300 N

/// The eight trials of a load cell that reads too little at large forces, with noise.
std::vector<Trial> bent(std::uint64_t seed) {
  std::vector<Trial> logs = shipped();
  std::vector<std::vector<double>> logged;
  for (Trial& t : logs) {
    logged.push_back(t.force);
    for (double& f : t.force) f *= 1 + kCurvature * f;
  }
  logs = noisy(simulated(logs, truth()), seed);
  for (std::size_t m = 0; m < logs.size(); ++m) logs[m].force = logged[m];
  return logs;
}

const Estimate* find(const std::vector<Estimate>& list, const std::string& name) {
  const auto at = std::find_if(list.begin(), list.end(), [&](const Estimate& e) { return e.name == name; });
  return at == list.end() ? nullptr : &*at;
}

}  // namespace

TEST_CASE("a term that a test adds: asked for by its score test, then fitted, with its interval and its name") {
  const std::vector<Trial> logs = bent(21);
  FitOptions o;
  o.restarts = 0;
  add(curvature(), o);

  const Identification without = identify::identify({rig(), logs, o}, truth(), limited());
  REQUIRE(without.trust);
  const ScoreTest* missing = without.trust->tests.missing();
  REQUIRE(missing);
  CHECK(missing->term == "force_curvature");
  CHECK(missing->size == Approx(kCurvature).epsilon(0.2));
  CHECK_FALSE(without.fit.trusted());

  o.terms.nuisance = {"force_curvature"};
  const Identification with = identify::identify({rig(), logs, o}, truth(), limited());
  REQUIRE(with.fit.converged);
  CHECK(with.fit.trusted());
  CHECK(with.fit.rms == Approx(kNoise).epsilon(0.03));
  const Estimate* e = find(with.fit.nuisance, "force_curvature");
  REQUIRE(e);
  CHECK(e->unit == "1/N");
  REQUIRE(e->std);
  INFO(e->value << " +- " << *e->std);
  CHECK(std::abs(e->value - kCurvature) < 4 * *e->std);
  CHECK(*e->std < 0.05 * kCurvature);
  CHECK(with.fit.fitted.back() == "force_curvature");
  for (std::size_t k = 0; k < kConstants; ++k)
    CHECK(std::abs(with.fit.parameters[k].value - kTruth[k]) < 4 * *with.fit.parameters[k].std);
  for (const ScoreTest& t : with.trust->tests.score_tests) CHECK(t.term != "force_curvature");
}

TEST_CASE("a term that a test adds: bounds, priors and derivatives come with the entry") {
  const std::vector<Trial> logs = bent(22);
  FitOptions o;
  o.restarts = 0;
  add(curvature(), o);
  o.terms.nuisance = {"force_curvature"};
  o.terms.upper["force_curvature"] = kCurvature / 2;
  const Fit bounded = fit(rig(), logs, truth(), limited(), o);
  CHECK(find(bounded.nuisance, "force_curvature")->at_bound);
  CHECK(find(bounded.nuisance, "force_curvature")->value == kCurvature / 2);
  o.terms.upper.clear();
  o.terms.priors = {{"force_curvature", 1e-4, 1e-9}};
  CHECK(find(fit(rig(), logs, truth(), limited(), o).nuisance, "force_curvature")->value == Approx(1e-4).epsilon(1e-3));

  // An exact one: the torque limit, of trials that reach it.
  SeaParameters<double> sea = truth();
  sea.tau_max = 15;
  FitOptions exact;
  exact.restarts = 0;
  add(limit(), exact);
  add(curvature(), exact);
  exact.terms.nuisance = {"torque_limit"};
  const std::vector<Trial> clipped = noisy(simulated(shipped(), sea), 23);
  const Fit f = fit(rig(), clipped, truth(), limited(), exact);
  REQUIRE(f.converged);
  const Estimate* e = find(f.nuisance, "torque_limit");
  REQUIRE(e);
  REQUIRE(e->std);
  INFO(e->value << " +- " << *e->std);
  CHECK(std::abs(e->value - 15) < 4 * *e->std);
  CHECK(f.sea.tau_max == e->value);
  const ResidualTests tests = test_residuals({rig(), clipped, exact}, f);  // 16 columns: more than a Jet has slots
  CHECK(tests.score_tests.size() == 15);
  CHECK_FALSE(tests.model_rejected());
}

TEST_CASE("terms that are none, or are asked for twice, are refused by name") {
  using Catch::Matchers::Contains;
  const auto refused = [](auto&& change, const std::string& text) {
    FitOptions o;
    change(o.terms);
    CHECK_THROWS_WITH(o.validate(), Contains(text));
  };
  refused([](auto& t) { t.free = {"k_q"}; }, "k_q");
  refused([](auto& t) { t.free = {}; }, "nothing to fit");
  refused([](auto& t) { t.free = {"friction"}; }, "free: 'friction'");
  refused([](auto& t) { t.nuisance = {"k_p"}; }, "nuisance: 'k_p'");
  refused([](auto& t) { t.nuisance = {"friction", "friction"}; }, "given twice");
  refused([](auto& t) { t.lower["k_p"] = -1; }, "must be at least 0");
  refused([](auto& t) { t.upper["k_p"] = 0; }, "lower < upper");
  refused([](auto& t) { t.priors = {{"friction", 0, 1}}; }, "prior of friction: it is not fitted");
  refused([](auto& t) { t.priors = {{"k_p", 50, 0}}; }, "above 0 is needed");
}

TEST_CASE("terms that no log of these can tell apart: the optional one is held at 0 and named, the fit goes on") {
  // With feedback of the motor and a reference at rest, viscous friction on the motor is k_d by another name.
  SeaParameters<double> sea = truth();
  sea.feedback = Feedback::kMotor, sea.viscous = 0.25;
  const std::vector<Trial> logs = noisy(simulated(shipped(), sea), 5);
  SeaParameters<double> base = limited();
  base.feedback = Feedback::kMotor;
  FitOptions o;
  o.restarts = 0;
  o.terms.nuisance = {"viscous_friction", "output_friction"};
  const Identification found = identify::identify({rig(), logs, o}, truth(), base);
  REQUIRE(found.fit.converged);
  REQUIRE(found.held.size() == 1);
  CHECK(found.held[0].term == "viscous_friction");
  CHECK(found.held[0].others == std::vector<std::string>{"k_d"});
  CHECK_THAT(found.fit.warnings.front(),
             Catch::Matchers::Contains("cannot tell viscous_friction from k_d: viscous_friction is held at 0"));
  CHECK(found.fit.sea.viscous == 0);
  CHECK(find(found.fit.nuisance, "viscous_friction") == nullptr);
  CHECK(find(found.fit.nuisance, "output_friction") != nullptr);
  const Estimate* k_d = find(found.fit.parameters, "k_d");
  REQUIRE((k_d && k_d->std));
  CHECK(std::abs(k_d->value - 1.25) < 4 * *k_d->std);
  CHECK(found.fit.rms == Approx(kNoise).epsilon(0.03));
  // With feedback of the output they are two.
  const Identification apart =
      identify::identify({rig(), noisy(simulated(shipped(), truth()), 5), o}, truth(), limited());
  CHECK(apart.held.empty());
}
