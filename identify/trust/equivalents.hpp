// Terms that explain the same residuals: which they are, and their consequence for a fit with one of them.
#pragma once

#include <string>
#include <vector>

#include "identify/trust/score.hpp"

namespace ukemi::identify {

/// Difference in BIC from which one explanation is distinguished from another.
inline constexpr double kToldApart = 10;

/// A term that would explain the residuals as well as another, given the errors that the rig states.
struct Rival {
  std::string term;           ///< the one that is examined
  std::string other;          ///< the rival
  double value = 0;           ///< of the rival, replacing the term [its unit]
  double bic = 0;             ///< by which the rival is worse: below kToldApart
  std::vector<double> shift;  ///< of each Fit::fitted, if the rival replaces the term
};

/// The rivals of a term that the fit lacks, at `size` beyond its absent value, to first order.
[[nodiscard]] std::vector<Rival> rivals_of(const Experiment& experiment, const Fit& fit, const Sensitivity& score,
                                           const std::string& lacking, double size);
/// The rivals of every shared nuisance term that was fitted and is needed: to first order and, where constants would be
/// trusted, by fits with the best of those that explain at least half of what it explains.
[[nodiscard]] std::vector<Rival> rivals_of_fitted(const Experiment& experiment, const Fit& fit,
                                                  const Sensitivity& score);
/// Distrusts each constant that a rival would move out of its interval.
void distrust_moved(const std::vector<Rival>& rivals, Fit& fit);

}  // namespace ukemi::identify
