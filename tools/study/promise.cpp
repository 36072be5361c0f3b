#include "tools/study/promise.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/decompositions.hpp"
#include "common/eigen.hpp"
#include "tools/study/drop_problem.hpp"

namespace ukemi::tools {

namespace {

/// Propagates errors of the constants to predicted drops.
class ErrorPropagation {
 public:
  ErrorPropagation(const DropSimulator& drops, const CalibrationOptions& options, const FloorFit& predicted,
                   const FitUncertainty& uncertainty)
      : drops_(drops), options_(options), predicted_(predicted), scatter_(predicted.noise) {
    const auto& table = *options.terms.table;
    for (std::size_t o = 0; o < scatter_.size(); ++o)
      if (const auto rms = uncertainty.rms.find(predicted.channels[o].name); rms != uncertainty.rms.end())
        scatter_[o] = std::fmax(scatter_[o], rms->second);
    const auto& [order, all] = uncertainty.constants;
    std::vector<int> kept;
    for (std::size_t k = 0; k < order.size(); ++k) {
      const auto term = std::find_if(table.begin(), table.end(), [&, k](auto& t) { return t.name == order[k]; });
      if (term == table.end() || !(all(long(k), long(k)) > 0)) continue;
      kept.push_back(int(k)), layout_.shared.push_back(&*term);
    }
    for (const std::string& name : options.terms.nuisance) layout_.own.push_back(&options.terms[name]);
    const Eigen::MatrixXd covariance = eigen(all)(kept, kept);
    std_ = covariance.diagonal().cwiseSqrt();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> correlation(std_.cwiseInverse().asDiagonal() * covariance *
                                                                     std_.cwiseInverse().asDiagonal());
    independent_ = correlation.eigenvectors() * correlation.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  }

  PredictionBands bands_of(std::size_t m) const {
    PredictionBands out;
    const DropProblem problem(drops_, layout_, options_, {m});
    const DropProblem::Start constants = problem.given();
    std::vector<double> own;
    for (const DropTerm* t : layout_.own) own.push_back(value_of(t->name, m));
    constexpr auto kSkip = DropResiduals::Peaks::kSkip;
    const DropResult here = problem.residuals[0].replay(constants.data(), own.data(), kSkip);
    const std::optional<Eigen::MatrixXd> own_slopes = own_by_constants(problem, constants, own);
    if (!here.simulated || !own_slopes) return out;
    std::vector<DropResult> moved;
    for (long k = 0; k < std_.size(); ++k) {
      DropProblem::Start perturbed = constants;
      perturbed[std::size_t(k)] += kStep * std_[k];
      std::vector<double> nuisance = own;
      for (std::size_t l = 0; l < nuisance.size(); ++l) nuisance[l] += (*own_slopes)(long(l), k) * kStep * std_[k];
      moved.push_back(problem.residuals[0].replay(perturbed.data(), nuisance.data(), kSkip));
      if (!moved.back().simulated) return out;
    }
    out.band.resize(here.value.size());
    for (std::size_t o = 0; o < here.value.size(); ++o)
      for (std::size_t i = 0; i < here.value[o].size(); ++i)
        out.band[o].push_back(kNormal975 * std::hypot(scatter_[o], by_errors(here, moved, [&](const DropResult& d) {
                                                                     return d.value[o][i];
                                                                   }).norm()));
    const auto same_contacts = [&](const DropResult& d) {
      return std::equal(d.changes.begin(), d.changes.end(), here.changes.begin(), here.changes.end(),
                        [](auto& a, auto& b) { return a.contact == b.contact && a.touches == b.touches; });
    };
    const bool same = std::all_of(moved.begin(), moved.end(), same_contacts);
    out.change =
        Eigen::MatrixXd::Constant(long(here.changes.size()), std_.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; same && i < here.changes.size(); ++i)
      out.change.row(long(i)) = by_errors(here, moved, [&](const DropResult& d) { return d.changes[i].t; });
    return out;
  }

 private:
  static constexpr double kStep = 0.1;  ///< of the differences, in standard errors

  double value_of(const std::string& name, std::size_t m) const {
    for (const identify::Estimate& e : predicted_.nuisance)
      if (e.trial == int(m) && e.name == name) return e.value;
    return options_.terms[name].absent;
  }
  /// Derivatives of the drop's refitted nuisance terms by the constants.
  std::optional<Eigen::MatrixXd> own_by_constants(const DropProblem& problem, const DropProblem::Start& constants,
                                                  const std::vector<double>& own) const {
    const DropProblem::Problem p = problem.problem(constants, predicted_.noise, kWhole);
    const identify::ResidualBlock& block = p.blocks[0];
    Eigen::VectorXd residual(block.size);
    Eigen::MatrixXd jacobian(block.size, long(constants.size() + own.size()));
    if (!block.evaluate(constants.data(), own.data(), residual.data(), jacobian.data())) return std::nullopt;
    if (own.empty()) return Eigen::MatrixXd(0, long(constants.size()));
    return Eigen::MatrixXd(
        -LeastNorm(jacobian.rightCols(long(own.size()))).solve(jacobian.leftCols(long(constants.size()))));
  }
  /// Derivatives of a value by independent errors of variance 1.
  template <class Value>
  Eigen::RowVectorXd by_errors(const DropResult& here, const std::vector<DropResult>& moved, Value&& value) const {
    Eigen::RowVectorXd slope(std_.size());
    for (long k = 0; k < slope.size(); ++k) slope[k] = (value(moved[std::size_t(k)]) - value(here)) / kStep;
    return slope * independent_;
  }

  const DropSimulator& drops_;
  const CalibrationOptions& options_;
  const FloorFit& predicted_;
  std::vector<double> scatter_;  ///< standard deviation of each output about its prediction
  DropLayout layout_;
  Eigen::VectorXd std_;
  Eigen::MatrixXd independent_;  ///< maps independent errors of variance 1 to the constants' errors over std_
};

}  // namespace

std::vector<PredictionBands> predict_bands(const DropSimulator& drops, const CalibrationOptions& options,
                                           const FloorFit& predicted, const FitUncertainty& uncertainty) {
  const ErrorPropagation propagation(drops, options, predicted, uncertainty);
  std::vector<PredictionBands> out;
  for (std::size_t m = 0; m < drops.drops(); ++m) out.push_back(propagation.bands_of(m));
  return out;
}

}  // namespace ukemi::tools
