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

namespace {

/// Whether the residuals of a fit with a linear force are nearer to those of the smooth one: the first estimate of the
/// term `force_smooth`, which its score test gives.
bool asks_for_smooth_force(const Experiment& experiment, const Fit& fit) {
  const auto no_force = [](const Trial& t) { return t.force.empty(); };
  const auto set = [](const Trial& t) { return t.force_smooth != 0; };
  const std::vector<Trial>& trials = experiment.trials;
  if (std::all_of(trials.begin(), trials.end(), no_force) || std::any_of(trials.begin(), trials.end(), set))
    return false;
  Experiment alone{experiment.rig, trials, experiment.options};
  Terms<RigTerm>& terms = alone.options.terms;
  if (terms.fits(kForceSmooth)) return false;
  std::erase_if(terms.table,
                [&](const RigTerm& t) { return !t.is_constant() && !terms.fits(t.name) && t.name != kForceSmooth; });
  const std::optional<Score> score = score_of(alone, fit);
  if (!score) return false;
  const std::vector<ScoreTest> tests = score_tests_of(*score);
  return !tests.empty() && tests.front().size > 0.5;
}

}  // namespace

Identification identify(const Experiment& experiment, const std::optional<SeaParameters<double>>& start,
                        const SeaParameters<double>& base, const TrustOptions& options) {
  const std::vector<Trial>& trials = experiment.trials;
  Identification out{fit(experiment.rig, trials, start, base, experiment.options)};
  if (out.fit.fitted.empty()) return out;
  if (options.force == TrustOptions::Force::kByResiduals && asks_for_smooth_force(experiment, out.fit)) {
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
  out.force_smooth = trials.front().force_smooth;
  out.trust = examine(experiment, out.fit, options);
  return out;
}

}  // namespace ukemi::identify
