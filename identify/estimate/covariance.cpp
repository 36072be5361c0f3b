#include "identify/estimate/covariance.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace ukemi::identify {

void add_covariances(const LeastSquaresProblem& problem, const std::vector<const Eigen::MatrixXd*>& squares,
                     LeastSquaresSolution& out) {
  const int G = int(problem.globals.size()), L = int(problem.locals.size()), B = int(problem.blocks.size());
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(G, G);
  std::vector<Eigen::MatrixXd> cross, inverse;
  for (const Eigen::MatrixXd* square : squares) {
    information += square->topLeftCorner(G, G);
    if (L == 0) continue;
    cross.push_back(square->block(0, G, G, L));
    inverse.push_back(square->block(G, G, L, L).completeOrthogonalDecomposition().pseudoInverse());
    information -= cross.back() * inverse.back() * cross.back().transpose();
  }
  for (const PriorResidual& p : problem.priors) {
    const double w = p.weight * problem.globals[std::size_t(p.global)].scale;
    information(p.global, p.global) += w * w;
  }
  Eigen::VectorXd unit(G);
  for (int i = 0; i < G; ++i) unit[i] = 1 / problem.globals[std::size_t(i)].scale;
  out.information = unit.asDiagonal() * information * unit.asDiagonal();
  std::vector<int> free;
  for (int i = 0; i < G; ++i)
    if (!out.at_bound[std::size_t(i)]) free.push_back(i);
  const int F = int(free.size());
  out.free_parameters = F + long(B) * L;
  out.global_covariance.setConstant(G, G, kNaN);
  out.local_variance.setConstant(B, L, kNaN);
  if (F == 0) return;
  // Unit diagonal first: eigenvalues then speak of directions, not of units.
  Eigen::VectorXd d(F);
  Eigen::MatrixXd m(F, F);
  for (int i = 0; i < F; ++i) d[i] = std::sqrt(std::max(information(free[std::size_t(i)], free[std::size_t(i)]), 0.0));
  for (int i = 0; i < F; ++i)
    for (int j = 0; j < F; ++j) {
      const double scale = d[i] * d[j];
      m(i, j) = scale > 0 ? information(free[std::size_t(i)], free[std::size_t(j)]) / scale : 0;
    }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(m);
  const double largest = eigen.eigenvalues()[F - 1];
  out.eigenvalues = largest > 0 ? Eigen::VectorXd(eigen.eigenvalues() / largest) : Eigen::VectorXd::Zero(F);
  constexpr double kSingular = 1e-13;  // below the rounding of J'J nothing is determined
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(F, F);
  std::vector<bool> determined(std::size_t(F), true);
  for (int e = 0; e < F; ++e) {
    const auto v = eigen.eigenvectors().col(e);
    if (out.eigenvalues[e] > kSingular) {
      covariance += v * v.transpose() / eigen.eigenvalues()[e];
    } else {
      for (int i = 0; i < F; ++i)
        if (v[i] * v[i] > 1e-6) determined[std::size_t(i)] = false;
    }
  }
  for (int i = 0; i < F; ++i)
    for (int j = 0; j < F; ++j)
      if (determined[std::size_t(i)] && determined[std::size_t(j)])
        out.global_covariance(free[std::size_t(i)], free[std::size_t(j)]) =
            covariance(i, j) / (d[i] * d[j]) * problem.globals[std::size_t(free[std::size_t(i)])].scale *
            problem.globals[std::size_t(free[std::size_t(j)])].scale;
  for (int b = 0; b < B && L > 0; ++b) {
    Eigen::MatrixXd of_free(F, L);
    for (int i = 0; i < F; ++i)
      of_free.row(i) = cross[std::size_t(b)].row(free[std::size_t(i)]) / (d[i] > 0 ? d[i] : 1);
    const Eigen::MatrixXd variance = inverse[std::size_t(b)] + inverse[std::size_t(b)] * of_free.transpose() *
                                                                   covariance * of_free *
                                                                   inverse[std::size_t(b)].transpose();
    for (int l = 0; l < L; ++l) {
      const double scale = problem.locals[std::size_t(l)].scale;
      out.local_variance(b, l) = variance(l, l) > 0 ? variance(l, l) * scale * scale : kNaN;
    }
  }
}

Eigen::MatrixXd correlation_of(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd inverse = covariance.diagonal().cwiseSqrt().cwiseInverse();
  return inverse.asDiagonal() * covariance * inverse.asDiagonal();
}

}  // namespace ukemi::identify
