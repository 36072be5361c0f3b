#include "tools/study/floor_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/decompositions.hpp"
#include "common/eigen.hpp"
#include "common/error.hpp"
#include "common/median.hpp"
#include "common/random.hpp"
#include "identify/estimate/multi_start.hpp"
#include "tools/study/drop_residuals.hpp"

namespace ukemi::tools {

using namespace landing;
using identify::Estimate, identify::LeastSquaresProblem, identify::LeastSquaresSolution;

namespace {

constexpr double kWhole = std::numeric_limits<double>::infinity();
constexpr int kPartIterations = 12;  ///< of the solver, at most, in a part that is not the whole
/// Relative fall of the cost that ends a search from a start; and the fall, in squared standard deviations of the
/// residuals, that ends the last fit, which goes on from there: it leaves 0.3 % of a standard error.
constexpr double kSearched = 1e-6, kFitted = 1e-5;
/// Standard deviation, in a constant's size, of the prior that holds it to the start there.
constexpr double kPartStd = 0.3;
/// Integrated steps, of a drop, after which a start is ended: those of datasets/drops take 1.3e4 in
/// all. And the multiple of it after which no other start is tried.
constexpr double kStepsOfStart = 2e5, kStarts = 4;

/// Values of a layout's shared terms: where a search starts.
using Start = std::vector<double>;

std::vector<std::size_t> every_drop(const DropSimulator& s) {
  std::vector<std::size_t> out(s.drops());
  std::iota(out.begin(), out.end(), std::size_t(0));
  return out;
}

/// The least-squares problem of drops with one layout of terms.
struct Problem {
  const DropSimulator& simulator;
  const DropLayout layout;
  const CalibrationOptions& options;
  const std::vector<std::size_t> which;
  const std::vector<double> horizons;
  std::vector<DropResiduals> models;
  mutable long steps = 0, parts = 0;  ///< integrated, and done, so far
  mutable bool spent = false;         ///< a start was ended because its work was spent

  Problem(const DropSimulator& s, DropLayout l, const CalibrationOptions& o)
      : Problem(s, std::move(l), o, every_drop(s)) {}
  /// The problem of some of the drops.
  Problem(const DropSimulator& s, DropLayout l, const CalibrationOptions& o, std::vector<std::size_t> some)
      : simulator(s), layout(std::move(l)), options(o), which(std::move(some)), horizons(s.parts()) {
    for (const std::size_t m : which) models.emplace_back(s, m, layout, o, steps);
  }
  Problem(const Problem&) = delete;

  /// The scene's constants; what is not a constant is absent.
  Start given() const {
    Start out;
    for (const DropTerm* t : layout.shared) out.push_back(t->is_constant() ? simulator.value(*t) : t->absent);
    return out;
  }

  /// From `start`, `after` seconds beyond each drop's first touchdown. Where that is not the whole, the constants are
  /// held loosely to the start: what so short a part does not determine must not run away.
  LeastSquaresProblem problem(const Start& start, const std::vector<double>& sigma, double after) const {
    LeastSquaresProblem p;
    for (std::size_t g = 0; g < layout.shared.size(); ++g)
      p.globals.push_back(layout.shared[g]->column(start[g], options.terms));
    for (const DropTerm* t : layout.own) p.locals.push_back(t->column(t->absent, options.terms));
    for (std::size_t m = 0; m < models.size(); ++m) {
      std::vector<Prior> priors;  // those of the shared terms are in the first block
      for (const Prior& prior : options.terms.priors)
        if (layout.holds(layout.own, prior.term) || (m == 0 && layout.holds(layout.shared, prior.term)))
          priors.push_back(prior);
      for (std::size_t k = 0; m == 0 && std::isfinite(after) && k < layout.shared.size(); ++k)
        priors.push_back({layout.shared[k]->name, p.globals[k].start, kPartStd * p.globals[k].scale});
      p.blocks.push_back(models[m].block(sigma, simulator.first_touchdown(which[m]) + after, priors));
    }
    return p;
  }
  /// The whole, from a solution of it.
  LeastSquaresProblem problem_from(const LeastSquaresSolution& s, const std::vector<double>& sigma) const {
    LeastSquaresProblem p = problem({s.globals.data(), s.globals.data() + s.globals.size()}, sigma, kWhole);
    for (std::size_t m = 0; m < p.blocks.size(); ++m)
      for (long k = 0; k < s.locals.cols(); ++k) p.blocks[m].local_start.push_back(s.locals(long(m), k));
    return p;
  }
  /// The work that a start may take [integrated steps].
  double work_of_start() const {
    return kStepsOfStart * double(models.size()) * simulator.patience(layout.shared.size() + layout.own.size());
  }
  LeastSquaresSolution solve(const LeastSquaresProblem& p, int iterations, long until,
                             double tolerance = kSearched) const {
    const auto stop = [&, until] {
      options.monitor.progress(parts, long(horizons.size()) * (1 + options.restarts) + 1);
      return steps > until || options.monitor.stopped();
    };
    return identify::solve(p, {.max_iterations = iterations, .cost_tolerance = tolerance, .stop = stop});
  }
  /// From `start`, part by part. Where the monitor stops it or its work is spent: the last part that was done, not
  /// converged; of parts that are not the whole no cost is comparable.
  LeastSquaresSolution solve_in_parts(Start start, const std::vector<double>& sigma) const {
    LeastSquaresSolution done;
    const long from = steps, until = from + long(work_of_start());
    for (const double after : horizons) {
      const bool whole = !std::isfinite(after);
      if (!whole && options.parts == CalibrationOptions::Parts::kWhole) continue;
      LeastSquaresSolution s =
          solve(problem(start, sigma, after),
                whole ? options.max_iterations : std::min(kPartIterations, options.max_iterations), until);
      if (options.monitor.stopped() || (steps > until && !(whole && s.usable))) {
        done.converged = false;
        if (steps > until) spent = true, done.cost = std::numeric_limits<double>::infinity();
        break;
      }
      if (s.usable) start = constants_at(s, start);
      done = std::move(s);
      ++parts;
    }
    done.work = double(steps - from);
    return done;
  }
  /// The solution's constants; what is no constant starts anew.
  Start constants_at(const LeastSquaresSolution& s, Start from) const {
    for (std::size_t g = 0; g < layout.shared.size(); ++g)
      if (layout.shared[g]->is_constant()) from[g] = s.globals[long(g)];
    return from;
  }
  /// Free constants drawn about the scene's own.
  Start drawn(Random random) const {
    Start out = given();
    for (std::size_t g = 0; g < out.size(); ++g) {
      const DropTerm& t = *layout.shared[g];
      if (t.is_constant())
        out[g] = t.one_sided() ? out[g] * random.factor(t.spread) : out[g] + random.uniform(-t.spread, t.spread);
    }
    return out;
  }
  std::vector<DropResult> replay(const LeastSquaresSolution& s) const {
    std::vector<DropResult> out;
    for (std::size_t m = 0; m < models.size(); ++m) {
      const Eigen::VectorXd own = s.locals.row(long(m));
      out.push_back(models[m].replay(s.globals.data(), own.data()));
    }
    return out;
  }
};

/// Whether its residual is about the logs' noise.
bool believed(const LeastSquaresSolution& s, const CalibrationOptions& options) {
  return s.usable && s.cost <= options.believed * options.believed * double(s.residuals);
}

/// The best solution from the scene and from starts drawn about it, until one has a small enough residual.
LeastSquaresSolution search(const Problem& problem, const CalibrationOptions& options, FloorFit& out) {
  identify::MultiStart starts({.believed = [&](const LeastSquaresSolution& s) { return believed(s, options); },
                               .work = kStarts * problem.work_of_start(),
                               .same = options.restarts + 2,  // so few starts are no reason to end early
                               .at_once = 1,
                               .threads = 1,
                               .monitor = {{}, options.monitor.stop}});
  const auto from = [&](const Start& start) { return problem.solve_in_parts(start, out.noise); };
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

/// The constants, their errors and verdicts.
void report(const LeastSquaresSolution& s, const Problem& fitted, const LeastSquaresProblem& problem, FloorFit& out) {
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

/// The residuals of each output of each drop, without those that are the rollout's own.
std::vector<identify::ResidualSeries> residuals_of(const DropSimulator& simulator, const FloorFit& c) {
  constexpr double kExact = 1e-6;  // of an output: below it a residual is the rollout's, not the log's
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

/// Terms that were not fitted, at a minimum: how the residuals there move with them and with what was.
struct FurtherTerms {
  const DropSimulator& simulator;
  const CalibrationOptions& options;
  const std::vector<double>& sigma;  ///< as in the fit
  const FloorFit& fit;
  DropLayout layout{options.terms};  ///< what was fitted, then these
  Start start{};                     ///< of layout.shared
  std::vector<identify::Term> shared{}, of_drop{};

  FurtherTerms(const DropSimulator& s, const CalibrationOptions& o, const std::vector<double>& weights,
               const FloorFit& c)
      : simulator(s), options(o), sigma(weights), fit(c) {
    for (const Estimate* e : c.globals()) start.push_back(e->value);
  }
  void add(const DropTerm& t) {
    identify::Term absent = t;
    if (t.is_constant()) {  // it may be above or below the value that it is held at, except at its bound
      absent.absent = simulator.value(t);
      if (absent.absent > t.lower) absent.lower = -identify::Term::kInfinity;
    }
    const bool each = t.scope == identify::Scope::kEach;
    if (!each) start.push_back(absent.absent);
    (each ? of_drop : shared).push_back(std::move(absent)), (each ? layout.own : layout.shared).push_back(&t);
  }
  std::optional<identify::Sensitivity> sensitivity() const {
    const Problem problem(simulator, layout, options);
    return identify::score_at(problem.problem(start, sigma, kWhole), fit, shared, of_drop);
  }
};

/// Tests the floor, see fit_floor. `sigma` as in the fit.
identify::ResidualTests test_floor(const DropSimulator& simulator, const CalibrationOptions& options,
                                   const std::vector<double>& sigma, const FloorFit& c) {
  const DropLayout fitted(options.terms);
  FurtherTerms further(simulator, options, sigma, c);
  for (const DropTerm& t : *options.terms.table) {
    // A term that moves the same numbers as a fitted one is that term, or Chow's test.
    bool covered = options.terms.fits(t.name);
    for (const auto* list : {&fitted.shared, &fitted.own})
      for (const DropTerm* other : *list) covered = covered || t.moves_what(*other);
    for (const DropTerm* other : further.layout.shared)  // of a constant of all contacts, and of one
      covered = covered || (t.is_constant() && other->is_constant() && t.moves_what(*other));
    if (!covered) further.add(t);
  }
  const std::vector<identify::ResidualSeries> series = residuals_of(simulator, c);
  std::optional<identify::Sensitivity> score;
  if (c.converged && !series.empty()) score = further.sensitivity();
  identify::ResidualTests out = identify::test_residuals(series, std::move(score));
  if (out.score) out.chow = identify::chow_tests_of(*out.score);
  return out;
}

/// What the errors of constants that were not fitted make of those that were. `sigma` as in the fit.
std::vector<identify::Considered> considered_of(const DropSimulator& simulator, const CalibrationOptions& options,
                                                const std::vector<double>& sigma, const FloorFit& c) {
  FurtherTerms further(simulator, options, sigma, c);
  for (const auto& [name, std] : options.errors) further.add(options.terms[name]);
  const std::optional<identify::Sensitivity> s = further.sensitivity();
  std::vector<identify::Considered> out;
  if (!s) return out;
  const identify::ScaledSolver solve(s->information);
  int column = s->parameters();
  for (const auto& [name, std] : options.errors)
    out.push_back(
        identify::considered(*s, solve, name, std, std * s->sum(0, column++, s->parameters(), 1), c.fitted.size()));
  return out;
}

/// The likelihood profile of a fitted constant, the other terms refitted. Where the errors were widened, the rise is
/// less by as much: its interval is as wide as theirs where it is a parabola.
identify::Profile profile_of(const Problem& fitted, const LeastSquaresSolution& best, const std::vector<double>& sigma,
                             const FloorFit& c, std::size_t global) {
  using From = identify::Profiled::From;
  const double n = double(best.residuals), variance = best.cost / (n - double(best.free_parameters));
  const Estimate& e = *c.globals()[global];
  const double widened = *e.std_noise * *e.std_noise / (best.global_covariance(long(global), long(global)) * variance);
  LeastSquaresSolution last = best;
  const auto rise = [&](double value, From from) {
    if (from == From::kFit) last = best;
    LeastSquaresProblem p = fitted.problem_from(last, sigma);
    p.globals[global].start = value, p.globals[global].held = true;
    const long until = fitted.steps + long(fitted.work_of_start());
    LeastSquaresSolution s = fitted.solve(p, fitted.options.max_iterations, until);
    if (!s.usable) return kWhole;
    last = std::move(s);
    return n * std::log(last.cost / best.cost) / widened;
  };
  const auto& terms = fitted.options.terms;
  return identify::profile({e, c.half_width, terms.lower_of(terms[e.name]), terms.upper_of(terms[e.name]), rise});
}

/// Says where the residual stays above the logs' own noise. A model that does not explain the logs has no error bars:
/// nothing fitted by it is trusted.
void compare_with_noise(FloorFit& out) {
  for (std::size_t o = 0; o < out.channels.size(); ++o)
    if (std::isfinite(out.noise[o]) && out.rms[o] > identify::kFarAboveNoise * out.noise[o]) {
      identify::distrust(out.parameters);
      out.warnings.push_back(
          fmt::format("{}: the residual {:.3g} {} is {:.1f} times the logs' noise: the model lacks "
                      "something, or no start found the minimum",
                      out.channels[o].name, out.rms[o], out.channels[o].unit, out.rms[o] / out.noise[o]));
    }
}

}  // namespace

void CalibrationOptions::validate() const {
  terms.validate();
  for (const std::string& constant : terms.free)
    for (const std::string& nuisance : terms.nuisance)
      if (terms[constant].moves_what(terms[nuisance]))
        throw InputError(fmt::format("{} and {}: one for all drops or one each, not both", constant, nuisance));
  for (const auto& [name, std] : errors) {
    check_positive("--errors: " + name, std);
    for (const auto* list : {&terms.free, &terms.nuisance})
      for (const std::string& fitted : *list)
        if (terms[name].moves_what(terms[fitted]))
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
      throw InputError({log.file}, fmt::format("the log ends at {:.4g} s, before the first touchdown at {:.4g} s: is "
                                               "the drop's height right, is t = 0 the release?",
                                               log.t.back(), touchdown));
  }
}

namespace {

/// A drop that was not simulated.
DropResult not_simulated(const DropLog& log) {
  DropResult out{.file = log.file};
  out.value.resize(log.output.size()), out.used.resize(log.output.size());
  out.rms.assign(log.output.size(), std::numeric_limits<double>::quiet_NaN());
  return out;
}

}  // namespace

FloorFit fit_floor(const DropSimulator& drops, const CalibrationOptions& options) {
  options.validate();
  check_logs(drops);
  const Problem problem(drops, DropLayout(options.terms), options);
  FloorFit out;
  out.logs_of = drops.logs_of();
  out.channels = drops.channels();
  out.noise = noise_of(drops);
  LeastSquaresSolution best = search(problem, options, out);
  out.steps = problem.steps;
  if (problem.spent && !believed(best, options))
    out.warnings.push_back(fmt::format("the search was ended after {:.2g} integrated steps, no start near the logs: {}",
                                       double(problem.steps), words(out.logs_of).unlike));
  if (!best.usable) {
    out.message = options.monitor.stopped() ? "interrupted before a part of the fit was done"
                                            : fmt::format("no start could be followed through the {}: {}",
                                                          words(out.logs_of).many, best.message);
    out.parameters = as_given(options, drops);
    for (std::size_t m = 0; m < drops.drops(); ++m) out.drops.push_back(not_simulated(drops.log(m)));
    out.rms = rms_of(out.drops);
    return out;
  }
  // Once more with each output's weight from its own residuals, so that errors and priors are in standard deviations.
  std::vector<double> sigma = rms_of(problem.replay(best));
  for (std::size_t o = 0; o < sigma.size(); ++o) sigma[o] = std::max(sigma[o], 1e-3 * out.noise[o]);
  const LeastSquaresProblem last = problem.problem_from(best, sigma);
  const long until = problem.steps + long(problem.work_of_start());
  if (LeastSquaresSolution s = problem.solve(last, options.max_iterations, until, kFitted / double(best.residuals));
      s.usable && !options.monitor.stopped())
    best = std::move(s);
  best.converged = best.converged && !options.monitor.stopped();
  out.steps = problem.steps;
  if (!best.converged) out.message = options.monitor.stopped() ? "interrupted" : best.message;
  report(best, problem, last, out);
  if (!options.errors.empty() && out.converged) {
    out.considered = considered_of(drops, options, sigma, out);
    identify::set_errors(eigen(out.noise_covariance), out);
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
  DropLayout layout;  // of one drop, whose own terms are then shared
  for (const std::string& name : options.terms.nuisance) layout.shared.push_back(&options.terms[name]);
  for (std::size_t m = 0; m < drops.drops(); ++m) {
    const Problem problem(drops, layout, options, {m});
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

namespace {

/// Constants that may be off, and how a drop's own terms follow them.
class PromiseOf {
 public:
  PromiseOf(const DropSimulator& drops, const CalibrationOptions& options, const FloorFit& predicted,
            const Identified& known)
      : drops_(drops), options_(options), predicted_(predicted), scatter_(predicted.noise) {
    const auto& table = *options.terms.table;
    for (std::size_t o = 0; o < scatter_.size(); ++o)
      if (const auto left = known.rms.find(predicted.channels[o].name); left != known.rms.end())
        scatter_[o] = std::fmax(scatter_[o], left->second);
    const auto& [order, all] = known.constants;
    std::vector<int> kept;
    for (std::size_t k = 0; k < order.size(); ++k) {
      const auto term = std::find_if(table.begin(), table.end(), [&, k](auto& t) { return t.name == order[k]; });
      if (term == table.end() || !(all(long(k), long(k)) > 0)) continue;
      kept.push_back(int(k)), layout_.shared.push_back(&*term);
    }
    for (const std::string& name : options.terms.nuisance) layout_.own.push_back(&options.terms[name]);
    const Eigen::MatrixXd covariance = eigen(all)(kept, kept);
    std_ = covariance.diagonal().cwiseSqrt();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts(std_.cwiseInverse().asDiagonal() * covariance *
                                                               std_.cwiseInverse().asDiagonal());
    independent_ = parts.eigenvectors() * parts.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  }

  Promise of(std::size_t m) const {
    Promise out;
    const Problem problem(drops_, layout_, options_, {m});
    const Start constants = problem.given();
    std::vector<double> own;
    for (const DropTerm* t : layout_.own) own.push_back(value_of(t->name, m));
    const DropResult here = problem.models[0].replay(constants.data(), own.data());
    const std::optional<Eigen::MatrixXd> follows = own_by_constants(problem, constants, own);
    if (!here.simulated || !follows) return out;
    std::vector<DropResult> moved;
    for (long k = 0; k < std_.size(); ++k) {
      Start beside = constants;
      beside[std::size_t(k)] += kPart * std_[k];
      std::vector<double> with = own;
      for (std::size_t l = 0; l < with.size(); ++l) with[l] += (*follows)(long(l), k) * kPart * std_[k];
      moved.push_back(problem.models[0].replay(beside.data(), with.data()));
      if (!moved.back().simulated) return out;
    }
    out.band.resize(here.value.size());
    for (std::size_t o = 0; o < here.value.size(); ++o)
      for (std::size_t i = 0; i < here.value[o].size(); ++i)
        out.band[o].push_back(kNormal975 * std::hypot(scatter_[o], by_errors(here, moved, [&](const DropResult& d) {
                                                                     return d.value[o][i];
                                                                   }).norm()));
    const auto same_contacts = [&](const DropResult& d) {
      return std::equal(d.changes.begin(), d.changes.end(), here.changes.begin(), here.changes.end(),
                        [](auto& a, auto& b) { return a.contact == b.contact && a.touches == b.touches; });
    };
    const bool same = std::all_of(moved.begin(), moved.end(), same_contacts);
    out.change =
        Eigen::MatrixXd::Constant(long(here.changes.size()), std_.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; same && i < here.changes.size(); ++i)
      out.change.row(long(i)) = by_errors(here, moved, [&](const DropResult& d) { return d.changes[i].t; });
    return out;
  }

 private:
  static constexpr double kPart = 0.1;  ///< of a standard error

  double value_of(const std::string& name, std::size_t m) const {
    for (const Estimate& e : predicted_.nuisance)
      if (e.trial == int(m) && e.name == name) return e.value;
    return options_.terms[name].absent;
  }
  /// Derivatives of the drop's own terms, refitted, by the constants.
  std::optional<Eigen::MatrixXd> own_by_constants(const Problem& problem, const Start& constants,
                                                  const std::vector<double>& own) const {
    const LeastSquaresProblem p = problem.problem(constants, predicted_.noise, kWhole);
    const identify::ResidualBlock& block = p.blocks[0];
    Eigen::VectorXd residual(block.size);
    Eigen::MatrixXd jacobian(block.size, long(constants.size() + own.size()));
    if (!block.evaluate(constants.data(), own.data(), residual.data(), jacobian.data())) return std::nullopt;
    if (own.empty()) return Eigen::MatrixXd(0, long(constants.size()));
    return Eigen::MatrixXd(
        -LeastNorm(jacobian.rightCols(long(own.size()))).solve(jacobian.leftCols(long(constants.size()))));
  }
  /// How a value moves with independent errors of variance 1.
  template <class Value>
  Eigen::RowVectorXd by_errors(const DropResult& here, const std::vector<DropResult>& moved, Value&& value) const {
    Eigen::RowVectorXd by(std_.size());
    for (long k = 0; k < by.size(); ++k) by[k] = (value(moved[std::size_t(k)]) - value(here)) / kPart;
    return by * independent_;
  }

  const DropSimulator& drops_;
  const CalibrationOptions& options_;
  const FloorFit& predicted_;
  std::vector<double> scatter_;  ///< of each output
  DropLayout layout_;
  Eigen::VectorXd std_;
  Eigen::MatrixXd independent_;  ///< times numbers of variance 1: correlated errors, in standard errors
};

}  // namespace

std::vector<Promise> promises(const DropSimulator& drops, const CalibrationOptions& options, const FloorFit& predicted,
                              const Identified& known) {
  const PromiseOf promise(drops, options, predicted, known);
  std::vector<Promise> out;
  for (std::size_t m = 0; m < drops.drops(); ++m) out.push_back(promise.of(m));
  return out;
}

std::vector<Eigen::MatrixXd> informations(const DropSimulator& drops, const CalibrationOptions& options,
                                          const std::vector<double>& sigma, const std::vector<Estimate>& own) {
  const DropLayout layout(options.terms);
  std::vector<Eigen::MatrixXd> out;
  for (std::size_t m = 0; m < drops.drops(); ++m) {
    const Problem problem(drops, layout, options, {m});
    LeastSquaresProblem p = problem.problem(problem.given(), sigma, kWhole);
    std::vector<double>& start = p.blocks[0].local_start;
    for (const DropTerm* t : layout.own) {
      start.push_back(t->absent);
      for (const Estimate& e : own)
        if (e.trial == int(m) && e.name == t->name) start.back() = e.value;
    }
    const LeastSquaresSolution here = identify::solve(p, {.max_iterations = 0});
    out.push_back(here.usable ? here.information : Eigen::MatrixXd());
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
    const Problem of_others(drops, layout, options, others), alone(drops, layout, options, {m});
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
