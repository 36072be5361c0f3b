// A solution as estimates of a table's terms, with their intervals and verdicts, and the warnings.
#pragma once

#include <string>
#include <vector>

#include "identify/estimate/term.hpp"
#include "identify/estimate/uncertainty.hpp"

namespace ukemi::identify {

/// The constants of a table at given values, without errors; `value(term)` returns each.
template <class T, class Value>
std::vector<Estimate> as_given(const Terms<T>& terms, Value&& value) {
  std::vector<Estimate> out;
  for (const T& t : *terms.table) {
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

/// The constant of that name; null where there is none.
const Estimate* find_constant(const Estimates& fit, const std::string& name);

/// The wording of warnings.
struct Wording {
  const char* data;                                                                    ///< "trials"
  enum class Interval { kRelative, kAbsolute } interval = Interval::kRelative;         ///< of unidentifiable constants
  enum class Correlated { kAlways, kUnlessTrusted } correlated = Correlated::kAlways;  ///< when to warn of a pair
};
/// Fills in `out` from a solution whose globals are `shared`, constants first; `out.parameters` are the constants as
/// given, `out.considered` the errors beside the noise, to which terms at a bound are added. Warns of constants at a
/// bound, not identifiable, or strongly correlated.
void set_estimates(const LeastSquaresSolution& solution, const LeastSquaresProblem& problem,
                   const std::vector<const Term*>& shared, const Wording& wording, Estimates& out);
/// Sets covariances, standard errors, intervals and verdicts of the globals from the noise's covariance, in the order
/// of `out.fitted`, and from `out.considered`.
void set_errors(const Eigen::MatrixXd& noise, Estimates& out);
/// Replaces the errors that were set before, and the warnings of wide intervals.
void update_errors(const Eigen::MatrixXd& noise, double half_width, Wording::Interval interval, Estimates& out);
/// Warns of priors that the logs alone contradict, to first order; a residual whose standard deviation is `noise` [the
/// solution's unit] weighs 1.
void warn_of_priors(const Choice& choice, const LeastSquaresSolution& solution, double noise, Estimates& out);

}  // namespace ukemi::identify
