#include "identify/trust/score.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "identify/estimate/statistics.hpp"

namespace ukemi::identify {

using Eigen::MatrixXd;
using Eigen::VectorXd;

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

std::optional<Sensitivity> score_of(const Experiment& experiment, const Fit& fit) {
  experiment.validate(fit);
  const auto failed = [](const TrialResult& r) { return r.status != RolloutStatus::kDone; };
  if (!fit.converged || std::any_of(fit.trials.begin(), fit.trials.end(), failed)) return std::nullopt;
  if (fit.sensitivity) return *fit.sensitivity;
  return sensitivity_of({experiment.rig, experiment.trials, experiment.options, fit, point_of(fit, fit.trials.size())});
}

std::optional<Sensitivity> score_at(const LeastSquaresProblem& problem, const Estimates& fit,
                                    const std::vector<Term>& shared, const std::vector<Term>& per_trial, double huber) {
  MinimumPoint at = point_of(fit, problem.blocks.size());
  Sensitivity further;
  for (const Term& t : shared) further.shared.push_back({t}), at.further.push_back(t.absent);
  for (const Term& t : per_trial) further.per_trial.push_back({t});
  return sensitivity_at(problem, at, std::move(further), huber);
}

namespace {

/// The test of shared term `a`. None where the fitted parameters have the same effect.
std::optional<ScoreTest> test_of_shared(const Sensitivity& s, const MatrixXd& gram, const ScaledSolver& solve,
                                        const VectorXd& step, std::size_t a) {
  constexpr double kRounding = 1e-12;  // of a term's effect, not explained by the fitted parameters
  const int F = s.parameters(), i = F + int(a);
  const VectorXd cross = gram.col(i).head(F), shift = solve(cross);
  const double own = gram(i, i), rest = own - cross.dot(shift), gradient = gram(i, gram.cols() - 1) - cross.dot(step);
  if (!(rest > kRounding * own && s.variance > 0)) return std::nullopt;
  const Term& term = s.shared[a];
  ScoreTest test{.term = term.name, .z = -gradient / std::sqrt(rest * s.variance), .size = -gradient / rest};
  const bool outside = term.one_sided() && test.z < 0;
  test.statistic = outside ? 0 : test.z * test.z;
  test.p = term.one_sided() ? 0.5 * std::erfc(test.z / std::sqrt(2.0)) : std::erfc(std::abs(test.z) / std::sqrt(2.0));
  test.gain = test.statistic * s.variance;
  const MatrixXd covariance = solve(MatrixXd::Identity(F, F));
  for (int f = 0; f < F; ++f) test.bias = std::max(test.bias, std::abs(shift[f]) / std::sqrt(covariance(f, f) * rest));
  return test;
}

/// The test of per-trial term `b`. t_m is the step of trial m that minimises the cost, with the shared parameters
/// eliminated: R t = -gradient with R = D - C' H^-1 C, D diagonal. By Woodbury only
/// H - C D^-1 C' is ever solved for.
std::optional<ScoreTest> test_of_trials(const Sensitivity& s, const VectorXd& step, std::size_t b) {
  const int F = s.parameters(), M = s.trials(), i = F + int(s.shared.size() + b);
  MatrixXd c(F, M);
  VectorXd d(M), gradient(M);
  for (int m = 0; m < M; ++m) {
    const MatrixXd gram = s.gram_of(m);
    c.col(m) = gram.col(i).head(F), d[m] = gram(i, i), gradient[m] = gram(i, gram.cols() - 1);
  }
  gradient -= c.transpose() * step;
  VectorXd inverse(M);
  for (int m = 0; m < M; ++m) inverse[m] = d[m] > 0 ? 1 / d[m] : 0;
  const ScaledSolver inner(s.information - c * inverse.asDiagonal() * c.transpose());
  const VectorXd first = inverse.cwiseProduct(gradient);
  const VectorXd term = first + inverse.cwiseProduct(c.transpose() * inner(c * first).col(0));
  const int degrees = int((d.array() > 0).count()) - (F - int(inner.rank()));
  if (degrees <= 0 || !(s.variance > 0)) return std::nullopt;
  ScoreTest test{.term = s.per_trial[b].name,
                 .scope = Scope::kEach,
                 .statistic = std::max(gradient.dot(term), 0.0) / s.variance,
                 .degrees = degrees};
  test.p = chi_squared_tail(test.statistic, degrees);
  test.gain = test.statistic * s.variance;
  Eigen::Index largest;
  (void)term.cwiseAbs().maxCoeff(&largest);
  test.size = -term[largest];
  return test;
}

}  // namespace

std::vector<ScoreTest> score_tests_of(const Sensitivity& s) {
  const ScaledSolver solve(s.information);
  const VectorXd step = solve(s.gradient);
  const MatrixXd gram = s.gram();
  std::vector<ScoreTest> out;
  for (std::size_t a = 0; a < s.shared.size(); ++a)
    if (auto test = s.shared[a].tested ? test_of_shared(s, gram, solve, step, a) : std::nullopt)
      out.push_back(std::move(*test));
  for (std::size_t b = 0; b < s.per_trial.size(); ++b)
    if (auto test = s.per_trial[b].tested ? test_of_trials(s, step, b) : std::nullopt) out.push_back(std::move(*test));
  return out;
}

std::vector<double> chow_tests_of(const Sensitivity& s) {
  constexpr double kRounding = 1e-9;  // of a trial's information, not shared with the others
  const int F = s.parameters(), M = s.trials();
  const ScaledSolver solve(s.information);
  const VectorXd step = solve(s.gradient);
  std::vector<double> out;
  for (int m = 0; M > 1 && m < M; ++m) {
    const MatrixXd gram = s.gram_of(m), information = gram.topLeftCorner(F, F);
    const VectorXd gradient = gram.topRightCorner(F, 1);
    const VectorXd unit = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const SymmetricEigen rest =
        symmetric_eigen(unit.asDiagonal() * (information - information * solve(information)) * unit.asDiagonal());
    const VectorXd along = rest.vectors.transpose() * unit.cwiseProduct(gradient - information * step);
    double statistic = 0;
    int degrees = 0;
    for (int f = 0; f < F; ++f)
      if (rest.values[f] > kRounding) statistic += along[f] * along[f] / (rest.values[f] * s.variance), ++degrees;
    out.push_back(degrees > 0 ? chi_squared_tail(statistic, degrees) : 1);
  }
  return out;
}

MatrixXd sandwich(const Sensitivity& s) {
  const int F = s.parameters();
  MatrixXd sum = MatrixXd::Zero(F, F);
  for (const MatrixXd& part : s.parts) {
    const ScaledSolver solve(s.information - part.topLeftCorner(F, F));
    const VectorXd shift = solve(part.topRightCorner(F, 1));
    sum += shift * shift.transpose();
  }
  const double parts = double(s.parts.size());
  return sum * (parts - 1) / parts;
}

}  // namespace ukemi::identify
