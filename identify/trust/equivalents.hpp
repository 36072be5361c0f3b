// Terms that explain the same residuals: which they are, and what it means for a fit that took one of them.
#pragma once

#include <string>
#include <vector>

#include "identify/trust/score.hpp"

namespace ukemi::identify {

/// By how much BIC must be better for one explanation to be told from another.
inline constexpr double kToldApart = 10;

/// A term that would explain the residuals in another's place as well, what the rig states of their errors counted.
struct Rival {
  std::string term;  ///< that is looked at
  std::string other;
  double value = 0;           ///< of the other, in its place [its unit]
  double bic = 0;             ///< by which it explains less: below kToldApart
  std::vector<double> shift;  ///< of each Fit::fitted, were it the other
};

/// Of a term that the fit lacks, `size` beyond its absence: to first order, the fitted terms following.
[[nodiscard]] std::vector<Rival> rivals_of(const Experiment& experiment, const Fit& fit, const Sensitivity& score,
                                           const std::string& lacking, double size);
/// Of every shared term that was fitted beside the constants and is needed: to first order and, where constants would
/// be trusted, by a fit with each of the few in its place that explain half of what it explains or more.
[[nodiscard]] std::vector<Rival> rivals_of_fitted(const Experiment& experiment, const Fit& fit,
                                                  const Sensitivity& score);
/// No constant is trusted that a rival would move out of its interval.
void distrust_moved(const std::vector<Rival>& rivals, Fit& fit);

}  // namespace ukemi::identify
