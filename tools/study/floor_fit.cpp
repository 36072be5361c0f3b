#include "tools/study/floor_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/eigen.hpp"
#include "common/error.hpp"
#include "common/median.hpp"
#include "common/random.hpp"
#include "identify/estimate/multi_start.hpp"
#include "tools/study/drop_problem.hpp"

namespace ukemi::tools {

using namespace landing;
using identify::Estimate, identify::LeastSquaresProblem, identify::LeastSquaresSolution;

namespace {

/// Decrease of the cost, in squared standard deviations of the residuals, that ends the final fit, which continues from
/// the best search: it leaves 0.3 % of a standard error.
constexpr double kFitTolerance = 1e-5;
constexpr double kWorkOfStarts = 4;  ///< over the work limit of one start: beyond it no further start is tried

/// Whether the residual is close enough to the logs' noise, see CalibrationOptions::believed.
bool believed(const LeastSquaresSolution& s, const CalibrationOptions& options) {
  return s.usable && s.cost <= options.believed * options.believed * double(s.residuals);
}

/// The best solution from the scene and from starts drawn about it, until one has a small enough residual.
LeastSquaresSolution search(const DropProblem& problem, const CalibrationOptions& options, FloorFit& out) {
  identify::MultiStart starts({.believed = [&](const LeastSquaresSolution& s) { return believed(s, options); },
                               .work = kWorkOfStarts * problem.work_of_start(),
                               .same = options.restarts + 2,  // never reached: repeated minima do not end the search
                               .at_once = 1,
                               .threads = 1,
                               .monitor = {{}, options.monitor.stop}});
  const auto from = [&](const DropProblem::Start& start) { return problem.solve_in_parts(start, out.noise); };
  starts.search_all(1, [&](int) { return from(problem.given()); });
  starts.search_until_believed(options.restarts,
                               [&](int i) { return from(problem.drawn(Random(options.seed, std::uint64_t(i)))); });
  out.starts = starts.starts();
  return starts.best();
}

/// The constants of the scene, without errors.
std::vector<Estimate> as_given(const CalibrationOptions& options, const DropSimulator& simulator) {
  return identify::as_given(options.terms, [&](const DropTerm& t) { return simulator.value(t); });
}

/// Sets the constants, their errors and verdicts, and warns of nuisance terms at their bounds.
void set_results(const LeastSquaresSolution& s, const DropProblem& fitted, const LeastSquaresProblem& problem,
                 FloorFit& out) {
  const std::vector<const identify::Term*> shared(fitted.layout.shared.begin(), fitted.layout.shared.end());
  out.parameters = as_given(fitted.options, fitted.simulator);
  using identify::Wording;
  set_estimates(s, problem, shared,
                {.data = words(fitted.simulator.logs_of()).many,
                 .interval = Wording::Interval::kAbsolute,
                 .correlated = Wording::Correlated::kUnlessTrusted},
                out);
  std::stable_sort(out.nuisance.begin(), out.nuisance.end(),
                   [](const Estimate& a, const Estimate& b) { return a.trial < b.trial; });
  for (const Estimate& e : out.nuisance)
    if (e.at_bound)
      out.warnings.push_back(fmt::format("{} of {} {} ended at its bound {}", e.name, words(out.logs_of).one,
                                         e.trial + 1, shortest(e.value)));
}

/// The residuals of each output of each drop, without those at the level of the rollout's numerical error.
std::vector<identify::ResidualSeries> residuals_of(const DropSimulator& simulator, const FloorFit& c) {
  constexpr double kExact = 1e-6;  // relative to the output: a smaller residual is the rollout's numerical error
  std::vector<identify::ResidualSeries> series;
  for (std::size_t m = 0; m < simulator.drops(); ++m)
    for (std::size_t o = 0; o < c.channels.size(); ++o) {
      const std::vector<double>& measured = simulator.log(m).output[o];
      const DropResult& r = c.drops[m];
      double largest = 0;
      for (const double x : measured)
        if (std::isfinite(x)) largest = std::max(largest, std::abs(x));
      if (!(r.rms[o] > kExact * largest)) continue;
      series.push_back({{}, &measured});
      for (std::size_t i = 0; i < measured.size(); ++i)
        if (r.used[o][i]) series.back().residual.push_back(r.value[o][i] - measured[i]);
    }
  return series;
}

/// Terms that were not fitted, and the sensitivity of the residuals at the minimum to them and to the fitted terms.
struct UnfittedTerms {
  const DropSimulator& simulator;
  const CalibrationOptions& options;
  const std::vector<double>& sigma;  ///< as in the fit
  const FloorFit& fit;
  DropLayout layout{options.terms};  ///< the fitted terms, then these
  DropProblem::Start start{};        ///< values of layout.shared
  std::vector<identify::Term> shared{}, of_drop{};

  UnfittedTerms(const DropSimulator& s, const CalibrationOptions& o, const std::vector<double>& weights,
                const FloorFit& c)
      : simulator(s), options(o), sigma(weights), fit(c) {
    for (const Estimate* e : c.globals()) start.push_back(e->value);
  }
  void add(const DropTerm& t) {
    identify::Term held = t;
    if (t.is_constant()) {  // held at its value, which it may exceed or fall below, except at its bound
      held.absent = simulator.value(t);
      if (held.absent > t.lower) held.lower = -identify::Term::kInfinity;
    }
    const bool each = t.scope == identify::Scope::kEach;
    if (!each) start.push_back(held.absent);
    (each ? of_drop : shared).push_back(std::move(held)), (each ? layout.own : layout.shared).push_back(&t);
  }
  std::optional<identify::Sensitivity> sensitivity() const {
    const DropProblem problem(simulator, layout, options);
    return identify::score_at(problem.problem(start, sigma, kWhole), fit, shared, of_drop);
  }
};

/// Tests the floor by its residuals, see fit_floor. `sigma` as in the fit.
identify::ResidualTests test_floor(const DropSimulator& simulator, const CalibrationOptions& options,
                                   const std::vector<double>& sigma, const FloorFit& c) {
  const DropLayout fitted(options.terms);
  UnfittedTerms unfitted(simulator, options, sigma, c);
  for (const DropTerm& t : *options.terms.table) {
    // A term that acts on the same numbers as a fitted one is that term, or is covered by Chow's test.
    bool covered = options.terms.fits(t.name);
    for (const auto* list : {&fitted.shared, &fitted.own})
      for (const DropTerm* other : *list) covered = covered || t.moves_same_number(*other);
    for (const DropTerm* other : unfitted.layout.shared)  // of KEY and CONTACT.KEY the first only
      covered = covered || (t.is_constant() && other->is_constant() && t.moves_same_number(*other));
    if (!covered) unfitted.add(t);
  }
  const std::vector<identify::ResidualSeries> series = residuals_of(simulator, c);
  std::optional<identify::Sensitivity> score;
  if (c.converged && !series.empty()) score = unfitted.sensitivity();
  identify::ResidualTests out = identify::test_residuals(series, std::move(score));
  if (out.score) out.chow = identify::chow_tests_of(*out.score);
  return out;
}

/// The effect of errors of terms that were not fitted on the fitted ones. `sigma` as in the fit.
std::vector<identify::Considered> considered_of(const DropSimulator& simulator, const CalibrationOptions& options,
                                                const std::vector<double>& sigma, const FloorFit& c) {
  UnfittedTerms unfitted(simulator, options, sigma, c);
  auto errors = options.errors;
  std::erase_if(errors, [](const auto& of) { return of.second == 0; });
  for (const auto& [name, std] : errors) unfitted.add(options.terms[name]);
  const std::optional<identify::Sensitivity> s = unfitted.sensitivity();
  std::vector<identify::Considered> out;
  if (!s) return out;
  const identify::ScaledSolver solve(s->information);
  int shared = s->parameters(), own = shared + int(s->shared.size());  // columns of the next terms
  for (const auto& [name, std] : errors) {
    const identify::Scope scope = options.terms[name].scope;
    const int column = scope == identify::Scope::kEach ? own++ : shared++;
    const Eigen::MatrixXd effect = identify::effect_of(*s, column, scope, [std = std](std::size_t) { return std; });
    out.push_back(identify::considered(*s, solve, name, std, effect, c.fitted.size()));
  }
  return out;
}

/// The likelihood profile of a fitted constant, the other terms refitted. The rise is divided by the factor by which
/// the variance was widened, so that a parabola has the same interval.
identify::Profile profile_of(const DropProblem& fitted, const LeastSquaresSolution& best,
                             const std::vector<double>& sigma, const FloorFit& c, std::size_t global) {
  using From = identify::Profiled::From;
  const double n = double(best.residuals), variance = best.cost / (n - double(best.free_parameters));
  const Estimate& e = *c.globals()[global];
  const double widened = *e.std_noise * *e.std_noise / (best.global_covariance(long(global), long(global)) * variance);
  LeastSquaresSolution last = best;
  const auto rise = [&](double value, From from) {
    if (from == From::kFit) last = best;
    LeastSquaresProblem p = fitted.problem_from(last, sigma);
    p.globals[global].start = value, p.globals[global].held = true;
    const long max_steps = fitted.steps + long(fitted.work_of_start());
    LeastSquaresSolution s = fitted.solve(p, fitted.options.max_iterations, max_steps);
    if (!s.usable) return std::numeric_limits<double>::infinity();
    last = std::move(s);
    return n * std::log(last.cost / best.cost) / widened;
  };
  const auto& terms = fitted.options.terms;
  return identify::profile({e, c.half_width, terms.lower_of(terms[e.name]), terms.upper_of(terms[e.name]), rise});
}

/// Warns of residuals far above the logs' noise. A model that does not explain the logs has no valid error bars: none
/// of its constants is trusted.
void compare_with_noise(FloorFit& out) {
  for (std::size_t o = 0; o < out.channels.size(); ++o)
    if (std::isfinite(out.noise[o]) && out.rms[o] > identify::kFarAboveNoise * out.noise[o]) {
      identify::distrust(out.parameters);
      out.warnings.push_back(
          fmt::format("{}: the residual {:.3g} {} is {:.1f} times the logs' noise: the model lacks something, or no "
                      "start found the minimum",
                      out.channels[o].name, out.rms[o], out.channels[o].unit, out.rms[o] / out.noise[o]));
    }
}

/// The result of a drop that could not be simulated.
DropResult not_simulated(const DropLog& log) {
  DropResult out{.file = log.file};
  out.value.resize(log.output.size()), out.used.resize(log.output.size());
  out.rms.assign(log.output.size(), std::numeric_limits<double>::quiet_NaN());
  return out;
}

}  // namespace

void CalibrationOptions::validate() const {
  terms.validate();
  for (const std::string& constant : terms.free)
    for (const std::string& nuisance : terms.nuisance)
      if (terms[constant].moves_same_number(terms[nuisance]))
        throw InputError(fmt::format("{} and {}: one for all drops or one each, not both", constant, nuisance));
  for (const auto& [name, std] : errors) {
    check_not_negative("--errors: " + name, std);
    const std::string& given = name;
    if (std::count_if(errors.begin(), errors.end(), [&](auto& e) { return e.first == given; }) > 1)
      throw InputError("--errors: " + name + ": given twice");
    for (const auto* list : {&terms.free, &terms.nuisance})
      for (const std::string& fitted : *list)
        if (name == fitted || terms[name].moves_same_number(terms[fitted]))
          throw InputError(fmt::format("--errors: {}: {} is fitted: --prior says what is known of it", name, fitted));
  }
  for (const std::string& constant : profiles)
    if (std::find(terms.free.begin(), terms.free.end(), constant) == terms.free.end())
      throw InputError("--profile: " + constant + ": it is not among the --free constants");
  if (!(accuracy >= 1e-13 && accuracy <= 1e-3))
    throw InputError(
        fmt::format("accuracy: {}: a relative tolerance from 1e-13 to 1e-3 is needed", shortest(accuracy)));
}

Verdicts FloorFit::verdicts() const {
  Verdicts out;
  for (const Estimate& e : parameters) out.emplace_back(e.name, identify::name(e.verdict));
  return out;
}

std::optional<Uncertainty> FloorFit::uncertainty(const std::vector<std::string>* among) const {
  std::vector<int> known;
  Uncertainty out;
  for (std::size_t i = 0; i < fitted.size(); ++i)
    if ((!among || std::find(among->begin(), among->end(), fitted[i]) != among->end()) &&
        std::isfinite(covariance(long(i), long(i))))
      known.push_back(int(i)), out.order.push_back(fitted[i]);
  if (known.empty()) return std::nullopt;
  out.covariance = eigen(covariance)(known, known);
  return out;
}

void check_logs(const DropSimulator& drops) {
  if (drops.drops() == 0)
    throw InputError(fmt::format("no {}: at least one log is needed", words(drops.logs_of()).many));
  for (std::size_t m = 0; m < drops.drops(); ++m) {
    const DropLog& log = drops.log(m);
    long measured = 0;
    for (std::size_t o = 0; o < log.output.size(); ++o) measured += log.count(o);
    if (measured == 0) throw InputError({log.file}, "no measured value of " + names_of(drops.channels()));
    if (const double touchdown = drops.first_touchdown(m); !(log.t.back() > touchdown))
      throw InputError({log.file}, fmt::format("the log ends at {:.4g} s, before the first touchdown{}: is the drop's "
                                               "height right, is t = 0 the release?",
                                               log.t.back(),
                                               std::isfinite(touchdown) ? fmt::format(" at {:.4g} s", touchdown) : ""));
  }
}

FloorFit fit_floor(const DropSimulator& drops, const CalibrationOptions& options) {
  options.validate();
  check_logs(drops);
  const DropProblem problem(drops, DropLayout(options.terms), options);
  FloorFit out;
  out.logs_of = drops.logs_of();
  out.channels = drops.channels();
  out.noise = noise_of(drops);
  LeastSquaresSolution best = search(problem, options, out);
  out.steps = problem.steps;
  if (problem.work_exceeded && !believed(best, options))
    out.warnings.push_back(fmt::format("the search was ended after {:.2g} integrated steps, no start near the logs: {}",
                                       double(problem.steps), words(out.logs_of).hint));
  if (!best.usable) {
    out.message = options.monitor.stopped() ? "interrupted before a part of the fit was done"
                                            : fmt::format("no start could be followed through the {}: {}",
                                                          words(out.logs_of).many, best.message);
    out.parameters = as_given(options, drops);
    for (std::size_t m = 0; m < drops.drops(); ++m) out.drops.push_back(not_simulated(drops.log(m)));
    out.rms = rms_of(out.drops);
    return out;
  }
  // Refit with each output weighted by its own residuals, so that errors and priors are in standard deviations.
  std::vector<double> sigma = rms_of(problem.replay(best));
  for (std::size_t o = 0; o < sigma.size(); ++o) sigma[o] = std::max(sigma[o], 1e-3 * out.noise[o]);
  const LeastSquaresProblem last = problem.problem_from(best, sigma);
  const long max_steps = problem.steps + long(problem.work_of_start());
  if (LeastSquaresSolution s =
          problem.solve(last, options.max_iterations, max_steps, kFitTolerance / double(best.residuals));
      s.usable && !options.monitor.stopped())
    best = std::move(s);
  best.converged = best.converged && !options.monitor.stopped();
  out.steps = problem.steps;
  if (!best.converged) out.message = options.monitor.stopped() ? "interrupted" : best.message;
  set_results(best, problem, last, out);
  identify::warn_of_priors(options.terms, best, 1, out);
  if (!options.errors.empty() && out.converged) {
    for (identify::Considered& c : considered_of(drops, options, sigma, out)) out.considered.push_back(std::move(c));
    identify::update_errors(eigen(out.noise_covariance), out.half_width, identify::Wording::Interval::kAbsolute, out);
  }
  out.drops = problem.replay(best);
  out.rms = rms_of(out.drops);
  compare_with_noise(out);
  out.tests = test_floor(drops, options, sigma, out);
  identify::widen_errors(out.tests, out);
  if (!out.converged) identify::distrust(out.parameters);
  for (const std::string& constant : options.profiles) {
    const auto global = std::size_t(std::find(out.fitted.begin(), out.fitted.end(), constant) - out.fitted.begin());
    if (out.globals()[global]->std && out.converged)
      out.profiles.push_back(profile_of(problem, best, sigma, out, global));
    else
      out.warnings.push_back(constant + " has no standard error: no profile");
  }
  return out;
}

FloorFit validate_floor(const DropSimulator& drops, const CalibrationOptions& options) {
  check_logs(drops);
  FloorFit out;
  out.logs_of = drops.logs_of();
  out.channels = drops.channels();
  out.noise = noise_of(drops);
  out.converged = true;
  DropLayout layout;  // of a single drop: its nuisance terms are the shared ones
  for (const std::string& name : options.terms.nuisance) layout.shared.push_back(&options.terms[name]);
  for (std::size_t m = 0; m < drops.drops(); ++m) {
    const DropProblem problem(drops, layout, options, {m});
    LeastSquaresSolution s;
    s.locals.resize(1, 0);
    if (!layout.shared.empty()) {
      const LeastSquaresProblem p = problem.problem(problem.given(), out.noise, kWhole);
      s = identify::solve(p, {.max_iterations = options.max_iterations});
      const double variance = s.cost / double(std::max(1l, s.residuals - s.free_parameters));
      for (long g = 0; s.usable && g < s.globals.size(); ++g)
        out.nuisance.push_back(identify::estimate_of(p.globals[std::size_t(g)], s.globals[g],
                                                     s.global_covariance(g, g) * variance, out.half_width, int(m)));
      if (!s.usable || !s.converged) out.converged = false, out.message = drops.log(m).file + ": " + s.message;
    }
    out.drops.push_back(s.usable || layout.shared.empty() ? problem.replay(s)[0] : not_simulated(drops.log(m)));
    if (!out.drops.back().simulated)
      out.converged = false, out.message = fmt::format("{}: the {} cannot be followed with these constants",
                                                       drops.log(m).file, words(out.logs_of).one);
  }
  out.rms = rms_of(out.drops);
  compare_with_noise(out);
  return out;
}

std::vector<Eigen::MatrixXd> drop_information(const DropSimulator& drops, const CalibrationOptions& options,
                                              const std::vector<double>& sigma, const std::vector<Estimate>& nuisance) {
  const DropLayout layout(options.terms);
  std::vector<Eigen::MatrixXd> out;
  for (std::size_t m = 0; m < drops.drops(); ++m) {
    const DropProblem problem(drops, layout, options, {m});
    LeastSquaresProblem p = problem.problem(problem.given(), sigma, kWhole);
    std::vector<double>& start = p.blocks[0].local_start;
    for (const DropTerm* t : layout.own) {
      start.push_back(t->absent);
      for (const Estimate& e : nuisance)
        if (e.trial == int(m) && e.name == t->name) start.back() = e.value;
    }
    const LeastSquaresSolution s = identify::solve(p, {.max_iterations = 0});
    out.push_back(s.usable ? s.information : Eigen::MatrixXd());
  }
  return out;
}

double held_out(const DropSimulator& drops, const CalibrationOptions& options) {
  const DropLayout layout(options.terms);
  const std::vector<double> noise = noise_of(drops);
  std::vector<double> of_drop;
  for (std::size_t m = 0; m < drops.drops(); ++m) {
    std::vector<std::size_t> others = every_drop(drops);
    others.erase(others.begin() + long(m));
    const DropProblem of_others(drops, layout, options, others), alone(drops, layout, options, {m});
    const LeastSquaresSolution s = of_others.solve(of_others.problem(of_others.given(), noise, kWhole), kPartIterations,
                                                   long(of_others.work_of_start()));
    if (!s.usable) return std::numeric_limits<double>::quiet_NaN();
    LeastSquaresProblem one = alone.problem({s.globals.data(), s.globals.data() + s.globals.size()}, noise, kWhole);
    double cost = identify::cost_at(one, {}, s.globals);
    one.hold_globals();
    if (!layout.own.empty()) cost = identify::solve(one, {}).cost;
    of_drop.push_back(std::sqrt(cost / double(one.blocks[0].size)));
  }
  return median(of_drop);
}

}  // namespace ukemi::tools
