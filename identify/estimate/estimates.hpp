// What a solution says of a table's terms: each as an estimate with its interval, and what a reader is warned of.
#pragma once

#include <string>
#include <vector>

#include "identify/estimate/term.hpp"
#include "identify/estimate/uncertainty.hpp"

namespace ukemi::identify {

/// The constants of a table as they are given, without errors; `value(term)` says where they stand.
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

/// How warnings speak.
struct Wording {
  const char* data;                                                             ///< "trials"
  enum class Interval { kRelative, kAbsolute } interval = Interval::kRelative;  ///< of a constant that is not known
  enum class Correlated { kAlways, kUnlessTrusted } correlated = Correlated::kAlways;  ///< said of two
};
/// Fills in what a solution says whose globals are `shared`, constants first; `out.parameters` are the constants as
/// they are given, `out.considered` what counts beside the noise; terms that ended at a bound join it. Warns of
/// constants at a bound, not identifiable, or hardly told apart.
void set_estimates(const LeastSquaresSolution& solution, const LeastSquaresProblem& problem,
                   const std::vector<const Term*>& shared, const Wording& wording, Estimates& out);
/// Covariances, standard errors, intervals and verdicts of what was fitted for all, from the noise's covariance, in the
/// order of `out.fitted`, and `out.considered`.
void set_errors(const Eigen::MatrixXd& noise, Estimates& out);
/// The same where they were set before; warnings of intervals tell the new ones.
void change_errors(const Eigen::MatrixXd& noise, double half_width, Wording::Interval interval, Estimates& out);
/// Of terms of which the logs without the prior say something else than it does, to first order; a residual whose
/// standard deviation is `noise` [the solution's unit] weighs 1.
void warn_of_priors(const Choice& choice, const LeastSquaresSolution& solution, double noise, Estimates& out);

}  // namespace ukemi::identify
