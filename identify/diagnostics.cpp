#include "identify/diagnostics.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/parallel.hpp"
#include "identify/statistics.hpp"
#include "identify/trial_problem.hpp"

namespace ukemi::identify {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Residuals of one output of one trial, and the log they are of.
struct Series {
  std::vector<double> residual;
  const std::vector<double>* measured;
};

std::vector<Series> residuals(const Fit& fit, const std::vector<Trial>& trials) {
  std::vector<Series> out;
  const auto add = [&](const std::vector<double>& predicted, const std::vector<double>& measured) {
    if (predicted.empty() || measured.empty()) return;
    Series s{std::vector<double>(measured.size()), &measured};
    for (std::size_t i = 0; i < measured.size(); ++i) s.residual[i] = predicted[i] - measured[i];
    out.push_back(std::move(s));
  };
  for (std::size_t m = 0; m < trials.size(); ++m)
    add(fit.trials[m].phi, trials[m].phi), add(fit.trials[m].phi_m, trials[m].phi_motor);
  return out;
}

/// The smallest step of a log: its quantum, where it is quantised.
double smallest_step(const std::vector<double>& x) {
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < x.size(); ++i)
    if (const double change = std::abs(x[i] - x[i - 1]); change > 1e-12) step = std::min(step, change);
  return step;
}

double root_mean_square(const std::vector<double>& x) {
  return std::sqrt(std::inner_product(x.begin(), x.end(), x.begin(), 0.0) / double(x.size()));
}

/// The fitted globals, in the problem's order.
std::vector<const Estimate*> globals_of(const Fit& fit) {
  std::vector<const Estimate*> out;
  for (const Estimate& e : fit.parameters)
    if (e.free) out.push_back(&e);
  for (const Estimate& e : fit.nuisance)
    if (e.trial < 0) out.push_back(&e);
  return out;
}

LeastSquaresProblem problem_of(const Rig& rig, const std::vector<Trial>& trials,
                               const std::vector<PreparedTrial>& prepared, const SeaParameters<double>& sea,
                               const FitOptions& options) {
  return make_problem(rig, prepared, std::vector<double>(trials.size(), 1.0), sea, suggest(rig, trials),
                      Layout(options), options, options.rollout());
}

/// The scores of the last globals of `problem`, absent from the fit: how steeply the cost falls as each rises from 0
/// while the others stay away.
std::vector<Lack> scores(const LeastSquaresProblem& problem, const Fit& fit, const std::vector<double>& weights) {
  const auto fitted = globals_of(fit);
  const int G = int(problem.globals.size()), L = int(problem.locals.size()), A = G - int(fitted.size());
  std::vector<double> global(std::size_t(G), 0.0);
  std::vector<int> free;  // one at its bound does not follow
  for (std::size_t g = 0; g < fitted.size(); ++g) {
    global[g] = fitted[g]->value;
    if (!fitted[g]->at_bound) free.push_back(int(g));
  }
  const int F = int(free.size());
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(F + A + 1, F + A + 1);  // of [J, terms, residual], locals eliminated
  double sum = 0, count = 0;
  std::vector<Lack> out(static_cast<std::size_t>(A));
  for (std::size_t m = 0; m < problem.blocks.size(); ++m) {
    std::vector<double> local;
    for (const Estimate& e : fit.nuisance)
      if (e.trial == int(m)) local.push_back(e.value);
    const int n = problem.blocks[m].size;
    Eigen::VectorXd r(n);
    Eigen::MatrixXd jacobian(n, G + L);
    if (!problem.blocks[m].evaluate(global.data(), local.data(), r.data(), jacobian.data())) return out;
    Eigen::MatrixXd all(n, F + A + 1);
    const auto jl = jacobian.rightCols(L);
    for (int f = 0; f < F; ++f) all.col(f) = jacobian.col(free[std::size_t(f)]);
    all.middleCols(F, A) = jacobian.middleCols(G - A, A), all.col(F + A) = r;
    all *= weights[m];
    if (L) all -= jl * jl.completeOrthogonalDecomposition().solve(all);
    square += all.transpose() * all;
    sum += weights[m] * weights[m] * r.squaredNorm(), count += n;
  }
  for (const Pull& p : problem.priors)
    if (const auto f = std::find(free.begin(), free.end(), p.global); f != free.end()) {
      const long i = f - free.begin();
      const double pull = p.weight * p.weight * (global[std::size_t(p.global)] - p.value);
      square(i, i) += p.weight * p.weight;
      square(i, F + A) += pull, square(F + A, i) += pull;
    }
  const Eigen::MatrixXd own = square.topLeftCorner(F, F), cross = square.topRightCorner(F, A + 1);
  const Eigen::MatrixXd rest =
      square.bottomRightCorner(A + 1, A + 1) - cross.transpose() * own.completeOrthogonalDecomposition().solve(cross);
  const double variance = sum / count;
  for (int a = 0; a < A; ++a)  // none where the others can do all that it can
    if (rest(a, a) > 1e-12 * square(F + a, F + a) && variance > 0) {
      out[std::size_t(a)].z = -rest(a, A) / std::sqrt(rest(a, a) * variance);
      out[std::size_t(a)].size = -rest(a, A) / rest(a, a);
    }
  return out;
}

}  // namespace

Whiteness whiteness(const Fit& fit, const std::vector<Trial>& trials) {
  Whiteness out;
  double q = 0, tested = 0;
  for (const Series& s : residuals(fit, trials)) {
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

Normality normality(const Fit& fit, const std::vector<Trial>& trials) {
  Normality out;
  Moments pooled;
  for (const Series& s : residuals(fit, trials)) {
    if (smallest_step(*s.measured) > root_mean_square(s.residual)) {
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

const Lack* Lacks::missed() const {
  const auto most =
      std::max_element(terms.begin(), terms.end(), [](const Lack& a, const Lack& b) { return a.z < b.z; });
  return most != terms.end() && most->p * double(terms.size()) < kTestLevel ? &*most : nullptr;
}

Lacks lacks(const Experiment& experiment, const Fit& fit) {
  Lacks out;
  const auto failed = [](const TrialResult& r) { return r.status != RolloutStatus::kDone; };
  if (!fit.converged || std::any_of(fit.trials.begin(), fit.trials.end(), failed)) return out;
  std::vector<PreparedTrial> prepared(experiment.trials.begin(), experiment.trials.end());
  std::vector<double> weights;
  for (const TrialResult& r : fit.trials)
    weights.push_back(experiment.options.weights == FitOptions::Weights::kTrial && r.rms > 0 ? fit.rms / r.rms : 1);
  FitOptions options = experiment.options;
  std::vector<NuisanceTerm> absent;
  for (const LadderTerm& term : kLadderTerms)
    if (fit.sea.*term.value == 0 && !options.fits(term.term)) absent.push_back(term.term);
  if (absent.empty()) return out;
  // All in one problem: they are the last of its globals.
  options.nuisance.insert(options.nuisance.end(), absent.begin(), absent.end());
  out.terms = scores(problem_of(experiment.rig, experiment.trials, prepared, fit.sea, options), fit, weights);
  for (std::size_t a = 0; a < absent.size(); ++a) {
    Lack& lack = out.terms[a];
    lack.term = name(absent[a]), lack.unit = unit(absent[a]);
    lack.p = 0.5 * std::erfc(lack.z / std::sqrt(2.0));
  }
  return out;
}

std::vector<Trial> without(std::vector<Trial> trials, std::size_t one) {
  trials.erase(trials.begin() + long(one));
  return trials;
}

Fit refit(const Rig& rig, const std::vector<Trial>& trials, const SeaParameters<double>& from, FitOptions options) {
  options.restarts = options.explore = 0;
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
  LeastSquaresProblem problem = problem_of(rig, one, prepared, fit.sea, options);
  problem.priors.clear();  // they pull what is held
  const auto fitted = globals_of(fit);
  Eigen::VectorXd globals(long(fitted.size()));
  for (std::size_t g = 0; g < fitted.size(); ++g) problem.globals[g].start = globals[long(g)] = fitted[g]->value;
  double cost = kNaN;
  if (problem.locals.empty()) {
    cost = cost_at(problem, {}, globals);
  } else if (const auto s = solve(problem, {.globals = LeastSquaresOptions::Globals::kHeld}); s.usable) {
    cost = s.cost;
  }
  return std::isfinite(cost) ? std::sqrt(cost / double(trial.measurements())) : kNaN;
}

std::vector<LeftOut> leave_one_out(const Experiment& experiment, const Fit& fit, int threads) {
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
    for (std::size_t k = 0; k < kConstants; ++k)
      l.shift.push_back(fit.parameters[k].std
                            ? (l.fit.parameters[k].value - fit.parameters[k].value) / *fit.parameters[k].std
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
