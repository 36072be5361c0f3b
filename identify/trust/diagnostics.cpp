#include "identify/trust/diagnostics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

/// Whether the log is quantised more coarsely than its residual, which is then neither white nor normal.
bool is_coarse(const ResidualSeries& s) { return smallest_step(*s.measured) > root_mean_square(s.residual); }

/// Integrated autocorrelation time [samples]: 1 + 2 sum of the autocorrelations before the first that is not above 0
/// (Geyer's initial positive sequence).
double correlation_time(const std::vector<double>& r) {
  const double square = lagged_product(r, 0);
  double out = 1;
  for (std::size_t lag = 1; lag < r.size(); ++lag) {
    const double rho = lagged_product(r, lag) / square;
    if (!(rho > 0)) break;
    out += 2 * rho;
  }
  return out;
}

/// Factor by which coarse logs raise the variance of a sum over residuals; 1 where none is coarse.
double inflation(const std::vector<ResidualSeries>& series) {
  double raised = 0, plain = 0;
  for (const ResidualSeries& s : series) {
    const double square = lagged_product(s.residual, 0);
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
    const double series_q = ljung_box(s.residual, kWhitenessLags);
    if (series_q == 0) continue;
    q += series_q, ++tested;
    out.correlation += lagged_product(s.residual, 1) / lagged_product(s.residual, 0);
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

/// Replaces the linear gains of the rejected terms of largest `worth` by those of fits: a term far from its absent
/// value explains more, or less, than its gradient there predicts. Of many trials a sample of eight is used.
void fit_gains(const Experiment& experiment, const Fit& fit, ResidualTests& tests) {
  constexpr int kMaxShared = 5, kMaxPerTrial = 3;
  constexpr std::size_t kMaxTrials = 8;
  constexpr int kMaxIterations = 12;  // the last digits of a gain do not matter
  const auto worth = [&](std::size_t i) { return tests.worth(tests.score_tests[i]); };
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < tests.score_tests.size(); ++i)
    if (tests.score_tests[i].rejected) candidates.push_back(i);
  if (candidates.size() < 2) return;
  std::sort(candidates.begin(), candidates.end(), [&](std::size_t a, std::size_t b) { return worth(a) > worth(b); });
  // Each scope by itself: the linear gain of per-trial terms is large whatever is missing.
  int shared = 0, per_trial = 0;
  std::erase_if(candidates, [&](std::size_t i) {
    return tests.score_tests[i].scope == Scope::kShared ? ++shared > kMaxShared : ++per_trial > kMaxPerTrial;
  });
  const std::vector<Trial>& all = experiment.trials;
  std::vector<Trial> sampled;
  for (std::size_t k = 0; k < std::min(kMaxTrials, all.size()); ++k)
    sampled.push_back(all[k * all.size() / std::min(kMaxTrials, all.size())]);
  const double plain_cost =
      sampled.size() == all.size() ? fit.cost : refit(experiment.rig, sampled, fit.sea, experiment.options).cost;
  const double scale = double(measurements(all)) / double(measurements(sampled));
  std::vector<double> gain(candidates.size(), 0.0);
  parallel_for(int(candidates.size()), experiment.options.threads, [&](int i) {
    FitOptions options = experiment.options;
    options.max_iterations = std::min(options.max_iterations, kMaxIterations);
    options.terms.nuisance.push_back(tests.score_tests[candidates[std::size_t(i)]].term);
    const ScoreTest& test = tests.score_tests[candidates[std::size_t(i)]];
    const RigTerm& term = options.terms[test.term];
    for (const double factor : {0.0, kFarFromAbsence}) {
      SeaParameters<double> from = fit.sea;
      if (factor > 0 && term.key.empty()) continue;
      if (factor > 0) term.set_in(from, factor * test.size);
      const Fit f = refit(experiment.rig, sampled, from, options);
      if (!f.fitted.empty()) gain[std::size_t(i)] = std::max(plain_cost - f.cost, gain[std::size_t(i)] / scale) * scale;
    }
  });
  for (std::size_t i = 0; i < candidates.size(); ++i) tests.score_tests[candidates[i]].gain = gain[i];
}

}  // namespace

bool ResidualTests::model_rejected() const {
  if (whiteness.rejected) return true;
  for (std::size_t m = 0; m < chow.size(); ++m)
    if (disagrees(m)) return true;
  return std::any_of(score_tests.begin(), score_tests.end(), [](const ScoreTest& t) { return t.rejected; });
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
  if (out.score) fit_gains(noise_only(experiment), fit, out);
  return out;
}

void widen_errors(const ResidualTests& tests, Estimates& fit) {
  if (!tests.model_rejected() && !(tests.inflation > 1)) return;
  if (tests.score) {
    const std::vector<int>& free = tests.score->free;
    const Eigen::MatrixXd robust = sandwich(*tests.score);
    Eigen::VectorXd factor(robust.rows());
    Eigen::MatrixXd noise = fit.noise_covariance;
    double widest = 1;
    for (long i = 0; i < robust.rows(); ++i) {
      const double noise_variance = noise(free[std::size_t(i)], free[std::size_t(i)]);
      factor[i] = robust(i, i) < noise_variance ? std::sqrt(noise_variance / robust(i, i)) : 1;
      if (noise_variance > 0) widest = std::max(widest, robust(i, i) / noise_variance);
    }
    for (long i = 0; i < robust.rows(); ++i)
      for (long j = 0; j < robust.cols(); ++j) {
        double& c = noise(free[std::size_t(i)], free[std::size_t(j)]);
        if (std::isfinite(c)) c = factor[i] * robust(i, j) * factor[j];
      }
    const long parts = long(tests.score->parts.size());
    update_errors(noise, std::max(fit.half_width, t_quantile_975(parts - 1)), Wording::Interval::kRelative, fit);
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
    sum += double(trials[m].measurements()) * 2 * std::log(white_rms(trials[m], fit.trials[m]));
  return sum;
}

double held_out_rms(const Rig& rig, const Trial& trial, const Fit& fit, const FitOptions& options) {
  const std::vector<Trial> one{trial};
  const std::vector<PreparedTrial> prepared{PreparedTrial(one.front())};
  const std::vector<Weighting> weights(1);
  LeastSquaresProblem problem = make_problem(rig, prepared, weights, fit.sea, suggest(rig, one),
                                             RigLayout(options.terms), options, options.rollout());
  problem.priors.clear();  // they would pull at held globals
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
      l.shift.push_back(fit.parameters[k].std  // not `std`: the rig's errors are common to all trials
                            ? (l.fit.parameters[k].value - fit.parameters[k].value) / *fit.parameters[k].std_noise
                            : kNaN);
    l.held_out = held_out_rms(experiment.rig, trials[m], l.fit, options);
    const std::vector<Trial> alone{trials[m]};
    const Fit own = refit(experiment.rig, alone, fit.sea, options);
    const double joint = deviance(fit, trials, options), n = double(measurements(trials));
    const double separate = options.weights == FitOptions::Weights::kEqual  // one variance for both
                                ? n * std::log((l.fit.cost + own.cost) / n)
                                : deviance(l.fit, others, options) + deviance(own, alone, options);
    if (std::isfinite(separate)) l.p = chi_squared_tail(joint - separate, double(fit.fitted.size()));
    l.disagrees = l.p * double(trials.size()) < kTestLevel;
  });
  return out;
}

}  // namespace ukemi::identify
