// How far a fit can be trusted, checked against what is true. The draws are simulated here: the hits of
// datasets/impact, the rollout itself with Table 2, and 0.5 mrad of normal noise, seeded.
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/design/design.hpp"
#include "identify/estimate/statistics.hpp"
#include "identify/trust/ladder.hpp"
#include "identify/trust/profile.hpp"
#include "test/impact.hpp"

using namespace ukemi;
using namespace ukemi::identify;
using namespace test;

namespace {

/// The truth, with dry friction [Nm].
SeaParameters<double> rubbing(double friction) {
  SeaParameters<double> sea = truth();
  sea.friction = friction;
  return sea;
}

/// A half-sine hit from 0.05 s on, sampled at 1 kHz for 0.5 s.
Trial hit(double newton, double seconds) {
  Trial out = blank_log({newton, seconds}, {.duration = 0.5});
  out.file = "hit";
  return out;
}

}  // namespace

TEST_CASE("tails of the chi-squared distribution, against the tables") {
  CHECK(chi_squared_tail(3.841458820694124, 1) == Approx(0.05).epsilon(1e-10));
  CHECK(chi_squared_tail(5.991464547107979, 2) == Approx(0.05).epsilon(1e-10));
  CHECK(chi_squared_tail(3, 2) == Approx(std::exp(-1.5)).epsilon(1e-12));
  CHECK(chi_squared_tail(124.342113404004, 100) == Approx(0.05).epsilon(1e-9));
  CHECK(chi_squared_tail(0, 3) == 1);
  CHECK(at_bound_tail(2.705543454095404, 1) == Approx(0.05).epsilon(1e-10));
  CHECK(at_bound_tail(3, 2) == Approx(0.5 * chi_squared_tail(3, 1) + 0.25 * std::exp(-1.5)).epsilon(1e-12));
}

TEST_CASE("white noise is called coloured in 1 % of draws, and non-normal in 1 %") {
  constexpr int kDraws = 2000, kSamples = 1000, kSeries = 8;
  int coloured = 0, odd = 0;
  for (int d = 0; d < kDraws; ++d) {
    double q = 0;
    Moments pooled{.count = kSamples * kSeries};
    for (int s = 0; s < kSeries; ++s) {
      Random random(41, std::uint64_t(d * kSeries + s));
      std::vector<double> x(kSamples);
      for (double& v : x) v = random.normal();
      q += ljung_box(x, kWhitenessLags);
      const Moments m = moments(x);
      pooled.skewness += m.skewness / kSeries, pooled.kurtosis += m.kurtosis / kSeries;
    }
    coloured += chi_squared_tail(q, kSeries * kWhitenessLags) < kTestLevel;
    odd += chi_squared_tail(jarque_bera(pooled), 2) < kTestLevel;
  }
  INFO(coloured << " coloured, " << odd << " non-normal of " << kDraws);
  // 20 expected; 4.45 is the binomial standard deviation.
  CHECK(std::abs(coloured - 20) < 4 * 4.45);
  CHECK(std::abs(odd - 20) < 4 * 4.45);
}

TEST_CASE("200 draws of the eight trials: each 95 % interval covers the truth in 91 to 98.5 %") {
  const auto exact = simulated(shipped(), truth());
  const int n = draws(200);
  std::array<int, kConstants> covered{};
  int trusted = 0, coloured = 0, odd = 0, lacking = 0, any = 0;
  for (int d = 0; d < n; ++d) {
    const auto trials = noisy(exact, 1000 + std::uint64_t(d));
    const Fit f = refit(rig(), trials, truth(), {});
    REQUIRE(f.converged);
    for (std::size_t k = 0; k < kConstants; ++k)
      covered[k] += f.parameters[k].ci_low <= kTruth[k] && kTruth[k] <= f.parameters[k].ci_high;
    trusted += f.trusted();
    const ResidualTests tests = test_residuals({rig(), trials, {}}, f);
    coloured += tests.whiteness.rejected;
    odd += tests.normality.rejected;
    lacking += tests.missing() != nullptr;
    any += tests.model_rejected() || tests.normality.rejected;
  }
  INFO("covered " << covered[0] << " " << covered[1] << " " << covered[2] << " " << covered[3] << " " << covered[4]
                  << "; coloured " << coloured << ", not normal " << odd << ", lacking " << lacking << ", any " << any
                  << " of " << n);
  for (const int c : covered) {
    CHECK(c >= 0.91 * n);
    CHECK(c <= 0.985 * n);
  }
  CHECK(trusted == n);
  CHECK(any <= 0.03 * n);  // 1 % expected, of all tests together; 0.7 % is the binomial standard deviation of 200 draws
}

TEST_CASE("dry friction of 0.2 Nm that the model lacks is named in 95 % of draws, and in 4 % where there is none") {
  const int n = draws(20), ladder_each = n > 20 ? 1 : 10;
  for (const double friction : {0.2, 0.0}) {
    const auto exact = simulated(shipped(), rubbing(friction));
    int by_score = 0, by_ladder = 0, ladders = 0, coloured = 0;
    for (int d = 0; d < n; ++d) {
      const auto trials = noisy(exact, 5000 + std::uint64_t(d));
      const Fit f = refit(rig(), trials, truth(), {});
      REQUIRE(f.converged);
      const ResidualTests tests = test_residuals({rig(), trials, {}}, f);
      by_score += tests.missing() && tests.missing()->term == "friction";
      coloured += tests.whiteness.rejected;
      if (d % ladder_each != 0) continue;  // which takes refits of many times a plain fit's cost
      const Ladder rungs = ladder({rig(), trials, {}}, f, HeldOut::kSkip);
      INFO(rungs.rungs[1].name << ": " << rungs.rungs[1].fit.message);
      REQUIRE(rungs.rungs[1].fit.converged);
      ++ladders, by_ladder += rungs.plain_rejected();
      if (friction > 0) CHECK(rungs.rungs[rungs.preferred].name.find("friction") == 0);
    }
    INFO("friction " << friction << ": named by the score test in " << by_score << ", residuals coloured in "
                     << coloured << " of " << n << "; by the ladder in " << by_ladder << " of " << ladders);
    if (friction > 0) {
      CHECK(by_score >= 0.95 * n);
      CHECK(coloured >= 0.95 * n);
      CHECK(by_ladder >= 0.95 * ladders);
    } else {  // of few draws, one may be among the 1 %
      CHECK(by_score <= std::max(0.04 * n, 1.0));
      CHECK(coloured <= std::max(0.04 * n, 1.0));
      CHECK(by_ladder <= std::max(0.04 * ladders, 1.0));
    }
  }
}

TEST_CASE("verdicts: the stated thresholds, at them and beyond") {
  const auto verdict = [](double half_width) {
    Estimate e{.name = "k", .value = -8, .std = {}};  // 10 % and 50 % of it are exact numbers
    set_error(e, half_width * half_width / 4, 0, 2);
    return judge(e);
  };
  CHECK(verdict(0.79) == Identifiability::kTrusted);
  CHECK(verdict(0.81) == Identifiability::kWeak);
  CHECK(verdict(4) == Identifiability::kWeak);
  CHECK(verdict(4.01) == Identifiability::kNotIdentifiable);
  Estimate e{.name = "k", .value = 8, .std = {}};
  CHECK(judge(e) == Identifiability::kNotIdentifiable);
  e.at_bound = true;
  CHECK(judge(e) == Identifiability::kAtBound);
  e.free = false;
  CHECK(judge(e) == Identifiability::kFixed);

  std::vector<Estimate> all(2);
  all[0].verdict = Identifiability::kTrusted;
  CHECK(all_trusted(all));
  distrust(all);
  CHECK(all[0].verdict == Identifiability::kWeak);
  CHECK(all[1].verdict == Identifiability::kFixed);
  CHECK_FALSE(all_trusted(all));
}

TEST_CASE("two weak hits alike: not trusted, and the direction they know least does to the angles what is said") {
  const auto trials = noisy(simulated({hit(1, 0.02), hit(1, 0.02)}, truth()), 3);
  const Fit f = refit(rig(), trials, truth(), {});
  REQUIRE(f.converged);
  CHECK_FALSE(f.trusted());
  REQUIRE(f.weakest.has_value());
  const Weakest& w = *f.weakest;
  REQUIRE(w.change.size() == 5);
  const std::string words = in_words(w, "trials", "the angles", "rad");
  INFO(words);
  CHECK(words.find("these trials tell least apart") == 0);
  CHECK(std::count(f.warnings.begin(), f.warnings.end(), words) == 1);
  CHECK(w.noise == Approx(kNoise).epsilon(0.1));
  // A hundredth of the change: so small that the angles move in proportion.
  auto u = ukemi::constants(f.sea);
  for (const auto& [name, change] : w.change) {
    const auto k = std::size_t(std::find(kConstantNames.begin(), kConstantNames.end(), name) - kConstantNames.begin());
    u[k] *= 1 + 0.01 * change;
  }
  SeaParameters<double> moved = f.sea;
  set_constants(moved, u);
  const Fit before = predict(rig(), trials, f.sea), after = predict(rig(), trials, moved);
  double square = 0, n = 0;
  for (std::size_t m = 0; m < trials.size(); ++m)
    for (std::size_t i = 0; i < trials[m].samples(); ++i, ++n)
      square += std::pow(after.trials[m].phi[i] - before.trials[m].phi[i], 2);
  CHECK(std::sqrt(square / n) == Approx(0.01 * w.rms).epsilon(0.05));
  CHECK(w.rms < 0.1 * w.noise);
}

TEST_CASE("coloured and heavy-tailed noise are said, quantised logs are no outliers") {
  const auto exact = simulated(shipped(), truth());
  auto coloured = exact, heavy = exact, quantised = noisy(exact, 5);
  for (std::size_t m = 0; m < exact.size(); ++m) {
    Random random(8, m);
    double ar = 0;
    for (std::size_t i = 0; i < exact[m].samples(); ++i) {
      ar = 0.3 * ar + kNoise * random.normal();
      coloured[m].phi[i] += ar;
      heavy[m].phi[i] += kNoise * random.normal() * (random.uniform() < 0.02 ? 5 : 1);
      quantised[m].phi[i] = 5e-3 * std::round(quantised[m].phi[i] / 5e-3);
    }
  }
  const Fit c = refit(rig(), coloured, truth(), {}), h = refit(rig(), heavy, truth(), {}),
            q = refit(rig(), quantised, truth(), {});
  CHECK(whiteness(residual_series(c, coloured)).p < kTestLevel);
  CHECK(whiteness(residual_series(c, coloured)).correlation == Approx(0.3).epsilon(0.15));
  CHECK(whiteness(residual_series(h, heavy)).p > kTestLevel);
  CHECK(normality(residual_series(h, heavy)).p < kTestLevel);
  CHECK(normality(residual_series(h, heavy)).kurtosis > 1);
  CHECK(normality(residual_series(q, quantised)).coarse == 8);
  CHECK(normality(residual_series(q, quantised)).p > kTestLevel);
}

TEST_CASE("a trial whose force reads 3 % high is named when it is left out, and none is where all are right") {
  auto trials = shipped();
  Fit f = refit(rig(), trials, truth(), {});
  for (const LeftOut& l : leave_one_out({rig(), trials, {}}, f)) {
    INFO(l.file << " p " << l.p);
    CHECK_FALSE(l.disagrees);
    CHECK(l.fit.converged);
    CHECK(l.held_out == Approx(kNoise).epsilon(0.1));
    for (const double s : l.shift) CHECK(std::abs(s) < 3);
  }
  for (double& x : trials[3].force) x *= 1.03;
  f = refit(rig(), trials, truth(), {});
  const auto left = leave_one_out({rig(), trials, {}}, f, 2);
  for (std::size_t m = 0; m < left.size(); ++m) {
    INFO(left[m].file << " p " << left[m].p);
    CHECK(left[m].held_out >= 0.9 * kNoise);
    if (m != 3) CHECK(left[m].p > left[3].p);
  }
  CHECK(left[3].disagrees);
  CHECK(left[3].held_out > 1.5 * kNoise);
}

TEST_CASE("profile likelihood: the linear interval where the trials are good, its own where they are weak") {
  const auto trials = shipped();
  const Fit f = refit(rig(), trials, truth(), {});
  const Profile p = profile({rig(), trials, {}}, f, "k_sea", {.points = 13});
  const Estimate& e = f.parameters[2];
  REQUIRE(p.low.has_value());
  REQUIRE(p.high.has_value());
  CHECK(*p.low == Approx(e.ci_low).margin(0.02 * e.half_width()));
  CHECK(*p.high == Approx(e.ci_high).margin(0.02 * e.half_width()));
  CHECK(p.rise[6] == 0);
  CHECK(p.rise.front() == Approx(9).epsilon(0.05));
  CHECK(std::is_sorted(p.value.begin(), p.value.end()));
  // An error of the rig widens both ends, by as much as it widens the linear interval.
  Rig rough = rig();
  rough.errors.inertia = 0.05;
  const Fit of_rough = refit(rough, trials, truth(), {});
  const Estimate& wide = of_rough.parameters[2];
  REQUIRE(wide.half_width() > 1.5 * e.half_width());
  const Profile r = profile({rough, trials, {}}, of_rough, "k_sea", {.points = 13});
  REQUIRE(r.low.has_value());
  REQUIRE(r.high.has_value());
  CHECK(*r.low == Approx(wide.ci_low).margin(0.02 * wide.half_width()));
  CHECK(*r.high == Approx(wide.ci_high).margin(0.02 * wide.half_width()));
  CHECK(*r.low_noise == Approx(*p.low).margin(0.02 * e.half_width()));

  const auto weak = noisy(simulated({hit(1, 0.02), hit(1, 0.02)}, truth()), 3);
  const Fit g = refit(rig(), weak, truth(), {});
  const Profile q = profile({rig(), weak, {}}, g, "k_sea");
  INFO(g.parameters[2].value << " linear " << g.parameters[2].ci_low << " " << g.parameters[2].ci_high << " profile "
                             << q.low.value_or(-1) << " " << q.high.value_or(-1));
  REQUIRE(q.low.has_value());
  // At the end of the interval the other constants, fitted afresh, leave the rise that was asked for.
  FitOptions held;
  std::erase(held.terms.free, "k_sea");
  SeaParameters<double> at = g.sea;
  at.k_sea = *q.low;
  const double rise = deviance(refit(rig(), weak, at, held), weak, held) - deviance(g, weak, {});
  CHECK(rise == Approx(q.threshold).epsilon(0.02));
  CHECK(std::abs(*q.low - g.parameters[2].ci_low) > 0.1 * g.parameters[2].half_width());
  CHECK_THROWS_WITH(profile({rig(), trials, {}}, f, "k_q"), "profile: 'k_q': no such constant");
}

TEST_CASE("a measured arm: the ladder prefers dry friction and rejects the model without") {
  const auto arm = measured_arm();
  if (!arm) return;
  FitOptions o;
  o.terms.nuisance = {"initial_angle"};
  const Fit plain = fit(arm->rig, arm->log, std::nullopt, arm->base, o);
  const Ladder l = ladder({arm->rig, arm->log, o}, plain, HeldOut::kCompute);
  CHECK(l.rungs[l.preferred].name.find("friction") == 0);
  const Rung& friction = l.rungs[1];  // what plain fits know of this arm is without stiffening
  REQUIRE(friction.name == "friction");
  INFO("rms " << friction.fit.rms);
  CHECK(friction.fit.sea.friction == Approx(0.07).epsilon(0.3));
  CHECK(l.plain_rejected());
  CHECK(std::isnan(l.rungs[0].held_out));  // one trial: nothing to hold out
  CHECK(leave_one_out({arm->rig, arm->log, o}, plain).empty());
}
