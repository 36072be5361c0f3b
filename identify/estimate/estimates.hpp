// What a solution says of a table's terms: each as an estimate with its interval, and what a reader is warned of.
#pragma once

#include <string>
#include <vector>

#include "common/uncertainty.hpp"
#include "identify/estimate/term.hpp"
#include "identify/estimate/uncertainty.hpp"

namespace ukemi::identify {

/// The result of a fit, whatever it fits.
struct Estimates {
  std::vector<Estimate> parameters;  ///< every constant of the table, in its order, fitted or not
  std::vector<Estimate> nuisance;    ///< shared, then term by term those of each trial
  std::vector<std::string> fitted;   ///< order of `covariance`: free constants, then shared terms
  /// Of noise and what was considered; NaN where not determined.
  Eigen::MatrixXd covariance, correlation;
  Eigen::MatrixXd noise_covariance;    ///< the part of it that is the logs' noise
  std::vector<Considered> considered;  ///< what was not fitted and is not exact
  Eigen::VectorXd eigenvalues;         ///< of the scaled information, ascending, largest 1
  double half_width = kNormal975;      ///< 95 % interval in standard errors (Student's t)
  std::optional<Weakest> weakest;      ///< the combination of constants that the data know least
  double cost = 0;                     ///< the sum of squares; weighted or robust where asked for
  bool converged = false;
  int iterations = 0;   ///< of the start that won
  int starts = 0;       ///< how many were run
  std::string message;  ///< why it did not converge, or that it was interrupted
  std::vector<std::string> warnings;

  /// Whether it converged and every fitted constant is trusted.
  bool trusted() const { return converged && all_trusted(parameters); }
  /// What was fitted for all trials, in the order of `fitted`.
  std::vector<const Estimate*> globals() const;
};

/// Where a constant's variance comes from.
struct ErrorBudget {
  std::string constant;
  std::vector<std::pair<std::string, double>> shares;  ///< "noise", then each Considered: parts of the variance, sum 1
};
/// Of every constant that has a standard error.
[[nodiscard]] std::vector<ErrorBudget> error_budget(const Estimates& estimates);

/// The constants of a table as they are given, without errors; `value(term)` says where they stand.
template <class T, class Value>
std::vector<Estimate> as_given(const Terms<T>& terms, Value&& value) {
  std::vector<Estimate> out;
  for (const T& t : terms.table) {
    if (!t.is_constant()) continue;
    const bool free = terms.fits(t.name);
    out.push_back({.name = t.name,
                   .unit = t.unit,
                   .value = value(t),
                   .std = {},
                   .free = free,
                   .verdict = free ? Identifiability::kNotIdentifiable : Identifiability::kFixed});
  }
  return out;
}

/// How warnings speak.
struct Wording {
  const char* data;                                                             ///< "trials"
  enum class Interval { kRelative, kAbsolute } interval = Interval::kRelative;  ///< of a constant that is not known
  enum class Correlated { kAlways, kUnlessTrusted } correlated = Correlated::kAlways;  ///< said of two
};
/// Fills in what a solution says whose globals are `shared`, constants first; `out.parameters` are the constants as
/// they are given, `out.considered` what counts beside the noise. Warns of constants at a bound, not identifiable, or
/// hardly told apart.
void set_estimates(const LeastSquaresSolution& solution, const LeastSquaresProblem& problem,
                   const std::vector<const Term*>& shared, const Wording& wording, Estimates& out);
/// Covariances, standard errors, intervals and verdicts of what was fitted for all, from the noise's covariance, in the
/// order of `out.fitted`, and `out.considered`.
void set_errors(const Eigen::MatrixXd& noise, Estimates& out);

}  // namespace ukemi::identify
