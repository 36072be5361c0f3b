// One trial from stretch to stretch: exactly where the rig is linear (linear_modes.hpp), integrated where it is not;
// from event to event (rig_events.hpp) where friction sticks or a limit is met, with exact derivatives through them.
// Included by the files that compile kernels (kernels.hpp, rollout_methods.cpp), by no other.
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

/// One trial with `Method` and the kernel of `kTerms`, see `rollout`. With kIntegrated nothing else is compiled.
template <class Method, SeaTerms kTerms, class T, RolloutOptions::Linear kLinear = RolloutOptions::Linear::kExact>
class Roll {
  static constexpr bool kExact = kLinear == RolloutOptions::Linear::kExact;
  using System = OneLinkSystem<kTerms, T>;
  using State = typename System::State;
  using Driver = integrate::Integrator<Method, System>;
  using Modes = LinearModes<kTerms, T>;
  using Status = integrate::Status;

 public:
  Roll(const Rig& rig, const SeaParameters<T>& sea, const Nuisance<T>& nuisance, const PreparedTrial& trial,
       const RolloutOptions& options, std::vector<T>& phi, std::vector<T>& phi_m, std::vector<T>* torque)
      : system_(driven_by(rig.drive, sea), rig),
        input_(rig.drive, sea, nuisance, trial),
        trial_(trial),
        t_(trial.trial->t),
        options_(options),
        bounds_{trial.phi_start, options.escape},
        most_steps_(options.max_steps + 2 * long(trial.stretches.size()) + steps_of_lag(sea)),
        driver_(system_, t_[0], start(rig, nuisance),
                {.accuracy = options.accuracy,
                 .first_step = std::min(1e-3, options.max_step),
                 .max_step = options.max_step}),
        events_(system_, driver_),
        recorder_(system_, nuisance, *trial.trial, phi, phi_m, torque) {
    if (!rig.drive.by_command() && std::isfinite(rig.drive.limit)) system_.command_limit = sea.k_t * T(rig.drive.limit);
    if constexpr (kTerms.extended)
      system_.lossy = present(sea.spring_loss), system_.mode.rubs[kMotorSide] = system_.lossy || present(sea.friction),
      system_.mode.rubs[kOutputSide] = present(sea.output_friction),
      system_.stribeck = system_.mode.rubbing() && present(sea.breakaway);
    if constexpr (kExact)
      if (options.linear == RolloutOptions::Linear::kExact && t_.size() > 1 && !bends(rig))
        modes_.emplace(system_, trial.spacing, value_of(input_.delay()));
    if constexpr (kTerms.late) {
      State y = driver_.state();
      if (!trial.stretches.empty()) system_.input = input_.driving(trial.stretches.front().input);
      system_.steady(t_[0], y);
      driver_.refresh(y);
    }
  }

  RolloutStatus run() {
    recorder_.begin(driver_.state());
    pace_from_ = t_[0];
    RolloutStatus status = RolloutStatus::kDone;
    for (const PreparedTrial::Stretch& stretch : input_.stretches()) {
      events_.change_input(input_.driving(stretch.input), stretch.jumps, input_.delay());
      arrived_ = false;
      while (!arrived_ && status == RolloutStatus::kDone)
        status = is_linear() ? flow(stretch.t_end) : integrate(stretch.t_end);
      if (status != RolloutStatus::kDone) break;
    }
    recorder_.finish();
    if (options_.work) {
      *options_.work = driver_.counters();
      options_.work->events += met_;
    }
    return status;
  }

 private:
  /// Takes work from the budget; false where it is spent.
  bool afford(double work) const {
    if (!options_.budget) return true;
    options_.budget->left -= work;
    return options_.budget->left > -options_.budget->overdraft;
  }
  /// Whether the rig is nonlinear in each of its modes.
  bool bends(const Rig& rig) const {
    return kTerms.extended &&
           (present(system_.sea.k_sea_cubic) || system_.stribeck || system_.lossy || rig.gravity.moment != 0);
  }
  bool is_linear() const { return kExact && modes_ && system_.mode.saturation == 0 && !system_.input.pushed; }
  State start(const Rig& rig, const Nuisance<T>& nuisance) const {
    State y = State::Constant(T(trial_.phi_start) + nuisance.angle);
    y[System::kOmega] = nuisance.rate, y[System::kOmegaM] = T(0);
    if constexpr (kTerms.extended)
      if (rig.gravity.moment != 0) hang(system_, rig.drive, trial_.phi_start, nuisance.angle, y);
    return y;
  }
  /// What the poles of a drive that is late take of an explicit method, however soft the rest.
  long steps_of_lag([[maybe_unused]] const SeaParameters<T>& sea) const {
    if constexpr (kTerms.late) return long(DriveLag<T>(sea).fastest() * (t_.back() - t_.front()));
    return 0;
  }

  // --- integrated ---

  /// To the end of the stretch, or to where the rig becomes linear.
  RolloutStatus integrate(double t_end) {
    for (;;) {
      const integrate::Outcome outcome = driver_.step(t_end);
      if (outcome.status > Status::kEvent || ++steps_ > most_steps_ || !afford(1) || !keeps_pace())
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
        arrived_ = true;
        return RolloutStatus::kDone;
      }
    }
  }
  /// Constants too stiff for an explicit method show early: at the pace of the last steps the rest would take too many.
  bool keeps_pace() {
    constexpr long kPace = 200;
    if (steps_ % kPace != 0) return true;
    const double t = driver_.time();
    if (double(kPace) * (t_.back() - t) > double(most_steps_) * (t - pace_from_)) return false;
    pace_from_ = t;
    return true;
  }

  // --- exact ---

  static constexpr double kStiff = 300;  ///< rate x interval beyond which the looks between samples cost too much

  /// To the end of the stretch, or to where a limit is met: a block of intervals at once about a held reference, else
  /// from interval to interval. A side that is stuck does not move at all: its rows of the flow are zero.
  RolloutStatus flow(double t_end) {
    if constexpr (kExact) {
      typename Modes::Mode& mode = modes_->mode();
      if (modes_->slides() && !(mode.flow.rate() * trial_.spacing < kStiff)) return RolloutStatus::kDiverged;
      double t = driver_.time();
      const typename Modes::Frame frame = modes_->enter(t);
      State rest = State::Zero();
      rest[System::kPhi] = rest[System::kPhiM] = frame.angle;
      State z = driver_.state() - rest;
      while (t < t_end) {
        const int n = frame.held ? clear_samples(mode, z, t, t_end) : 0;
        const std::optional<RolloutStatus> ended =
            n > 0 ? flow_block(mode, rest, n, t, z) : flow_interval(mode, frame, rest, t_end, t, z);
        if (ended) return *ended;
      }
      driver_.restart(t, z + rest);
    }
    arrived_ = true;
    return RolloutStatus::kDone;
  }
  /// How many samples can be read off one state.
  int clear_samples(const typename Modes::Mode& mode, const State& z, double t, double t_end) const {
    return modes_->clear_intervals(mode, z,
                                   recorder_.on_grid(t, t_end, trial_.spacing, Modes::kOffGrid, Modes::Flow::kBlock));
  }
  /// n samples on, or how the trial ends there.
  std::optional<RolloutStatus> flow_block(const typename Modes::Mode& mode, const State& rest, int n, double& t,
                                          State& z) {
    const RolloutStatus status = recorder_.record_block(mode.flow, rest[System::kPhi], z, n, bounds_);
    if (status != RolloutStatus::kDone) return status;
    t = recorder_.last_time();
    z = mode.flow.after(n, z);
    if (recorder_.has_torque()) recorder_.record_last_torque(z + rest);
    return std::nullopt;
  }
  /// To the next sample, an interval at most; or how the flow ends before it, where a limit is met.
  std::optional<RolloutStatus> flow_interval(typename Modes::Mode& mode, const typename Modes::Frame& f,
                                             const State& rest, double t_end, double& t, State& z) {
    const typename Modes::Flow& flow = mode.flow;
    const bool to_sample = recorder_.due(t_end);
    const double next = to_sample ? recorder_.time() : t_end, left = next - t, d = std::min(left, trial_.spacing);
    const auto* leap = f.held ? nullptr : modes_->leap_over(mode, d);
    const bool clear = f.held ? modes_->below_limit(mode, values_of(z)) : modes_->unlimited();
    if (!(leap && clear) && !afford(f.held ? flow.work(d) : 1 + flow.rate() * d)) return RolloutStatus::kDiverged;
    const State drive = f.drive(t);
    const auto after = [&](double h) { return f.held ? flow.advance(z, h) : flow.advance(z, drive, f.b1, h); };
    const State end = leap ? leap->after(z, drive, f.b1) : after(d);
    if (!clear) {
      const auto met = modes_->meeting(mode, values_of(z), t, d, values_of(end));
      if (met.guard >= 0) {
        driver_.restart(t + met.s * d, after(met.s * d) + rest);
        ++met_;
        return events_.cross(met.guard) ? RolloutStatus::kDone : RolloutStatus::kDiverged;
      }
    }
    z = end;
    t = d == left ? next : t + d;
    if (d < left || !to_sample) return std::nullopt;
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
  std::optional<Modes> modes_;  ///< where the rig has linear modes, and they are wanted
  bool arrived_ = false;        ///< at the end of the stretch
  long steps_ = 0, met_ = 0;    ///< integrated; limits met where the rig was linear
  double pace_from_ = 0;        ///< time at the last look at the pace [s]
};

}  // namespace ukemi::identify
