// What leaves the program as trusted: logs of eight hits from an independent simulator (test/joint_simulator.hpp) with
// effects that the model lacks. 500 Hz, 1 mrad.
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/logs/hits.hpp"
#include "identify/trust/diagnostics.hpp"
#include "test/joint_simulator.hpp"

using namespace ukemi;
using namespace ukemi::identify;
using namespace test;

namespace {

struct Judged {
  Fit fit;
  ResidualTests tests;
  double plain = 0,
         widened = 0;  ///< largest error of a constant in its own standard errors, without and with the tests
};

/// Fits and tests as `ukemi identify` does, from Table 2.
Judged judged(const std::vector<Trial>& logs, const FitOptions& options = {}) {
  Judged out{.fit = refit(rig(), logs, truth(), options), .tests = {}};
  REQUIRE(out.fit.converged);
  out.plain = worst_error(out.fit);
  out.tests = test_residuals({rig(), logs, options}, out.fit);
  widen_errors(out.tests, out.fit);
  out.widened = worst_error(out.fit);
  return out;
}

std::string told(const Judged& j) {
  std::string text = std::to_string(j.plain) + " s.e. off, " + std::to_string(j.widened) + " of the widened; " +
                     (j.fit.trusted() ? "TRUSTED" : "not trusted") + "; white p " + std::to_string(j.tests.whiteness.p);
  for (std::size_t i = 0; i < j.tests.score_tests.size(); ++i)
    text += std::string("\n  ") + j.tests.score_tests[i].term + " chi2 " +
            std::to_string(j.tests.score_tests[i].statistic) + " of " + std::to_string(j.tests.score_tests[i].degrees) +
            (j.tests.score_tests[i].rejected ? " rejected" : "") + " size " +
            std::to_string(j.tests.score_tests[i].size);
  if (const ScoreTest* l = j.tests.missing()) text += std::string("\n  missed: ") + l->term;
  return text;
}

void check_not_wrong(const Judged& j) {
  INFO(told(j));
  CHECK((!j.fit.trusted() || j.widened <= 3));
}

}  // namespace

TEST_CASE("eight good hits of another simulator are trusted") {
  const int n = draws(20);
  int trusted = 0, within = 0;
  for (int d = 0; d < n; ++d) {
    const Judged j = judged(eight_hits({}, 100 + std::uint64_t(d)));
    INFO("draw " << d << ": " << told(j));
    trusted += j.fit.trusted(), within += j.plain <= 3;
    CHECK((j.fit.trusted() || j.tests.model_rejected()));
  }
  INFO(trusted << " trusted, " << within << " within 3 standard errors of " << n);
  CHECK(trusted >= n - std::max(1.0, 0.03 * n));
  CHECK(within >= n - std::max(1.0, 0.03 * n));
}

TEST_CASE("what the model lacks is never trusted and wrong") {
  for (std::uint64_t seed = 1; seed <= std::uint64_t(draws(3)); ++seed) {
    const Judged viscous = judged(eight_hits({.viscous = 0.1}, seed));
    INFO("viscous: " << told(viscous));
    CHECK(viscous.plain > 10);
    CHECK_FALSE(viscous.fit.trusted());
    REQUIRE(viscous.tests.missing());
    CHECK(viscous.tests.missing()->term == "viscous_friction");
    CHECK(viscous.tests.missing()->size == Approx(0.1).epsilon(0.2));

    const Judged gain = judged(eight_hits({.force_gain = 1.03}, seed));
    INFO("gain: " << told(gain));
    CHECK(gain.plain > 10);
    CHECK_FALSE(gain.fit.trusted());
    REQUIRE(gain.tests.missing());
    CHECK(gain.tests.missing()->term == "force_gain");

    check_not_wrong(judged(eight_hits({.load_cell = 0.5}, seed)));

    std::vector<Trial> gap = eight_hits({}, seed);
    drop_rows(gap[4], 38, 13);
    const Judged lost = judged(gap);
    INFO("rows missing: " << told(lost));
    CHECK_FALSE(lost.fit.trusted());
    CHECK(lost.fit.flawed_logs);
  }
}

TEST_CASE("the term that was named, fitted along: trusted again, and right") {
  const std::pair<Effects, std::string> cases[] = {{{.viscous = 0.1}, "viscous_friction"},
                                                   {{.dry = 0.3}, "friction"},  // it sticks there, and here
                                                   {{.force_gain = 1.03}, "force_gain"}};
  for (const auto& [effects, term] : cases) {
    FitOptions with;
    with.terms.nuisance = {term};
    const Judged j = judged(eight_hits(effects, 5), with);
    INFO(term << ": " << told(j));
    CHECK(j.fit.trusted());
    CHECK(j.plain < 3.5);
    const Estimate& e = j.fit.nuisance.at(0);
    const double expected = term == "viscous_friction" ? 0.1 : term == "friction" ? 0.3 : 1 / 1.03;
    CHECK(std::abs(e.value - expected) < 3.5 * *e.std);
  }
}

TEST_CASE("load-cell noise: at rest between hits, weighed within them") {
  const int n = draws(20);
  int trusted = 0, within = 0;
  for (int d = 0; d < n; ++d) {
    std::vector<Trial> logs = eight_hits({.load_cell = 0.5}, 300 + std::uint64_t(d));
    for (Trial& t : logs) flatten_force_between_hits(t, d % 2 ? std::optional(0.5) : std::nullopt);
    for (const Trial& t : logs) CHECK(t.force_noise == Approx(0.5).epsilon(0.5));
    const Judged j = judged(logs);
    INFO("draw " << d << ": " << told(j));
    check_not_wrong(j);
    trusted += j.fit.trusted(), within += j.plain <= 3;
  }
  INFO(trusted << " trusted, " << within << " within 3 standard errors of " << n);
  CHECK(trusted >= n - std::max(1.0, 0.03 * n));
  CHECK(within >= n - std::max(1.0, 0.05 * n));
}

TEST_CASE("1.2 s at 10 kHz with 0.02 N of load-cell noise fits, as it is logged and at rest between hits") {
  Trial log;
  log.file = "fast";
  Random random(4);
  for (int i = 0; i <= 12'000; ++i) {
    log.t.push_back(i * 1e-4);
    const double s = (log.t.back() - 0.05) / 0.02;
    log.force.push_back(s > 0 && s < 1 ? 120 * std::sin(std::numbers::pi * s) : 0);
  }
  log.phi = joint_angle(log.t, log.force, {});
  for (double& x : log.phi) x += kNoise * random.normal();
  for (double& x : log.force) x += 0.02 * random.normal();
  Trial quiet = log;
  flatten_force_between_hits(quiet);
  for (const Trial* t : {&log, &quiet}) {
    const Fit f = refit(rig(), {*t}, truth(), {});
    INFO(f.message << ", " << worst_error(f) << " s.e. off");
    CHECK(f.converged);
    CHECK(worst_error(f) < 4);
  }
}

TEST_CASE("the monitor is told of starts and ends a fit, the best so far kept") {
  const auto logs = eight_hits({}, 9);
  std::atomic<long> told{0}, asked{0};
  FitOptions o;
  o.explore = 6, o.threads = 1;
  o.monitor.on_progress = [&](long done, long total) {
    CHECK(done <= total);
    CHECK(total == 6);
    ++told;
  };
  const Fit whole = fit(rig(), logs, std::nullopt, limited(), o);
  CHECK(told == 6);
  CHECK_FALSE(whole.interrupted);
  o.explore = 0, o.monitor = {{}, [&] { return ++asked > 30; }};
  const SeaParameters<double> start = limited({60, 1.2, 80, 1.2, 0.1});
  const Fit ended = fit(rig(), logs, start, limited(), o);
  CHECK(ended.interrupted);
  CHECK_FALSE(ended.converged);
  REQUIRE_FALSE(ended.fitted.empty());
  CHECK(ended.cost < predict(rig(), logs, start).cost);
}
