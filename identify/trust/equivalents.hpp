// Terms that explain the same residuals: which they are, and what it means for a fit that took one of them.
#pragma once

#include <string>
#include <vector>

#include "identify/trust/score.hpp"

namespace ukemi::identify {

/// By how much BIC must be better for one explanation to be told from another.
inline constexpr double kToldApart = 10;

/// A term that would explain the residuals in another's place, to first order: of the fitted terms freed, both columns
/// are all but parallel, and what the rig states of their errors does not part them.
struct Rival {
  std::string term;  ///< that is looked at
  std::string other;
  double value = 0;           ///< of the other, in its place [its unit]
  double bic = 0;             ///< by which it explains less: below kToldApart
  std::vector<double> shift;  ///< of each Fit::fitted, were it the other
};

/// Of a term that the fit lacks, `size` beyond its absence.
[[nodiscard]] std::vector<Rival> rivals_of(const Experiment& experiment, const Fit& fit, const Sensitivity& score,
                                           const std::string& lacking, double size);
/// Of every shared term that was fitted beside the constants and is needed.
[[nodiscard]] std::vector<Rival> rivals_of_fitted(const Experiment& experiment, const Fit& fit,
                                                  const Sensitivity& score);
/// No constant is trusted that a rival would move out of its interval.
void distrust_moved(const std::vector<Rival>& rivals, Fit& fit);

}  // namespace ukemi::identify
