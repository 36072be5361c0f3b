#include "identify/trust/diagnostics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/parallel.hpp"
#include "identify/estimate/statistics.hpp"
#include "identify/fit/replay.hpp"
#include "identify/fit/trial_problem.hpp"
#include "identify/logs/trial_checks.hpp"

namespace ukemi::identify {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The smallest step of a log: its quantum, where it is quantised.
double smallest_step(const std::vector<double>& x) {
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < x.size(); ++i)
    if (const double change = std::abs(x[i] - x[i - 1]); change > 1e-12) step = std::min(step, change);
  return step;
}

/// Whether the log is quantised more coarsely than its residual, which is then the quantum's: neither white nor normal.
bool is_coarse(const ResidualSeries& s) { return smallest_step(*s.measured) > root_mean_square(s.residual); }

/// So many samples of a series count as one: 1 + 2 sum of its autocorrelations, to the first that is not above 0
/// (Geyer's initial positive sequence).
double correlation_time(const std::vector<double>& r) {
  const double square = std::inner_product(r.begin(), r.end(), r.begin(), 0.0);
  double out = 1;
  for (long lag = 1; lag < long(r.size()); ++lag) {
    const double rho = std::inner_product(r.begin() + lag, r.end(), r.begin(), 0.0) / square;
    if (!(rho > 0)) break;
    out += 2 * rho;
  }
  return out;
}

/// By how much coarse logs raise the variance of a sum over residuals; 1 where none is coarse.
double inflation(const std::vector<ResidualSeries>& series) {
  double raised = 0, plain = 0;
  for (const ResidualSeries& s : series) {
    const double square = std::inner_product(s.residual.begin(), s.residual.end(), s.residual.begin(), 0.0);
    plain += square, raised += square * (is_coarse(s) ? correlation_time(s.residual) : 1);
  }
  return plain > 0 ? raised / plain : 1;
}

}  // namespace

std::vector<ResidualSeries> residual_series(const Fit& fit, const std::vector<Trial>& trials) {
  std::vector<ResidualSeries> out;
  for (std::size_t m = 0; m < trials.size(); ++m) {
    const Trial& log = trials[m];
    const TrialResult& r = fit.trials[m];
    if (r.phi.empty() && r.phi_m.empty()) continue;
    const Eigen::VectorXd all = white_residuals(log, r);
    const double* from = all.data();
    for (const std::vector<double>* measured : log.measured()) {
      if (!measured->empty()) out.push_back({{from, from + measured->size()}, measured});
      from += measured->size();
    }
  }
  return out;
}

Whiteness whiteness(const std::vector<ResidualSeries>& series) {
  Whiteness out;
  double q = 0, tested = 0;
  for (const ResidualSeries& s : series) {
    if (is_coarse(s)) continue;
    const double of_series = ljung_box(s.residual, kWhitenessLags);
    if (of_series == 0) continue;
    const std::vector<double>& r = s.residual;
    const double square = std::inner_product(r.begin(), r.end(), r.begin(), 0.0);
    q += of_series, ++tested;
    out.correlation += std::inner_product(r.begin() + 1, r.end(), r.begin(), 0.0) / square;
  }
  if (tested == 0) return out;
  out.correlation /= tested;
  out.p = chi_squared_tail(q, tested * kWhitenessLags);
  return out;
}

Normality normality(const std::vector<ResidualSeries>& series) {
  Normality out;
  Moments pooled;
  for (const ResidualSeries& s : series) {
    if (is_coarse(s)) {
      ++out.coarse;
      continue;
    }
    const Moments m = moments(s.residual);
    pooled.count += m.count;
    pooled.skewness += m.count * m.skewness, pooled.kurtosis += m.count * m.kurtosis;
    ++out.tested;
  }
  if (!(pooled.count > 0)) return out;
  pooled.skewness /= pooled.count, pooled.kurtosis /= pooled.count;
  out.skewness = pooled.skewness, out.kurtosis = pooled.kurtosis;
  out.p = chi_squared_tail(jarque_bera(pooled), 2);
  return out;
}

namespace {

/// Replaces the linear gains of the rejected terms that promise most by those of fits: a term that is far from its
/// absence explains more, or less, than its slope there says. Of many trials eight stand for all.
void fit_gains(const Experiment& experiment, const Fit& fit, ResidualTests& tests) {
  constexpr int kMostShared = 5, kMostOfTrials = 3;
  constexpr std::size_t kMostTrials = 8;
  constexpr int kMostIterations = 12;  // the last digits of a gain do not tell
  const auto worth = [&](std::size_t i) { return tests.worth(tests.score_tests[i]); };
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < tests.score_tests.size(); ++i)
    if (tests.score_tests[i].rejected) candidates.push_back(i);
  if (candidates.size() < 2) return;
  std::sort(candidates.begin(), candidates.end(), [&](std::size_t a, std::size_t b) { return worth(a) > worth(b); });
  // Each kind by itself: what each trial has of its own promises much, in a line, of whatever is missing.
  int shared = 0, of_trials = 0;
  std::erase_if(candidates, [&](std::size_t i) {
    return tests.score_tests[i].scope == Scope::kShared ? ++shared > kMostShared : ++of_trials > kMostOfTrials;
  });
  const std::vector<Trial>& all = experiment.trials;
  std::vector<Trial> some;
  for (std::size_t k = 0; k < std::min(kMostTrials, all.size()); ++k)
    some.push_back(all[k * all.size() / std::min(kMostTrials, all.size())]);
  const double plain =
      some.size() == all.size() ? fit.cost : refit(experiment.rig, some, fit.sea, experiment.options).cost;
  const double share = double(measurements(all)) / double(measurements(some));
  std::vector<double> gain(candidates.size(), 0.0);
  parallel_for(int(candidates.size()), experiment.options.threads, [&](int i) {
    FitOptions with = experiment.options;
    with.max_iterations = std::min(with.max_iterations, kMostIterations);
    with.terms.nuisance.push_back(tests.score_tests[candidates[std::size_t(i)]].term);
    const ScoreTest& test = tests.score_tests[candidates[std::size_t(i)]];
    const RigTerm& term = with.terms[test.term];
    for (const double times : {0.0, kFarFromAbsence}) {
      SeaParameters<double> from = fit.sea;
      if (times > 0 && term.key.empty()) continue;
      if (times > 0) term.set_in(from, times * test.size);
      const Fit f = refit(experiment.rig, some, from, with);
      if (!f.fitted.empty()) gain[std::size_t(i)] = std::max(plain - f.cost, gain[std::size_t(i)] / share) * share;
    }
  });
  for (std::size_t i = 0; i < candidates.size(); ++i) tests.score_tests[candidates[i]].gain = gain[i];
}

}  // namespace

bool ResidualTests::model_rejected() const {
  bool rejected = whiteness.rejected;
  for (const ScoreTest& t : score_tests) rejected = rejected || t.rejected;
  for (std::size_t m = 0; m < chow.size(); ++m) rejected = rejected || disagrees(m);
  return rejected;
}

double ResidualTests::worth(const ScoreTest& test) const {
  return test.gain / score->variance - test.degrees * std::log(samples);
}

const ScoreTest* ResidualTests::missing() const {
  const ScoreTest* best = nullptr;
  for (const ScoreTest& t : score_tests)
    if (t.rejected && (!best || worth(t) > worth(*best))) best = &t;
  return best;
}

double ResidualTests::rms_with(const ScoreTest& test) const {
  return std::sqrt(std::max(score->variance - test.gain / samples, 0.0));
}

ResidualTests test_residuals(const std::vector<ResidualSeries>& series, std::optional<Sensitivity> score) {
  ResidualTests out;
  for (const ResidualSeries& s : series) out.samples += double(s.residual.size());
  out.whiteness = whiteness(series);
  out.normality = normality(series);
  out.score = std::move(score);
  if (out.score) {
    Sensitivity inflated = *out.score;
    out.inflation = inflation(series);
    inflated.variance *= out.inflation;
    out.score_tests = score_tests_of(inflated);
  }
  std::vector<double> p{out.whiteness.p, out.normality.p};
  for (const ScoreTest& l : out.score_tests) p.push_back(l.p);
  const std::vector<bool> rejected = holm(p, kTestLevel);
  out.whiteness.rejected = rejected[0], out.normality.rejected = rejected[1];
  for (std::size_t i = 0; i < out.score_tests.size(); ++i) out.score_tests[i].rejected = rejected[i + 2];
  return out;
}

ResidualTests test_residuals(const Experiment& experiment, const Fit& fit) {
  experiment.validate(fit);
  ResidualTests out = test_residuals(residual_series(fit, experiment.trials), score_of(experiment, fit));
  if (out.score) fit_gains(of_noise(experiment), fit, out);
  return out;
}

void widen_errors(const ResidualTests& tests, Estimates& fit) {
  if (!tests.model_rejected() && !(tests.inflation > 1)) return;
  if (tests.score) {
    const std::vector<int>& free = tests.score->free;
    const Eigen::MatrixXd sandwiched = sandwich(*tests.score);
    Eigen::VectorXd wider(sandwiched.rows());
    Eigen::MatrixXd noise = fit.noise_covariance;
    double widest = 1;
    for (long i = 0; i < sandwiched.rows(); ++i) {
      const double own = noise(free[std::size_t(i)], free[std::size_t(i)]);
      wider[i] = sandwiched(i, i) < own ? std::sqrt(own / sandwiched(i, i)) : 1;
      if (own > 0) widest = std::max(widest, sandwiched(i, i) / own);
    }
    for (long i = 0; i < sandwiched.rows(); ++i)
      for (long j = 0; j < sandwiched.cols(); ++j) {
        double& c = noise(free[std::size_t(i)], free[std::size_t(j)]);
        if (std::isfinite(c)) c = wider[i] * sandwiched(i, j) * wider[j];
      }
    const long parts = long(tests.score->parts.size());
    change_errors(noise, std::max(fit.half_width, t_quantile_975(parts - 1)), Wording::Interval::kRelative, fit);
    for (Estimate& e : fit.nuisance)
      if (e.trial >= 0 && e.std) set_error(e, *e.std * *e.std * widest, *e.std * *e.std * widest, fit.half_width);
  }
  if (tests.model_rejected()) distrust(fit.parameters);
}

void widen_errors(const ResidualTests& tests, Fit& fit) {
  widen_errors(tests, static_cast<Estimates&>(fit));
  if (!fit.converged || fit.far_above_noise || fit.flawed_logs) distrust(fit.parameters);
}

std::vector<Trial> without(std::vector<Trial> trials, std::size_t one) {
  trials.erase(trials.begin() + long(one));
  return trials;
}

Fit refit(const Rig& rig, const std::vector<Trial>& trials, const SeaParameters<double>& from, FitOptions options) {
  options.restarts = options.explore = 0;
  options.monitor.on_progress = nullptr;
  return fit(rig, trials, from, from, options);
}

double deviance(const Fit& fit, const std::vector<Trial>& trials, const FitOptions& options) {
  if (options.weights == FitOptions::Weights::kEqual) {
    const double n = double(measurements(trials));
    return n * std::log(fit.cost / n);
  }
  double sum = 0;
  for (std::size_t m = 0; m < trials.size(); ++m)
    sum += double(trials[m].measurements()) * 2 * std::log(fit.trials[m].rms);
  return sum;
}

double held_out_rms(const Rig& rig, const Trial& trial, const Fit& fit, const FitOptions& options) {
  const std::vector<Trial> one{trial};
  const std::vector<PreparedTrial> prepared{PreparedTrial(one.front())};
  const std::vector<Weighting> weights(1);
  LeastSquaresProblem problem = make_problem(rig, prepared, weights, fit.sea, suggest(rig, one),
                                             RigLayout(options.terms), options, options.rollout());
  problem.priors.clear();  // they pull what is held
  const auto fitted = fit.globals();
  Eigen::VectorXd globals(long(fitted.size()));
  for (std::size_t g = 0; g < fitted.size(); ++g) problem.globals[g].start = globals[long(g)] = fitted[g]->value;
  problem.hold_globals();
  double cost = kNaN;
  if (problem.locals.empty()) {
    cost = cost_at(problem, {}, globals);
  } else if (const auto s = solve(problem, {}); s.usable) {
    cost = s.cost;
  }
  return std::isfinite(cost) ? std::sqrt(cost / double(trial.measurements())) : kNaN;
}

std::vector<LeftOut> leave_one_out(const Experiment& experiment, const Fit& fit, int threads) {
  experiment.validate(fit);
  const std::vector<Trial>& trials = experiment.trials;
  const FitOptions& options = experiment.options;
  if (trials.size() < 2) return {};
  std::vector<LeftOut> out(trials.size());
  parallel_for(int(trials.size()), threads, [&](int i) {
    const auto m = std::size_t(i);
    LeftOut& l = out[m];
    l.file = trials[m].file;
    const std::vector<Trial> others = without(trials, m);
    l.fit = refit(experiment.rig, others, fit.sea, options);
    for (std::size_t k = 0; k < fit.parameters.size(); ++k)
      l.shift.push_back(fit.parameters[k].std  // the rig's errors are those of all trials
                            ? (l.fit.parameters[k].value - fit.parameters[k].value) / *fit.parameters[k].std_noise
                            : kNaN);
    l.held_out = held_out_rms(experiment.rig, trials[m], l.fit, options);
    const std::vector<Trial> alone{trials[m]};
    const Fit own = refit(experiment.rig, alone, fit.sea, options);
    const double together = deviance(fit, trials, options), n = double(measurements(trials));
    const double apart = options.weights == FitOptions::Weights::kEqual  // one variance for both
                             ? n * std::log((l.fit.cost + own.cost) / n)
                             : deviance(l.fit, others, options) + deviance(own, alone, options);
    if (std::isfinite(apart)) l.p = chi_squared_tail(together - apart, double(fit.fitted.size()));
    l.disagrees = l.p * double(trials.size()) < kTestLevel;
  });
  return out;
}

}  // namespace ukemi::identify
