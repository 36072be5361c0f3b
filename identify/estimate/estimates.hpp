// What a solution says of a table's terms: each as an estimate with its interval, and what a reader is warned of.
#pragma once

#include <string>
#include <vector>

#include "identify/estimate/term.hpp"
#include "identify/estimate/uncertainty.hpp"

namespace ukemi::identify {

struct Estimates {
  std::vector<Estimate> parameters;         ///< every constant of the table, in its order, fitted or not
  std::vector<Estimate> nuisance;           ///< shared, then term by term those of each trial
  std::vector<std::string> fitted;          ///< order of `covariance`: free constants, then shared terms
  Eigen::MatrixXd covariance, correlation;  ///< NaN where not determined
  Eigen::VectorXd eigenvalues;              ///< of the scaled information, ascending, largest 1
  double half_width = 1.96;                 ///< 95 % interval in standard errors (Student's t)
  std::optional<Weakest> weakest;           ///< the combination of constants that the data know least

  /// What was fitted for all trials, in the order of `fitted`.
  std::vector<const Estimate*> globals() const;
};

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

/// The estimates of a solution whose globals are `shared`, constants first; `given` are the constants as they are
/// given.
[[nodiscard]] Estimates estimates_of(const LeastSquaresSolution& solution, const LeastSquaresProblem& problem,
                                     const std::vector<const Term*>& shared, std::vector<Estimate> given);

/// How warnings speak.
struct Wording {
  const char* data;                                                             ///< "trials"
  enum class Interval { kRelative, kAbsolute } interval = Interval::kRelative;  ///< of a constant that is not known
  enum class Correlated { kAlways, kUnlessTrusted } correlated = Correlated::kAlways;  ///< said of two
};
/// Constants at a bound, not identifiable, or hardly told apart.
std::vector<std::string> warnings_of(const Estimates& estimates, const Wording& wording);

}  // namespace ukemi::identify
