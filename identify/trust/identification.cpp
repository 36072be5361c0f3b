#include "identify/trust/identification.hpp"

#include <algorithm>

#include "common/error.hpp"

namespace ukemi::identify {

Trust examine(const Experiment& experiment, Fit& fit, const TrustOptions& options) {
  Trust out;
  out.tests = test_residuals(experiment, fit);
  widen_errors(out.tests, fit);
  if (fit.interrupted) return out;
  if (options.depth == TrustOptions::Depth::kRefit) {
    out.ladder = ladder(experiment, fit, HeldOut::kCompute, options.threads);
    if (fit.converged) out.left_out = leave_one_out(experiment, fit, options.threads);
  }
  for (const std::string& constant : options.profiles) {
    const auto e = std::find_if(fit.parameters.begin(), fit.parameters.end(),
                                [&](const Estimate& p) { return p.name == constant; });
    if (e == fit.parameters.end()) throw InputError("profile: " + quoted(constant) + ": no such constant");
    if (e->std && fit.converged)
      out.profiles.push_back(profile(experiment, fit, constant));
    else
      out.not_profiled.push_back(constant);
  }
  return out;
}

Identification identify(const Experiment& experiment, const std::optional<SeaParameters<double>>& start,
                        const SeaParameters<double>& base, const TrustOptions& options) {
  Identification out{fit(experiment.rig, experiment.trials, start, base, experiment.options), {}};
  if (!out.fit.fitted.empty()) out.trust = examine(experiment, out.fit, options);
  return out;
}

}  // namespace ukemi::identify
