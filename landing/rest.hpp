// When a landing is over: no later peak can exceed the running one.
//
// Rest is not a small speed alone (calibration: a fallen robot slides for many seconds and that is rest; a robot
// balanced on one point is slow just before it topples and that is not). The rule, all of it at once, after the motion
// has ended:
//   1. the spring torque is inside its limit, and the centre of mass, shifted by the tangential forces' lever
//      (x - y F_x / W), lies inside the support that the pressed points span, with a margin m > 0;
//   2. the energy that could still do something, E = kinetic energy without the common sliding + motor and spring
//   energy
//      about their equilibrium, is at most kBarrierShare of the barrier W (sqrt(m^2 + y^2) - y) to topple over either
//      end;
//   3. E is at most kImpactShare of the energy whose whole release against the floor could bring back the running peak.
// The thresholds are ours; test/property/rest.cpp proves them by sampling.
#pragma once

#include "landing/landing_system.hpp"

namespace ukemi::landing {

inline constexpr double kBarrierShare = 0.02;
inline constexpr double kImpactShare = 0.02;

/// True where the run may end; `peak` is the running peak of |ddr_0| [m/s^2], `dy` the field at the state y.
template <LandingTerms kTerms, bool kAccounts>
bool at_rest(const LandingSystem<kTerms, kAccounts>& system, const typename LandingSystem<kTerms, kAccounts>::State& y,
             const typename LandingSystem<kTerms, kAccounts>::State& dy, double peak) {
  const auto& link = system.link;
  if (system.phase != Phase::kAfter || system.saturation != 0 || link.gravity <= 0) return false;
  const SeaParameters<double>& sea = system.sea;
  const double mass = link.total_mass, weight = mass * link.gravity;
  // (3) An impact with energy E on an effective mass m, a quarter of the whole, gives at most v (C / m + sqrt(K / m)),
  // v = sqrt(2 E / m).
  const double m = 0.25 * mass, per_speed = system.floor.damping_normal / m + std::sqrt(system.floor.stiffness / m),
               speed = peak / per_speed, limit = kImpactShare * 0.5 * m * speed * speed;
  double energy = system.motor_energy(y);
  if (energy > limit) return false;
  const Pose<double> p = system.pose(y);
  energy += kinetic_energy(link, p) - 0.5 * mass * p.vx * p.vx;
  if (energy > limit) return false;

  double left = std::numeric_limits<double>::infinity(), right = -left, fx = 0;
  for (int j = 0; j < kPoints; ++j) {
    if (system.contact[j] != Contact::kClear) fx += tangential_force(system.floor, velocity_x(link, p, j));
    if (system.contact[j] != Contact::kPressed) continue;
    const double x = place(link, p, j);
    left = std::min(left, x), right = std::max(right, x);
  }
  const double shifted = p.x - p.y * fx / weight;
  const double margin = std::min(std::min(p.x, shifted) - left, right - std::max(p.x, shifted));
  if (!(margin > 0)) return false;
  const double barrier = weight * margin * margin / (std::sqrt(margin * margin + p.y * p.y) + std::max(p.y, 0.0));

  // Torques and forces out of balance, as the energy of a spring that would hold them.
  const double torque = sea.i_motor * dy[kOmegaM], joint = std::max(std::min(sea.k_p, sea.k_sea), 1e-9);
  const double force = mass * dy[kVy];
  energy += 0.5 * torque * torque / joint + 0.5 * force * force / system.floor.stiffness;
  return energy <= limit && energy <= kBarrierShare * barrier;
}

}  // namespace ukemi::landing
