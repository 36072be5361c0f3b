// One landing from event to event: the loop of all methods and kernels. Included only by kernels.hpp and methods.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "landing/run/peak_tracker.hpp"
#include "landing/run/recorder.hpp"
#include "landing/run/rest.hpp"
#include "landing/run/schedule.hpp"

namespace ukemi::landing {

/// Whether the state at t breaks the limits.
template <class System>
bool breaks_limits(const System& system, const Limits& limits, double t, const typename System::State& y) {
  const SeaState<double> s = system.sea_state(y);
  return limits.broken_by(s, system.motor_torque_of(t, y));
}

/// Simulates one landing with `Method` and the kernel of `kTerms`; with kReport records everything that a report needs.
template <class Method, LandingTerms kTerms, bool kReport>
class Follower {
  using System = LandingSystem<kTerms, kReport>;
  using State = typename System::State;
  using Integrator = integrate::Integrator<Method, System>;

 public:
  Follower(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion, const SimulateOptions& options,
           LandingPeak& out, Landing* landing, double rate)
      : scene_(scene),
        motion_(motion),
        options_(options),
        out_(out),
        system_(scene, sea, motion),
        schedule_(scene, motion, moves(motion)),
        recorder_(landing, rate) {}

  void follow() {
    State y = released(system_, scene_, scene_.drop, motion_);
    if constexpr (kReport) recorder_.start(system_, 0, y);
    if (schedule_.ballistic()) fly_ballistic(y);
    t_ = schedule_.start();
    if (schedule_.ends_in_flight()) {
      if constexpr (kReport) recorder_.row(system_, t_, y);
      return finish(End::kNoContact, y);
    }
    Integrator integrator(system_, t_, y,
                          {.accuracy = step_accuracy(options_.accuracy, system_.sea),
                           .first_step = std::min(options_.max_step, schedule_.first_step()),
                           .max_step = options_.max_step});
    system_.change(schedule_.initial_change(system_), motion_, t_);
    system_.settle(t_, y);
    impact_energy_ = impact_energy(system_);
    std::optional<End> end;
    for (long n = 0; !end; ++n) end = advance(integrator, n);
    out_.work = integrator.counters();
    finish(*end, integrator.state());
  }

 private:
  /// The first flight in closed form; its peak is g.
  void fly_ballistic(State& y) {
    const double g = system_.link.gravity, until = schedule_.start();
    peak_.consider(g * g, 0);
    if constexpr (kReport) recorder_.ballistic(system_, scene_.drop, y, until);
    fly(system_, scene_, until, y);
  }

  /// Takes a step and handles its event or deadline. Returns how the run ended, if it did.
  std::optional<End> advance(Integrator& integrator, long n) {
    if (system_.phase == Phase::kMoving) integrator.limit_next_step(schedule_.motion_max_step());
    const integrate::Outcome outcome = integrator.step(schedule_.stop());
    t_ = integrator.time();
    out_.status = outcome.status;
    if (n >= options_.max_steps) return fail(Failure::kSteps);
    if (outcome.status > integrate::Status::kEvent) return fail(Failure::kIntegration);
    if (!outcome.immediate && integrator.step().h > 0)
      if (const auto end = check_step(integrator)) return end;
    if (peak_.square > options_.abandon_above * options_.abandon_above) return End::kAbandoned;
    if (options_.stopped(n)) return End::kStopped;
    if (outcome.event >= 0) return cross(integrator, outcome.event);
    if (outcome.status == integrate::Status::kReached) {
      const Schedule::Deadline deadline = schedule_.reached(t_, system_);
      if (deadline.end) return deadline.end;
      if (!change(integrator, deadline.change)) return End::kBroken;
    }
    const bool may_rest = options_.rest == SimulateOptions::Rest::kStop;
    if (may_rest && at_rest(system_, integrator.state(), peak_.square, impact_energy_)) return End::kRest;
    return std::nullopt;
  }

  /// Tracks the peak and checks the limits in the last step.
  std::optional<End> check_step(Integrator& integrator) {
    const double before = peak_.square;
    if (!peak_.step(system_, integrator)) return fail(Failure::kUnresolved);
    if constexpr (kTerms.sea.extended) {
      const SeaState<double> s = system_.sea_state(integrator.state());
      if (gives_way(system_.sea.k_sea, system_.sea.k_sea_cubic, s.phi_m - s.phi)) return fail(Failure::kGivesWay);
    }
    if (peak_.square != before) out_.peak_contact = out_.contacts.size() - 1;
    const State& y = integrator.state();
    out_.joint_lost = out_.joint_lost || std::abs(y[kTheta1] - y[kTheta0]) > kLostJoint;
    if (options_.limits.within_steps() && breaks_limits(system_, options_.limits, t_, y)) return End::kBroken;
    if constexpr (kReport) recorder_.step(system_, integrator);
    return std::nullopt;
  }

  /// Changes the reference at a deadline; the field jumps if the landing motion starts. False if that breaks a limit.
  bool change(Integrator& integrator, ReferenceChange to) {
    if (to == ReferenceChange::kNone) return true;
    if (to == ReferenceChange::kLand && options_.limits.broken_by(motion_, t_)) return false;
    system_.change(to, motion_, t_);
    if (to == ReferenceChange::kHoldFinal) return true;
    settle(integrator, -1);
    peak_.jump();
    if constexpr (kReport) recorder_.jump();
    return true;
  }

  std::optional<End> cross(Integrator& integrator, int event) {
    if constexpr (kReport) recorder_.row(system_, t_, integrator.state());
    const Schedule::Crossing crossing = schedule_.cross(event, t_, system_, options_.limits, out_.contacts);
    if (crossing.forbidden) return End::kBroken;
    if (crossing.change == ReferenceChange::kLand && options_.limits.broken_by(motion_, t_)) return End::kBroken;
    if (crossing.touchdown && options_.touchdowns) options_.touchdowns->push_back(t_);
    system_.change(crossing.change, motion_, t_);
    settle(integrator, event);
    peak_.jump();
    if constexpr (kReport) {
      recorder_.jump();
      if (crossing.touchdown) recorder_.touchdown(Point(event), t_);
      if (crossing.liftoff) recorder_.liftoff(Point(event), t_);
      recorder_.row(system_, t_, integrator.state());
    }
    return std::nullopt;
  }

  /// Settles friction and restarts the integrator after guard `event`, or (-1) after a deadline.
  void settle(Integrator& integrator, int event) {
    State y = integrator.state();
    system_.settle(event, t_, y);
    integrator.refresh(y);
  }

  End fail(Failure why) {
    out_.failure = why;
    return End::kFailed;
  }

  void finish(End end, const State& y) {
    if constexpr (kReport) recorder_.finish();
    out_.end = end, out_.t_end = t_;
    out_.peak = std::sqrt(peak_.square), out_.t_peak = peak_.t;
    std::copy_n(y.data(), kMechanical, out_.state.begin());
  }

  const Scene& scene_;
  const Motion& motion_;
  const SimulateOptions& options_;
  LandingPeak& out_;
  System system_;
  Schedule schedule_;
  std::conditional_t<kReport, Recorder<System>, NoRecorder> recorder_;
  PeakTracker peak_;
  double t_ = 0, impact_energy_ = 0;  ///< see impact_energy
};

}  // namespace ukemi::landing
