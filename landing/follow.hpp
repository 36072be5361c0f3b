// One landing from event to event: the loop that every method and every kernel shares. Included by what compiles
// kernels (kernels.hpp, methods.cpp), by no other.
#pragma once

#include <cmath>
#include <type_traits>

#include "landing/peak_tracker.hpp"
#include "landing/recorder.hpp"
#include "landing/rest.hpp"
#include "landing/simulate.hpp"

namespace ukemi::landing {

/// State at release, x_0 = 0, the lowest contact point at the drop's height.
template <class System>
typename System::State released(const System& system, const Scene& scene, const Motion& motion) {
  typename System::State y = System::State::Zero();
  y[kTheta0] = scene.drop.pitch, y[kTheta1] = scene.drop.pitch + motion.phi_i, y[kPhiM] = motion.phi_i;
  y[kVx] = scene.drop.forward_speed;
  y[kOmega0] = y[kOmega1] = scene.drop.pitch_rate;
  const Pose<double> p = system.pose(y);
  const double k = system.link.k1 * system.link.a;
  y[kX] = k * (p.s0 + p.s1);  // r_0 = (0, .)
  y[kVx] += k * (p.omega0 * p.c0 + p.omega1 * p.c1);
  y[kVy] = k * (p.omega0 * p.s0 + p.omega1 * p.s1);
  double lowest = std::numeric_limits<double>::infinity();
  for (int j = 0; j < kPoints; ++j)
    if (scene.contacts[j] || !scene.touches()) lowest = std::min(lowest, height(system.link, p, j));
  y[kY] = scene.drop.height - lowest;
  return y;
}

/// Follows one landing with `Method` and the kernel of `kTerms`; with kReport, everything that a report needs.
template <class Method, LandingTerms kTerms, bool kReport>
void follow(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion, const SimulateOptions& options,
            LandingPeak& out, [[maybe_unused]] Landing* landing, [[maybe_unused]] double rate) {
  using System = LandingSystem<kTerms, kReport>;
  System system(scene, sea, motion);
  [[maybe_unused]] std::conditional_t<kReport, Recorder<System>, NoRecorder> recorder(landing, rate);
  typename System::State y = released(system, scene, motion);
  const double g = system.link.gravity;
  double t = 0, limit = scene.t_end.value_or(Scene::kFollow);
  PeakTracker peak;
  if constexpr (kReport) recorder.start(system, t, y);

  // 1) With no pitch rate nothing moves relative to anything else: ballistic, in closed form, peak g.
  const bool ballistic = scene.drop.pitch_rate == 0;
  if (ballistic) {
    const bool lands = scene.touches() && (g > 0 || scene.drop.height == 0);
    const double fall =
        lands ? std::sqrt(g > 0 ? 2 * scene.drop.height / g : 0) : std::numeric_limits<double>::infinity();
    t = std::min(fall, limit);
    peak.consider(g * g, 0);
    if constexpr (kReport) recorder.ballistic(system, scene.drop, y, t);
    y[kX] += y[kVx] * t, y[kVy] = -g * t;
    y[kY] = lands && t == fall ? y[kY] - scene.drop.height : y[kY] - 0.5 * g * t * t;
    if (t < fall) {
      if constexpr (kReport) recorder.row(system, t, y), recorder.finish();
      out.t_end = t, out.end = End::kTimeLimit, out.peak = g, out.t_peak = 0,
      out.state = y.template head<kMechanical>();
      return;
    }
  }

  // 2), 3) From event to event.
  integrate::Integrator<Method, System> integrator(system, t, y,
                                                   {.accuracy = options.accuracy,
                                                    .first_step = std::min(options.max_step, ballistic ? 1e-3 : 1e-2),
                                                    .max_step = options.max_step});
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
      break;
    }
    if (!outcome.immediate && integrator.step().h > 0) {
      peak.step(system, integrator);
      if constexpr (kReport) recorder.step(system, integrator);
    }
    if (peak.square > options.abandon_above * options.abandon_above) {
      out.end = End::kAbandoned;
      break;
    }
    if (outcome.event >= 0) {
      if constexpr (kReport) recorder.row(system, t, integrator.state());
      const bool touchdown = outcome.event < kPoints && system.contact[outcome.event] == Contact::kClear;
      if (touchdown && options.touchdowns) options.touchdowns->push_back(t);
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
        out.end = End::kTimeLimit;
        break;
      }
    }
    if (options.rest == SimulateOptions::Rest::kStop &&
        at_rest(system, integrator.state(), integrator.slope(), std::sqrt(peak.square))) {
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
