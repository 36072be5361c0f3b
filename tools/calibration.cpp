#include "tools/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "common/random.hpp"
#include "identify/least_squares.hpp"
#include "identify/trial.hpp"
#include "landing/release.hpp"

namespace ukemi::tools {

using namespace landing;
using identify::Estimate, identify::LeastSquaresProblem, identify::LeastSquaresSolution, identify::ResidualBlock;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
using PerOutput = std::array<double, kOutputs>;

bool is_constant(Term t) { return int(t) < kCalibrated; }
bool holds(const std::vector<Term>& list, Term t) { return std::find(list.begin(), list.end(), t) != list.end(); }
/// Size of a nuisance term, for scaling.
constexpr std::array<double, kTerms> kTypical = {0, 0, 0, 0, 1e-3, 0.01, 0.05, 0.02};

/// Where a term's derivative stands in a DropSample; -1: it is the rate.
int slot_of(Term t) {
  constexpr std::array<Parameter, kTerms> kOf = {
      Parameter::kStiffness, Parameter::kDampingNormal, Parameter::kDampingTangential, Parameter::kPitch,
      Parameter::kPitch,     Parameter::kHeight,        Parameter::kForwardSpeed,      Parameter::kPitch};
  return t == Term::kTimeShift ? -1 : drop_slot(kOf[std::size_t(t)]);
}

/// Where a term's value stands in a scene; none for the time shift.
double& number_of(Scene& s, Term t) {
  switch (t) {
    case Term::kStiffness:
      return s.floor->stiffness;
    case Term::kDampingNormal:
      return s.floor->damping_normal;
    case Term::kDampingTangential:
      return s.floor->damping_tangential;
    case Term::kHeightOffset:
      return s.drop.height;
    case Term::kSpeedOffset:
      return s.drop.forward_speed;
    default:
      return s.drop.pitch;
  }
}

/// What is fitted: `shared` by all drops, then `own` of each.
struct Layout {
  std::vector<Term> shared, own;
  bool shifted() const { return holds(shared, Term::kTimeShift) || holds(own, Term::kTimeShift); }
};

double median(std::vector<double> x) {
  std::nth_element(x.begin(), x.begin() + long(x.size() / 2), x.end());
  return x[x.size() / 2];
}

/// One drop as a function of a point of the fit.
class DropModel {
 public:
  DropModel(const Scene& scene, const SeaParameters<double>& sea, const LoggedDrop& drop, const Layout& layout,
            double accuracy)
      : scene_(scene), sea_(sea), drop_(drop), layout_(layout), options_{.accuracy = accuracy} {
    const std::vector<double>& t = drop.log.t;
    if (layout.shifted()) first_ = std::size_t(std::lower_bound(t.begin(), t.end(), kLargestShift) - t.begin());
    for (int o = 0; o < kOutputs; ++o) {
      std::vector<double> gaps;
      double last = kNaN;
      for (std::size_t i = 0; i < drop.log.output[std::size_t(o)].size(); ++i)
        if (std::isfinite(drop.log.output[std::size_t(o)][i])) {
          if (std::isfinite(last)) gaps.push_back(t[i] - last);
          last = t[i];
        }
      if (!gaps.empty()) interval_[std::size_t(o)] = median(gaps);
    }
  }

  const LoggedDrop& drop() const { return drop_; }

  /// Residuals (sim - meas) / sigma up to `seconds` after release, then the priors'. `sigma` is copied.
  ResidualBlock block(const PerOutput& sigma, double seconds, const std::vector<Prior>& priors) const {
    const std::vector<double>& t = drop_.log.t;
    const auto end = std::size_t(std::upper_bound(t.begin(), t.end(), seconds) - t.begin());
    struct Row {
      int output;
      std::size_t sample;
    };
    std::vector<Row> rows;
    for (int o = 0; o < kOutputs; ++o)
      for (std::size_t i = first_; i < std::min(end, drop_.log.output[std::size_t(o)].size()); ++i)
        if (std::isfinite(drop_.log.output[std::size_t(o)][i])) rows.push_back({o, i});
    const auto memory = std::make_shared<Memory>();
    return {int(rows.size() + priors.size()),
            [=, this](const double* shared, const double* own, double* r, double* jacobian) {
              const Rolled* rolled = recall(*memory, shared, own, end);
              if (!rolled) return false;
              const std::size_t size = rows.size() + priors.size();
              std::size_t row = 0;
              const auto fill = [&](double residual, const auto& of_term) {
                double* to = jacobian ? jacobian + row : nullptr;
                for (const auto* list : {&layout_.shared, &layout_.own})
                  for (const Term term : *list)
                    if (to) *to = of_term(term), to += size;
                r[row++] = residual;
              };
              for (const Row& x : rows) {
                const DropSample& s = rolled->rollout.samples[x.sample - first_];
                const double inverse = 1 / sigma[std::size_t(x.output)],
                             difference =
                                 s.value[std::size_t(x.output)] - drop_.log.output[std::size_t(x.output)][x.sample];
                if (left_out(*rolled, DropOutput(x.output), x.sample)) {
                  fill(0, [](Term) { return 0.0; });
                  continue;
                }
                fill(difference * inverse, [&](Term term) {
                  const int slot = slot_of(term);
                  return inverse * (slot < 0 ? s.rate[std::size_t(x.output)] : s.slope[std::size_t(x.output)][slot]);
                });
              }
              for (const Prior& p : priors) {
                double value = 0;
                for (std::size_t k = 0; k < layout_.shared.size(); ++k)
                  if (layout_.shared[k] == p.term) value = shared[k];
                for (std::size_t k = 0; k < layout_.own.size(); ++k)
                  if (layout_.own[k] == p.term) value = own[k];
                fill((value - p.value) / p.std, [&](Term term) { return term == p.term ? 1 / p.std : 0; });
              }
              return true;
            }};
  }

  /// The whole drop beside its log.
  DropResult replay(const double* shared, const double* own) const {
    DropResult out{.file = drop_.log.file};
    Memory memory;
    const Rolled* rolled = recall(memory, shared, own, drop_.log.t.size());
    out.simulated = rolled != nullptr;
    out.rms.fill(kNaN);
    out.peak_measured = out.peak_simulated = out.peak_between = kNaN;
    if (!rolled) return out;
    for (int o = 0; o < kOutputs; ++o) {
      const auto k = std::size_t(o);
      const std::vector<double>& measured = drop_.log.output[k];
      if (measured.empty()) continue;
      out.value[k].assign(measured.size(), kNaN), out.used[k].assign(measured.size(), false);
      double sum = 0;
      long n = 0;
      for (std::size_t i = first_; i < measured.size(); ++i) {
        if (!std::isfinite(measured[i])) continue;
        out.value[k][i] = rolled->rollout.samples[i - first_].value[k];
        if (left_out(*rolled, DropOutput(o), i)) continue;
        out.used[k][i] = true;
        sum += std::pow(out.value[k][i] - measured[i], 2), ++n;
      }
      if (n > 0) out.rms[k] = std::sqrt(sum / double(n));
    }
    SimulateOptions to_the_end = options_;
    to_the_end.rest = SimulateOptions::Rest::kIgnore;
    Scene scene = rolled->scene;
    scene.t_end = drop_.log.t.back() + rolled->shift;
    out.peak_between = peak_acceleration(scene, sea_, drop_.motion, to_the_end).peak;
    for (std::size_t i = first_; i < drop_.log.t.size(); ++i) {
      const auto& a = drop_.log.output;
      const double measured = !a[kAcc].empty()                         ? a[kAcc][i]
                              : !a[kAccX].empty() && !a[kAccY].empty() ? std::hypot(a[kAccX][i], a[kAccY][i])
                                                                       : kNaN;
      if (!std::isfinite(measured)) continue;
      out.peak_measured = std::fmax(out.peak_measured, measured);
      out.peak_simulated = std::fmax(out.peak_simulated, rolled->rollout.samples[i - first_].value[kAcc]);
    }
    return out;
  }

 private:
  struct Rolled {
    Scene scene;
    DropRollout rollout;
    double shift;
  };
  /// The last point that was asked for: the solver wants the cost and then the Jacobian of the same.
  struct Memory {
    std::vector<double> point;
    Rolled rolled;
    bool complete = false;
  };
  const Rolled* recall(Memory& m, const double* shared, const double* own, std::size_t end) const {
    std::vector<double> point(shared, shared + layout_.shared.size());
    point.insert(point.end(), own, own + layout_.own.size());
    if (point != m.point || m.point.empty()) {
      m.point = point;
      m.complete = roll(shared, own, end, m.rolled);
    }
    return m.complete ? &m.rolled : nullptr;
  }
  bool roll(const double* shared, const double* own, std::size_t end, Rolled& out) const {
    Scene& scene = out.scene = scene_;
    scene.drop = drop_.thrown;
    scene.drop.pitch = scene_.drop.pitch;
    out.shift = 0;
    const auto set = [&](Term t, double value) {
      if (t == Term::kTimeShift)
        out.shift = value;
      else if (is_constant(t))
        number_of(scene, t) = value;
      else
        number_of(scene, t) += value;
    };
    for (std::size_t k = 0; k < layout_.shared.size(); ++k) set(layout_.shared[k], shared[k]);
    for (std::size_t k = 0; k < layout_.own.size(); ++k) set(layout_.own[k], own[k]);
    if (!(scene.drop.height >= 0 && scene.floor->stiffness > 0)) return false;
    std::vector<double> times;
    for (std::size_t i = first_; i < end; ++i) times.push_back(std::max(0.0, drop_.log.t[i] + out.shift));
    out.rollout = roll_drop(scene, sea_, drop_.motion, times, options_);
    return out.rollout.complete;
  }

  /// True within a sampling interval of a jump.
  bool left_out(const Rolled& rolled, DropOutput o, std::size_t i) const {
    if (!landing::jumps(o)) return false;
    const std::vector<double>& jumps = rolled.rollout.jumps;
    const double width = interval_[std::size_t(o)], t = drop_.log.t[i] + rolled.shift;
    const auto next = std::lower_bound(jumps.begin(), jumps.end(), t - width);
    return next != jumps.end() && *next <= t + width;
  }

  const Scene& scene_;
  const SeaParameters<double>& sea_;
  const LoggedDrop& drop_;
  const Layout& layout_;
  SimulateOptions options_;
  std::size_t first_ = 0;  ///< rows before it are left out
  PerOutput interval_{};   ///< an output's sampling interval [s]
};

/// The noise of each output, over all drops; NaN where none measured it.
PerOutput noise_of(const std::vector<LoggedDrop>& drops) {
  PerOutput out;
  for (std::size_t o = 0; o < kOutputs; ++o) {
    double sum = 0, n = 0, largest = 0;
    for (const LoggedDrop& d : drops) {
      std::vector<double> x;
      for (const double v : d.log.output[o])
        if (std::isfinite(v)) x.push_back(v), largest = std::max(largest, std::abs(v));
      sum += double(x.size()) * std::pow(identify::noise_level(x), 2), n += double(x.size());
    }
    constexpr double kFinest = 1e-9;  // of the output: a log without noise still has a weight
    out[o] = n > 0 ? std::max({std::sqrt(sum / n), kFinest * largest, 1e-12}) : kNaN;
  }
  return out;
}

/// The residual of each output over all drops.
PerOutput rms_of(const std::vector<DropResult>& drops) {
  PerOutput out;
  for (std::size_t o = 0; o < kOutputs; ++o) {
    double sum = 0, n = 0;
    for (const DropResult& d : drops)
      for (const bool used : d.used[o])
        if (used) n += 1, sum += d.rms[o] * d.rms[o];
    out[o] = n > 0 ? std::sqrt(sum / n) : kNaN;
  }
  return out;
}

void check(const Scene& scene, const std::vector<LoggedDrop>& drops) {
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
    for (const LoggedDrop& d : drops) models.emplace_back(scene, sea, d, layout, o.accuracy);
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

/// What an interval of a constant is measured against.
double size_of(const Estimate& e, Term t) {
  return t == Term::kPitch ? std::max(std::abs(e.value), kPitchSize) : std::abs(e.value);
}

/// The constants, their errors and what can be said of them.
void report(const LeastSquaresSolution& s, const Layout& layout, const LeastSquaresProblem& problem, Calibration& out) {
  const long dof = s.residuals - s.free_parameters;
  const double variance = dof > 0 ? s.cost / double(dof) : kNaN;
  out.half_width = identify::t_quantile_975(std::max(dof, 1l));
  out.covariance = s.global_covariance * variance;
  out.correlation = identify::correlation_of(out.covariance);
  out.eigenvalues = s.eigenvalues;
  for (const Term t : layout.shared) out.fitted.push_back(kTermNames[std::size_t(t)]);
  for (int k = 0; k < kCalibrated; ++k) {
    const Term t{k};
    Estimate e{.name = kTermNames[std::size_t(k)], .unit = kTermUnits[std::size_t(k)], .std = {}, .free = false};
    e.value = number_of(out.scene, t);
    const auto at = std::find(layout.shared.begin(), layout.shared.end(), t);
    if (at != layout.shared.end()) {
      const long g = at - layout.shared.begin();
      e.free = true, e.at_bound = s.at_bound[std::size_t(g)];
      identify::set_error(e, out.covariance(g, g), out.half_width);
    }
    const Verdict v = e.verdict = identify::judge(e, size_of(e, t));
    out.parameters.push_back(e);
    if (v == Verdict::kAtBound)
      out.warnings.push_back(fmt::format("{} ended at its bound {}: no standard error", e.name, shortest(e.value)));
    if (v == Verdict::kNotIdentifiable && !e.std) out.warnings.push_back(e.name + " is not determined by these drops");
    if (v == Verdict::kNotIdentifiable && e.std)
      out.warnings.push_back(fmt::format("{} is not identifiable: the 95 % interval is {:.3g} {} either way", e.name,
                                         out.half_width * *e.std, e.unit));
  }
  const auto relied_on = [&](const std::string& fitted) {
    const auto e =
        std::find_if(out.parameters.begin(), out.parameters.end(), [&](const Estimate& x) { return x.name == fitted; });
    return e->verdict == Verdict::kTrusted;
  };
  for (std::size_t i = 0; i < out.fitted.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (std::abs(out.correlation(long(i), long(j))) > 0.95 && !(relied_on(out.fitted[i]) && relied_on(out.fitted[j])))
        out.warnings.push_back(fmt::format("{} and {} correlate by {:.3f}: these drops hardly tell them apart",
                                           out.fitted[j], out.fitted[i], out.correlation(long(i), long(j))));
  for (long m = 0; m < s.locals.rows(); ++m)
    for (long l = 0; l < s.locals.cols(); ++l) {
      const identify::Parameter& p = problem.locals[std::size_t(l)];
      Estimate e{.name = p.name, .unit = p.unit, .value = s.locals(m, l), .std = {}, .trial = int(m)};
      e.at_bound = e.value <= p.lower || e.value >= p.upper;
      if (e.at_bound)
        out.warnings.push_back(fmt::format("{} of drop {} ended at its bound {}", e.name, m + 1, shortest(e.value)));
      identify::set_error(e, s.local_variance(m, l) * variance, out.half_width);
      out.nuisance.push_back(e);
    }
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

Calibration calibrate(const Scene& scene, const SeaParameters<double>& sea, const std::vector<LoggedDrop>& drops,
                      const CalibrationOptions& options) {
  options.validate();
  check(scene, drops);
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
  const auto attempt = [&](Scene start) {
    LeastSquaresSolution s;
    for (const double after : kAfter) {
      const int iterations = std::isfinite(after) ? std::min(kRough, options.max_iterations) : options.max_iterations;
      s = identify::solve(problem.problem(start, out.noise, after), {.max_iterations = iterations});
      if (s.usable) start = with(s);
    }
    ++out.starts;
    return s;
  };
  const auto believed = [&](const LeastSquaresSolution& s) {
    return s.usable && s.cost <= identify::kFarAboveNoise * identify::kFarAboveNoise * double(s.residuals);
  };
  LeastSquaresSolution best = attempt(scene);
  for (int i = 0; i < options.restarts && !believed(best); ++i) {
    Random random(options.seed, std::uint64_t(i));
    Scene start = scene;
    for (const Term t : options.free)
      t == Term::kPitch ? number_of(start, t) += random.uniform(-0.2, 0.2) : number_of(start, t) *= random.factor(2);
    LeastSquaresSolution s = attempt(start);
    if (s.usable && (!best.usable || s.cost < best.cost)) best = std::move(s);
  }
  if (!best.usable) {
    out.message = "no start could be followed through the drops: " + best.message;
    for (int k = 0; k < kCalibrated; ++k) {
      out.parameters.push_back({.name = kTermNames[std::size_t(k)],
                                .unit = kTermUnits[std::size_t(k)],
                                .value = number_of(out.scene, Term{k}),
                                .std = {},
                                .free = holds(options.free, Term{k})});
      out.parameters.back().verdict = out.parameters.back().free ? Verdict::kNotIdentifiable : Verdict::kFixed;
    }
    for (const LoggedDrop& d : drops) out.drops.push_back({.file = d.log.file});
    return out;
  }
  // Once more with each output's weight from its own residuals, so that errors and priors are in standard deviations.
  PerOutput sigma = rms_of(problem.replay(best));
  for (std::size_t o = 0; o < kOutputs; ++o) sigma[o] = std::max(sigma[o], 1e-3 * out.noise[o]);
  const LeastSquaresProblem last = problem.problem(with(best), sigma, CalibrationOptions::kInfinity);
  if (LeastSquaresSolution s = identify::solve(last, {.max_iterations = options.max_iterations}); s.usable)
    best = std::move(s);
  out.scene = with(best);
  out.cost = best.cost, out.converged = best.converged, out.iterations = best.iterations;
  if (!best.converged) out.message = best.message;
  report(best, problem.layout, last, out);
  out.drops = problem.replay(best);
  out.rms = rms_of(out.drops);
  compare_with_noise(out);
  return out;
}

Calibration validate(const Scene& scene, const SeaParameters<double>& sea, const std::vector<LoggedDrop>& drops,
                     const CalibrationOptions& options) {
  check(scene, drops);
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
