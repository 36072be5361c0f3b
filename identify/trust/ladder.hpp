// The model ladder: the same trials with and without each optional term, to see which they ask for.
#pragma once

#include <string>
#include <vector>

#include "identify/trust/diagnostics.hpp"

namespace ukemi::identify {

struct Rung {
  std::string name;                ///< "plain", "friction", ...
  std::vector<std::string> terms;  ///< of the ladder, that it has
  FitOptions options;
  Fit fit;
  double deviance = 0;
  double bic = 0;       ///< deviance + (fitted parameters) log(samples); the smallest is preferred
  double p = 1;         ///< of the likelihood ratio against plain, under which the terms are at their bound, 0
  double held_out = 0;  ///< rms over all trials, each predicted from the others; NaN with a single trial [rad]
};

struct Ladder {
  std::vector<Rung> rungs;    ///< plain first, then every combination of the terms
  std::size_t preferred = 0;  ///< smallest BIC among those that converged
  double p_plain = 1;         ///< of plain: the smallest p, times the number of alternatives
  bool plain_rejected() const { return p_plain < kTestLevel; }
};

enum class HeldOut { kSkip, kCompute };

/// Fits with every combination of the table's ladder terms (RigTerm::in_ladder), each from where `fit` ended and, where
/// even all terms leave the residual far above the noise, again from fresh starts. What the options fit beside these
/// terms stays. On `threads` threads (0: all).
[[nodiscard]] Ladder ladder(const Experiment& experiment, const Fit& fit, HeldOut held_out, int threads = 1);

}  // namespace ukemi::identify
