#include "identify/trust/identification.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/actuator_constants.hpp"
#include "common/error.hpp"
#include "identify/estimate/covariance.hpp"

namespace ukemi::identify {

namespace {

/// What a fraction of a fit's own time tells; widens the fit's errors.
Trust tested(const Experiment& experiment, Fit& fit) {
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

/// Adds what takes several fits.
void deepen(const Experiment& whole, const Fit& fit, const TrustOptions& options, Trust& out) {
  if (fit.interrupted) return;
  const Experiment experiment = of_noise(whole);
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

/// Whether it is an optional constant of the actuator; a motor without torque drives nothing.
bool is_actuator_s(const RigTerm& t) {
  return !t.is_constant() && !t.key.empty() && t.relative_to != &SeaParameters<double>::k_t;
}

/// The shared term of that name where it may be absent: an optional one of the actuator, with 0 as its bound; else
/// null.
const RigTerm* optional_term(const Terms<RigTerm>& terms, const std::string& name) {
  const auto t =
      std::find_if(terms.table->begin(), terms.table->end(), [&](const RigTerm& r) { return r.name == name; });
  return t != terms.table->end() && is_actuator_s(*t) && t->one_sided() ? &*t : nullptr;
}

/// An optional term that others do completely in these trials; none: nothing.
std::optional<HeldTerm> redundant(const Fit& fit, const Terms<RigTerm>& terms) {
  constexpr double kSame = 1e-6;  // off a correlation of 1 or -1: rounding tells the two apart, no log
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

/// Another fit in place of what was found; what was searched before stays counted and said.
void adopt(Fit again, Fit& fit) {
  again.starts += fit.starts;
  if (!fit.minima.empty()) again.minima = std::move(fit.minima);
  fit = std::move(again);
}

/// Holds what the trials cannot tell from others, and fits again without it.
void hold_redundant(Experiment& experiment, Identification& out) {
  Terms<RigTerm>& terms = experiment.options.terms;
  while (out.fit.converged && !out.fit.interrupted) {
    const auto found = redundant(out.fit, terms);
    if (!found) break;
    const RigTerm& term = *optional_term(terms, found->term);
    SeaParameters<double> from = out.fit.sea;
    term.set_in(from, term.absent);
    std::erase_if(terms.nuisance, [&](const std::string& n) { return n == term.name; });
    adopt(refit(experiment.rig, experiment.trials, from, experiment.options), out.fit);
    out.held.push_back(*found);
  }
}

/// Whether the residuals of fits with a linear force are nearer to those of the smooth one: the first estimate of the
/// term `force_smooth`, which its score test gives.
bool ask_for_smooth_force(const ResidualTests& tests, const std::vector<Trial>& trials) {
  if (std::any_of(trials.begin(), trials.end(), [](const Trial& t) { return t.force_smooth != 0; })) return false;
  return std::any_of(tests.score_tests.begin(), tests.score_tests.end(),
                     [](const ScoreTest& t) { return t.term == kForceSmooth && t.size > 0.5; });
}

/// The fit; where the rig does not say what its drive feeds back, the better one of both sides'.
Fit fit_sides(const Experiment& e, const std::optional<SeaParameters<double>>& start, SeaParameters<double> base,
              std::optional<FeedbackFound>& found) {
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

/// What was held is said; where the logs do not tell the sides apart nothing is trusted.
void tell_choices(const Terms<RigTerm>& terms, Identification& out) {
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
  constexpr double kSame = 1e-6;  // relative costs so near are one minimum's
  return a.converged && (!b.converged || a.cost < (1 - kSame) * b.cost);
}

/// What the score tests of a model without some terms foretell of the fit with them.
struct Pointed {
  Fit fit;                     ///< the best that starts there
  double plain = 0, gain = 0;  ///< cost without the terms, and by how much it should fall, to first order
};

/// Fits that start where the model without `terms` ends, with each at the first estimate of its score test, and
/// farther: dry friction has minima of its own near 0.
Pointed fit_where_tests_point(const Experiment& e, const std::vector<std::string>& terms,
                              const std::optional<SeaParameters<double>>& start, SeaParameters<double> base) {
  Pointed out;
  Experiment plain = of_noise(e);
  for (const std::string& name : terms) {
    std::erase(plain.options.terms.nuisance, name);
    e.options.terms[name].set_in(base, e.options.terms[name].absent);
  }
  const Fit without = fit(e.rig, e.trials, start, base, plain.options);
  const auto score = score_of(plain, without);
  if (!score) return out;
  out.plain = without.cost, out.fit.starts = without.starts;
  SeaParameters<double> from = without.sea;
  for (const double times : {1.0, kFarFromAbsence}) {
    for (const ScoreTest& t : score_tests_of(*score)) {
      if (!(t.gain > 0) || std::find(terms.begin(), terms.end(), t.term) == terms.end()) continue;
      e.options.terms[t.term].set_in(from, times * t.size);
      out.gain = std::max(out.gain, t.gain);
    }
    Fit f = refit(e.rig, e.trials, from, e.options);
    f.starts += out.fit.starts;
    if (clearly_better(f, out.fit)) out.fit = std::move(f);
  }
  return out;
}

bool doubtful(const Identification& i) {
  return !i.fit.converged || i.fit.far_above_noise || i.trust->tests.model_rejected();
}

/// What a second look came to, in words; empty where there is nothing to say.
struct SecondLook {
  std::string better;   ///< a better minimum was found
  std::string in_vain;  ///< none was that explains the logs
};

/// A fit with terms of the actuator whose residuals the model does not explain may have ended at a minimum of no
/// account. Looks where the score tests of the model without them point and, where their promise is not met there
/// either, from kMoreStarts drawn starts.
SecondLook look_again(const Experiment& e, const std::optional<SeaParameters<double>>& start,
                      SeaParameters<double> base, Identification& out) {
  constexpr int kMoreStarts = 20;
  constexpr double kMet = 0.5;  // of the fall that is promised, which is to first order
  std::vector<std::string> terms;
  for (const std::string& name : e.options.terms.nuisance)
    if (const RigTerm& t = e.options.terms[name]; is_actuator_s(t) && std::isfinite(t.absent)) terms.push_back(name);
  SecondLook said;
  if (terms.empty() || out.fit.interrupted || e.options.explore > 0 || !doubtful(out)) return said;
  const double first = out.fit.rms;
  const auto adopt_better = [&](Fit f, const std::string& where) {
    if (!clearly_better(f, out.fit)) return void(out.fit.starts += f.starts);
    said.better =
        fmt::format("the first minimum found, {:.4g} rad rms, was not the best: {:.4g} rad {}", first, f.rms, where);
    adopt(std::move(f), out.fit);
    out.trust = tested(e, out.fit);
  };
  base.feedback = out.fit.sea.feedback;
  Pointed pointed = fit_where_tests_point(e, terms, start, base);
  adopt_better(std::move(pointed.fit), "where the score tests point");
  const bool met = pointed.gain > 0 && out.fit.cost <= pointed.plain - kMet * pointed.gain;
  if (!doubtful(out) || (met && !out.fit.far_above_noise)) return said;
  FitOptions explore = e.options;
  explore.explore = kMoreStarts;
  adopt_better(fit(e.rig, e.trials, start, base, explore), fmt::format("from {} drawn starts", kMoreStarts));
  if (doubtful(out))
    said.in_vain = fmt::format(
        "{}: where its score test points and {} drawn starts found nothing better: the model lacks something else",
        fmt::join(terms, " and "), kMoreStarts);
  return said;
}

/// Takes the fit with a smooth force between the samples where the residuals ask for one and it leaves less; then the
/// trials with that force.
std::optional<std::vector<Trial>> take_smooth_force(const Experiment& e, Identification& out) {
  if (!ask_for_smooth_force(out.trust->tests, e.trials)) return std::nullopt;
  std::vector<Trial> smooth = e.trials;
  for (Trial& t : smooth) t.force_smooth = 1;
  Fit again = refit(e.rig, smooth, out.fit.sea, e.options);
  if (!(again.converged && again.rms < out.fit.rms)) return std::nullopt;
  adopt(std::move(again), out.fit), out.force_smooth = 1;
  out.trust = tested({e.rig, smooth, e.options}, out.fit);
  return smooth;
}

/// Says what was done on the way to the fit of `fitted`, and looks into it as deep as asked for.
void finish(const Experiment& fitted, const SecondLook& look, const TrustOptions& options, Identification& out) {
  if (!look.better.empty()) out.fit.warnings.push_back(look.better);
  if (!look.in_vain.empty() && doubtful(out)) out.fit.warnings.push_back(look.in_vain);
  tell_choices(fitted.options.terms, out);
  deepen(fitted, out.fit, options, *out.trust);
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
  Identification out{};
  out.fit = fit_sides(experiment, start, base, out.feedback);
  if (out.fit.fitted.empty()) return out;
  hold_redundant(told_apart, out);
  out.force_smooth = trials.front().force_smooth;
  out.trust = tested(told_apart, out.fit);
  const SecondLook look = look_again(told_apart, start, base, out);
  std::optional<std::vector<Trial>> smooth;
  if (options.force == TrustOptions::Force::kByResiduals) smooth = take_smooth_force(told_apart, out);
  finish({experiment.rig, smooth ? *smooth : trials, told_apart.options}, look, options, out);
  return out;
}

}  // namespace ukemi::identify
