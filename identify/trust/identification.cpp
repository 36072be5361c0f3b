#include "identify/trust/identification.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

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

/// The shared term of that name where it may be absent: an optional one of the actuator, with 0 as its bound; else
/// null.
const RigTerm* optional_term(const Terms<RigTerm>& terms, const std::string& name) {
  const auto t = std::find_if(terms.table.begin(), terms.table.end(), [&](const RigTerm& r) { return r.name == name; });
  const bool may_be_absent = t != terms.table.end() && !t->is_constant() && !t->key.empty() && t->one_sided() &&
                             t->relative_to != &SeaParameters<double>::k_t;  // a motor without torque drives nothing
  return may_be_absent ? &*t : nullptr;
}

/// An optional term that others do completely in these trials; none: nothing.
std::optional<HeldTerm> redundant(const Fit& fit, const Terms<RigTerm>& terms) {
  constexpr double kSame = 1e-6;  // off a correlation of 1 or -1: rounding tells the two apart, no log
  const std::vector<const Estimate*> globals = fit.globals();
  for (std::size_t i = 0; i < globals.size(); ++i) {
    const Estimate& e = *globals[i];
    if (e.at_bound || !e.free || !optional_term(terms, e.name)) continue;
    HeldTerm out{e.name, {}};
    for (std::size_t j = 0; j < globals.size(); ++j) {
      const bool both_undetermined = !e.std && !globals[j]->std && globals[j]->free && !globals[j]->at_bound;
      if (i != j && (both_undetermined || std::abs(fit.correlation(long(i), long(j))) > 1 - kSame))
        out.others.push_back(globals[j]->name);
    }
    if (!out.others.empty()) return out;
  }
  return std::nullopt;
}

/// Holds what the trials cannot tell from others, and fits again without it.
void hold_redundant(Experiment& experiment, Identification& out) {
  Terms<RigTerm>& terms = experiment.options.terms;
  std::vector<std::string> warnings;
  while (out.fit.converged && !out.fit.interrupted) {
    const auto found = redundant(out.fit, terms);
    if (!found) break;
    const RigTerm& term = *optional_term(terms, found->term);
    SeaParameters<double> from = out.fit.sea;
    term.set_in(from, term.absent);
    std::erase_if(terms.nuisance, [&](const std::string& n) { return n == term.name; });
    Fit again = refit(experiment.rig, experiment.trials, from, experiment.options);
    again.minima = std::move(out.fit.minima), again.starts += out.fit.starts;
    out.fit = std::move(again);
    warnings.push_back(fmt::format("these trials cannot tell {} from {}: {} is held at {:g}", found->term,
                                   fmt::join(found->others, " and "), found->term, term.absent));
    out.held.push_back(*found);
  }
  out.fit.warnings.insert(out.fit.warnings.begin(), warnings.begin(), warnings.end());
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
  Experiment told_apart = experiment;
  Identification out{fit(experiment.rig, trials, start, base, experiment.options)};
  if (out.fit.fitted.empty()) return out;
  hold_redundant(told_apart, out);
  out.force_smooth = trials.front().force_smooth;
  out.trust = tested(told_apart, out.fit);
  if (options.force == TrustOptions::Force::kByResiduals && ask_for_smooth_force(out.trust->tests, trials)) {
    std::vector<Trial> smooth = trials;
    for (Trial& t : smooth) t.force_smooth = 1;
    Fit again = refit(experiment.rig, smooth, out.fit.sea, told_apart.options);
    if (again.converged && again.rms < out.fit.rms) {
      again.minima = std::move(out.fit.minima), again.starts += out.fit.starts;
      out.fit = std::move(again), out.force_smooth = 1;
      out.trust = examine({experiment.rig, smooth, told_apart.options}, out.fit, options);
      return out;
    }
  }
  deepen(told_apart, out.fit, options, *out.trust);
  return out;
}

}  // namespace ukemi::identify
