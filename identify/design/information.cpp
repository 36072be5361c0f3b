#include "identify/design/information.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/checks.hpp"
#include "common/decompositions.hpp"
#include "common/eigen.hpp"
#include "common/error.hpp"
#include "identify/estimate/least_squares.hpp"
#include "identify/estimate/statistics.hpp"

namespace ukemi::identify {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kUndetermined = std::numeric_limits<double>::infinity();

std::size_t slot(int constant) { return std::size_t(constant); }

}  // namespace

void Knowledge::validate() const {
  ukemi::validate(sea);
  const auto u = ukemi::constants(sea);
  for (const int c : constants) {
    if (c < 0 || c >= kConstants)
      throw InputError(fmt::format("knowledge: constant {}: 0 to {} is needed", c, kConstants - 1));
    check_positive(kConstantNames[slot(c)], u[slot(c)]);
  }
  const long n = long(constants.size());
  if (n == 0 || n > kConstants || information.rows() != n || information.cols() != n || !information.allFinite())
    throw InputError(
        fmt::format("knowledge: information of {} x {}: finite, a row for each of 1 to {} constants, is needed",
                    information.rows(), information.cols(), kConstants));
}

RolloutStatus differentiate(const Rig& rig, const SeaParameters<double>& sea, const std::vector<int>& constants,
                            const PreparedTrial& trial, std::vector<ConstantJet>& phi,
                            std::vector<ConstantJet>& phi_m) {
  auto p = sea.cast<ConstantJet>();
  auto u = ukemi::constants(p);
  for (std::size_t i = 0; i < constants.size(); ++i) u[slot(constants[i])].v[long(i)] = u[slot(constants[i])].a;
  set_constants(p, u);
  return rollout(rig, p, {}, trial, {}, phi, phi_m);
}

std::optional<MatrixXd> information_of(const Rig& rig, const SeaParameters<double>& sea,
                                       const std::vector<int>& constants, const Trial& trial, double noise) {
  check_positive("noise", noise);
  thread_local std::vector<ConstantJet> phi, phi_m;
  const PreparedTrial prepared(trial);
  if (differentiate(rig, sea, constants, prepared, phi, phi_m) != RolloutStatus::kDone) return std::nullopt;
  using Square = Eigen::Matrix<double, kSmallJet, kSmallJet>;
  Square sum = Square::Zero();
  for (std::size_t i = 0; i < trial.phi.size(); ++i) sum.noalias() += phi[i].v * phi[i].v.transpose();
  for (std::size_t i = 0; i < trial.phi_motor.size(); ++i) sum.noalias() += phi_m[i].v * phi_m[i].v.transpose();
  const long n = long(constants.size());
  const MatrixXd out = sum.topLeftCorner(n, n) / (noise * noise);
  if (!out.allFinite()) return std::nullopt;
  return out;
}

std::vector<int> uncertain_constants(const Actuator& actuator) {
  const auto u = ukemi::constants(actuator.sea);
  const std::vector<std::string>& named = actuator.uncertain;
  std::vector<int> out;
  for (int c = 0; c < kConstants; ++c)
    if (u[slot(c)] > 0 &&
        (named.empty() || std::find(named.begin(), named.end(), kConstantNames[slot(c)]) != named.end()))
      out.push_back(c);
  return out;
}

Knowledge knowledge_of(const Rig& rig, const SeaParameters<double>& sea, const std::vector<int>& constants,
                       const std::vector<Trial>& trials, double noise) {
  const long n = long(constants.size());
  Knowledge k{.sea = sea, .constants = constants, .information = MatrixXd::Zero(n, n)};
  for (const Trial& t : trials) {
    const auto added = information_of(rig, sea, constants, t, noise);
    if (!added) throw InputError({t.file}, "the estimate cannot be followed through this trial: fit it first");
    k.information += *added;
    k.measurements += long(t.phi.size() + t.phi_motor.size());
  }
  return k;
}

std::optional<Knowledge> knowledge_of(const Actuator& actuator) {
  Knowledge k{.sea = actuator.sea, .constants = uncertain_constants(actuator), .information = {}};
  if (actuator.uncertain.empty() || k.constants.empty()) return std::nullopt;
  const auto u = ukemi::constants(actuator.sea);
  std::vector<long> rows;
  VectorXd inverse(long(k.constants.size()));
  for (const int c : k.constants) {
    const auto at = std::find(actuator.uncertain.begin(), actuator.uncertain.end(), kConstantNames[slot(c)]);
    inverse[long(rows.size())] = 1 / u[slot(c)];
    rows.push_back(at - actuator.uncertain.begin());
  }
  const auto information =
      covariance_of(inverse.asDiagonal() * MatrixXd(eigen(actuator.covariance)(rows, rows)) * inverse.asDiagonal());
  if (!information) return std::nullopt;
  k.information = *information;
  return k;
}

std::optional<MatrixXd> covariance_of(const MatrixXd& information) {
  // Unit diagonal first: what counts as singular then does not depend on scales.
  if (!(information.diagonal().array() > 0).all()) return std::nullopt;
  const VectorXd d = information.diagonal().cwiseSqrt().cwiseInverse();
  const SymmetricEigen eigen = symmetric_eigen(d.asDiagonal() * information * d.asDiagonal());
  constexpr double kSingular = 1e-13;
  const VectorXd& values = eigen.values;
  if (!(values[0] > kSingular * values[values.size() - 1])) return std::nullopt;
  return MatrixXd(d.asDiagonal() * eigen.vectors * values.cwiseInverse().asDiagonal() * eigen.vectors.transpose() *
                  d.asDiagonal());
}

VectorXd half_widths(const MatrixXd& information, long measurements) {
  const auto covariance = covariance_of(information);
  if (!covariance) return VectorXd::Constant(information.rows(), kUndetermined);
  constexpr long kManyDegrees = 1'000'000'000;
  return t_quantile_975(measurements > 0 ? std::max(measurements - information.rows(), 1l) : kManyDegrees) *
         covariance->diagonal().cwiseSqrt();
}

const char* name(Criterion criterion) {
  return criterion == Criterion::kWorst ? "worst" : criterion == Criterion::kD ? "d" : "e";
}
double criterion_value(Criterion criterion, const MatrixXd& information) {
  const auto covariance = covariance_of(information);
  if (!covariance) return kUndetermined;
  if (criterion == Criterion::kWorst) return std::sqrt(covariance->diagonal().maxCoeff());
  const VectorXd axes = symmetric_eigen(*covariance).values.cwiseMax(0).cwiseSqrt();
  if (criterion == Criterion::kE) return axes.maxCoeff();
  return std::exp(axes.array().log().mean());
}

}  // namespace ukemi::identify
