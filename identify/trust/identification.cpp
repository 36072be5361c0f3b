#include "identify/trust/identification.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/actuator_constants.hpp"
#include "common/error.hpp"
#include "identify/estimate/covariance.hpp"
#include "identify/logs/trial_checks.hpp"

namespace ukemi::identify {

namespace {

/// Tests of Depth::kResiduals; widens the fit's errors.
Trust test_fit(const Experiment& experiment, Fit& fit) {
  Trust out;
  out.tests = test_residuals(experiment, fit);
  widen_errors(out.tests, fit);
  if (!out.tests.score) return out;
  out.rivals = rivals_of_fitted(experiment, fit, *out.tests.score);
  distrust_moved(out.rivals, fit);
  if (const ScoreTest* missing = out.tests.missing())
    for (Rival& r : rivals_of(experiment, fit, *out.tests.score, missing->term, missing->size))
      out.rivals.push_back(std::move(r));
  return out;
}

/// Adds the tests that refit.
void add_refits(const Experiment& whole, const Fit& fit, const TrustOptions& options, Trust& out) {
  if (fit.interrupted) return;
  const Experiment experiment = noise_only(whole);
  if (options.depth == TrustOptions::Depth::kRefit) {
    out.ladder = ladder(experiment, fit, HeldOut::kCompute, options.threads);
    if (fit.converged) out.left_out = leave_one_out(experiment, fit, options.threads);
  }
  for (const std::string& constant : options.profiles) {
    const Estimate* e = find_constant(fit, constant);
    if (!e) throw InputError("profile: " + quoted(constant) + ": no such constant");
    if (e->std && fit.converged)
      out.profiles.push_back(profile(experiment, fit, constant));
    else
      out.not_profiled.push_back(constant);
  }
}

/// Whether it is an optional constant of the actuator; k_t is none: a motor without torque drives nothing.
bool is_optional_constant(const RigTerm& t) {
  return !t.is_constant() && !t.key.empty() && t.relative_to != &SeaParameters<double>::k_t;
}

/// The optional term of the actuator of that name, if its bound is its absent value, 0; else null.
const RigTerm* optional_term(const Terms<RigTerm>& terms, const std::string& name) {
  const auto t =
      std::find_if(terms.table->begin(), terms.table->end(), [&](const RigTerm& r) { return r.name == name; });
  return t != terms.table->end() && is_optional_constant(*t) && t->one_sided() ? &*t : nullptr;
}

/// An optional term whose effect others have completely in these trials.
std::optional<HeldTerm> redundant(const Fit& fit, const Terms<RigTerm>& terms) {
  constexpr double kSame = 1e-6;  // distance from a correlation of 1 or -1 that is rounding
  const std::vector<const Estimate*> globals = fit.globals();
  const Eigen::MatrixXd correlation = correlation_of(fit.noise_covariance);
  for (std::size_t i = 0; i < globals.size(); ++i) {
    const Estimate& e = *globals[i];
    if (e.at_bound || !e.free || !optional_term(terms, e.name)) continue;
    HeldTerm out{e.name, {}};
    for (std::size_t j = 0; j < globals.size(); ++j) {
      const bool both_undetermined = !e.std && !globals[j]->std && globals[j]->free && !globals[j]->at_bound;
      if (i != j && (both_undetermined || std::abs(correlation(long(i), long(j))) > 1 - kSame))
        out.others.push_back(globals[j]->name);
    }
    if (!out.others.empty()) return out;
  }
  return std::nullopt;
}

/// Replaces `fit`; its starts stay counted and its minima reported.
void replace(Fit replacement, Fit& fit) {
  replacement.starts += fit.starts;
  if (!fit.minima.empty()) replacement.minima = std::move(fit.minima);
  fit = std::move(replacement);
}

/// Holds the terms that the trials cannot distinguish from others, and refits without them.
void hold_redundant(Experiment& experiment, Identification& out) {
  Terms<RigTerm>& terms = experiment.options.terms;
  while (out.fit.converged && !out.fit.interrupted) {
    const auto found = redundant(out.fit, terms);
    if (!found) break;
    const RigTerm& term = *optional_term(terms, found->term);
    SeaParameters<double> from = out.fit.sea;
    term.set_in(from, term.absent);
    terms.remove(term.name);
    replace(refit(experiment.rig, experiment.trials, from, experiment.options), out.fit);
    out.held.push_back(*found);
  }
}

/// Whether the residuals of a fit with a linear force suggest the smooth one: by the score test's first estimate of the
/// term `force_smooth`.
bool suggest_smooth_force(const ResidualTests& tests, const std::vector<Trial>& trials) {
  if (std::any_of(trials.begin(), trials.end(), [](const Trial& t) { return t.force_smooth != 0; })) return false;
  return std::any_of(tests.score_tests.begin(), tests.score_tests.end(),
                     [](const ScoreTest& t) { return t.term == kForceSmooth && t.size > 0.5; });
}

/// The fit; where the rig does not state what its drive feeds back, the better of the fits with either side.
Fit fit_either_feedback(const Experiment& e, const std::optional<SeaParameters<double>>& start,
                        SeaParameters<double> base, std::optional<FeedbackFound>& found) {
  Fit first = fit(e.rig, e.trials, start, base, e.options);
  const auto unknown = [&](const Trial& t) { return t.rig_or(e.rig).feedback_unknown(); };
  if (first.interrupted || std::none_of(e.trials.begin(), e.trials.end(), unknown)) return first;
  base.feedback = base.feedback == Feedback::kMotor ? Feedback::kOutput : Feedback::kMotor;
  Fit second = fit(e.rig, e.trials, start, base, e.options);
  if (first.fitted.empty() || (second.converged && (!first.converged || second.cost < first.cost)))
    std::swap(first, second);
  if (first.fitted.empty()) return first;
  found = {first.sea.feedback, std::numeric_limits<double>::infinity()};
  if (!second.fitted.empty()) found->bic = deviance(second, e.trials, e.options) - deviance(first, e.trials, e.options);
  first.starts += second.starts;
  return first;
}

/// Warns of held terms and of the feedback that was found; where that is not clear no constant is trusted.
void warn_of_choices(const Terms<RigTerm>& terms, Identification& out) {
  std::vector<std::string> held;
  for (const HeldTerm& h : out.held)
    held.push_back(fmt::format("these trials cannot tell {} from {}: {} is held at {:g}", h.term,
                               fmt::join(h.others, " and "), h.term, terms[h.term].absent));
  out.fit.warnings.insert(out.fit.warnings.begin(), held.begin(), held.end());
  if (!out.feedback) return;
  const FeedbackFound& f = *out.feedback;
  out.fit.warnings.push_back(fmt::format(
      "the rig does not say what the drive feeds back: with the {} side the logs are explained {} ({:.3g} in BIC){}",
      name(f.side), f.clear() ? "better" : "no worse", f.bic,
      f.clear() ? ": state feedback in the rig file" : ": no constant is trusted until feedback is stated"));
  if (!f.clear()) distrust(out.fit.parameters);
}

bool clearly_better(const Fit& a, const Fit& b) {
  constexpr double kSame = 1e-6;  // relative difference of costs of one minimum
  return a.converged && (!b.converged || a.cost < (1 - kSame) * b.cost);
}

/// The fit with some terms from starts that the score tests of the model without them suggest.
struct ScoreStarted {
  Fit fit;                     ///< the best from these starts
  double plain = 0, gain = 0;  ///< cost without the terms, and its predicted decrease, to first order
};

/// Fits from the minimum of the model without `terms`, with each at the first estimate of its score test, and at
/// kFarFromAbsence times it: dry friction has spurious minima near 0.
ScoreStarted fit_from_score_tests(const Experiment& e, const std::vector<std::string>& terms,
                                  const std::optional<SeaParameters<double>>& start, SeaParameters<double> base) {
  ScoreStarted out;
  Experiment plain = noise_only(e);
  for (const std::string& name : terms) {
    plain.options.terms.remove(name);
    e.options.terms[name].set_in(base, e.options.terms[name].absent);
  }
  const Fit without = fit(e.rig, e.trials, start, base, plain.options);
  const auto score = score_of(plain, without);
  if (!score) return out;
  out.plain = without.cost, out.fit.starts = without.starts;
  SeaParameters<double> from = without.sea;
  for (const double factor : {1.0, kFarFromAbsence}) {
    for (const ScoreTest& t : score_tests_of(*score)) {
      if (!(t.gain > 0) || std::find(terms.begin(), terms.end(), t.term) == terms.end()) continue;
      e.options.terms[t.term].set_in(from, factor * t.size);
      out.gain = std::max(out.gain, t.gain);
    }
    Fit with_terms = refit(e.rig, e.trials, from, e.options);
    with_terms.starts += out.fit.starts;
    if (clearly_better(with_terms, out.fit)) out.fit = std::move(with_terms);
  }
  return out;
}

bool doubtful(const Identification& i) {
  return !i.fit.converged || i.fit.far_above_noise || i.trust->tests.model_rejected();
}

/// Warnings of a second search; empty where there is none.
struct SecondSearch {
  std::string better;  ///< a better minimum was found
  std::string failed;  ///< no minimum was found that explains the logs
};

/// Whether two fitted terms are so correlated that the cost has a flat valley, in which a local search may end at a
/// minimum of its side.
bool has_flat_valley(const Fit& fit) {
  constexpr double kFlat = 0.999;
  Eigen::MatrixXd correlation = correlation_of(fit.noise_covariance);
  correlation.diagonal().setZero();
  return fit.converged && (correlation.array().abs() > kFlat).any();
}

/// A fit whose residuals the model does not explain, or whose cost has a flat valley, may have ended at a local
/// minimum. Searches from starts by the score tests of the model without its terms of the actuator and, where the
/// predicted decrease of the cost is not met, from kMoreStarts drawn starts. Without such terms only residuals far
/// above the noise count as unexplained.
SecondSearch search_again(const Experiment& e, const std::optional<SeaParameters<double>>& start,
                          SeaParameters<double> base, Identification& out) {
  constexpr int kMoreStarts = 20;
  constexpr double kMet = 0.5;  // of the predicted decrease, which is of first order
  std::vector<std::string> terms;
  for (const std::string& name : e.options.terms.nuisance)
    if (const RigTerm& t = e.options.terms[name]; is_optional_constant(t) && std::isfinite(t.absent))
      terms.push_back(name);
  SecondSearch warnings;
  const auto unexplained = [&] { return terms.empty() ? out.fit.far_above_noise : doubtful(out); };
  if (out.fit.interrupted || e.options.explore > 0 || !(unexplained() || has_flat_valley(out.fit))) return warnings;
  const double first_rms = out.fit.rms;
  const auto replace_if_better = [&](Fit other, const std::string& origin) {
    if (!clearly_better(other, out.fit)) return void(out.fit.starts += other.starts);
    warnings.better = fmt::format("the first minimum found, {:.4g} rad rms, was not the best: {:.4g} rad {}", first_rms,
                                  other.rms, origin);
    replace(std::move(other), out.fit);
    out.trust = test_fit(e, out.fit);
  };
  base.feedback = out.fit.sea.feedback;
  bool met = false;
  if (!terms.empty() && unexplained()) {
    ScoreStarted score_started = fit_from_score_tests(e, terms, start, base);
    replace_if_better(std::move(score_started.fit), "where the score tests point");
    met = score_started.gain > 0 && out.fit.cost <= score_started.plain - kMet * score_started.gain;
  }
  if (!has_flat_valley(out.fit) && (!unexplained() || (met && !out.fit.far_above_noise))) return warnings;
  FitOptions explore = e.options;
  explore.explore = kMoreStarts;
  Fit explored = fit(e.rig, e.trials, start, base, explore);
  if (!explored.minima.empty()) out.fit.minima = explored.minima;
  replace_if_better(std::move(explored), fmt::format("from {} drawn starts", kMoreStarts));
  if (e.options.monitor.stopped()) return out.fit.interrupted = true, warnings;
  if (!terms.empty() && doubtful(out))
    warnings.failed = fmt::format(
        "{}: where its score test points and {} drawn starts found nothing better: the model lacks something else",
        fmt::join(terms, " and "), kMoreStarts);
  return warnings;
}

/// Distrusts constants that another minimum, which explains the logs as well, puts beyond their intervals; warns of it.
void distrust_by_minima(const Experiment& e, Fit& fit) {
  constexpr double kAsWell = 3.84;  // of the deviance: 95 % of chi-squared, one degree of freedom
  if (fit.minima.empty()) return;
  const double n = double(measurements(e.trials));
  const Minimum& lowest = fit.minima.front();
  for (const Minimum& m : fit.minima) {
    if (n * std::log(m.cost / lowest.cost) > kAsWell) continue;
    std::vector<std::string> elsewhere;
    for (Estimate& constant : fit.parameters) {
      const RigTerm& term = e.options.terms[constant.name];
      const double value = term.value_in(m.sea);
      if (!constant.std || std::abs(value - term.value_in(lowest.sea)) <= constant.half_width()) continue;
      elsewhere.push_back(fmt::format("{} {:.4g}", constant.name, value));
      if (constant.verdict == Identifiability::kTrusted) constant.verdict = Identifiability::kWeak;
    }
    if (!elsewhere.empty())
      fit.warnings.push_back(
          fmt::format("another minimum explains these logs as well, with {}: not trusted", fmt::join(elsewhere, ", ")));
  }
}

/// What is found by a further fit, tested: its starts add to those before, whose minima are reported.
Identification continued(const Experiment& e, Fit further, const Identification& before) {
  further.starts += before.fit.starts;
  if (!before.fit.minima.empty()) further.minima = before.fit.minima;
  Identification out{std::move(further), before.held, before.stated, before.feedback, before.force_smooth, {}};
  if (!out.fit.fitted.empty()) out.trust = test_fit(e, out.fit);
  return out;
}

/// The trials with a smooth force between their samples, and what is found with them.
struct SmoothForce {
  std::vector<Trial> trials;
  Identification found;
};
/// None where the residuals do not suggest it, or the fit with it is no likelier.
std::optional<SmoothForce> try_smooth_force(const Experiment& e, const Identification& linear) {
  if (!suggest_smooth_force(linear.trust->tests, e.trials)) return std::nullopt;
  SmoothForce out{e.trials, {}};
  for (Trial& t : out.trials) t.force_smooth = 1;
  Fit fit = refit(e.rig, out.trials, linear.fit.sea, e.options);
  if (!(fit.converged && deviance(fit, out.trials, e.options) < deviance(linear.fit, e.trials, e.options)))
    return std::nullopt;
  out.found = continued({e.rig, out.trials, e.options}, std::move(fit), linear);
  out.found.force_smooth = 1;
  return out;
}

/// Of the terms whose absence the tests reject, and which they find within what the rig states of their error, the one
/// of largest worth; null where there is none.
const ScoreTest* missing_stated(const ResidualTests& tests, const Terms<RigTerm>& terms, const Fit& fit) {
  constexpr double kWithin = 3;  // standard deviations
  const ScoreTest* best = nullptr;
  for (const ScoreTest& t : tests.score_tests) {
    const RigErrorKey* stated = terms[t.term].error;
    if (!t.rejected || !stated || (best && tests.worth(t) <= tests.worth(*best))) continue;
    for (const Considered& c : fit.considered)
      if (c.name == stated->key && std::abs(t.size) <= kWithin * c.std) best = &t;
  }
  return best;
}

/// What is found with the terms along whose errors the rig states and for which the residuals ask, the stated errors as
/// priors; none unless that explains the logs, and they were not explained before.
std::optional<Identification> with_stated_errors(Experiment e, const Identification& without) {
  std::optional<Identification> out;
  const auto last = [&]() -> const Identification& { return out ? *out : without; };
  while (last().fit.converged && !last().fit.interrupted && last().trust->tests.model_rejected()) {
    const ScoreTest* missing = missing_stated(last().trust->tests, e.options.terms, last().fit);
    if (!missing) return std::nullopt;
    const std::string term = missing->term;
    e.options.terms.nuisance.push_back(term);
    out = continued(e, refit(e.rig, e.trials, last().fit.sea, e.options), last());
    out->stated.push_back(term);
  }
  if (!out || !out->fit.converged || out->fit.interrupted) return std::nullopt;
  out->fit.warnings.push_back(fmt::format(
      "fitted along, within the errors that the rig states: {}: the logs ask for that", fmt::join(out->stated, ", ")));
  return out;
}

/// Adds the warnings of the searches before the last fit, of `fitted`, and the requested refits.
void finish(Experiment fitted, const SecondSearch& second, const TrustOptions& options, Identification& out) {
  for (const std::string& term : out.stated) fitted.options.terms.nuisance.push_back(term);
  if (!second.better.empty()) out.fit.warnings.push_back(second.better);
  if (!second.failed.empty() && doubtful(out)) out.fit.warnings.push_back(second.failed);
  distrust_by_minima(fitted, out.fit);
  warn_of_choices(fitted.options.terms, out);
  add_refits(fitted, out.fit, options, *out.trust);
}

}  // namespace

Identification identify(const Experiment& experiment, const std::optional<SeaParameters<double>>& start,
                        const SeaParameters<double>& base, const TrustOptions& options) {
  const std::vector<Trial>& trials = experiment.trials;
  Experiment reduced = experiment;
  Identification out{};
  out.fit = fit_either_feedback(experiment, start, base, out.feedback);
  if (out.fit.fitted.empty()) return out;
  hold_redundant(reduced, out);
  out.force_smooth = trials.front().force_smooth;
  out.trust = test_fit(reduced, out.fit);
  const SecondSearch second = search_again(reduced, start, base, out);
  std::optional<SmoothForce> smooth;
  if (options.force == TrustOptions::Force::kByResiduals) smooth = try_smooth_force(reduced, out);
  std::optional<Identification> explained;
  if (smooth) explained = with_stated_errors({experiment.rig, smooth->trials, reduced.options}, smooth->found);
  // An error of the rig may look like a smooth force.
  if (!smooth || (!explained && smooth->found.trust->tests.model_rejected()))
    explained = with_stated_errors(reduced, out);
  if (explained)
    out = std::move(*explained);
  else if (smooth)
    out = std::move(smooth->found);
  finish({experiment.rig, smooth && out.force_smooth > 0 ? smooth->trials : trials, reduced.options}, second, options,
         out);
  return out;
}

}  // namespace ukemi::identify
