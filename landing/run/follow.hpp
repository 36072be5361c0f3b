// One landing from event to event: the loop that every method and every kernel shares. Included by what compiles
// kernels (kernels.hpp, methods.cpp), by no other.
#pragma once

#include <cmath>
#include <type_traits>

#include "landing/run/peak_tracker.hpp"
#include "landing/run/recorder.hpp"
#include "landing/model/release.hpp"
#include "landing/run/rest.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

/// True where the motor turns faster or pulls harder than the limits allow.
template <class System>
bool exceeds(const System& system, const Limits& limits, double t, const typename System::State& y) {
  return std::abs(y[kOmegaM]) > limits.motor_speed ||
         std::abs(system.motor_torque_of(system.sea_state(y), system.reference(t))) > limits.motor_torque;
}

/// Follows one landing with `Method` and the kernel of `kTerms`; with kReport, everything that a report needs.
template <class Method, LandingTerms kTerms, bool kReport>
void follow(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion, const SimulateOptions& options,
            LandingPeak& out, [[maybe_unused]] Landing* landing, [[maybe_unused]] double rate) {
  using System = LandingSystem<kTerms, kReport>;
  System system(scene, sea, motion);
  [[maybe_unused]] std::conditional_t<kReport, Recorder<System>, NoRecorder> recorder(landing, rate);
  typename System::State y = released(system, scene, scene.drop, motion);
  const double g = system.link.gravity;
  double t = 0, limit = flight_limit(scene);
  PeakTracker peak;
  if constexpr (kReport) recorder.start(system, t, y);

  // 1) The first flight in closed form, peak g.
  const bool ballistic = is_ballistic(scene);
  if (ballistic) {
    const double fall = fall_time(scene);
    t = std::min(fall, limit);
    peak.consider(g * g, 0);
    if constexpr (kReport) recorder.ballistic(system, scene.drop, y, t);
    fly(system, scene, t, y);
    if (t < fall) {
      if constexpr (kReport) recorder.row(system, t, y), recorder.finish();
      out.t_end = t, out.end = End::kNoContact, out.peak = g, out.t_peak = 0,
      out.state = y.template head<kMechanical>();
      return;
    }
  }

  // 2), 3) From event to event.
  integrate::Integrator<Method, System> integrator(system, t, y,
                                                   {.accuracy = options.accuracy,
                                                    .first_step = std::min(options.max_step, ballistic ? 1e-3 : 1e-2),
                                                    .max_step = options.max_step});
  const double impact = impact_energy(system);
  double motion_end = std::numeric_limits<double>::infinity();
  bool touched = false;
  for (long n = 0;; ++n) {
    // A motion is never passed over in a few steps, however short it is.
    if (system.phase == Phase::kMoving) integrator.limit_next_step(0.125 * motion.duration);
    const integrate::Outcome outcome = integrator.step(std::min(limit, motion_end));
    t = integrator.time();
    out.status = outcome.status;
    if (outcome.status > integrate::Status::kEvent || n >= options.max_steps) {
      out.end = End::kFailed;
      out.failure = n >= options.max_steps ? Failure::kSteps : Failure::kIntegration;
      break;
    }
    if (!outcome.immediate && integrator.step().h > 0) {
      const double before = peak.square;
      if (!peak.step(system, integrator)) {
        out.end = End::kFailed, out.failure = Failure::kUnresolved;
        break;
      }
      if (peak.square != before) out.peak_contact = out.contacts.size() - 1;
      if (options.limits.rated() && exceeds(system, options.limits, t, integrator.state())) {
        out.end = End::kBroken;
        break;
      }
      if constexpr (kReport) recorder.step(system, integrator);
    }
    if (peak.square > options.abandon_above * options.abandon_above) {
      out.end = End::kAbandoned;
      break;
    }
    if (options.stopped(n)) {
      out.end = End::kStopped;
      break;
    }
    if (outcome.event >= 0) {
      if constexpr (kReport) recorder.row(system, t, integrator.state());
      const bool touchdown = outcome.event < kPoints && system.contact[outcome.event] == Contact::kClear;
      if (touchdown && options.limits.forbidden[outcome.event]) {
        out.end = End::kBroken;
        break;
      }
      if (touchdown && options.touchdowns) options.touchdowns->push_back(t);
      if (outcome.event < kPoints)
        touchdown ? out.contacts.touchdown(Point(outcome.event), t) : out.contacts.liftoff(Point(outcome.event), t);
      if (touchdown && !touched) {
        touched = true;
        system.motion_start = t;
        const bool moves = motion.phi_i != motion.phi_f;
        system.phase = moves ? Phase::kMoving : Phase::kAfter;
        if (moves) motion_end = t + motion.duration;
        if (!scene.t_end) limit = t + Scene::kFollow;
      }
      system.cross(outcome.event);
      integrator.refresh();
      peak.jump();
      if constexpr (kReport) recorder.jump();
      if constexpr (kReport) {
        if (touchdown)
          recorder.touchdown(Point(outcome.event), t);
        else if (outcome.event < kPoints)
          recorder.liftoff(Point(outcome.event), t);
        recorder.row(system, t, integrator.state());
      }
      continue;
    }
    if (outcome.status == integrate::Status::kReached) {
      if (t >= motion_end - 1e-14) {
        system.phase = Phase::kAfter;
        motion_end = std::numeric_limits<double>::infinity();
      }
      if (t >= limit - 1e-14) {
        out.end = touched ? End::kTimeLimit : End::kNoContact;
        break;
      }
    }
    if (options.rest == SimulateOptions::Rest::kStop && at_rest(system, integrator.state(), peak.square, impact)) {
      out.end = End::kRest;
      break;
    }
  }
  if constexpr (kReport) recorder.finish();
  out.t_end = t;
  out.peak = std::sqrt(peak.square), out.t_peak = peak.t;
  out.state = integrator.state().template head<kMechanical>();
  out.work = integrator.counters();
}

}  // namespace ukemi::landing
