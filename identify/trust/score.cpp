#include "identify/trust/score.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "identify/fit/statistics.hpp"
#include "identify/fit/trial_problem.hpp"

namespace ukemi::identify {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Where a term is absent.
double neutral(NuisanceTerm t) { return t == NuisanceTerm::kForceGain ? 1 : 0; }
/// Whether it cannot be below its absence.
bool one_sided(NuisanceTerm t) {
  return t == NuisanceTerm::kFriction || t == NuisanceTerm::kViscous || t == NuisanceTerm::kStiffening;
}
bool absent(NuisanceTerm t, const Fit& fit, const FitOptions& options) {
  if (options.fits(t)) return false;
  const SeaParameters<double>& sea = fit.sea;
  return !(t == NuisanceTerm::kFriction && sea.friction != 0) && !(t == NuisanceTerm::kViscous && sea.viscous != 0) &&
         !(t == NuisanceTerm::kStiffening && sea.k_sea_cubic != 0);
}

/// The solution of a x = b by units that make a's diagonal 1; directions that a says nothing of are left alone.
struct Solver {
  explicit Solver(const MatrixXd& a) : unit(a.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse()) {
    decomposition.setThreshold(1e-12);
    decomposition.compute(unit.asDiagonal() * a * unit.asDiagonal());
  }
  MatrixXd operator()(const MatrixXd& b) const {
    return unit.asDiagonal() * decomposition.solve(unit.asDiagonal() * b);
  }
  VectorXd unit;
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposition;
};

}  // namespace

std::optional<Score> score_of(const Experiment& experiment, const Fit& fit) {
  const auto failed = [](const TrialResult& r) { return r.status != RolloutStatus::kDone; };
  if (!fit.converged || std::any_of(fit.trials.begin(), fit.trials.end(), failed)) return std::nullopt;
  Score out;
  FitOptions options = experiment.options;
  for (const NuisanceTerm t : kNuisanceTerms)
    if (absent(t, fit, options)) (is_shared(t) ? out.shared : out.of_trial).push_back(t);
  // The absent ones come last among the globals and among the locals.
  options.nuisance.insert(options.nuisance.end(), out.shared.begin(), out.shared.end());
  options.nuisance.insert(options.nuisance.end(), out.of_trial.begin(), out.of_trial.end());
  const std::vector<PreparedTrial> prepared(experiment.trials.begin(), experiment.trials.end());
  std::vector<Weighting> weights;
  for (const TrialResult& r : fit.trials) weights.push_back(r.weighting);
  const LeastSquaresProblem problem =
      make_problem(experiment.rig, prepared, weights, fit.sea, suggest(experiment.rig, experiment.trials),
                   Layout(options), options, options.rollout());

  std::vector<double> global;
  for (const Estimate* e : fit.globals()) {
    if (!e->at_bound) out.free.push_back(int(global.size()));  // one at its bound does not follow
    global.push_back(e->value);
  }
  for (const NuisanceTerm t : out.shared) global.push_back(neutral(t));
  const int G = int(problem.globals.size()), L = int(problem.locals.size()), F = out.parameters(),
            A = int(out.shared.size()), B = int(out.of_trial.size()), columns = F + A + B + 1;
  const int M = int(problem.blocks.size());
  constexpr int kSpare = 3;  // parts beyond parameters: fewer tell little of the errors
  out.parts_of_trial = M >= F + kSpare ? 1 : (2 * F + kSpare) / M + 1;
  out.information = MatrixXd::Zero(F, F), out.slope = VectorXd::Zero(F);
  double square = 0, count = 0;
  for (int m = 0; m < M; ++m) {
    std::vector<double> local;
    for (const Estimate& e : fit.nuisance)
      if (e.trial == m) local.push_back(e.value);
    const int fitted_locals = int(local.size());
    local.resize(std::size_t(L), 0.0);
    const ResidualBlock& block = problem.blocks[std::size_t(m)];
    const int n = block.size;
    VectorXd r(n);
    MatrixXd jacobian(n, G + L);
    if (!block.evaluate(global.data(), local.data(), r.data(), jacobian.data())) return std::nullopt;
    if (options.huber > 0) r = r.cwiseMax(-options.huber).cwiseMin(options.huber);
    square += r.squaredNorm(), count += n;
    MatrixXd all(n, columns);
    for (int f = 0; f < F; ++f) all.col(f) = jacobian.col(out.free[std::size_t(f)]);
    all.middleCols(F, A) = jacobian.middleCols(G - A, A);
    all.middleCols(F + A, B) = jacobian.rightCols(B);
    all.col(columns - 1) = r;
    if (fitted_locals > 0) {
      const MatrixXd own = jacobian.middleCols(G, fitted_locals);
      all -= own * own.completeOrthogonalDecomposition().solve(all);
    }
    for (int p = 0; p < out.parts_of_trial; ++p) {
      const int from = int(long(n) * p / out.parts_of_trial), to = int(long(n) * (p + 1) / out.parts_of_trial);
      const auto rows = all.middleRows(from, to - from);
      out.parts.push_back(rows.transpose() * rows);
      out.information += out.parts.back().topLeftCorner(F, F);
      out.slope += out.parts.back().topRightCorner(F, 1);
    }
  }
  for (const Pull& p : problem.priors)
    if (const auto f = std::find(out.free.begin(), out.free.end(), p.global); f != out.free.end()) {
      const long i = f - out.free.begin();
      out.information(i, i) += p.weight * p.weight;
      out.slope[i] += p.weight * p.weight * (global[std::size_t(p.global)] - p.value);
    }
  out.variance = square / count;
  return out;
}

std::vector<Lack> lacks(const Score& s) {
  constexpr double kAll = 1e-12;  // of a term's effect that the others leave: they can do all of it
  const int F = s.parameters(), r = F + int(s.shared.size() + s.of_trial.size());
  const Solver solve(s.information);
  const VectorXd step = solve(s.slope);
  const MatrixXd covariance = solve(MatrixXd::Identity(F, F));
  const auto sum = [&](int i, int j, int rows, int columns) {
    MatrixXd out = MatrixXd::Zero(rows, columns);
    for (const MatrixXd& part : s.parts) out += part.block(i, j, rows, columns);
    return out;
  };
  std::vector<Lack> out;
  for (std::size_t a = 0; a < s.shared.size(); ++a) {
    const int i = F + int(a);
    const MatrixXd cross = sum(0, i, F, 1);
    const double own = sum(i, i, 1, 1)(0, 0), rest = own - cross.col(0).dot(solve(cross).col(0)),
                 slope = sum(i, r, 1, 1)(0, 0) - cross.col(0).dot(step);
    if (!(rest > kAll * own && s.variance > 0)) continue;
    Lack lack{.term = s.shared[a], .z = -slope / std::sqrt(rest * s.variance), .size = -slope / rest};
    const bool outside = one_sided(lack.term) && lack.z < 0;
    lack.statistic = outside ? 0 : lack.z * lack.z;
    lack.p =
        one_sided(lack.term) ? 0.5 * std::erfc(lack.z / std::sqrt(2.0)) : std::erfc(std::abs(lack.z) / std::sqrt(2.0));
    lack.gain = lack.statistic * s.variance;
    const VectorXd moved = solve(cross);
    for (int f = 0; f < F; ++f)
      lack.bias = std::max(lack.bias, std::abs(moved[f]) / std::sqrt(covariance(f, f) * rest));
    out.push_back(lack);
  }
  for (std::size_t b = 0; b < s.of_trial.size(); ++b) {
    // A trial's term t_m is the step that the residuals of trial m ask for, the shared parameters following them all:
    // R t = -slopes with R = D - C' H^-1 C, D diagonal. By Woodbury only H - C D^-1 C' is ever solved for.
    const int i = F + int(s.shared.size() + b);
    const int M = s.trials();
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
    if (degrees <= 0 || !(s.variance > 0)) continue;
    Lack lack{.term = s.of_trial[b], .statistic = std::max(slope.dot(term), 0.0) / s.variance, .degrees = degrees};
    lack.p = chi_squared_tail(lack.statistic, degrees);
    lack.gain = lack.statistic * s.variance;
    Eigen::Index largest;
    (void)term.cwiseAbs().maxCoeff(&largest);
    lack.size = -term[largest];
    out.push_back(lack);
  }
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
