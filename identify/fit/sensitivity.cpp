#include "identify/fit/sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include "common/eigen.hpp"
#include "identify/fit/trial_problem.hpp"

namespace ukemi::identify {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of trial m, a row a residual: what each free parameter, each further shared term and each further term of the trial
/// does to it, then the residual itself; freed from what the trial's own fitted terms do. Adds the residuals' square.
/// None where the trial cannot be followed.
std::optional<MatrixXd> columns_of(const LeastSquaresProblem& problem, int m, const std::vector<double>& global,
                                   const std::vector<double>& local, int fitted_locals, const Sensitivity& s,
                                   double huber, double& square) {
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

/// Adds the parts of one trial.
void add_parts(const MatrixXd& columns, Sensitivity& out) {
  const int n = int(columns.rows()), F = out.parameters();
  for (int p = 0; p < out.parts_of_trial; ++p) {
    const int from = n * p / out.parts_of_trial, to = n * (p + 1) / out.parts_of_trial;
    const auto rows = columns.middleRows(from, to - from);
    out.parts.push_back(rows.transpose() * rows);
    out.information += out.parts.back().topLeftCorner(F, F);
    out.slope += out.parts.back().topRightCorner(F, 1);
  }
}

double error_in(const AtMinimum& at, std::size_t trial, const RigTerm& t) {
  return at.trials[trial].rig_or(at.rig).errors.*t.error->at;
}
/// That a rig of the trials states of a term that was not fitted and has a say; else 0.
double largest_error(const RigTerm& t, const AtMinimum& at) {
  double out = 0;
  if (!t.error || at.options.terms.fits(t.name) || !t.has_a_say(at.trials)) return out;
  for (std::size_t m = 0; m < at.trials.size(); ++m) out = std::max(out, error_in(at, m, t));
  return out;
}

std::vector<RigTerm> further_terms(const AtMinimum& at) {
  std::vector<RigTerm> out;
  for (RigTerm t : *at.options.terms.table) {
    if (t.is_constant() || at.options.terms.fits(t.name) || !t.has_a_say(at.trials)) continue;
    const bool says_something = t.only_with.empty() || std::any_of(t.only_with.begin(), t.only_with.end(),
                                                                   [&](auto c) { return at.sea.*c != 0; });
    t.tested = t.tested && says_something && std::isfinite(t.absent) && t.value_in(at.sea) == t.absent;
    if (t.tested || largest_error(t, at) > 0) out.push_back(std::move(t));
  }
  return out;
}

}  // namespace

MatrixXd Sensitivity::sum(int row, int column, int rows, int columns) const {
  MatrixXd out = MatrixXd::Zero(rows, columns);
  for (const MatrixXd& part : parts) out += part.block(row, column, rows, columns);
  return out;
}

std::optional<Sensitivity> sensitivity_at(const LeastSquaresProblem& problem, const MinimumPoint& at, Sensitivity out,
                                          double huber) {
  std::vector<double> global = at.globals;
  for (int g = 0; g < int(global.size()); ++g)
    if (!at.at_bound[std::size_t(g)]) out.free.push_back(g);  // one at its bound does not follow
  if (out.free.empty()) return std::nullopt;
  global.insert(global.end(), at.further.begin(), at.further.end());
  const int F = out.parameters(), M = int(problem.blocks.size());
  constexpr int kSpare = 3;  // parts beyond parameters: fewer tell little of the errors
  out.parts_of_trial = M >= F + kSpare ? 1 : (2 * F + kSpare) / M + 1;
  out.information = MatrixXd::Zero(F, F), out.slope = VectorXd::Zero(F);
  double square = 0, count = 0;
  for (int m = 0; m < M; ++m) {
    std::vector<double> local = at.locals[std::size_t(m)];
    const int fitted_locals = int(local.size());
    for (const RigTerm& t : out.of_trial) local.push_back(t.absent);
    const auto columns = columns_of(problem, m, global, local, fitted_locals, out, huber, square);
    if (!columns) return std::nullopt;
    count += double(columns->rows());
    add_parts(*columns, out);
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

std::optional<Sensitivity> sensitivity_of(const AtMinimum& at) {
  Sensitivity further;
  FitOptions options = at.options;
  // The further ones come last among the globals and among the locals.
  for (const RigTerm& t : further_terms(at)) {
    (t.scope == Scope::kShared ? further.shared : further.of_trial).push_back(t);
    options.terms.nuisance.push_back(t.name);
  }
  const std::vector<PreparedTrial> prepared(at.trials.begin(), at.trials.end());
  const LeastSquaresProblem problem = make_problem(at.rig, prepared, at.weights, at.sea, suggest(at.rig, at.trials),
                                                   RigLayout(options.terms), options, options.rollout());
  MinimumPoint point{at.globals, at.at_bound, at.locals, {}};
  for (const RigTerm& t : further.shared) point.further.push_back(t.value_in(at.sea));
  return sensitivity_at(problem, point, std::move(further), options.huber);
}

bool states_errors(const AtMinimum& at) {
  return std::any_of(at.options.terms.table->begin(), at.options.terms.table->end(),
                     [&](const RigTerm& t) { return largest_error(t, at) > 0; });
}

Considered considered(const Sensitivity& s, const ScaledSolver& solve, const std::string& name, double std,
                      const MatrixXd& effect, std::size_t fitted) {
  const MatrixXd moved = -solve(effect);
  Considered out{name, std, MatrixXd::Zero(long(fitted), moved.cols())};
  for (int f = 0; f < s.parameters(); ++f) eigen(out.shift).row(s.free[std::size_t(f)]) = moved.row(f);
  return out;
}

std::vector<Considered> considered_of(const AtMinimum& at, const Sensitivity& s) {
  const ScaledSolver solve(s.information);
  const int F = s.parameters(), M = s.trials();
  std::vector<Considered> out;
  const auto add = [&](const RigTerm& t, int column) {
    if (!(largest_error(t, at) > 0)) return;
    MatrixXd effect = MatrixXd::Zero(F, M);  // of each trial, by its own rig's error
    for (std::size_t p = 0; p < s.parts.size(); ++p) {
      const std::size_t m = p / std::size_t(s.parts_of_trial);
      effect.col(long(m)) += error_in(at, m, t) * s.parts[p].block(0, column, F, 1);
    }
    if (t.scope == Scope::kShared) effect = effect.rowwise().sum().eval();
    out.push_back(considered(s, solve, t.error->key, at.rig.errors.*t.error->at, effect, at.globals.size()));
  };
  for (std::size_t a = 0; a < s.shared.size(); ++a) add(s.shared[a], F + int(a));
  for (std::size_t b = 0; b < s.of_trial.size(); ++b) add(s.of_trial[b], F + int(s.shared.size() + b));
  return out;
}

}  // namespace ukemi::identify
