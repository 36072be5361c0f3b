#include "identify/fit/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "common/parallel.hpp"
#include "identify/logs/hits.hpp"
#include "identify/fit/least_squares.hpp"
#include "identify/fit/starts.hpp"
#include "identify/fit/trial_problem.hpp"

namespace ukemi::identify {

const char* name(NuisanceTerm t) {
  constexpr std::array<const char*, kNuisanceTerms.size()> kNames = {
      "friction",     "viscous_friction", "stiffening", "force_gain", "initial_angle",
      "initial_rate", "encoder_offset",   "force_bias", "time_shift"};
  return kNames[std::size_t(t)];
}
const char* unit(NuisanceTerm t) {
  constexpr std::array<const char*, kNuisanceTerms.size()> kUnits = {"Nm",    "Nm/(rad/s)", "Nm/rad^3", "1", "rad",
                                                                     "rad/s", "rad",        "N",        "s"};
  return kUnits[std::size_t(t)];
}

void FitOptions::validate() const {
  for (int i = 0; i < kConstants; ++i) {
    const auto k = std::size_t(i);
    if (!(lower[k] >= 0))
      throw InputError(fmt::format("lower bound of {}: {}: must be at least 0", kConstantNames[k], shortest(lower[k])));
    if (!(lower[k] < upper[k]))
      throw InputError(fmt::format("bounds of {}: {} to {}: lower < upper is needed", kConstantNames[k],
                                   shortest(lower[k]), shortest(upper[k])));
  }
  for (int i = 0; i < kConstants; ++i)
    if (const auto& p = prior[std::size_t(i)]) {
      const char* constant = kConstantNames[std::size_t(i)];
      if (!(p->std > 0 && std::isfinite(p->std)))
        throw InputError(
            fmt::format("prior of {}: standard deviation {}: must be above 0", constant, shortest(p->std)));
      if (!free[std::size_t(i)]) throw InputError(fmt::format("prior of {}: it is not fitted", constant));
    }
  for (auto t = nuisance.begin(); t != nuisance.end(); ++t)
    if (std::find(nuisance.begin(), t, *t) != t) throw InputError(fmt::format("nuisance: {}: given twice", name(*t)));
  if (!(huber >= 0)) throw InputError(fmt::format("loss: {}: Huber's delta must be above 0", shortest(huber)));
  if (!(accuracy >= 1e-13 && accuracy <= 1e-3))
    throw InputError(
        fmt::format("accuracy: {}: a relative tolerance from 1e-13 to 1e-3 is needed", shortest(accuracy)));
}

namespace {

TrialResult replay(const Rig& rig, const PreparedTrial& prepared, const SeaParameters<double>& sea,
                   const Nuisance<double>& nuisance, const RolloutOptions& options) {
  const Trial& trial = *prepared.trial;
  TrialResult out{.file = trial.file, .samples = trial.samples(), .phi = {}, .phi_m = {}, .nuisance = nuisance};
  out.noise = std::max(noise_level(trial.phi), noise_level(trial.phi_motor));
  out.status = rollout(rig, sea, nuisance, prepared, options, out.phi, out.phi_m);
  if (out.status != RolloutStatus::kDone) {
    out.phi.clear(), out.phi_m.clear();
    out.rms = std::numeric_limits<double>::quiet_NaN();
    return out;
  }
  double sum = 0;
  for (std::size_t i = 0; i < trial.phi.size(); ++i) sum += (out.phi[i] - trial.phi[i]) * (out.phi[i] - trial.phi[i]);
  for (std::size_t i = 0; i < trial.phi_motor.size(); ++i)
    sum += (out.phi_m[i] - trial.phi_motor[i]) * (out.phi_m[i] - trial.phi_motor[i]);
  if (trial.measurements() > 0) out.rms = std::sqrt(sum / double(trial.measurements()));
  return out;
}

/// Root mean square over all trials of what `rms` says of each.
template <class Rms>
double pooled(const std::vector<TrialResult>& trials, const std::vector<Trial>& logs, Rms&& rms) {
  double sum = 0, n = 0;
  for (std::size_t m = 0; m < trials.size(); ++m) {
    const double count = double(logs[m].measurements()), v = rms(logs[m], trials[m]);
    sum += count * v * v, n += count;
  }
  return n > 0 ? std::sqrt(sum / n) : 0;
}
double raw_rms(const Trial&, const TrialResult& r) { return r.rms; }

void warn_of_short_pulses(const std::vector<Trial>& trials, std::vector<std::string>& warnings) {
  for (const Trial& t : trials)
    if (const int n = shortest_pulse(t); n > 0 && n < 8)
      warnings.push_back(fmt::format(
          "{}: a pulse of {} samples: below 8 the log loses part of the impulse and biases the fit", t.file, n));
}

/// Warns of gaps, each log's longest and those in hits; true where one is in a hit.
bool warn_of_gaps(const std::vector<Trial>& trials, std::vector<std::string>& warnings) {
  bool any_in_hit = false;
  for (const Trial& t : trials) {
    const std::vector<Gap> all = gaps(t);
    const Gap* longest = nullptr;
    bool in_hit = false;
    for (const Gap& g : all) {
      if (!longest || g.length > longest->length) longest = &g;
      if (g.place != Gap::Place::kInHit || in_hit) continue;
      in_hit = any_in_hit = true;
      warnings.push_back(
          fmt::format("{}: a gap of {:.3g} ms at {:.6g} s, in a hit: what the force did there is lost; no "
                      "constant is trusted",
                      t.file, 1e3 * g.length, g.t));
    }
    if (longest && !in_hit)
      warnings.push_back(fmt::format("{}: {} in the log, the longest of {:.3g} ms at {:.6g} s", t.file,
                                     all.size() == 1 ? "a gap" : fmt::format("{} gaps", all.size()),
                                     1e3 * longest->length, longest->t));
  }
  return any_in_hit;
}

/// Warns of a force whose sign is flipped; true where one is.
bool warn_of_signs(const std::vector<Trial>& trials, std::vector<std::string>& warnings) {
  constexpr double kAgainst = -0.3;
  std::vector<const Trial*> against;
  std::size_t judged = 0;
  for (const Trial& t : trials)
    if (const auto answer = answer_to_first_hit(t)) {
      ++judged;
      if (*answer < kAgainst) against.push_back(&t);
    }
  if (against.empty()) return false;
  if (against.size() == judged) {
    warnings.push_back(
        "the link moves against the force in every trial: its sign is flipped? try -F: force=-... in "
        "--columns (or --force-columns)");
    return true;
  }
  for (const Trial* t : against)
    warnings.push_back(
        fmt::format("{}: the link moves against the force, unlike in {} of {} trials: its sign is flipped "
                    "in this log?",
                    t->file, judged - against.size(), judged));
  return true;
}

/// rms of a trial's residuals made white [rad].
double white_rms(const Trial& log, const TrialResult& r) {
  if (r.weighting.u.size() == 0) return r.rms;
  Eigen::VectorXd all(long(log.measurements()));
  long i = 0;
  for (std::size_t k = 0; k < log.phi.size(); ++k) all[i++] = r.phi[k] - log.phi[k];
  for (std::size_t k = 0; k < log.phi_motor.size(); ++k) all[i++] = r.phi_m[k] - log.phi_motor[k];
  r.weighting.whiten(all);
  return std::sqrt(all.squaredNorm() / double(all.size()));
}

/// Samples and stretches: what one rollout of all trials has to follow.
double size_of(const std::vector<PreparedTrial>& trials) {
  double size = 0;
  for (const PreparedTrial& t : trials) size += double(t.trial->samples() + t.stretches.size());
  return size;
}

/// The constants as they are given, without errors.
std::vector<Estimate> as_given(const SeaParameters<double>& sea, const std::array<bool, kConstants>& free) {
  std::vector<Estimate> out;
  const auto u = ukemi::constants(sea);
  for (std::size_t k = 0; k < kConstants; ++k)
    out.push_back({.name = kConstantNames[k],
                   .unit = kConstantUnits[k],
                   .value = u[k],
                   .std = {},
                   .free = free[k],
                   .verdict = free[k] ? Verdict::kNotIdentifiable : Verdict::kFixed});
  return out;
}

/// The parameters, their errors and what can be said of them.
void report(const LeastSquaresSolution& s, const LeastSquaresProblem& problem, const Layout& layout,
            const FitOptions& options, Fit& out) {
  std::vector<double> sizes;
  for (std::size_t g = 0; g < layout.constants.size(); ++g) sizes.push_back(std::abs(s.globals[long(g)]));
  Uncertainty u = uncertainty_of(s, problem, sizes);
  out.covariance = std::move(u.covariance);
  out.correlation = std::move(u.correlation);
  out.eigenvalues = std::move(u.eigenvalues);
  out.half_width = u.half_width;
  out.weakest = std::move(u.weakest);
  out.parameters = as_given(out.sea, options.free);
  for (std::size_t g = 0; g < problem.globals.size(); ++g) {
    out.fitted.push_back(u.globals[g].name);
    if (g < layout.constants.size())
      out.parameters[std::size_t(layout.constants[g])] = u.globals[g];
    else
      out.nuisance.push_back(u.globals[g]);
  }
  out.nuisance.insert(out.nuisance.end(), u.locals.begin(), u.locals.end());
  out.identifiable = true;
  for (const Estimate& e : out.parameters) {
    if (e.verdict == Verdict::kAtBound)
      out.warnings.push_back(fmt::format("{} ended at its bound {}: no standard error", e.name, shortest(e.value)));
    if (e.verdict != Verdict::kNotIdentifiable) continue;
    out.identifiable = false;
    out.warnings.push_back(
        e.std ? fmt::format("{} is not identifiable: the 95 % interval is {:.0f} % of its value either way", e.name,
                            100 * e.half_width() / std::abs(e.value))
              : e.name + " is not determined by these trials");
  }
  for (long i = 0; i < out.correlation.rows(); ++i)
    for (long j = 0; j < i; ++j)
      if (std::abs(out.correlation(i, j)) > 0.95)
        out.warnings.push_back(fmt::format("{} and {} correlate by {:.3f}: these trials hardly tell them apart",
                                           out.fitted[std::size_t(j)], out.fitted[std::size_t(i)],
                                           out.correlation(i, j)));
  if (out.weakest && !all_trusted(out.parameters))
    out.warnings.push_back(in_words(*out.weakest, "trials", "the angles", "rad"));
}

}  // namespace

std::vector<const Estimate*> Fit::globals() const {
  std::vector<const Estimate*> out;
  for (const Estimate& e : parameters)
    if (e.free) out.push_back(&e);
  for (const Estimate& e : nuisance)
    if (e.trial < 0) out.push_back(&e);
  return out;
}

Fit fit(const Rig& rig, const std::vector<Trial>& trials, const std::optional<SeaParameters<double>>& start,
        const SeaParameters<double>& base, const FitOptions& options) {
  options.validate();
  if (trials.empty()) throw InputError("no trials: at least one is needed");
  const Layout layout(options);
  if (layout.constants.empty()) throw InputError("nothing to fit: at least one free constant is needed");
  Fit out;
  warn_of_short_pulses(trials, out.warnings);
  const bool gap_in_hit = warn_of_gaps(trials, out.warnings), flipped = warn_of_signs(trials, out.warnings);
  out.flawed_logs = gap_in_hit || flipped;
  std::vector<PreparedTrial> prepared;
  for (const Trial& t : trials) prepared.emplace_back(t);
  std::vector<Weighting> weights(trials.size());
  const RolloutOptions rollout_options = options.rollout();
  const LeastSquaresOptions solver{.max_iterations = options.max_iterations, .huber = options.huber};
  const Suggestion suggestion = suggest(rig, trials);

  // The logs' own noise decides whether a minimum is believed.
  const double measured = double(measurements(trials));
  if (measured == 0) throw InputError("no measured angle in any trial: phi is needed");
  const double noise = noise_level(trials);
  const auto believed = [&](const LeastSquaresSolution& s) {
    return s.usable && s.converged && s.cost <= kFarAboveNoise * kFarAboveNoise * noise * noise * measured;
  };

  // Work is bounded start by start and over all: counted, so the same whatever the threads.
  constexpr double kSteps = 1e5, kStepsOfSample = 60, kStartsWorth = 4;
  const double per_start = kSteps + kStepsOfSample * size_of(prepared);
  double left = kStartsWorth * per_start;
  bool out_of_work = false;

  const auto problem_from = [&](const SeaParameters<double>& p, Budget* budget = nullptr) {
    RolloutOptions o = rollout_options;
    o.budget = budget;
    return make_problem(rig, prepared, weights, p, suggestion, layout, options, o);
  };
  // A drawn start within the bounds; what is not free stays as given.
  const auto admitted = [&](const SeaParameters<double>& drawn) {
    auto u = ukemi::constants(drawn);
    const auto given = ukemi::constants(start.value_or(base));
    for (std::size_t k = 0; k < kConstants; ++k)
      u[k] = options.free[k] ? std::clamp(u[k], options.lower[k], options.upper[k]) : given[k];
    SeaParameters<double> p = base;
    set_constants(p, u);
    return p;
  };
  // Candidates, best first, judged on a coarse rollout of two trials.
  const auto candidates = [&](std::uint64_t seed) {
    const int draws = suggestion.spread_gains < 2 ? 60 : 240;  // few where the logs give the gains away
    std::vector<SeaParameters<double>> drawn = draw_starts(suggestion, draws, seed);
    if (start) {  // half of them about the given start instead
      const auto about = draw_starts({.centre = *start, .spread_gains = 10, .spread_rest = 10}, draws / 2, seed + 1);
      std::copy(about.begin(), about.end(), drawn.begin());
    }
    std::vector<PreparedTrial> few;
    for (std::size_t m = 0; m < prepared.size() && few.size() < 2; m += std::max<std::size_t>(1, prepared.size() / 2))
      few.push_back(prepared[m]);
    const std::vector<Weighting> equal(few.size());
    RolloutOptions coarse{.accuracy = 1e-4, .escape = options.escape, .max_steps = 5000};
    constexpr double kScreening = 3;  // steps a sample: enough for what comes near the logs
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < drawn.size() && !options.monitor.stopped(); ++i) {
      drawn[i] = admitted(drawn[i]);
      Budget budget{kScreening * size_of(few)};
      coarse.budget = &budget;
      const LeastSquaresProblem p = make_problem(rig, few, equal, drawn[i], suggestion, layout, options, coarse);
      Eigen::VectorXd x(layout.globals());
      for (int g = 0; g < layout.globals(); ++g) x[g] = p.globals[std::size_t(g)].start;
      order.emplace_back(cost_at(p, solver, x), i);
    }
    std::sort(order.begin(), order.end());
    // The best, each at least a factor of 3 in some constant away from those before it: no two from one basin if
    // possible.
    std::vector<SeaParameters<double>> chosen;
    for (const auto& [cost, i] : order) {
      const bool near = std::any_of(chosen.begin(), chosen.end(), [&](const SeaParameters<double>& c) {
        const auto a = ukemi::constants(c), b = ukemi::constants(drawn[i]);
        double farthest = 0;
        for (std::size_t k = 0; k < kConstants; ++k)
          if (a[k] > 0 && b[k] > 0) farthest = std::max(farthest, std::abs(std::log(a[k] / b[k])));
        return farthest < std::log(3.0);
      });
      if (std::isfinite(cost) && !near) chosen.push_back(drawn[i]);
    }
    return chosen;
  };

  LeastSquaresSolution best;
  best.cost = FitOptions::kInfinity;
  SeaParameters<double> best_from = base;
  int times_found = 0;
  const auto take = [&](LeastSquaresSolution s, const SeaParameters<double>& from) {
    constexpr double kLevel = 1e-6;  // costs this near are one minimum's
    ++out.starts;
    if (s.usable && s.converged) {
      SeaParameters<double> sea = from;
      Nuisance<double> nuisance;
      const Eigen::VectorXd local = s.locals.row(0);
      layout.apply<double>(s.globals.data(), local.data(), sea, nuisance, [](double v, int) { return v; });
      const auto same = std::find_if(out.minima.begin(), out.minima.end(),
                                     [&](const Minimum& m) { return std::abs(m.cost / s.cost - 1) < kLevel; });
      if (same == out.minima.end())
        out.minima.push_back({sea, s.cost, 1});
      else
        *same = {s.cost < same->cost ? sea : same->sea, std::min(s.cost, same->cost), same->found + 1};
    }
    if (s.usable && s.cost < best.cost * (1 - kLevel)) times_found = 0;
    if (s.usable && s.cost < best.cost * (1 + kLevel)) ++times_found;
    if (s.usable && (s.cost < best.cost || !best.usable))
      best = std::move(s), best_from = from;
    else if (best.message.empty())
      best.message = s.message;
  };
  std::atomic<long> started{0};
  const long most_starts = options.explore > 0 ? options.explore + (start ? 1 : 0) : options.restarts + 1;
  const auto attempt = [&](std::span<const SeaParameters<double>> from) {
    std::vector<LeastSquaresSolution> solutions(from.size());
    std::vector<Budget> budgets(from.size(), {per_start, per_start});
    parallel_for(int(from.size()), options.threads, [&](int i) {
      const auto k = std::size_t(i);
      LeastSquaresOptions bounded = solver;
      bounded.stop = [&, k] { return budgets[k].spent() || options.monitor.stopped(); };
      solutions[k] = solve(problem_from(from[k], &budgets[k]), bounded);
      options.monitor.progress(++started, most_starts);
    });
    for (std::size_t i = 0; i < from.size(); ++i) {
      left -= per_start - budgets[i].left;
      out_of_work = out_of_work || budgets[i].spent();
      take(std::move(solutions[i]), from[i]);
    }
  };
  if (start) {
    for (int c = 0; c < kConstants; ++c)
      if (options.free[std::size_t(c)] && ukemi::constants(*start)[std::size_t(c)] <= 0)
        out.warnings.push_back(fmt::format("{} started at 0: moved off it", kConstantNames[std::size_t(c)]));
    SeaParameters<double> from = base;
    set_constants(from, ukemi::constants(*start));
    attempt({&from, 1});
  }
  if (options.explore > 0) {
    auto list = draw_starts(start ? Suggestion{.centre = *start, .spread_gains = 10, .spread_rest = 10} : suggestion,
                            options.explore, options.seed);
    for (SeaParameters<double>& p : list) p = admitted(p);
    attempt(list);
  } else if (options.restarts > 0 && !believed(best)) {
    const auto list = candidates(options.seed);
    constexpr int kSame = 5;    // the best minimum found so often is taken for the global one
    constexpr int kAtOnce = 2;  // whatever the number of threads
    const auto goes_on = [&] {
      return !believed(best) && times_found < kSame && left > 0 && !options.monitor.stopped();
    };
    for (int i = 0; i < options.restarts && i < int(list.size()) && goes_on(); i += kAtOnce)
      attempt(std::span(list).subspan(std::size_t(i), std::min<std::size_t>(kAtOnce, list.size() - std::size_t(i))));
  }
  std::sort(out.minima.begin(), out.minima.end(), [](const Minimum& a, const Minimum& b) { return a.cost < b.cost; });
  out.interrupted = options.monitor.stopped();
  const std::string spent =
      out_of_work ? fmt::format("a start was ended after {:.3g} integrated steps", per_start) : "";
  if (!best.usable) {
    out.sea = start.value_or(base);
    out.message = "no start could be followed through the trials: " + (out.interrupted ? "interrupted"
                                                                       : out_of_work   ? spent
                                                                       : best.message.empty()
                                                                           ? "every rollout escapes or diverges"
                                                                           : best.message);
    for (const PreparedTrial& t : prepared) out.trials.push_back(replay(rig, t, out.sea, {}, rollout_options));
    out.parameters = as_given(out.sea, options.free);
    return out;
  }

  RolloutOptions replayed = rollout_options;  // as `predict` does
  if (!replayed.method) replayed.method = Method::kAuto;
  const auto unpack = [&] {
    out.sea = best_from;
    out.trials.clear();
    for (std::size_t m = 0; m < prepared.size(); ++m) {
      Nuisance<double> nuisance;
      const Eigen::VectorXd local = best.locals.row(long(m));
      layout.apply<double>(best.globals.data(), local.data(), out.sea, nuisance, [](double v, int) { return v; });
      out.trials.push_back(replay(rig, prepared[m], out.sea, nuisance, replayed));
      out.trials.back().weighting = weights[m];
    }
  };
  unpack();
  bool coloured = false;
  for (std::size_t m = 0; m < trials.size(); ++m) {
    weights[m] = weigh_force_noise(rig, out.sea, out.trials[m].nuisance, trials[m], noise, rollout_options);
    out.trials[m].weighting = weights[m];
    coloured = coloured || weights[m].u.size() > 0;
  }
  const bool by_trial = options.weights == FitOptions::Weights::kTrial;
  if (by_trial) {
    const double all = pooled(out.trials, trials, white_rms);
    for (std::size_t m = 0; m < trials.size(); ++m) {
      const double own = white_rms(trials[m], out.trials[m]);
      weights[m].weight = own > 0 ? all / own : 1;
    }
  }
  if (by_trial || coloured) {
    best.cost = FitOptions::kInfinity;
    out.minima.clear();
    attempt({&out.sea, 1});
    unpack();
  }
  out.cost = best.cost;
  out.rms = pooled(out.trials, trials, raw_rms);
  out.converged = best.converged;
  out.iterations = best.iterations;
  if (!best.converged) out.message = out.interrupted ? "interrupted" : out_of_work ? spent : best.message;
  report(best, problem_from(best_from), layout, options, out);
  if (out.flawed_logs) distrust(out.parameters);
  const double unexplained = coloured ? pooled(out.trials, trials, white_rms) : out.rms;
  out.far_above_noise = noise > 0 && unexplained > kFarAboveNoise * noise;
  if (out.far_above_noise) {
    distrust(out.parameters);
    out.warnings.push_back(
        fmt::format("the residual {:.3g} rad is {:.1f} times the logs' noise {:.3g} rad after {} starts: the model "
                    "lacks something, or no start found the minimum; no constant is trusted",
                    unexplained, unexplained / noise, noise, out.starts));
  }
  return out;
}

Fit predict(const Rig& rig, const std::vector<Trial>& trials, const SeaParameters<double>& sea,
            const FitOptions& options) {
  options.validate();
  Fit out;
  warn_of_short_pulses(trials, out.warnings);
  (void)warn_of_gaps(trials, out.warnings);
  (void)warn_of_signs(trials, out.warnings);
  out.sea = sea;
  out.converged = out.identifiable = true;
  const RolloutOptions rollout_options{.accuracy = options.accuracy, .method = Method::kAuto, .escape = options.escape};
  for (const Trial& t : trials) {
    const PreparedTrial prepared(t);
    out.trials.push_back(replay(rig, prepared, sea, {}, rollout_options));
    const TrialResult& r = out.trials.back();
    if (r.status != RolloutStatus::kDone) {
      out.converged = false;
      out.message = t.file + ": " + name(r.status);
    }
    out.cost += r.rms * r.rms * double(t.measurements());
  }
  out.rms = pooled(out.trials, trials, raw_rms);
  out.parameters = as_given(sea, {});
  return out;
}

}  // namespace ukemi::identify
