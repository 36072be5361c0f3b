#include "tools/study/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "common/random.hpp"
#include "identify/fit/least_squares.hpp"
#include "landing/model/release.hpp"
#include "tools/study/drop_model.hpp"

namespace ukemi::tools {

using namespace landing;
using identify::Estimate, identify::LeastSquaresProblem, identify::LeastSquaresSolution;

namespace {

/// Size of a nuisance term, for scaling.
constexpr std::array<double, kTerms> kTypical = {0, 0, 0, 0, 1e-3, 0.01, 0.05, 0.02};

/// The parameters of the problem, from the constants of `start` on.
LeastSquaresProblem parameters(const Scene& start, const Layout& layout, const CalibrationOptions& options) {
  LeastSquaresProblem p;
  const auto add = [&](Term t, std::vector<identify::Parameter>& to) {
    const auto k = std::size_t(t);
    if (!is_constant(t)) {
      const double bound = t == Term::kTimeShift ? kLargestShift : CalibrationOptions::kInfinity;
      to.push_back({kTermNames[k], kTermUnits[k], 0, -bound, bound, kTypical[k]});
      return;
    }
    Scene s = start;
    const double value = number_of(s, t), size = t == Term::kPitch ? kPitchSize : std::max(value, 1.0);
    // K_f > 0: its bound of 0 is the smallest that the model can be asked with.
    const double lower = t == Term::kStiffness ? std::max(options.lower[k], 1e-3 * size) : options.lower[k];
    to.push_back({kTermNames[k], kTermUnits[k], value, lower, options.upper[k], size});
  };
  for (const Term t : layout.shared) add(t, p.globals);
  for (const Term t : layout.own) add(t, p.locals);
  return p;
}

/// A fit of all drops by one layout.
struct Problem {
  const Layout layout;
  const CalibrationOptions& options;
  std::vector<DropModel> models;

  Problem(const Scene& scene, const SeaParameters<double>& sea, const std::vector<LoggedDrop>& drops, const Layout& l,
          const CalibrationOptions& o)
      : layout(l), options(o) {
    for (const LoggedDrop& d : drops) models.emplace_back(scene, sea, d, layout, o);
  }
  Problem(const Problem&) = delete;

  /// From `start`, `after` seconds beyond each drop's first touchdown. Where that is not the whole, the constants are
  /// held loosely to the start: what so short a part does not determine must not run away.
  LeastSquaresProblem problem(const Scene& start, const PerOutput& sigma, double after) const {
    LeastSquaresProblem p = parameters(start, layout, options);
    for (std::size_t m = 0; m < models.size(); ++m) {
      Scene thrown = start;
      thrown.drop = models[m].drop().thrown;
      const double touchdown = is_ballistic(thrown) ? fall_time(thrown) : 0;
      std::vector<Prior> priors;  // those of the shared terms stand in the first block
      for (const Prior& prior : options.priors)
        if (holds(layout.own, prior.term) || (m == 0 && holds(layout.shared, prior.term))) priors.push_back(prior);
      constexpr double kLeash = 0.3;  // of a constant's size
      for (std::size_t k = 0; m == 0 && std::isfinite(after) && k < layout.shared.size(); ++k)
        priors.push_back({layout.shared[k], p.globals[k].start, kLeash * p.globals[k].scale});
      p.blocks.push_back(models[m].block(sigma, touchdown + after, priors));
    }
    return p;
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

/// The constants of `scene`, without errors.
std::vector<Estimate> as_given(Scene scene, const std::vector<Term>& free) {
  std::vector<Estimate> out;
  for (int k = 0; k < kCalibrated; ++k) {
    const Term t{k};
    const bool fitted = holds(free, t);
    out.push_back({.name = kTermNames[std::size_t(k)],
                   .unit = kTermUnits[std::size_t(k)],
                   .value = number_of(scene, t),
                   .std = {},
                   .free = fitted,
                   .verdict = fitted ? Verdict::kNotIdentifiable : Verdict::kFixed});
  }
  return out;
}

/// The constants, their errors and what can be said of them.
void report(const LeastSquaresSolution& s, const Layout& layout, const LeastSquaresProblem& problem, Calibration& out) {
  std::vector<double> sizes;  // what an interval is measured against
  for (std::size_t g = 0; g < layout.shared.size(); ++g)
    sizes.push_back(std::max(std::abs(s.globals[long(g)]), layout.shared[g] == Term::kPitch ? kPitchSize : 0));
  identify::Uncertainty u = identify::uncertainty_of(s, problem, sizes);
  out.covariance = std::move(u.covariance);
  out.correlation = std::move(u.correlation);
  out.eigenvalues = std::move(u.eigenvalues);
  out.half_width = u.half_width;
  out.parameters = as_given(out.scene, layout.shared);
  for (std::size_t g = 0; g < layout.shared.size(); ++g) {
    out.fitted.push_back(u.globals[g].name);
    out.parameters[std::size_t(layout.shared[g])] = u.globals[g];
  }
  for (const Estimate& e : out.parameters) {
    if (e.verdict == Verdict::kAtBound)
      out.warnings.push_back(fmt::format("{} ended at its bound {}: no standard error", e.name, shortest(e.value)));
    if (e.verdict == Verdict::kNotIdentifiable)
      out.warnings.push_back(e.std ? fmt::format("{} is not identifiable: the 95 % interval is {:.3g} {} either way",
                                                 e.name, e.half_width(), e.unit)
                                   : e.name + " is not determined by these drops");
  }
  const auto trusted = [&](std::size_t g) { return u.globals[g].verdict == Verdict::kTrusted; };
  for (std::size_t i = 0; i < out.fitted.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (std::abs(out.correlation(long(i), long(j))) > 0.95 && !(trusted(i) && trusted(j)))
        out.warnings.push_back(fmt::format("{} and {} correlate by {:.3f}: these drops hardly tell them apart",
                                           out.fitted[j], out.fitted[i], out.correlation(long(i), long(j))));
  out.nuisance = std::move(u.locals);
  std::stable_sort(out.nuisance.begin(), out.nuisance.end(),
                   [](const Estimate& a, const Estimate& b) { return a.trial < b.trial; });
  for (const Estimate& e : out.nuisance)
    if (e.at_bound)
      out.warnings.push_back(
          fmt::format("{} of drop {} ended at its bound {}", e.name, e.trial + 1, shortest(e.value)));
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
  for (std::size_t k = 0; k < kCalibrated; ++k) {
    if (k != std::size_t(Term::kPitch) && !(lower[k] >= 0))
      throw InputError(fmt::format("lower bound of {}: {}: must be at least 0", kTermNames[k], shortest(lower[k])));
    if (!(lower[k] < upper[k]))
      throw InputError(fmt::format("bounds of {}: {} to {}: lower < upper is needed", kTermNames[k], shortest(lower[k]),
                                   shortest(upper[k])));
  }
  for (const Prior& p : priors)
    if (!(p.std > 0))
      throw InputError(fmt::format("prior of {}: {}: a standard deviation above 0 is needed",
                                   kTermNames[std::size_t(p.term)], shortest(p.std)));
  if (free.empty()) throw InputError("nothing to fit: at least one free constant is needed");
  if (holds(free, Term::kPitch) && holds(nuisance, Term::kPitchOffset))
    throw InputError("pitch and pitch_offset: one for all drops or one each, not both");
  if (!(accuracy >= 1e-13 && accuracy <= 1e-3))
    throw InputError(
        fmt::format("accuracy: {}: a relative tolerance from 1e-13 to 1e-3 is needed", shortest(accuracy)));
}

bool Calibration::trusted() const { return converged && identify::all_trusted(parameters); }

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
    if (is_ballistic(thrown) && d.log.t.back() <= fall_time(thrown))
      throw InputError({d.log.file}, fmt::format("the log ends at {:.4g} s, before the first touchdown at {:.4g} s: is "
                                                 "the drop's height right, is t = 0 the release?",
                                                 d.log.t.back(), fall_time(thrown)));
  }
}

Calibration calibrate(const Scene& scene, const SeaParameters<double>& sea, const std::vector<LoggedDrop>& drops,
                      const CalibrationOptions& options) {
  options.validate();
  check_drops(scene, drops);
  const Problem problem(scene, sea, drops, {options.free, options.nuisance}, options);
  Calibration out{.scene = scene};
  out.noise = noise_of(drops);

  const auto with = [&](const LeastSquaresSolution& s) {
    Scene x = scene;
    for (std::size_t g = 0; g < options.free.size(); ++g) number_of(x, options.free[g]) = s.globals[long(g)];
    return x;
  };
  // A drop is followed a little further each time: what comes after a touchdown can be met only once the touchdown is.
  constexpr double kInfinity = CalibrationOptions::kInfinity;
  constexpr std::array<double, 9> kAfter = {0.02, 0.03, 0.05, 0.08, 0.13, 0.2, 0.3, 0.5, kInfinity};
  constexpr int kRough = 12;  // iterations of a part
  long parts = 0;
  const auto attempt = [&](Scene start) {  // where it is stopped: the last part that was done
    LeastSquaresSolution done;
    for (const double after : kAfter) {
      const int iterations = std::isfinite(after) ? std::min(kRough, options.max_iterations) : options.max_iterations;
      LeastSquaresSolution s =
          identify::solve(problem.problem(start, out.noise, after), {.max_iterations = iterations});
      if (options.monitor.stopped()) {
        done.converged = false;
        break;
      }
      if (s.usable) start = with(s);
      done = std::move(s);
      options.monitor.progress(++parts, long(kAfter.size()) * (out.starts + 1) + 1);
    }
    ++out.starts;
    return done;
  };
  const auto believed = [&](const LeastSquaresSolution& s) {
    return s.usable && s.cost <= identify::kFarAboveNoise * identify::kFarAboveNoise * double(s.residuals);
  };
  LeastSquaresSolution best = attempt(scene);
  for (int i = 0; i < options.restarts && !believed(best) && !options.monitor.stopped(); ++i) {
    Random random(options.seed, std::uint64_t(i));
    Scene start = scene;
    for (const Term t : options.free)
      t == Term::kPitch ? number_of(start, t) += random.uniform(-0.2, 0.2) : number_of(start, t) *= random.factor(2);
    LeastSquaresSolution s = attempt(start);
    if (s.usable && (!best.usable || s.cost < best.cost)) best = std::move(s);
  }
  if (!best.usable) {
    out.message = options.monitor.stopped() ? "interrupted before a part of the fit was done"
                                            : "no start could be followed through the drops: " + best.message;
    out.parameters = as_given(scene, options.free);
    for (const LoggedDrop& d : drops) out.drops.push_back({.file = d.log.file});
    return out;
  }
  // Once more with each output's weight from its own residuals, so that errors and priors are in standard deviations.
  PerOutput sigma = rms_of(problem.replay(best));
  for (std::size_t o = 0; o < kOutputs; ++o) sigma[o] = std::max(sigma[o], 1e-3 * out.noise[o]);
  const LeastSquaresProblem last = problem.problem(with(best), sigma, CalibrationOptions::kInfinity);
  if (LeastSquaresSolution s = identify::solve(last, {.max_iterations = options.max_iterations});
      s.usable && !options.monitor.stopped())
    best = std::move(s);
  best.converged = best.converged && !options.monitor.stopped();
  out.scene = with(best);
  out.cost = best.cost, out.converged = best.converged, out.iterations = best.iterations;
  if (!best.converged) out.message = options.monitor.stopped() ? "interrupted" : best.message;
  report(best, problem.layout, last, out);
  out.drops = problem.replay(best);
  out.rms = rms_of(out.drops);
  compare_with_noise(out);
  return out;
}

Calibration validate(const Scene& scene, const SeaParameters<double>& sea, const std::vector<LoggedDrop>& drops,
                     const CalibrationOptions& options) {
  check_drops(scene, drops);
  Calibration out{.scene = scene};
  out.noise = noise_of(drops);
  out.converged = true;
  for (std::size_t m = 0; m < drops.size(); ++m) {
    const std::vector<LoggedDrop> one = {drops[m]};
    const Problem problem(scene, sea, one, {options.nuisance, {}}, options);
    LeastSquaresSolution s;
    s.locals.resize(1, 0);
    if (!options.nuisance.empty()) {
      const LeastSquaresProblem p = problem.problem(scene, out.noise, CalibrationOptions::kInfinity);
      s = identify::solve(p, {.max_iterations = options.max_iterations});
      const double variance = s.cost / double(std::max(1l, s.residuals - s.free_parameters));
      for (long g = 0; s.usable && g < s.globals.size(); ++g) {
        Estimate e{.name = p.globals[std::size_t(g)].name,
                   .unit = p.globals[std::size_t(g)].unit,
                   .value = s.globals[g],
                   .std = {},
                   .at_bound = s.at_bound[std::size_t(g)],
                   .trial = int(m)};
        identify::set_error(e, s.global_covariance(g, g) * variance, out.half_width);
        out.nuisance.push_back(e);
      }
      if (!s.usable || !s.converged) out.converged = false, out.message = drops[m].log.file + ": " + s.message;
    }
    out.drops.push_back(s.usable || options.nuisance.empty() ? problem.replay(s)[0]
                                                             : DropResult{.file = drops[m].log.file});
    if (!out.drops.back().simulated)
      out.converged = false, out.message = drops[m].log.file + ": the drop cannot be followed with these constants";
  }
  out.rms = rms_of(out.drops);
  compare_with_noise(out);
  return out;
}

}  // namespace ukemi::tools
