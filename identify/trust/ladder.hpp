// The model ladder: fits of the same trials with and without each optional term, to select the model.
#pragma once

#include <string>
#include <vector>

#include "identify/trust/diagnostics.hpp"

namespace ukemi::identify {

struct Rung {
  std::string name;                ///< "plain", "friction", ...
  std::vector<std::string> terms;  ///< those of the ladder that it has
  FitOptions options;
  Fit fit;
  double deviance = 0;
  double bic = 0;  ///< deviance + (fitted parameters) log(samples); the smallest is preferred
  double p = 1;    ///< of the likelihood ratio against plain, the terms at their bound, 0, under the null hypothesis
  double held_out = 0;  ///< rms over all trials, each predicted from the others; NaN with a single trial [rad]
};

struct Ladder {
  std::vector<Rung> rungs;    ///< plain first, then every combination of the terms
  std::size_t preferred = 0;  ///< smallest BIC among those that converged
  double p_plain = 1;         ///< of plain: the smallest p, times the number of alternatives
  bool plain_rejected() const { return p_plain < kTestLevel; }
};

enum class HeldOut { kSkip, kCompute };

/// Fits with every combination of the table's ladder terms (RigTerm::in_ladder), each from the minimum of `fit` and, if
/// the residual stays far above the noise with all terms, also from drawn starts. The options' other terms are kept. On
/// `threads` threads (0: all).
[[nodiscard]] Ladder ladder(const Experiment& experiment, const Fit& fit, HeldOut held_out, int threads = 1);

}  // namespace ukemi::identify
