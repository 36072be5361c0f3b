// When a landing of a robot of any joints is over: the rule of landing/run/rest.hpp, whose thresholds it takes.
//
// After all motions have ended, no limit acts, and of what could still do something
//     E = kinetic energy without the common sliding of a free robot + that of the motors
//         + 1/2 a . M a / w^2,   a the accelerations were all rates 0, w as `softest`: what is out of balance, as the
//           energy of the softest spring that may still carry it
// is at most kImpactShare of the energy whose whole release against the floor could bring back the running peak; a free
// robot's centre of mass also stands within its support, and E is at most kBarrierShare of the barrier to topple over
// either end, and it does not gain speed down a slope. Ours; test/legs/references.cpp follows what it ends to the end.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "landing/body/body_system.hpp"
#include "landing/run/rest.hpp"

namespace ukemi::landing {

/// As `impact_energy` of the paper's robot, of the stiffest contact [J per (m/s^2)^2].
template <class System>
double impact_energy(const System& s) {
  constexpr double kDeep = 0.05;  // a contact of Hunt and Crossley is never deeper [m]
  double k = 0, c = 0;
  for (int i = 0; i < s.body.contacts; ++i) {
    const auto& x = s.point[i];
    const double power = x.hunt_crossley ? x.k * std::pow(kDeep, x.p - 1) : x.k;
    k = std::max(k, power + x.k_pad);
    c = std::max(c, (x.hunt_crossley ? x.dissipation * power * kDeep : x.c) + x.c_pad);
  }
  const double m = 0.25 * s.body.mass, per_speed = c / m + std::sqrt(k / m);
  return kImpactShare * 0.5 * m / (per_speed * per_speed);
}

/// How far the centre of mass of a free robot, shifted by the forces' lever, stands within its support [m].
template <class System>
double support_margin(const System& s, const typename System::Pose& p, const typename System::State& y) {
  double left = std::numeric_limits<double>::infinity(), right = -left, along = 0;
  for (int i = 0; i < s.body.contacts; ++i) {
    const auto& m = s.contact[i];
    if (!m.floor && !m.pad) continue;
    const double x = position(s.body.contact[i], p, s.body.bodies)[0];
    left = std::min(left, x), right = std::max(right, x);
    const auto at = s.point_at(i, p);
    along -= tangential_force(s.point[i], m, s.held(i, y, at), normal_force(s.point[i], m, at.y, at.v, 0.0).value);
  }
  const double weight = -s.body.mass * s.gravity[1], by_force = p.x - p.y * along / weight,
               by_weight = p.x - p.y * s.gravity[0] / s.gravity[1];
  return std::min(std::min(by_force, by_weight) - left, right - std::max(by_force, by_weight));
}

/// A lower bound of the frequency at which springs carry what is out of balance: the whole mass on the floor and, in
/// series, on every joint at the longest lever, whose stiffness gravity may lower; where a joint has none left, or a
/// contact is not linear, that of a pendulum longer than any robot [rad/s].
template <class System>
double softest(const System& s) {
  constexpr double kSlow = 3;
  double lever = 0, compliance = 0;  // [m], [m/N]
  const double weight = s.body.mass * std::hypot(s.gravity[0], s.gravity[1]);
  for (int i = 0; i < s.body.contacts; ++i) {
    double far = 0;
    for (int j = 0; j < s.body.bodies; ++j) far += std::hypot(s.body.contact[i].a[j], s.body.contact[i].b[j]);
    lever = std::max(lever, s.body.base == Base::kFree ? 2 * far : far);
    const auto& x = s.point[i];
    if (!s.contact[i].touching) continue;
    if (x.hunt_crossley) return kSlow;
    compliance = std::max(compliance, 1 / x.k + (x.padded ? 1 / x.k_pad : 0));
  }
  for (int i = 0; i < s.body.joints; ++i) {
    const auto& d = s.drive[i];
    const double own = d.kind == DriveKind::kElastic  ? std::min(d.sea.k_p, d.sea.k_sea)
                       : d.kind == DriveKind::kGeared ? d.sea.k_p
                                                      : d.stiffness;
    const double left = own + d.parallel_stiffness - weight * lever;
    if (!(left > 0)) return kSlow;
    compliance += lever * lever / left;
  }
  return std::max(kSlow, std::sqrt(1 / (s.body.mass * compliance)));
}

inline constexpr double kGains = 0.1;  ///< of gravity's part along the slope

/// True where the run may end in the state y; see above.
template <class System>
bool at_rest(const System& s, double t, const typename System::State& y, double peak_square, double per_square) {
  for (int i = 0; i < s.body.joints; ++i)
    if (s.joint[i].phase == Phase::kMoving || s.joint[i].saturation != 0) return false;
  const double limit = per_square * peak_square;
  const bool free = s.body.base == Base::kFree;
  auto p = s.pose(y);
  const double slide = p.vx;
  if (free) p.vx = 0;
  double energy = kinetic_energy(s.body, p);
  for (int i = 0; i < s.body.joints; ++i)
    energy += 0.5 * s.drive[i].sea.i_motor * y[System::kOmegaM + i] * y[System::kOmegaM + i];
  if (!(energy <= limit)) return false;
  if (free && !(support_margin(s, s.pose(y), y) > 0)) return false;

  auto still = y;
  for (int i = System::kVx; i < System::kSlip; ++i) still[i] = 0;
  if (free) still[System::kVx] = slide;
  std::optional<System> stuck;  // what dry friction holds is in balance
  if (s.rubs) stuck.emplace(s), stuck->stand_still(t, still);
  const System& standing = stuck ? *stuck : s;
  const double soft = softest(s);
  bool downhill = false;  // a free robot that slides down the slope and still gains speed
  const auto unheld = [&] {
    const auto dy = standing.derivative(t, still);
    const auto acc = s.accelerations_of(dy);
    p.vx = free ? 0 : acc.x, p.vy = acc.y;
    downhill = free && acc.x * s.gravity[0] > kGains * s.gravity[0] * s.gravity[0];
    for (int j = 0; j < s.body.bodies; ++j) p.omega[j] = acc.alpha[j];
    double out = kinetic_energy(s.body, p);
    for (int i = 0; i < s.body.joints; ++i)
      out += 0.5 * s.drive[i].sea.i_motor * dy[System::kOmegaM + i] * dy[System::kOmegaM + i];
    return out / (soft * soft);
  };
  energy += unheld();
  if constexpr (System::kWork > System::kLag)  // what is still on its way in a drive that is late
    s.settle_lags(t, still), energy += unheld();
  if (downhill || !(energy <= limit)) return false;
  if (!free) return true;
  const auto at = s.pose(y);
  const double margin = support_margin(s, at, y), height = std::max(at.y, 0.0);
  const double rise = std::hypot(margin, height) + height;
  return energy <= kBarrierShare * -s.body.mass * s.gravity[1] * margin * margin / rise;
}

}  // namespace ukemi::landing
