#include "identify/trust/identification.hpp"

#include <algorithm>

#include "common/error.hpp"

namespace ukemi::identify {

namespace {

/// What a fraction of a fit's own time tells; widens the fit's errors.
Trust tested(const Experiment& experiment, Fit& fit) {
  Trust out{.tests = test_residuals(experiment, fit)};
  widen_errors(out.tests, fit);
  return out;
}

/// Adds what takes several fits.
void deepen(const Experiment& experiment, const Fit& fit, const TrustOptions& options, Trust& out) {
  if (fit.interrupted) return;
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
}

/// Whether the residuals of fits with a linear force are nearer to those of the smooth one: the first estimate of the
/// term `force_smooth`, which its score test gives.
bool ask_for_smooth_force(const ResidualTests& tests, const std::vector<Trial>& trials) {
  if (std::any_of(trials.begin(), trials.end(), [](const Trial& t) { return t.force_smooth != 0; })) return false;
  return std::any_of(tests.score_tests.begin(), tests.score_tests.end(),
                     [](const ScoreTest& t) { return t.term == kForceSmooth && t.size > 0.5; });
}

}  // namespace

Trust examine(const Experiment& experiment, Fit& fit, const TrustOptions& options) {
  Trust out = tested(experiment, fit);
  deepen(experiment, fit, options, out);
  return out;
}

Identification identify(const Experiment& experiment, const std::optional<SeaParameters<double>>& start,
                        const SeaParameters<double>& base, const TrustOptions& options) {
  const std::vector<Trial>& trials = experiment.trials;
  Identification out{fit(experiment.rig, trials, start, base, experiment.options)};
  if (out.fit.fitted.empty()) return out;
  out.force_smooth = trials.front().force_smooth;
  out.trust = tested(experiment, out.fit);
  if (options.force == TrustOptions::Force::kByResiduals && ask_for_smooth_force(out.trust->tests, trials)) {
    std::vector<Trial> smooth = trials;
    for (Trial& t : smooth) t.force_smooth = 1;
    Fit again = refit(experiment.rig, smooth, out.fit.sea, experiment.options);
    if (again.converged && again.rms < out.fit.rms) {
      again.minima = std::move(out.fit.minima), again.starts += out.fit.starts;
      out.fit = std::move(again), out.force_smooth = 1;
      out.trust = examine({experiment.rig, smooth, experiment.options}, out.fit, options);
      return out;
    }
  }
  deepen(experiment, out.fit, options, *out.trust);
  return out;
}

}  // namespace ukemi::identify
