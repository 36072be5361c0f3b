#include "tools/study/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/csv.hpp"
#include "common/eigen.hpp"
#include "common/error.hpp"
#include "common/random.hpp"
#include "identify/estimate/multi_start.hpp"
#include "landing/model/release.hpp"
#include "tools/study/drop_residuals.hpp"

namespace ukemi::tools {

using namespace landing;
using identify::Estimate, identify::LeastSquaresProblem, identify::LeastSquaresSolution;

namespace {

/// From a drop's first touchdown on, how far it is followed, part by part [s]: what comes after a touchdown can be met
/// only once the touchdown is. `test_regression "calibrate*"` chose them, from starts 30 % off.
constexpr double kWhole = std::numeric_limits<double>::infinity();
constexpr std::array<double, 9> kAfter = {0.02, 0.03, 0.05, 0.08, 0.13, 0.2, 0.3, 0.5, kWhole};
constexpr int kPartIterations = 12;  ///< of the solver, at most, in a part that is not the whole
/// Standard deviation, in a constant's size, of what holds it to the start there.
constexpr double kPartStd = 0.3;
/// Integrated steps, of a drop, after which a start is ended where it stands: those of datasets/drops take 1.3e4 in
/// all. And starts that may take so many before no other is tried.
constexpr double kStepsOfStart = 2e5, kStarts = 4;

/// A fit of all drops by one layout.
struct Problem {
  const DropLayout layout;
  const CalibrationOptions& options;
  std::vector<DropResiduals> models;
  mutable long steps = 0, parts = 0;  ///< integrated, and done, so far
  mutable bool spent = false;         ///< a start was ended, for its work was spent

  Problem(const Scene& scene, const SeaParameters<double>& sea, const std::vector<LoggedDrop>& drops, DropLayout l,
          const CalibrationOptions& o)
      : layout(std::move(l)), options(o) {
    for (const LoggedDrop& d : drops) models.emplace_back(scene, sea, d, layout, o, steps);
  }
  Problem(const Problem&) = delete;

  /// From `start`, `after` seconds beyond each drop's first touchdown. Where that is not the whole, the constants are
  /// held loosely to the start: what so short a part does not determine must not run away.
  LeastSquaresProblem problem(const Scene& start, const PerOutput& sigma, double after) const {
    LeastSquaresProblem p;
    for (const DropTerm* t : layout.shared) p.globals.push_back(t->column(start, options.terms));
    for (const DropTerm* t : layout.own) p.locals.push_back(t->column(start, options.terms));
    for (std::size_t m = 0; m < models.size(); ++m) {
      Scene thrown = start;
      thrown.drop = models[m].drop().thrown;
      const double touchdown = is_ballistic(thrown.drop, 0) ? fall_time(thrown) : 0;
      std::vector<Prior> priors;  // those of the shared terms stand in the first block
      for (const Prior& prior : options.terms.priors)
        if (layout.holds(layout.own, prior.term) || (m == 0 && layout.holds(layout.shared, prior.term)))
          priors.push_back(prior);
      for (std::size_t k = 0; m == 0 && std::isfinite(after) && k < layout.shared.size(); ++k)
        priors.push_back({layout.shared[k]->name, p.globals[k].start, kPartStd * p.globals[k].scale});
      p.blocks.push_back(models[m].block(sigma, touchdown + after, priors));
    }
    return p;
  }
  /// The work that a start may take [integrated steps].
  double work_of_start() const { return kStepsOfStart * double(models.size()); }
  LeastSquaresSolution solve(const LeastSquaresProblem& p, int iterations, long until) const {
    const auto stop = [&, until] {
      options.monitor.progress(parts, long(kAfter.size()) * (1 + options.restarts) + 1);
      return steps > until || options.monitor.stopped();
    };
    return identify::solve(p, {.max_iterations = iterations, .stop = stop});
  }
  /// From `start`, part by part. Where the monitor stops it or its work is spent: the last part that was done, not
  /// converged; of parts that are not the whole no cost is comparable.
  LeastSquaresSolution solve_in_parts(Scene start, const PerOutput& sigma) const {
    LeastSquaresSolution done;
    const long from = steps, until = from + long(work_of_start());
    for (const double after : kAfter) {
      const bool whole = !std::isfinite(after);
      LeastSquaresSolution s =
          solve(problem(start, sigma, after),
                whole ? options.max_iterations : std::min(kPartIterations, options.max_iterations), until);
      if (options.monitor.stopped() || (steps > until && !(whole && s.usable))) {
        done.converged = false;
        if (steps > until) spent = true, done.cost = std::numeric_limits<double>::infinity();
        break;
      }
      if (s.usable) start = scene_at(s, start);
      done = std::move(s);
      ++parts;
    }
    done.work = double(steps - from);
    return done;
  }
  /// `scene` with the solution's constants.
  Scene scene_at(const LeastSquaresSolution& s, Scene scene) const {
    for (std::size_t g = 0; g < layout.shared.size(); ++g)
      if (layout.shared[g]->is_constant()) layout.shared[g]->set_in(scene, s.globals[long(g)]);
    return scene;
  }
  /// `scene` with the free constants drawn about its own.
  Scene drawn(Scene scene, Random random) const {
    for (const DropTerm* t : layout.shared) {
      const double at = t->value_in(scene);
      if (t->is_constant())
        t->set_in(scene, t->one_sided() ? at * random.factor(t->spread) : at + random.uniform(-t->spread, t->spread));
    }
    return scene;
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

/// Whether it leaves no more than the logs' noise, about.
bool believed(const LeastSquaresSolution& s) {
  constexpr double kLevel = identify::kFarAboveNoise * identify::kFarAboveNoise;
  return s.usable && s.cost <= kLevel * double(s.residuals);
}

/// The best solution from the scene and from starts drawn about it, while none is believed.
LeastSquaresSolution search(const Problem& problem, const Scene& scene, const CalibrationOptions& options,
                            Calibration& out) {
  identify::MultiStart starts({.believed = believed,
                               .work = kStarts * problem.work_of_start(),
                               .same = options.restarts + 2,  // so few starts are no reason to end early
                               .at_once = 1,
                               .threads = 1,
                               .monitor = {{}, options.monitor.stop}});
  const auto from = [&](const Scene& start) { return problem.solve_in_parts(start, out.noise); };
  starts.search_all(1, [&](int) { return from(scene); });
  starts.search_until_believed(
      options.restarts, [&](int i) { return from(problem.drawn(scene, Random(options.seed, std::uint64_t(i)))); });
  out.starts = starts.starts();
  return starts.best();
}

/// The constants of `scene`, without errors.
std::vector<Estimate> as_given(const CalibrationOptions& options, const Scene& scene) {
  return identify::as_given(options.terms, [&](const DropTerm& t) { return t.value_in(scene); });
}

/// The constants, their errors and what can be said of them.
void report(const LeastSquaresSolution& s, const Problem& fitted, const LeastSquaresProblem& problem,
            Calibration& out) {
  const std::vector<const identify::Term*> shared(fitted.layout.shared.begin(), fitted.layout.shared.end());
  out.parameters = as_given(fitted.options, out.scene);
  using identify::Wording;
  set_estimates(
      s, problem, shared,
      {.data = "drops", .interval = Wording::Interval::kAbsolute, .correlated = Wording::Correlated::kUnlessTrusted},
      out);
  std::stable_sort(out.nuisance.begin(), out.nuisance.end(),
                   [](const Estimate& a, const Estimate& b) { return a.trial < b.trial; });
  for (const Estimate& e : out.nuisance)
    if (e.at_bound)
      out.warnings.push_back(
          fmt::format("{} of drop {} ended at its bound {}", e.name, e.trial + 1, shortest(e.value)));
}

/// Tests the floor, see calibrate. `sigma` as in the fit.
identify::ResidualTests test_floor(const SeaParameters<double>& sea, const std::vector<LoggedDrop>& drops,
                                   const CalibrationOptions& options, const PerOutput& sigma, const Calibration& c) {
  const DropLayout fitted(options.terms);
  DropLayout layout = fitted;
  std::vector<identify::Term> shared, of_drop;
  for (const DropTerm& t : *options.terms.table) {
    // What moves the same as a fitted term is that term, or Chow's test.
    bool covered = options.terms.fits(t.name);
    for (const auto* list : {&fitted.shared, &fitted.own})
      for (const DropTerm* other : *list) covered = covered || t.moves_what(*other);
    if (covered) continue;
    identify::Term absent = t;
    if (t.is_constant()) {  // it may be more or less than what it is held at
      absent.absent = t.value_in(c.scene), absent.lower = -identify::Term::kInfinity;
    }
    const bool each = t.scope == identify::Scope::kEach;
    (each ? of_drop : shared).push_back(std::move(absent)), (each ? layout.own : layout.shared).push_back(&t);
  }
  constexpr double kExact = 1e-6;  // of an output: below it a residual is the rollout's, not the log's
  std::vector<identify::ResidualSeries> series;
  for (std::size_t m = 0; m < drops.size(); ++m)
    for (std::size_t o = 0; o < kOutputs; ++o) {
      const std::vector<double>& measured = drops[m].log.output[o];
      const DropResult& r = c.drops[m];
      double largest = 0;
      for (const double x : measured)
        if (std::isfinite(x)) largest = std::max(largest, std::abs(x));
      if (!(r.rms[o] > kExact * largest)) continue;
      series.push_back({{}, &measured});
      for (std::size_t i = 0; i < measured.size(); ++i)
        if (r.used[o][i]) series.back().residual.push_back(r.value[o][i] - measured[i]);
    }
  const Problem problem(c.scene, sea, drops, layout, options);
  std::optional<identify::Sensitivity> score;
  if (c.converged && !series.empty())
    score = identify::score_at(problem.problem(c.scene, sigma, kWhole), c, shared, of_drop);
  identify::ResidualTests out = identify::test_residuals(series, std::move(score));
  if (out.score) out.chow = identify::chow_tests_of(*out.score);
  return out;
}

Verdicts verdicts_of(const std::vector<Estimate>& constants) {
  Verdicts out;
  for (const Estimate& e : constants) out.emplace_back(e.name, identify::name(e.verdict));
  return out;
}

/// Of the constants that were fitted, as far as it is known.
std::optional<Uncertainty> uncertainty_of(const Calibration& c) {
  std::vector<int> known;
  Uncertainty out;
  for (std::size_t i = 0; i < c.fitted.size(); ++i)
    if (std::find(kUncertainNames.begin(), kUncertainNames.end(), c.fitted[i]) != kUncertainNames.end() &&
        std::isfinite(c.covariance(long(i), long(i))))
      known.push_back(int(i)), out.order.push_back(c.fitted[i]);
  if (known.empty()) return std::nullopt;
  out.covariance = eigen(c.covariance)(known, known);
  return out;
}

/// Says where the residual stays above the logs' own noise. A model that does not explain the logs has no error bars:
/// nothing fitted by it is trusted.
void compare_with_noise(Calibration& out) {
  for (std::size_t o = 0; o < kOutputs; ++o)
    if (std::isfinite(out.noise[o]) && out.rms[o] > identify::kFarAboveNoise * out.noise[o]) {
      identify::distrust(out.parameters);
      out.warnings.push_back(
          fmt::format("{}: the residual {:.3g} {} is {:.1f} times the logs' noise: the model lacks "
                      "something, or no start found the minimum",
                      kOutputNames[o], out.rms[o], kOutputUnits[o], out.rms[o] / out.noise[o]));
    }
}

}  // namespace

void CalibrationOptions::validate() const {
  terms.validate();
  for (const std::string& constant : terms.free)
    for (const std::string& nuisance : terms.nuisance)
      if (terms[constant].moves_what(terms[nuisance]))
        throw InputError(fmt::format("{} and {}: one for all drops or one each, not both", constant, nuisance));
  if (!(accuracy >= 1e-13 && accuracy <= 1e-3))
    throw InputError(
        fmt::format("accuracy: {}: a relative tolerance from 1e-13 to 1e-3 is needed", shortest(accuracy)));
}

void check_drops(const Scene& scene, const std::vector<LoggedDrop>& drops) {
  if (drops.empty()) throw InputError("no drops: at least one log is needed");
  if (!scene.touches())
    throw InputError("the scene has no [floor] or no contacts: both are needed, the floor's constants as a start");
  for (const LoggedDrop& d : drops) {
    long measured = 0;
    for (int o = 0; o < kOutputs; ++o) measured += d.log.count(DropOutput(o));
    if (measured == 0) throw InputError({d.log.file}, "no measured value of acc, ax, ay, x_0, y_0 or phi_0");
    Scene thrown = scene;
    thrown.drop = d.thrown;
    if (is_ballistic(thrown.drop, 0) && d.log.t.back() <= fall_time(thrown))
      throw InputError({d.log.file}, fmt::format("the log ends at {:.4g} s, before the first touchdown at {:.4g} s: is "
                                                 "the drop's height right, is t = 0 the release?",
                                                 d.log.t.back(), fall_time(thrown)));
  }
}

Calibration calibrate(const Scene& scene, const SeaParameters<double>& sea, const std::vector<LoggedDrop>& drops,
                      const CalibrationOptions& options) {
  options.validate();
  check_drops(scene, drops);
  const Problem problem(scene, sea, drops, DropLayout(options.terms), options);
  Calibration out;
  out.scene = scene;
  out.noise = noise_of(drops);
  LeastSquaresSolution best = search(problem, scene, options, out);
  out.steps = problem.steps;
  if (problem.spent && !believed(best))
    out.warnings.push_back(
        fmt::format("the search was ended after {:.2g} integrated steps, no start near the logs: are the "
                    "drop's height, speed and pitch right, is t = 0 the release?",
                    double(problem.steps)));
  if (!best.usable) {
    out.message = options.monitor.stopped() ? "interrupted before a part of the fit was done"
                                            : "no start could be followed through the drops: " + best.message;
    out.parameters = as_given(options, scene), out.scene.verdicts = verdicts_of(out.parameters);
    for (const LoggedDrop& d : drops) out.drops.push_back({.file = d.log.file});
    return out;
  }
  // Once more with each output's weight from its own residuals, so that errors and priors are in standard deviations.
  PerOutput sigma = rms_of(problem.replay(best));
  for (std::size_t o = 0; o < kOutputs; ++o) sigma[o] = std::max(sigma[o], 1e-3 * out.noise[o]);
  const LeastSquaresProblem last = problem.problem(problem.scene_at(best, scene), sigma, kWhole);
  if (LeastSquaresSolution s =
          problem.solve(last, options.max_iterations, problem.steps + long(problem.work_of_start()));
      s.usable && !options.monitor.stopped())
    best = std::move(s);
  best.converged = best.converged && !options.monitor.stopped();
  out.scene = problem.scene_at(best, scene);
  out.steps = problem.steps;
  if (!best.converged) out.message = options.monitor.stopped() ? "interrupted" : best.message;
  report(best, problem, last, out);
  out.drops = problem.replay(best);
  out.rms = rms_of(out.drops);
  compare_with_noise(out);
  out.tests = test_floor(sea, drops, options, sigma, out);
  identify::widen_errors(out.tests, out);
  if (!out.converged) identify::distrust(out.parameters);
  if (out.converged) out.scene.uncertainty = uncertainty_of(out);
  out.scene.verdicts = verdicts_of(out.parameters);
  return out;
}

Calibration validate(const Scene& scene, const SeaParameters<double>& sea, const std::vector<LoggedDrop>& drops,
                     const CalibrationOptions& options) {
  check_drops(scene, drops);
  Calibration out;
  out.scene = scene;
  out.noise = noise_of(drops);
  out.converged = true;
  DropLayout layout;  // of one drop, whose own terms are then shared
  for (const std::string& name : options.terms.nuisance) layout.shared.push_back(&options.terms[name]);
  for (std::size_t m = 0; m < drops.size(); ++m) {
    const std::vector<LoggedDrop> one = {drops[m]};
    const Problem problem(scene, sea, one, layout, options);
    LeastSquaresSolution s;
    s.locals.resize(1, 0);
    if (!layout.shared.empty()) {
      const LeastSquaresProblem p = problem.problem(scene, out.noise, kWhole);
      s = identify::solve(p, {.max_iterations = options.max_iterations});
      const double variance = s.cost / double(std::max(1l, s.residuals - s.free_parameters));
      for (long g = 0; s.usable && g < s.globals.size(); ++g)
        out.nuisance.push_back(identify::estimate_of(p.globals[std::size_t(g)], s.globals[g],
                                                     s.global_covariance(g, g) * variance, out.half_width, int(m)));
      if (!s.usable || !s.converged) out.converged = false, out.message = drops[m].log.file + ": " + s.message;
    }
    out.drops.push_back(s.usable || layout.shared.empty() ? problem.replay(s)[0]
                                                          : DropResult{.file = drops[m].log.file});
    if (!out.drops.back().simulated)
      out.converged = false, out.message = drops[m].log.file + ": the drop cannot be followed with these constants";
  }
  out.rms = rms_of(out.drops);
  compare_with_noise(out);
  return out;
}

}  // namespace ukemi::tools
