#include "identify/trust/ladder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/parallel.hpp"
#include "identify/estimate/statistics.hpp"
#include "identify/logs/trial_checks.hpp"

namespace ukemi::identify {

namespace {

/// Leave-one-out rms: each trial predicted by a fit of the others [rad].
double held_out_error(const Experiment& experiment, const Rung& rung) {
  const std::vector<Trial>& trials = experiment.trials;
  if (trials.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0, n = 0;
  for (std::size_t m = 0; m < trials.size(); ++m) {
    const Fit fit = refit(experiment.rig, without(trials, m), rung.fit.sea, rung.options);
    const double rms = held_out_rms(experiment.rig, trials[m], fit, rung.options);
    sum += double(trials[m].measurements()) * rms * rms, n += double(trials[m].measurements());
  }
  return std::sqrt(sum / n);
}

/// Whether `a` is the better fit; one without a usable start has no cost.
bool better(const Fit& a, const Fit& b) {
  if (a.fitted.empty() || b.fitted.empty()) return b.fitted.empty() && !a.fitted.empty();
  return a.converged != b.converged ? a.converged : a.cost < b.cost;
}

/// The ladder's terms.
std::vector<const RigTerm*> terms_of(const Experiment& experiment) {
  std::vector<const RigTerm*> out;
  for (const RigTerm& t : *experiment.options.terms.table)
    if (t.in_ladder) out.push_back(&t);
  return out;
}
/// Whether the rung of this index has the term: a bit each.
bool has(std::size_t rung, std::size_t term) { return rung >> term & 1; }

/// A rung for each subset of the terms, not yet fitted.
std::vector<Rung> rungs_of(const Experiment& experiment, const std::vector<const RigTerm*>& terms) {
  std::vector<Rung> out(std::size_t(1) << terms.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    Rung& r = out[i];
    r.options = experiment.options;
    std::vector<std::string>& nuisance = r.options.terms.nuisance;
    for (std::size_t t = 0; t < terms.size(); ++t) {
      if (!has(i, t)) {
        r.options.terms.remove(terms[t]->name);
        continue;
      }
      std::erase(nuisance, terms[t]->name);
      nuisance.push_back(terms[t]->name);
      r.name += (r.terms.empty() ? "" : " and ") + terms[t]->name;
      r.terms.push_back(terms[t]->name);
    }
    if (r.name.empty()) r.name = "plain";
  }
  return out;
}

/// Fits each rung from `fit` without the terms that the rung lacks; from drawn starts too where that is doubtful.
void fit_rungs(const Experiment& experiment, const std::vector<const RigTerm*>& terms, const Fit& fit, int threads,
               std::vector<Rung>& rungs) {
  const auto start_of = [&](int i) {
    SeaParameters<double> from = fit.sea;
    for (std::size_t t = 0; t < terms.size(); ++t)
      if (!has(std::size_t(i), t)) terms[t]->set_in(from, terms[t]->absent);
    return from;
  };
  parallel_for(int(rungs.size()), threads, [&](int i) {
    Rung& r = rungs[std::size_t(i)];
    r.fit = refit(experiment.rig, experiment.trials, start_of(i), r.options);
  });
  const Fit& full = rungs.back().fit;
  const bool restart_all = !full.converged || full.far_above_noise,
             any_held =
                 std::any_of(fit.parameters.begin(), fit.parameters.end(), [](const Estimate&e) { return !e.free; });
  parallel_for(int(rungs.size()), threads, [&](int i) {
    Rung& r = rungs[std::size_t(i)];
    if (r.terms.empty() || !(restart_all || !r.fit.converged)) return;
    const SeaParameters<double> from = start_of(i);
    Fit restarted = identify::fit(experiment.rig, experiment.trials, any_held ? std::optional(from) : std::nullopt,
                                  from, r.options);
    if (better(restarted, r.fit)) r.fit = std::move(restarted);
  });
}

/// Sets the rung's deviance, BIC and, if requested, error on held-out trials.
void set_criteria(const Experiment& experiment, HeldOut held_out, Rung& r) {
  const auto locals =
      std::count_if(r.fit.nuisance.begin(), r.fit.nuisance.end(), [](const Estimate& e) { return e.trial >= 0; });
  r.deviance = deviance(r.fit, experiment.trials, r.options);
  r.bic = r.deviance + double(long(r.fit.fitted.size()) + locals) * std::log(double(measurements(experiment.trials)));
  r.held_out = std::numeric_limits<double>::quiet_NaN();
  if (held_out == HeldOut::kCompute && r.fit.converged) r.held_out = held_out_error(experiment, r);
}

}  // namespace

Ladder ladder(const Experiment& experiment, const Fit& fit, HeldOut held_out, int threads) {
  experiment.validate(fit);
  const std::vector<const RigTerm*> terms = terms_of(experiment);
  Ladder out;
  out.rungs = rungs_of(experiment, terms);
  fit_rungs(experiment, terms, fit, threads, out.rungs);
  const std::size_t rungs = out.rungs.size();
  parallel_for(int(rungs), threads, [&](int i) { set_criteria(experiment, held_out, out.rungs[std::size_t(i)]); });
  for (std::size_t i = 1; i < rungs; ++i) {
    Rung& r = out.rungs[i];
    if (!r.fit.converged) continue;
    r.p = at_bound_tail(out.rungs[0].deviance - r.deviance, int(r.terms.size()));
    out.p_plain = std::min({1.0, out.p_plain, r.p * double(rungs - 1)});
    if (r.bic < out.rungs[out.preferred].bic || !out.rungs[out.preferred].fit.converged) out.preferred = i;
  }
  return out;
}

}  // namespace ukemi::identify
