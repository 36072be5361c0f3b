// The rest test: a landing is over when no later peak can exceed the running one.
//
// A small speed is not enough (calibration: a fallen robot slides for many seconds and that is rest; a robot
// balanced on one point is slow just before it topples and that is not). The rule, all of it at once, after the motion
// has ended:
//   1. the spring torque is inside its limit, and the centre of mass, shifted by the tangential forces' lever
//      (x - y F_x / W), lies inside the support that the pressed points span, with a margin m > 0;
//   2. the energy that could still act, E = kinetic energy without the common sliding + motor energy + that of the
//      springs (joint, floor) relative to static equilibrium, is at most kBarrierShare of the barrier W
//      (sqrt(m^2 + y^2) - y) to topple over either end;
//   3. E is at most kImpactShare of the energy whose whole release against the floor could bring back the running peak.
// The thresholds are ours; test/property/rest.cpp proves them by sampling.
#pragma once

#include "landing/model/landing_system.hpp"

namespace ukemi::landing {

inline constexpr double kBarrierShare = 0.02;
inline constexpr double kImpactShare = 0.02;

/// The energy whose whole release against the floor could bring back a peak of 1 m/s^2, times kImpactShare [J]: an
/// impact with energy E on an effective mass m, a quarter of the whole, gives at most v (C / m + sqrt(K / m)),
/// v = sqrt(2 E / m).
template <LandingTerms kTerms, bool kAccounts>
double impact_energy(const LandingSystem<kTerms, kAccounts>& system) {
  const double m = 0.25 * system.link.total_mass,
               per_speed = system.floor.damping_normal / m + std::sqrt(system.floor.stiffness / m);
  return kImpactShare * 0.5 * m / (per_speed * per_speed);
}

/// Whether the run may end in the state y, by lane for packs; `peak_square` is the square of the running peak of
/// |ddr_0| [m^2/s^4], `per_square` the system's `impact_energy`.
template <LandingTerms kTerms, bool kAccounts, Scalar T>
auto at_rest(const LandingSystem<kTerms, kAccounts, T>& system,
             const typename LandingSystem<kTerms, kAccounts, T>::State& y, const T& peak_square, const T& per_square) {
  using std::sqrt;
  using Lane = typename LandingSystem<kTerms, kAccounts, T>::Lane;
  const auto& link = system.link;
  const SeaParameters<T>& sea = system.sea;
  Lane rest = after(system.phase) & !at_upper(system.saturation) & !at_lower(system.saturation) & (link.gravity > T(0));
  if (!any(rest)) return rest;
  const T mass = link.total_mass, weight = mass * link.gravity;
  const T limit = per_square * peak_square;
  T energy = system.motor_energy(y);
  rest &= energy <= limit;
  if (!any(rest)) return rest;
  const Pose<T> p = system.pose(y);
  energy += kinetic_energy(link, p) - T(0.5) * mass * p.vx * p.vx;
  rest &= energy <= limit;
  if (!any(rest)) return rest;

  T left(std::numeric_limits<double>::infinity()), right = -left, fx(0), spring_force(0);
  for (int j = 0; j < kPoints; ++j) {
    fx += select(below(system.contact[j]), tangential_force(system.floor, velocity_x(link, p, j)), T(0));
    spring_force += select(pressed(system.contact[j]), normal_force(system.floor, height(link, p, j), T(0)), T(0));
    const T x = place(link, p, j);
    left = select(pressed(system.contact[j]) & (x < left), x, left);
    right = select(pressed(system.contact[j]) & (x > right), x, right);
  }
  const auto minimum = [](const T& a, const T& b) { return select(a < b, a, b); };
  const T shifted = p.x - p.y * fx / weight, first = minimum(p.x, shifted), last = p.x + shifted - first;
  const T margin = minimum(first - left, right - last);
  rest &= margin > T(0);
  if (!any(rest)) return rest;
  const T rise = sqrt(margin * margin + p.y * p.y) + select(p.y > T(0), p.y, T(0));
  const T barrier = weight * margin * margin / rise;

  // Unbalanced torques and forces without dampers, which only slow it, as energy of the spring that would balance them.
  const T torque = system.unbalanced_motor_torque(y), softest = minimum(sea.k_p, sea.k_sea),
          joint = select(softest > T(1e-9), softest, T(1e-9));
  const T force = weight - spring_force;
  energy += T(0.5) * torque * torque / joint + T(0.5) * force * force / system.floor.stiffness;
  rest &= (energy <= limit) & (energy <= T(kBarrierShare) * barrier);
  return rest;
}

}  // namespace ukemi::landing
