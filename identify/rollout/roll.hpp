// Rollout of one trial, segment by segment: exact where the rig is linear (linear_modes.hpp), else integrated; from
// event to event (rig_events.hpp) where friction sticks or a limit is met, with exact derivatives through them.
// Included only by the files that compile kernels (kernels.hpp, rollout_methods.cpp).
#pragma once

#include <cmath>
#include <optional>

#include "identify/rollout/hang.hpp"
#include "identify/rollout/linear_modes.hpp"
#include "identify/rollout/recorder.hpp"
#include "identify/rollout/rig_events.hpp"
#include "identify/rollout/rig_input.hpp"
#include "identify/rollout/rollout.hpp"

namespace ukemi::identify {

/// One trial with `Method` and the kernel of `kTerms`, see `rollout`. kIntegrated compiles no linear modes.
template <class Method, SeaTerms kTerms, class T, RolloutOptions::Linear kLinear = RolloutOptions::Linear::kExact>
class TrialRollout {
  static constexpr bool kExact = kLinear == RolloutOptions::Linear::kExact;
  using System = OneLinkSystem<kTerms, T>;
  using State = typename System::State;
  using Driver = integrate::Integrator<Method, System>;
  using Modes = LinearModes<kTerms, T>;
  using Status = integrate::Status;

 public:
  TrialRollout(const Rig& rig, const SeaParameters<T>& sea, const Nuisance<T>& nuisance, const PreparedTrial& trial,
               const RolloutOptions& options, std::vector<T>& phi, std::vector<T>& phi_m, std::vector<T>* torque)
      : system_(with_drive_gains(rig.drive, sea), rig),
        input_(rig.drive, sea, nuisance, trial),
        trial_(trial),
        t_(trial.trial->t),
        options_(options),
        bounds_{trial.phi_start, options.escape},
        most_steps_(options.max_steps + 2 * long(trial.segments.size()) + lag_steps(sea)),
        driver_(system_, t_[0], start(rig, nuisance),
                {.accuracy = options.accuracy,
                 .first_step = std::min(1e-3, options.max_step),
                 .max_step = options.max_step}),
        events_(system_, driver_),
        recorder_(system_, nuisance, *trial.trial, phi, phi_m, torque) {
    if (const Drive& d = rig.drive; !d.known_command() && std::isfinite(d.limit))
      system_.command_limit = sea.k_t * T(d.limit);
    if constexpr (kTerms.extended)
      system_.lossy = present(sea.spring_loss), system_.mode.rubs[kMotorSide] = system_.lossy || present(sea.friction),
      system_.mode.rubs[kOutputSide] = present(sea.output_friction),
      system_.stribeck = system_.mode.rubbing() && present(sea.breakaway);
    if constexpr (kExact)
      if (options.linear == RolloutOptions::Linear::kExact && t_.size() > 1 && !is_nonlinear(rig))
        modes_.emplace(system_, trial.spacing, value_of(input_.delay()));
    if constexpr (kTerms.late) {
      State y = driver_.state();
      if (!trial.segments.empty()) system_.input = input_.driving(trial.segments.front().input);
      system_.steady(t_[0], y);
      driver_.refresh(y);
    }
  }

  RolloutStatus run() {
    recorder_.begin(driver_.state());
    pace_start_ = t_[0];
    RolloutStatus status = RolloutStatus::kDone;
    for (const PreparedTrial::Segment& segment : input_.segments()) {
      events_.change_input(input_.driving(segment.input), segment.jumps, input_.delay());
      segment_done_ = false;
      while (!segment_done_ && status == RolloutStatus::kDone)
        status = is_linear() ? flow(segment.t_end) : integrate(segment.t_end);
      if (status != RolloutStatus::kDone) break;
    }
    recorder_.finish();
    if (options_.work) {
      *options_.work = driver_.counters();
      options_.work->events += crossings_;
    }
    return status;
  }

 private:
  /// Takes `work` from the budget; false where the budget is exhausted.
  bool spend(double work) const {
    if (!options_.budget) return true;
    options_.budget->left -= work;
    return options_.budget->left > -options_.budget->overdraft;
  }
  /// Whether the rig is nonlinear in each of its modes.
  bool is_nonlinear(const Rig& rig) const {
    return kTerms.extended &&
           (present(system_.sea.k_sea_cubic) || system_.stribeck || system_.lossy || rig.gravity.moment != 0);
  }
  bool is_linear() const { return kExact && modes_ && system_.mode.saturation == 0 && !system_.input.has_force; }
  State start(const Rig& rig, const Nuisance<T>& nuisance) const {
    State y = State::Constant(T(trial_.phi_start) + nuisance.angle);
    y[System::kOmega] = nuisance.rate, y[System::kOmegaM] = T(0);
    if constexpr (kTerms.extended)
      if (rig.gravity.moment != 0) set_hanging_equilibrium(system_, rig.drive, trial_.phi_start, nuisance.angle, y);
    return y;
  }
  /// Additional steps of an explicit method for the poles of a late drive.
  long lag_steps([[maybe_unused]] const SeaParameters<T>& sea) const {
    if constexpr (kTerms.late) return long(DriveLag<T>(sea).fastest_pole() * (t_.back() - t_.front()));
    return 0;
  }

  // --- integrated ---

  /// Integrates to the end of the segment, or to where the rig becomes linear.
  RolloutStatus integrate(double t_end) {
    for (;;) {
      const integrate::Outcome outcome = driver_.step(t_end);
      if (outcome.status > Status::kEvent || ++steps_ > most_steps_ || !spend(1) || !keeps_pace())
        return RolloutStatus::kDiverged;
      const bool reached = outcome.status == Status::kReached;
      recorder_.record_step(driver_, t_end, reached);
      const State& y = driver_.state();
      if constexpr (kTerms.extended)
        if (gives_way(value_of(system_.sea.k_sea), value_of(system_.sea.k_sea_cubic),
                      value_of(y[System::kPhiM]) - value_of(y[System::kPhi])))
          return RolloutStatus::kEscaped;
      const RolloutStatus status = bounds_.status(value_of(y[System::kPhi]));
      if (status != RolloutStatus::kDone) return status;
      if (outcome.event >= 0) {
        if (!events_.cross(outcome.event)) return RolloutStatus::kDiverged;
        if (is_linear()) return RolloutStatus::kDone;
      }
      if (reached) {
        segment_done_ = true;
        return RolloutStatus::kDone;
      }
    }
  }
  /// False where, at the pace of the last steps, the rest would take too many: too stiff for an explicit method.
  bool keeps_pace() {
    constexpr long kPace = 200;
    if (steps_ % kPace != 0) return true;
    const double t = driver_.time();
    if (double(kPace) * (t_.back() - t) > double(most_steps_) * (t - pace_start_)) return false;
    pace_start_ = t;
    return true;
  }

  // --- exact ---

  static constexpr double kStiff = 300;  ///< rate bound x interval beyond which the guard checks cost too much

  /// Solves exactly to the end of the segment, or to where a guard is met: a block of intervals at once about a held
  /// reference, else interval by interval. A stuck side does not move: its rows of the flow are zero.
  RolloutStatus flow(double t_end) {
    if constexpr (kExact) {
      typename Modes::Mode& mode = modes_->mode();
      if (modes_->has_events() && !(mode.flow.rate_bound() * trial_.spacing < kStiff)) return RolloutStatus::kDiverged;
      double t = driver_.time();
      const typename Modes::Frame frame = modes_->enter_frame(t);
      State rest = State::Zero();
      rest[System::kPhi] = rest[System::kPhiM] = frame.angle;
      State z = driver_.state() - rest;
      while (t < t_end) {
        const int n = frame.is_rest ? clear_samples(mode, z, t, t_end) : 0;
        const std::optional<RolloutStatus> status =
            n > 0 ? flow_block(mode, rest, n, t, z) : flow_interval(mode, frame, rest, t_end, t, z);
        if (status) return *status;
      }
      driver_.restart(t, z + rest);
    }
    segment_done_ = true;
    return RolloutStatus::kDone;
  }
  /// How many of the next samples can be computed from the state z.
  int clear_samples(const typename Modes::Mode& mode, const State& z, double t, double t_end) const {
    return modes_->clear_intervals(mode, z,
                                   recorder_.on_grid(t, t_end, trial_.spacing, Modes::kOffGrid, Modes::Flow::kBlock));
  }
  /// Advances by n samples; the status if the trial ends there.
  std::optional<RolloutStatus> flow_block(const typename Modes::Mode& mode, const State& rest, int n, double& t,
                                          State& z) {
    const RolloutStatus status = recorder_.record_block(mode.flow, rest[System::kPhi], z, n, bounds_);
    if (status != RolloutStatus::kDone) return status;
    t = recorder_.last_time();
    z = mode.flow.after(n, z);
    if (recorder_.has_torque()) recorder_.record_last_torque(z + rest);
    return std::nullopt;
  }
  /// Advances to the next sample, by an interval at most; the status if a guard or the end of the trial comes first.
  std::optional<RolloutStatus> flow_interval(typename Modes::Mode& mode, const typename Modes::Frame& f,
                                             const State& rest, double t_end, double& t, State& z) {
    const typename Modes::Flow& flow = mode.flow;
    const bool is_sample = recorder_.due(t_end);
    const double next = is_sample ? recorder_.time() : t_end, left = next - t, d = std::min(left, trial_.spacing);
    const auto* propagator = f.is_rest ? nullptr : modes_->cached_propagator(mode, d);
    const bool clear = f.is_rest ? modes_->below_limit(mode, values_of(z)) : modes_->is_event_free();
    if (!(propagator && clear) && !spend(f.is_rest ? flow.cost(d) : 1 + flow.rate_bound() * d))
      return RolloutStatus::kDiverged;
    const State drive = f.drive(t);
    const auto after = [&](double h) { return f.is_rest ? flow.advance(z, h) : flow.advance(z, drive, f.b1, h); };
    const State end = propagator ? propagator->after(z, drive, f.b1) : after(d);
    if (!clear) {
      const auto crossing = modes_->first_crossing(mode, values_of(z), t, d, values_of(end));
      if (crossing.guard >= 0) {
        driver_.restart(t + crossing.s * d, after(crossing.s * d) + rest);
        ++crossings_;
        return events_.cross(crossing.guard) ? RolloutStatus::kDone : RolloutStatus::kDiverged;
      }
    }
    z = end;
    t = d == left ? next : t + d;
    if (d < left || !is_sample) return std::nullopt;
    recorder_.record(z + rest);
    const RolloutStatus status = bounds_.status(value_of(z[System::kPhi] + f.angle));
    return status == RolloutStatus::kDone ? std::nullopt : std::optional(status);
  }

  System system_;
  const RigInput<T> input_;
  const PreparedTrial& trial_;
  const std::vector<double>& t_;
  const RolloutOptions& options_;
  const EscapeBounds bounds_;
  const long most_steps_;
  Driver driver_;
  RigEvents<System, Driver, kTerms, T> events_;
  Recorder<System, T> recorder_;
  std::optional<Modes> modes_;      ///< where the rig has linear modes, and the options use them
  bool segment_done_ = false;       ///< the end of the segment is reached
  long steps_ = 0, crossings_ = 0;  ///< integrated steps; guards met in linear modes
  double pace_start_ = 0;           ///< time of the last check of the pace [s]
};

}  // namespace ukemi::identify
