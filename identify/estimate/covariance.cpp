#include "identify/estimate/covariance.hpp"

#include <algorithm>
#include <cmath>

#include "common/decompositions.hpp"

namespace ukemi::identify {

namespace {

/// Covariance of the globals off their bounds, in units that make the information's diagonal 1: d are its roots. Fills
/// in the solution's eigenvalues and global covariance.
Eigen::MatrixXd covariance_of_free(const LeastSquaresProblem& problem, const Eigen::MatrixXd& information,
                                   const std::vector<long>& free, Eigen::VectorXd& d, LeastSquaresSolution& out) {
  const long F = long(free.size());
  // Unit diagonal first: eigenvalues then speak of directions, not of units.
  Eigen::MatrixXd m = information(free, free);
  d = m.diagonal().cwiseMax(0).cwiseSqrt();
  for (long i = 0; i < F; ++i)
    for (long j = 0; j < F; ++j) m(i, j) = d[i] * d[j] > 0 ? m(i, j) / (d[i] * d[j]) : 0;
  const SymmetricEigen eigen = symmetric_eigen(m);
  const double largest = eigen.values[F - 1];
  out.eigenvalues = largest > 0 ? Eigen::VectorXd(eigen.values / largest) : Eigen::VectorXd::Zero(F);
  constexpr double kSingular = 1e-13;  // below the rounding of J'J nothing is determined
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(F, F);
  std::vector<bool> determined(free.size(), true);
  for (long e = 0; e < F; ++e) {
    const auto v = eigen.vectors.col(e);
    if (out.eigenvalues[e] > kSingular)
      covariance += v * v.transpose() / eigen.values[e];
    else
      for (long i = 0; i < F; ++i) determined[std::size_t(i)] = determined[std::size_t(i)] && !(v[i] * v[i] > 1e-6);
  }
  const auto scale = [&](long i) { return problem.globals[std::size_t(free[std::size_t(i)])].scale; };
  for (long i = 0; i < F; ++i)
    for (long j = 0; j < F; ++j)
      if (determined[std::size_t(i)] && determined[std::size_t(j)])
        out.global_covariance(free[std::size_t(i)], free[std::size_t(j)]) =
            covariance(i, j) / (d[i] * d[j]) * scale(i) * scale(j);
  return covariance;
}

}  // namespace

Eigen::VectorXd gradient_at(const LeastSquaresProblem& problem, const std::vector<const Eigen::MatrixXd*>& grams,
                            const std::vector<double>& scaled) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(long(scaled.size()));
  for (const Eigen::MatrixXd* gram : grams) out += gram->col(gram->cols() - 1).head(out.size());
  for (const PriorResidual& p : problem.priors) {
    const double scale = problem.globals[std::size_t(p.global)].scale;
    out[p.global] += (scaled[std::size_t(p.global)] * scale - p.value) * p.weight * p.weight * scale;
  }
  return out;
}

void add_covariances(const LeastSquaresProblem& problem, const std::vector<const Eigen::MatrixXd*>& grams,
                     LeastSquaresSolution& out) {
  const int G = int(problem.globals.size()), L = int(problem.locals.size()), B = int(problem.blocks.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(G, G);
  std::vector<Eigen::MatrixXd> cross, inverse;
  for (const Eigen::MatrixXd* gram : grams) {
    information += gram->topLeftCorner(G, G);
    if (L == 0) continue;
    cross.push_back(gram->block(0, G, G, L));
    inverse.push_back(LeastNorm(gram->block(G, G, L, L)).pseudo_inverse());
    information -= cross.back() * inverse.back() * cross.back().transpose();
  }
  for (const PriorResidual& p : problem.priors) {
    const double w = p.weight * problem.globals[std::size_t(p.global)].scale;
    information(p.global, p.global) += w * w;
  }
  Eigen::VectorXd unit(G);
  for (int i = 0; i < G; ++i) unit[i] = 1 / problem.globals[std::size_t(i)].scale;
  out.information = unit.asDiagonal() * information * unit.asDiagonal();
  std::vector<long> free;
  for (int i = 0; i < G; ++i)
    if (!out.at_bound[std::size_t(i)]) free.push_back(i);
  const long F = long(free.size());
  out.free_parameters = F + long(B) * L;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(F, F);  // by unit diagonals d
  Eigen::VectorXd d = Eigen::VectorXd::Zero(F);
  if (F > 0) covariance = covariance_of_free(problem, information, free, d, out);
  for (std::size_t b = 0; b < cross.size(); ++b) {
    Eigen::MatrixXd of_free = cross[b](free, Eigen::all);
    for (long i = 0; i < F; ++i) of_free.row(i) /= d[i] > 0 ? d[i] : 1;
    const Eigen::MatrixXd variance =
        inverse[b] + inverse[b] * of_free.transpose() * covariance * of_free * inverse[b].transpose();
    for (int l = 0; l < L; ++l) {
      const double size = problem.locals[std::size_t(l)].scale;
      out.local_variance(long(b), l) = variance(l, l) > 0 ? variance(l, l) * size * size : NAN;
    }
  }
}

Eigen::MatrixXd correlation_of(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd inverse = covariance.diagonal().cwiseSqrt().cwiseInverse();
  return inverse.asDiagonal() * covariance * inverse.asDiagonal();
}

}  // namespace ukemi::identify
