#include "identify/fit/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/error.hpp"
#include "identify/estimate/estimates.hpp"
#include "identify/fit/fit_search.hpp"
#include "identify/fit/replay.hpp"
#include "identify/fit/sensitivity.hpp"
#include "identify/logs/log_check.hpp"

namespace ukemi::identify {

RolloutOptions FitOptions::rollout() const {
  return {.accuracy = accuracy, .max_step = max_step, .method = method, .escape = escape};
}

void FitOptions::validate() const {
  terms.validate();
  for (const Prior& p : terms.priors)
    if (terms[p.term].scope == Scope::kEach)
      throw InputError(fmt::format("prior of {}: each trial has its own; only shared terms can have one", p.term));
  if (!(accuracy >= 1e-13 && accuracy <= 1e-3))
    throw InputError(
        fmt::format("accuracy: {}: a relative tolerance from 1e-13 to 1e-3 is needed", shortest(accuracy)));
  rollout().validate();
  if (!(huber >= 0 && std::isfinite(huber)))
    throw InputError(fmt::format("loss: {}: Huber's delta must be at least 0", shortest(huber)));
  constexpr long kMaxCount = 1'000'000;
  check_count("restarts", restarts, 0, kMaxCount), check_count("starts", explore, 0, kMaxCount);
  check_count("threads", threads, 0, kMaxCount), check_count("max_iterations", max_iterations, 1, kMaxCount);
  starts.validate();
}

namespace {

void validate(const Rig& rig, const std::vector<Trial>& trials, const FitOptions& options) {
  if (trials.empty()) throw InputError("no trials: at least one is needed");
  rig.validate(), options.validate();
  for (const Trial& t : trials) {
    t.validate();
    if (!(t.force_smooth >= 0 && t.force_smooth <= 1))
      throw InputError(fmt::format("{}: force_smooth: {}: 0 to 1 is needed", t.file, shortest(t.force_smooth)));
  }
}

/// Validates a start or `base`; an inertia of 0 is allowed: a fit moves it off that bound.
void validate_start(SeaParameters<double> sea) {
  if (sea.i_motor == 0) sea.i_motor = 1;
  ukemi::validate(sea);
}

std::vector<Estimate> constants_of(const Terms<RigTerm>& terms, const SeaParameters<double>& sea) {
  return identify::as_given(terms, [&](const RigTerm& t) { return t.value_in(sea); });
}

/// Warns of constants that start at 0, where a scaled search cannot start.
void warn_of_zero_starts(const SeaParameters<double>& start, const FitOptions& options, Fit& out) {
  for (const RigTerm& t : *options.terms.table)
    if (t.is_constant() && options.terms.fits(t.name) && t.value_in(start) <= 0)
      out.warnings.push_back(fmt::format("{} started at 0: moved off it", t.name));
}

/// The result where no start could be simulated.
Fit failed_fit(const Rig& rig, const FitSearch& search, const SeaParameters<double>& sea, const FitOptions& options,
               Fit out) {
  out.sea = sea;
  out.rms = out.cost = std::numeric_limits<double>::quiet_NaN();
  const std::string& reason = search.best().message;
  out.message =
      "no start could be followed through the trials: " + (out.interrupted                 ? "interrupted"
                                                           : !search.stop_reason().empty() ? search.stop_reason()
                                                           : reason.empty() ? "every rollout escapes or diverges"
                                                                            : reason);
  for (const PreparedTrial& t : search.prepared()) out.trials.push_back(replay(rig, t, {sea}, options.rollout()));
  out.parameters = constants_of(options.terms, sea);
  return out;
}

/// Of a rollout without derivatives: steps are implicit where the motion is stiff.
RolloutOptions replay_options(const FitOptions& options) {
  RolloutOptions out = options.rollout();
  if (!out.method) out.method = Method::kAuto;
  return out;
}

/// Replays the trials at the best solution, by the same integration method as `predict`.
void replay_best(const FitSearch& search, const std::vector<Weighting>& weights, const FitOptions& options, Fit& out) {
  const RolloutOptions o = replay_options(options);
  out.sea = search.best_sea();
  out.trials.clear();
  for (std::size_t m = 0; m < weights.size(); ++m)
    search.at_best(m, [&](const Rig& rig, const RolloutInputs<double>& inputs, const PreparedTrial& trial) {
      out.trials.push_back(replay(rig, trial, inputs, o));
      out.trials.back().weighting = std::make_shared<const Weighting>(weights[m]);
    });
}

/// Sets the weighting of each trial's residuals: by the force's noise where it colours them, and by trial.
/// Returns whether any changed.
bool reweigh(FitSearch& search, const std::vector<Trial>& trials, const FitOptions& options, Fit& out) {
  bool changed = false;
  std::vector<Weighting>& weights = search.weights();
  for (std::size_t m = 0; m < trials.size(); ++m) {
    weights[m] = search.at_best(m, [&](const Rig& rig, const RolloutInputs<double>& inputs,
                                       const PreparedTrial& trial) {
      return force_noise_weighting(rig, inputs.sea, inputs.nuisance, *trial.trial, search.noise(), options.rollout());
    });
    out.trials[m].weighting = std::make_shared<const Weighting>(weights[m]);
    changed = changed || weights[m].u.size() > 0;
  }
  if (options.weights != FitOptions::Weights::kTrial) return changed;
  const double pooled_rms = pooled(out.trials, trials, white_rms);
  for (std::size_t m = 0; m < trials.size(); ++m) {
    const double trial_rms = white_rms(trials[m], out.trials[m]);
    weights[m].weight = trial_rms > 0 ? pooled_rms / trial_rms : 1;
  }
  return true;
}

/// Sets the errors beside the noise, see Considered.
void set_considered(const Rig& rig, const FitSearch& search, const std::vector<Trial>& trials,
                    const FitOptions& options, Fit& out) {
  const LeastSquaresSolution& best = search.best();
  FitMinimum minimum{rig, trials, options, out, {{best.globals.begin(), best.globals.end()}, best.at_bound, {}, {}}};
  if (options.errors == FitOptions::Errors::kNoiseOnly || !states_errors(minimum)) return;
  for (const auto& locals : best.locals.rowwise()) minimum.point.locals.emplace_back(locals.begin(), locals.end());
  const auto sensitivity = sensitivity_of(minimum);
  if (!sensitivity) return;
  out.considered = considered_of(minimum, *sensitivity);
  out.sensitivity = std::make_shared<const Sensitivity>(*sensitivity);
}

/// Sets the estimates, their verdicts and the warnings.
void report(const Rig& rig, const FitSearch& search, const std::vector<Trial>& trials, const FitOptions& options,
            Fit& out) {
  const std::vector<const Term*> shared(search.layout().shared.begin(), search.layout().shared.end());
  set_considered(rig, search, trials, options, out);
  out.parameters = constants_of(options.terms, out.sea);
  set_estimates(search.best(), search.best_problem(), shared, {.data = "trials"}, out);
  warn_of_priors(options.terms, search.best(), search.noise(), out);
  out.identifiable = std::none_of(out.parameters.begin(), out.parameters.end(),
                                  [](const Estimate& e) { return e.verdict == Identifiability::kNotIdentifiable; });
  if (out.weakest && !all_trusted(out.parameters))
    out.warnings.push_back(in_words(*out.weakest, "trials", "the angles", "rad"));
  if (out.flawed_logs) distrust(out.parameters);
  const double noise = search.noise(), unexplained = pooled(out.trials, trials, white_rms);
  out.far_above_noise = noise > 0 && unexplained > kFarAboveNoise * noise;
  if (!out.far_above_noise) return;
  distrust(out.parameters);
  out.warnings.push_back(
      fmt::format("the residual {:.3g} rad is {:.1f} times the logs' noise {:.3g} rad: the model "
                  "lacks something, or no start found the minimum; no constant is trusted",
                  unexplained, unexplained / noise, noise));
}

}  // namespace

Fit fit(const Rig& rig, const std::vector<Trial>& trials, const std::optional<SeaParameters<double>>& start,
        const SeaParameters<double>& base, const FitOptions& options) {
  validate(rig, trials, options), validate_start(base);
  if (start) validate_start(*start);
  FitSearch search(rig, trials, start, base, options);
  Fit out;
  LogCheck logs = check_logs(trials);
  out.warnings = std::move(logs.warnings), out.flawed_logs = logs.flawed;
  if (start) warn_of_zero_starts(*start, options, out);
  search.run();
  out.minima = search.minima();
  out.starts = search.starts();
  out.interrupted = options.monitor.stopped();
  if (!search.best().usable) return failed_fit(rig, search, start.value_or(base), options, std::move(out));

  replay_best(search, search.weights(), options, out);
  if (reweigh(search, trials, options, out)) {
    search.restart(out.sea);
    out.minima = search.minima();
    out.starts = search.starts();
    replay_best(search, search.weights(), options, out);
  }
  const LeastSquaresSolution& best = search.best();
  out.rms = pooled(out.trials, trials, raw_rms);
  if (!best.converged)
    out.message = out.interrupted ? "interrupted" : search.stop_reason().empty() ? best.message : search.stop_reason();
  report(rig, search, trials, options, out);
  return out;
}

Fit predict(const Rig& rig, const std::vector<Trial>& trials, const SeaParameters<double>& sea,
            const FitOptions& options, const std::vector<Nuisance<double>>& own) {
  validate(rig, trials, options), ukemi::validate(sea);
  if (!own.empty() && own.size() != trials.size())
    throw InputError(fmt::format("own terms of {} trials: {} are needed, one each", own.size(), trials.size()));
  Fit out;
  out.warnings = check_logs(trials).warnings;
  out.sea = sea;
  out.converged = out.identifiable = true;
  const RolloutOptions rollout_options = replay_options(options);
  for (const Trial& t : trials) {
    const RolloutInputs<double> inputs{sea, own.empty() ? Nuisance<double>{} : own[out.trials.size()]};
    out.trials.push_back(replay(rig, PreparedTrial(t), inputs, rollout_options));
    const TrialResult& r = out.trials.back();
    if (r.status != RolloutStatus::kDone) {
      out.converged = false;
      out.message = t.file + ": " + name(r.status);
    }
    out.cost += r.rms * r.rms * double(t.measurements());
  }
  out.rms = pooled(out.trials, trials, raw_rms);
  Terms<RigTerm> held = options.terms;
  held.free.clear();
  out.parameters = constants_of(held, sea);
  return out;
}

std::vector<Trial> with_nearer_force(const Rig& rig, const std::vector<Trial>& trials, const SeaParameters<double>& sea,
                                     const FitOptions& options) {
  if (std::all_of(trials.begin(), trials.end(), [](const Trial& t) { return t.force.empty(); })) return trials;
  std::vector<Trial> smooth = trials;
  for (Trial& t : smooth) {
    if (t.force_smooth != 0) return trials;
    t.force_smooth = 1;
  }
  const Fit curved = predict(rig, smooth, sea, options), linear = predict(rig, trials, sea, options);
  return curved.converged && (!linear.converged || curved.rms < linear.rms) ? smooth : trials;
}

}  // namespace ukemi::identify
