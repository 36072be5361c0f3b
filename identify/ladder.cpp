#include "identify/ladder.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "common/parallel.hpp"
#include "identify/statistics.hpp"

namespace ukemi::identify {

namespace {

/// rms over all trials, each predicted by a fit of the others.
double held_out_error(const Experiment& experiment, const Rung& rung) {
  const std::vector<Trial>& trials = experiment.trials;
  if (trials.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0, n = 0;
  for (std::size_t m = 0; m < trials.size(); ++m) {
    std::vector<Trial> others = trials;
    others.erase(others.begin() + long(m));
    const Fit fit = refit(experiment.rig, others, rung.fit.sea, rung.options);
    const double rms = held_out_rms(experiment.rig, trials[m], fit, rung.options);
    sum += double(trials[m].measurements()) * rms * rms, n += double(trials[m].measurements());
  }
  return std::sqrt(sum / n);
}

/// The fit of a rung from where another ended and, where terms that it adds leave the residual far above the noise,
/// from the starts that the trials suggest; the better of both.
Fit climb(const Experiment& experiment, const SeaParameters<double>& from, const FitOptions& options) {
  Fit near = refit(experiment.rig, experiment.trials, from, options);
  if (near.converged && !near.far_above_noise) return near;
  const bool some_held = std::count(options.free.begin(), options.free.end(), false) > 0;
  Fit far = fit(experiment.rig, experiment.trials, some_held ? std::optional(from) : std::nullopt, from, options);
  if (far.converged != near.converged) return far.converged ? far : near;
  return far.cost < near.cost ? far : near;
}

}  // namespace

Ladder ladder(const Experiment& experiment, const Fit& fit, HeldOut held_out, int threads) {
  constexpr unsigned kTerms = std::size(kLadderTerms), kRungs = 1u << kTerms;
  double samples = 0;
  for (const Trial& t : experiment.trials) samples += double(t.measurements());
  Ladder out;
  out.rungs.resize(kRungs);
  parallel_for(int(kRungs), threads, [&](int i) {
    Rung& r = out.rungs[std::size_t(i)];
    r.options = experiment.options;
    SeaParameters<double> from = fit.sea;
    for (unsigned t = 0; t < kTerms; ++t) {
      const LadderTerm& term = kLadderTerms[t];
      const bool has = unsigned(i) >> t & 1;
      std::erase(r.options.nuisance, term.asked);
      if (has) r.options.nuisance.push_back(term.asked);
      if (!has) from.*term.value = 0;
      if (has) r.name += (r.terms++ ? " and " : "") + std::string(term.name);
    }
    if (r.name.empty()) r.name = "plain";
    r.fit =
        r.terms > 0 ? climb(experiment, from, r.options) : refit(experiment.rig, experiment.trials, from, r.options);
    r.deviance = deviance(r.fit, experiment.trials, r.options);
    r.bic = r.deviance +
            double(r.fit.fitted.size() + std::size_t(std::count_if(r.fit.nuisance.begin(), r.fit.nuisance.end(),
                                                                   [](const Estimate& e) { return e.trial >= 0; }))) *
                std::log(samples);
    r.held_out = std::numeric_limits<double>::quiet_NaN();
    if (held_out == HeldOut::kCompute && r.fit.converged) r.held_out = held_out_error(experiment, r);
  });
  for (std::size_t i = 1; i < kRungs; ++i) {
    Rung& r = out.rungs[i];
    if (!r.fit.converged) continue;
    r.p = at_bound_tail(out.rungs[0].deviance - r.deviance, r.terms);
    out.p_plain = std::min({1.0, out.p_plain, r.p * double(kRungs - 1)});
    if (r.bic < out.rungs[out.preferred].bic || !out.rungs[out.preferred].fit.converged) out.preferred = i;
  }
  return out;
}

}  // namespace ukemi::identify
