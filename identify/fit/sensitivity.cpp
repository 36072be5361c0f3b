#include "identify/fit/sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include "common/eigen.hpp"
#include "identify/fit/trial_problem.hpp"

namespace ukemi::identify {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// [J T L r] of trial m, a row for each residual: derivatives by each free parameter, each further shared term and each
/// further term of the trial, then the residual; the trial's fitted locals are projected out. Adds the residuals' sum
/// of squares. None where the trial cannot be simulated.
std::optional<MatrixXd> columns_of(const LeastSquaresProblem& problem, int m, const std::vector<double>& global,
                                   const std::vector<double>& local, int fitted_locals, const Sensitivity& s,
                                   double huber, double& sum_of_squares) {
  const int G = int(problem.globals.size()), L = int(problem.locals.size()), F = s.parameters(),
            A = int(s.shared.size()), B = int(s.per_trial.size());
  const ResidualBlock& block = problem.blocks[std::size_t(m)];
  VectorXd r(block.size);
  MatrixXd jacobian(block.size, G + L);
  if (!block.evaluate(global.data(), local.data(), r.data(), jacobian.data())) return std::nullopt;
  if (huber > 0) r = r.cwiseMax(-huber).cwiseMin(huber);
  sum_of_squares += r.squaredNorm();
  MatrixXd out(block.size, F + A + B + 1);
  for (int f = 0; f < F; ++f) out.col(f) = jacobian.col(s.free[std::size_t(f)]);
  out.middleCols(F, A) = jacobian.middleCols(G - A, A);
  out.middleCols(F + A, B) = jacobian.rightCols(B);
  out.rightCols(1) = r;
  if (fitted_locals > 0) {
    const MatrixXd local_columns = jacobian.middleCols(G, fitted_locals);
    out -= local_columns * LeastNorm(local_columns).solve(out);
  }
  return out;
}

void add_parts(const MatrixXd& columns, Sensitivity& out) {
  const int n = int(columns.rows()), F = out.parameters();
  for (int p = 0; p < out.parts_per_trial; ++p) {
    const int from = n * p / out.parts_per_trial, to = n * (p + 1) / out.parts_per_trial;
    const auto rows = columns.middleRows(from, to - from);
    out.parts.push_back(rows.transpose() * rows);
    out.information += out.parts.back().topLeftCorner(F, F);
    out.gradient += out.parts.back().topRightCorner(F, 1);
  }
}

double stated_error(const FitMinimum& minimum, std::size_t trial, const RigTerm& t) {
  return minimum.trials[trial].rig_or(minimum.rig).errors.*t.error->at;
}
/// Largest error that the trials' rigs state of a term that applies to them and was not fitted; 0 where none.
double largest_error(const RigTerm& t, const FitMinimum& minimum) {
  double out = 0;
  if (!t.error || minimum.options.terms.fits(t.name) || !t.applies_to(minimum.trials)) return out;
  for (std::size_t m = 0; m < minimum.trials.size(); ++m) out = std::max(out, stated_error(minimum, m, t));
  return out;
}

std::vector<RigTerm> further_terms(const FitMinimum& minimum) {
  std::vector<RigTerm> out;
  for (RigTerm t : *minimum.options.terms.table) {
    if (t.is_constant() || minimum.options.terms.fits(t.name) || !t.applies_to(minimum.trials)) continue;
    const bool has_effect = t.only_with.empty() || std::any_of(t.only_with.begin(), t.only_with.end(),
                                                               [&](auto c) { return minimum.fit.sea.*c != 0; });
    t.tested = t.tested && has_effect && std::isfinite(t.absent) && t.value_in(minimum.fit.sea) == t.absent;
    if (t.tested || largest_error(t, minimum) > 0) out.push_back(std::move(t));
  }
  return out;
}

}  // namespace

MatrixXd Sensitivity::sum(int first, int count) const {
  MatrixXd out = parts[std::size_t(first)];
  for (int p = first + 1; p < first + count; ++p) out += parts[std::size_t(p)];
  return out;
}

MinimumPoint point_of(const Estimates& fit, std::size_t blocks) {
  MinimumPoint out;
  for (const Estimate* e : fit.globals()) out.globals.push_back(e->value), out.at_bound.push_back(e->at_bound);
  out.locals.resize(blocks);
  for (const Estimate& e : fit.nuisance)
    if (e.trial >= 0) out.locals[std::size_t(e.trial)].push_back(e.value);
  return out;
}

std::optional<Sensitivity> sensitivity_at(const LeastSquaresProblem& problem, const MinimumPoint& point,
                                          Sensitivity out, double huber) {
  std::vector<double> global = point.globals;
  for (int g = 0; g < int(global.size()); ++g)
    if (!point.at_bound[std::size_t(g)]) out.free.push_back(g);  // one at its bound stays there
  if (out.free.empty()) return std::nullopt;
  global.insert(global.end(), point.further.begin(), point.further.end());
  const int F = out.parameters(), M = int(problem.blocks.size());
  constexpr int kSpare = 3;  // parts beyond parameters: fewer estimate the errors badly
  out.parts_per_trial = M >= F + kSpare ? 1 : (2 * F + kSpare) / M + 1;
  out.information = MatrixXd::Zero(F, F), out.gradient = VectorXd::Zero(F);
  double sum_of_squares = 0, count = 0;
  for (int m = 0; m < M; ++m) {
    std::vector<double> local = point.locals[std::size_t(m)];
    const int fitted_locals = int(local.size());
    for (const RigTerm& t : out.per_trial) local.push_back(t.absent);
    const auto columns = columns_of(problem, m, global, local, fitted_locals, out, huber, sum_of_squares);
    if (!columns) return std::nullopt;
    count += double(columns->rows());
    add_parts(*columns, out);
  }
  for (const PriorResidual& p : problem.priors)
    if (const auto f = std::find(out.free.begin(), out.free.end(), p.global); f != out.free.end()) {
      const long i = f - out.free.begin();
      out.information(i, i) += p.weight * p.weight;
      out.gradient[i] += p.weight * p.weight * (global[std::size_t(p.global)] - p.value);
    }
  out.variance = sum_of_squares / count;
  return out;
}

std::optional<Sensitivity> sensitivity_of(const FitMinimum& minimum) {
  Sensitivity further;
  FitOptions options = minimum.options;
  // The further terms come last among the globals and among the locals.
  for (const RigTerm& t : further_terms(minimum)) {
    (t.scope == Scope::kShared ? further.shared : further.per_trial).push_back(t);
    options.terms.nuisance.push_back(t.name);
  }
  const std::vector<PreparedTrial> prepared(minimum.trials.begin(), minimum.trials.end());
  std::vector<Weighting> weights;
  for (const TrialResult& r : minimum.fit.trials) weights.push_back(weighting_of(r));
  const SeaParameters<double>& sea = minimum.fit.sea;
  const LeastSquaresProblem problem =
      make_problem(minimum.rig, prepared, weights, sea, suggest(minimum.rig, minimum.trials), RigLayout(options.terms),
                   options, options.rollout());
  MinimumPoint point = minimum.point;
  for (const RigTerm& t : further.shared) point.further.push_back(t.value_in(sea));
  return sensitivity_at(problem, point, std::move(further), options.huber);
}

bool states_errors(const FitMinimum& minimum) {
  return std::any_of(minimum.options.terms.table->begin(), minimum.options.terms.table->end(),
                     [&](const RigTerm& t) { return largest_error(t, minimum) > 0; });
}

MatrixXd effect_of(const Sensitivity& s, int column, Scope scope, const std::function<double(std::size_t trial)>& std) {
  const int F = s.parameters();
  MatrixXd out = MatrixXd::Zero(F, s.trials());
  for (std::size_t p = 0; p < s.parts.size(); ++p) {
    const std::size_t m = p / std::size_t(s.parts_per_trial);
    out.col(long(m)) += std(m) * s.parts[p].block(0, column, F, 1);
  }
  return scope == Scope::kShared ? MatrixXd(out.rowwise().sum()) : out;
}

Considered considered(const Sensitivity& s, const ScaledSolver& solve, const std::string& name, double std,
                      const MatrixXd& effect, std::size_t fitted) {
  const MatrixXd shift = -solve(effect);
  Considered out{name, std, MatrixXd::Zero(long(fitted), shift.cols())};
  for (int f = 0; f < s.parameters(); ++f) eigen(out.shift).row(s.free[std::size_t(f)]) = shift.row(f);
  return out;
}

std::vector<Considered> considered_of(const FitMinimum& minimum, const Sensitivity& s) {
  const ScaledSolver solve(s.information);
  const int F = s.parameters();
  std::vector<Considered> out;
  const auto add = [&](const RigTerm& t, int column) {
    if (!(largest_error(t, minimum) > 0)) return;
    const MatrixXd effect = effect_of(s, column, t.scope, [&](std::size_t m) { return stated_error(minimum, m, t); });
    out.push_back(
        considered(s, solve, t.error->key, minimum.rig.errors.*t.error->at, effect, minimum.point.globals.size()));
  };
  for (std::size_t a = 0; a < s.shared.size(); ++a) add(s.shared[a], F + int(a));
  for (std::size_t b = 0; b < s.per_trial.size(); ++b) add(s.per_trial[b], F + int(s.shared.size() + b));
  return out;
}

}  // namespace ukemi::identify
