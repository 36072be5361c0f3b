#include "identify/trust/score.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/decompositions.hpp"
#include "common/error.hpp"
#include "identify/estimate/statistics.hpp"
#include "identify/fit/trial_problem.hpp"

namespace ukemi::identify {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

bool absent(const RigTerm& t, const Fit& fit, const Experiment& experiment) {
  const bool says_something = t.only_with.empty() || std::any_of(t.only_with.begin(), t.only_with.end(),
                                                                 [&](auto constant) { return fit.sea.*constant != 0; });
  return !t.is_constant() && !experiment.options.terms.fits(t.name) && t.value_in(fit.sea) == t.absent &&
         says_something && t.has_a_say(experiment.trials);
}

/// The solution of a x = b by units that make a's diagonal 1; directions that a says nothing of are left alone.
struct Solver {
  explicit Solver(const MatrixXd& a)
      : unit(a.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse()),
        decomposition(unit.asDiagonal() * a * unit.asDiagonal(), 1e-12) {}
  MatrixXd operator()(const MatrixXd& b) const {
    return unit.asDiagonal() * decomposition.solve(unit.asDiagonal() * b);
  }
  VectorXd unit;
  LeastNorm decomposition;
};

/// Of trial m, a row a residual: what each free parameter, each absent shared term and each absent term of the trial
/// does to it, then the residual itself; freed from what the trial's own fitted terms do. Adds the residuals' square.
/// None where the trial cannot be followed.
std::optional<MatrixXd> columns_of(const LeastSquaresProblem& problem, int m, const std::vector<double>& global,
                                   const std::vector<double>& local, int fitted_locals, const Score& s, double huber,
                                   double& square) {
  const int G = int(problem.globals.size()), L = int(problem.locals.size()), F = s.parameters(),
            A = int(s.shared.size()), B = int(s.of_trial.size());
  const ResidualBlock& block = problem.blocks[std::size_t(m)];
  VectorXd r(block.size);
  MatrixXd jacobian(block.size, G + L);
  if (!block.evaluate(global.data(), local.data(), r.data(), jacobian.data())) return std::nullopt;
  if (huber > 0) r = r.cwiseMax(-huber).cwiseMin(huber);
  square += r.squaredNorm();
  MatrixXd out(block.size, F + A + B + 1);
  for (int f = 0; f < F; ++f) out.col(f) = jacobian.col(s.free[std::size_t(f)]);
  out.middleCols(F, A) = jacobian.middleCols(G - A, A);
  out.middleCols(F + A, B) = jacobian.rightCols(B);
  out.rightCols(1) = r;
  if (fitted_locals > 0) {
    const MatrixXd own = jacobian.middleCols(G, fitted_locals);
    out -= own * LeastNorm(own).solve(out);
  }
  return out;
}

}  // namespace

void Experiment::validate(const Fit& fit) const {
  rig.validate(), options.validate();
  if (fit.trials.size() != trials.size())
    throw InputError(fmt::format("a fit of {} trials for {} trials", fit.trials.size(), trials.size()));
  for (std::size_t m = 0; m < trials.size(); ++m) {
    trials[m].validate();
    const TrialResult& r = fit.trials[m];
    if (r.status == RolloutStatus::kDone && r.phi.size() != trials[m].samples())
      throw InputError(
          fmt::format("{}: {} predicted angles for {} samples", r.file, r.phi.size(), trials[m].samples()));
  }
}

std::optional<Score> score_of(const Experiment& experiment, const Fit& fit) {
  experiment.validate(fit);
  const auto failed = [](const TrialResult& r) { return r.status != RolloutStatus::kDone; };
  if (!fit.converged || std::any_of(fit.trials.begin(), fit.trials.end(), failed)) return std::nullopt;
  Score out;
  FitOptions options = experiment.options;
  // The absent ones come last among the globals and among the locals.
  for (const RigTerm& t : options.terms.table)
    if (absent(t, fit, experiment)) {
      (t.scope == Scope::kShared ? out.shared : out.of_trial).push_back(t);
      options.terms.nuisance.push_back(t.name);
    }
  const std::vector<PreparedTrial> prepared(experiment.trials.begin(), experiment.trials.end());
  std::vector<Weighting> weights;
  for (const TrialResult& r : fit.trials) weights.push_back(r.weighting);
  const LeastSquaresProblem problem =
      make_problem(experiment.rig, prepared, weights, fit.sea, suggest(experiment.rig, experiment.trials),
                   RigLayout(options.terms), options, options.rollout());

  std::vector<double> global;
  for (const Estimate* e : fit.globals()) {
    if (!e->at_bound) out.free.push_back(int(global.size()));  // one at its bound does not follow
    global.push_back(e->value);
  }
  if (out.free.empty()) return std::nullopt;
  for (const Term& t : out.shared) global.push_back(t.absent);
  const int F = out.parameters(), M = int(problem.blocks.size());
  constexpr int kSpare = 3;  // parts beyond parameters: fewer tell little of the errors
  out.parts_of_trial = M >= F + kSpare ? 1 : (2 * F + kSpare) / M + 1;
  out.information = MatrixXd::Zero(F, F), out.slope = VectorXd::Zero(F);
  double square = 0, count = 0;
  for (int m = 0; m < M; ++m) {
    std::vector<double> local;
    for (const Estimate& e : fit.nuisance)
      if (e.trial == m) local.push_back(e.value);
    const int fitted_locals = int(local.size());
    for (const Term& t : out.of_trial) local.push_back(t.absent);
    const auto columns = columns_of(problem, m, global, local, fitted_locals, out, options.huber, square);
    if (!columns) return std::nullopt;
    const long n = columns->rows();
    count += double(n);
    for (int p = 0; p < out.parts_of_trial; ++p) {
      const int from = int(n * p / out.parts_of_trial), to = int(n * (p + 1) / out.parts_of_trial);
      const auto rows = columns->middleRows(from, to - from);
      out.parts.push_back(rows.transpose() * rows);
      out.information += out.parts.back().topLeftCorner(F, F);
      out.slope += out.parts.back().topRightCorner(F, 1);
    }
  }
  for (const PriorResidual& p : problem.priors)
    if (const auto f = std::find(out.free.begin(), out.free.end(), p.global); f != out.free.end()) {
      const long i = f - out.free.begin();
      out.information(i, i) += p.weight * p.weight;
      out.slope[i] += p.weight * p.weight * (global[std::size_t(p.global)] - p.value);
    }
  out.variance = square / count;
  return out;
}

namespace {

/// Of term `a` of the shared ones. None where the others can do all that it does.
std::optional<ScoreTest> test_of_shared(const Score& s, const Solver& solve, const VectorXd& step, std::size_t a) {
  constexpr double kAll = 1e-12;  // of a term's effect that the others leave
  const int F = s.parameters(), r = F + int(s.shared.size() + s.of_trial.size()), i = F + int(a);
  const auto sum = [&](int row, int column, int rows) {
    VectorXd out = VectorXd::Zero(rows);
    for (const MatrixXd& part : s.parts) out += part.block(row, column, rows, 1);
    return out;
  };
  const VectorXd cross = sum(0, i, F), moved = solve(cross);
  const double own = sum(i, i, 1)[0], rest = own - cross.dot(moved), slope = sum(i, r, 1)[0] - cross.dot(step);
  if (!(rest > kAll * own && s.variance > 0)) return std::nullopt;
  const Term& term = s.shared[a];
  ScoreTest test{.term = term.name, .z = -slope / std::sqrt(rest * s.variance), .size = -slope / rest};
  const bool outside = term.one_sided() && test.z < 0;
  test.statistic = outside ? 0 : test.z * test.z;
  test.p = term.one_sided() ? 0.5 * std::erfc(test.z / std::sqrt(2.0)) : std::erfc(std::abs(test.z) / std::sqrt(2.0));
  test.gain = test.statistic * s.variance;
  const MatrixXd covariance = solve(MatrixXd::Identity(F, F));
  for (int f = 0; f < F; ++f) test.bias = std::max(test.bias, std::abs(moved[f]) / std::sqrt(covariance(f, f) * rest));
  return test;
}

/// Of term `b` of those that each trial has for itself. t_m is the step that the residuals of trial m ask for, the
/// shared parameters following them all: R t = -slopes with R = D - C' H^-1 C, D diagonal. By Woodbury only
/// H - C D^-1 C' is ever solved for.
std::optional<ScoreTest> test_of_trials(const Score& s, const VectorXd& step, std::size_t b) {
  const int F = s.parameters(), r = F + int(s.shared.size() + s.of_trial.size()), M = s.trials();
  const int i = F + int(s.shared.size() + b);
  MatrixXd c = MatrixXd::Zero(F, M);
  VectorXd d = VectorXd::Zero(M), slope = VectorXd::Zero(M);
  for (std::size_t p = 0; p < s.parts.size(); ++p) {
    const long m = long(p) / s.parts_of_trial;
    c.col(m) += s.parts[p].block(0, i, F, 1);
    d[m] += s.parts[p](i, i), slope[m] += s.parts[p](i, r);
  }
  slope -= c.transpose() * step;
  VectorXd inverse(M);
  for (int m = 0; m < M; ++m) inverse[m] = d[m] > 0 ? 1 / d[m] : 0;
  const Solver inner(s.information - c * inverse.asDiagonal() * c.transpose());
  const VectorXd first = inverse.cwiseProduct(slope);
  const VectorXd term = first + inverse.cwiseProduct(c.transpose() * inner(c * first).col(0));
  const int degrees = int((d.array() > 0).count()) - (F - int(inner.decomposition.rank()));
  if (degrees <= 0 || !(s.variance > 0)) return std::nullopt;
  ScoreTest test{.term = s.of_trial[b].name,
                 .scope = Scope::kEach,
                 .statistic = std::max(slope.dot(term), 0.0) / s.variance,
                 .degrees = degrees};
  test.p = chi_squared_tail(test.statistic, degrees);
  test.gain = test.statistic * s.variance;
  Eigen::Index largest;
  (void)term.cwiseAbs().maxCoeff(&largest);
  test.size = -term[largest];
  return test;
}

}  // namespace

std::vector<ScoreTest> score_tests_of(const Score& s) {
  const Solver solve(s.information);
  const VectorXd step = solve(s.slope);
  std::vector<ScoreTest> out;
  for (std::size_t a = 0; a < s.shared.size(); ++a)
    if (auto test = test_of_shared(s, solve, step, a)) out.push_back(std::move(*test));
  for (std::size_t b = 0; b < s.of_trial.size(); ++b)
    if (auto test = test_of_trials(s, step, b)) out.push_back(std::move(*test));
  return out;
}

MatrixXd sandwich(const Score& s) {
  const int F = s.parameters();
  MatrixXd sum = MatrixXd::Zero(F, F);
  for (const MatrixXd& part : s.parts) {
    const Solver solve(s.information - part.topLeftCorner(F, F));
    const VectorXd moved = solve(part.topRightCorner(F, 1));
    sum += moved * moved.transpose();
  }
  const double parts = double(s.parts.size());
  return sum * (parts - 1) / parts;
}

}  // namespace ukemi::identify
