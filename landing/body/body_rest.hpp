// When a landing is over: no later peak can exceed the running one.
//
// A small speed is not enough: a fallen robot that slides for seconds is at rest, one that is balanced on a point is
// not just before it topples. All motions have ended, no torque limit acts, and the energy that could still act
//     E = kinetic energy without the common sliding of a free robot + kinetic energy of the motors
//         + 1/2 a . M a / w^2,   a the accelerations at zero rates, w the softest_frequency: the unbalanced forces, as
//           the energy of the softest spring that may still carry them; or what they release, where that is less and
//           the present posture is stable (restoring_energy)
// is at most kImpactShare of the energy whose whole release against the floor could bring back the running peak, or
// what steps leave unresolved; a free robot's centre of mass is also within its support, E is at most kBarrierShare of
// the barrier to topple over either end, and it does not gain speed down a slope. Ours, the thresholds too;
// test/property/rest.cpp and test/legs/rest.cpp sample ended runs and integrate them on.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "landing/body/body_system.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

inline constexpr double kBarrierShare = 0.02, kImpactShare = 0.02;

/// Stiffness [N/m] and damping [N/(m/s)] of the stiffest contact.
struct StiffestContact {
  double k = 0, c = 0;
};
template <class System>
StiffestContact stiffest_contact(const System& s) {
  constexpr double kDeep = 0.05;  // a contact of Hunt and Crossley is never deeper [m]
  StiffestContact out;
  for (int i = 0; i < s.body.contacts; ++i) {
    const auto& x = s.point[i];
    const double power = x.hunt_crossley ? x.k * std::pow(kDeep, x.p - 1) : x.k;
    out.k = std::max(out.k, power + x.k_pad);
    out.c = std::max(out.c, (x.hunt_crossley ? x.dissipation * power * kDeep : x.c) + x.c_pad);
  }
  return out;
}

/// The largest energy E of a run at rest [J].
struct RestEnergy {
  /// Largest energy of an impact on the stiffest contact whose acceleration stays below 1 m/s^2 [J per (m/s^2)^2].
  double per_square = 0;
  /// What steps leave in a contact that rests: they move it by some times their tolerance [J].
  double unresolved = 0;

  RestEnergy() = default;
  template <class System>
  RestEnergy(const System& s, double accuracy) {
    constexpr double kMoved = 10;  // measured: up to 7
    const auto [k, c] = stiffest_contact(s);
    const double m = 0.25 * s.body.mass, per_speed = c / m + std::sqrt(k / m),
                 shift = kMoved * accuracy * s.tolerance_unit(System::kY);
    per_square = kImpactShare * 0.5 * m / (per_speed * per_speed), unresolved = 0.5 * k * shift * shift;
  }
  /// `peak_square`: of the running peak [m^2/s^4]; none below 0.
  double operator()(double peak_square) const {
    return peak_square < 0 ? -1 : std::max(per_square * peak_square, unresolved);
  }
};

/// Distance of a free robot's centre of mass, shifted by the forces' lever, inside the edge of its support [m].
template <class System>
double support_margin(const System& s, const typename System::Pose& p, const typename System::State& y) {
  double left = std::numeric_limits<double>::infinity(), right = -left, along = 0;
  for (int i = 0; i < s.body.contacts; ++i) {
    const auto& m = s.contact[i];
    if (!m.floor && !m.pad) continue;
    const double x = position(s.body.contact[i], p, s.body.bodies)[0];
    left = std::min(left, x), right = std::max(right, x);
    const auto at = s.point_at(i, p);
    along -=
        tangential_force(s.point[i], m, s.sticking_force(i, y, at), normal_force(s.point[i], m, at.y, at.v, 0.0).value);
  }
  const double weight = -s.body.mass * s.gravity[1], by_force = p.x - p.y * along / weight,
               by_weight = p.x - p.y * s.gravity[0] / s.gravity[1];
  return std::min(std::min(by_force, by_weight) - left, right - std::max(by_force, by_weight));
}

/// Lower bound of the natural frequency: the whole mass on the contact's spring in series with every joint's at the
/// longest lever, joint stiffness reduced by gravity. Without stiffness, or with a nonlinear contact, that of a
/// pendulum longer than any robot [rad/s].
template <class System>
double softest_frequency(const System& s) {
  constexpr double kPendulumFrequency = 3;
  double lever = 0, compliance = 0;  // [m], [m/N]
  const double weight = s.body.mass * std::hypot(s.gravity[0], s.gravity[1]);
  for (int i = 0; i < s.body.contacts; ++i) {
    double arm_length = 0;
    for (int j = 0; j < s.body.bodies; ++j) arm_length += std::hypot(s.body.contact[i].a[j], s.body.contact[i].b[j]);
    lever = std::max(lever, s.body.base == Base::kFree ? 2 * arm_length : arm_length);
    const auto& x = s.point[i];
    if (!s.contact[i].touching) continue;
    if (x.hunt_crossley) return kPendulumFrequency;
    compliance = std::max(compliance, 1 / x.k + (x.padded ? 1 / x.k_pad : 0));
  }
  for (int i = 0; i < s.body.joints; ++i) {
    const auto& d = s.drive[i];
    const double joint = d.kind == DriveKind::kElastic  ? std::min(d.sea.k_p, d.sea.k_sea)
                         : d.kind == DriveKind::kGeared ? d.sea.k_p
                                                        : d.stiffness;
    const double stiffness = joint + d.parallel_stiffness - weight * lever;
    if (!(stiffness > 0)) return kPendulumFrequency;
    compliance += lever * lever / stiffness;
  }
  return std::max(kPendulumFrequency, std::sqrt(1 / (s.body.mass * compliance)));
}

/// Energy that generalised forces Q out of balance release, 1/2 Q . K^-1 Q, with K the symmetric part of -dQ/dq at zero
/// rates. Nothing where forces follow more than positions (dry friction, sliding contacts), or where K does not hold
/// the robot: it is not positive definite. `still`: a state at zero rates; `rate`: the field there.
template <class System>
std::optional<double> restoring_energy(const System& s, double t, const typename System::State& still,
                                       const typename System::State& rate) {
  constexpr double kStep = 1e-7;  // of a difference [m], [rad]
  constexpr std::size_t n = System::kPositions;
  using Forces = std::array<double, n>;
  if (s.has_friction) return std::nullopt;
  for (int i = 0; i < s.body.contacts; ++i)
    if (s.contact[i].slides != 0) return std::nullopt;
  const int bodies = s.body.bodies;
  const bool rail = s.body.base == Base::kRail;
  // Coordinates that count; the common sliding of a free robot is left out.
  const auto counts = [&](int i) {
    if (i == System::kX) return rail;
    if (i == System::kY) return s.is_free();
    if (i < System::kPhiM) return i < System::kTheta + bodies && !(i == System::kTheta && s.body.first_fixed);
    return i - System::kPhiM < s.body.joints && s.kind(i - System::kPhiM) == DriveKind::kElastic;
  };
  std::array<double, System::kB + 1> unused{};
  const MassMatrix<double, System::kSize> mass(s.body, s.pose(still), unused);
  const auto forces = [&](const typename System::State& dy) {  // M ddq; at rest Q is small, and so is what M changes
    Forces out{};
    const auto add = [&](int i, int k, double m) {
      out[std::size_t(i)] += m * dy[k + System::kPositions];
      if (i != k) out[std::size_t(k)] += m * dy[i + System::kPositions];
    };
    for (int j = 0; j < bodies; ++j)
      for (int k = 0; k <= j; ++k) add(System::kTheta + j, System::kTheta + k, mass.m[std::size_t(j)][std::size_t(k)]);
    if (s.is_free()) add(System::kY, System::kY, s.body.mass);
    for (int j = 0; rail && j <= bodies; ++j)
      add(System::kX, j < bodies ? System::kTheta + j : System::kX, mass.m[std::size_t(bodies)][std::size_t(j)]);
    for (int i = 0; i < s.body.joints; ++i)
      add(System::kPhiM + i, System::kPhiM + i, s.drive[std::size_t(i)].sea.i_motor);
    return out;
  };
  Forces q = forces(rate);
  Symmetric<double, int(n)> stiffness;
  for (int j = 0; j < int(n); ++j) {
    if (!counts(j)) {
      stiffness.m[std::size_t(j)][std::size_t(j)] = 1, q[std::size_t(j)] = 0;
      continue;
    }
    auto moved = still;
    moved[j] += kStep;
    const Forces there = forces(s.derivative(t, moved));
    for (int i = 0; i < int(n); ++i)
      if (counts(i))
        stiffness.m[std::size_t(std::max(i, j))][std::size_t(std::min(i, j))] +=
            (i == j ? 1 : 0.5) * (q[std::size_t(i)] - there[std::size_t(i)]) / kStep;
  }
  stiffness.factor(int(n));
  Forces moved = q;
  stiffness.solve(int(n), moved);
  double out = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!(stiffness.m[i][i] > 0)) return std::nullopt;
    out += 0.5 * q[i] * moved[i];
  }
  return out;
}

inline constexpr double kDownhillShare = 0.1;  ///< of gravity's component along the slope

/// Energy E of the state y relative to its limits by the rule above, which must be at most 1 to end the run; a
/// lower bound of it above 1 if parts of E exceed them. Absent if the run may not end there whatever E is, as with a
/// `limit` of E below 0.
template <class System>
std::optional<double> rest_ratio(const System& s, double t, const typename System::State& y, double limit) {
  constexpr std::nullopt_t kNever = std::nullopt;
  if (limit < 0) return kNever;
  for (int i = 0; i < s.body.joints; ++i)
    if (s.joint[i].phase == Phase::kMoving || s.joint[i].saturation != 0) return kNever;
  const bool free = s.body.base == Base::kFree;
  auto p = s.pose(y);
  const double sliding_speed = p.vx;
  if (free) p.vx = 0;
  double energy = kinetic_energy(s.body, p);
  for (int i = 0; i < s.body.joints; ++i)
    energy += 0.5 * s.drive[i].sea.i_motor * y[System::kOmegaM + i] * y[System::kOmegaM + i];
  if (!(energy <= limit)) return energy / limit;
  if (free && !(support_margin(s, s.pose(y), y) > 0)) return kNever;

  auto still = y;
  for (int i = System::kVx; i < System::kSlip; ++i) still[i] = 0;
  if (free) still[System::kVx] = sliding_speed;
  std::optional<System> sticking;  // dry friction balances what it can hold
  if (s.has_friction) sticking.emplace(s), sticking->stick_where_possible(t, still);
  const System& at_standstill = sticking ? *sticking : s;
  const double frequency = softest_frequency(s);
  bool downhill = false;  // a free robot slides down the slope and gains speed
  const auto unbalanced_energy = [&] {
    const auto dy = at_standstill.derivative(t, still);
    const auto acc = s.accelerations_of(dy);
    p.vx = free ? 0 : acc.x, p.vy = acc.y;
    downhill = free && acc.x * s.gravity[0] > kDownhillShare * s.gravity[0] * s.gravity[0];
    for (int j = 0; j < s.body.bodies; ++j) p.omega[j] = acc.alpha[j];
    double out = kinetic_energy(s.body, p);
    for (int i = 0; i < s.body.joints; ++i)
      out += 0.5 * s.drive[i].sea.i_motor * dy[System::kOmegaM + i] * dy[System::kOmegaM + i];
    out /= frequency * frequency;
    if (energy + out <= limit) return out;
    return std::min(out,
                    restoring_energy(at_standstill, t, still, dy).value_or(std::numeric_limits<double>::infinity()));
  };
  energy += unbalanced_energy();
  if constexpr (System::kWork > System::kLag)  // torques still on their way in late drives
    s.settle_lags_at(t, still), energy += unbalanced_energy();
  if (downhill) return kNever;
  if (!free || !(energy <= limit)) return energy / limit;
  const auto at = s.pose(y);
  const double margin = support_margin(s, at, y), height = std::max(at.y, 0.0);
  const double rise = std::hypot(margin, height) + height;
  return energy / std::min(limit, kBarrierShare * -s.body.mass * s.gravity[1] * margin * margin / rise);
}

/// When the rest test is worth its cost, about that of ten evaluations of the field.
class RestTest {
 public:
  void restart() { next_ = 0; }
  /// Whether a test is due after so many steps.
  bool due(double steps) const { return steps >= next_; }
  /// Tests the state; if it is not at rest, the next test waits for E to decay.
  template <class System>
  bool operator()(double steps, const System& s, double t, const typename System::State& y, double limit) {
    constexpr double kStepsToHalve = 4, kMinWait = 4, kMaxWait = 16;  // steps; E halves in 1.5 or more
    const std::optional<double> ratio = rest_ratio(s, t, y, limit);
    if (ratio && *ratio <= 1) return true;
    next_ =
        steps + (ratio && *ratio > 1 ? std::clamp(kStepsToHalve * std::log2(*ratio), kMinWait, kMaxWait) : kMinWait);
    return false;
  }

 private:
  double next_ = 0;
};

}  // namespace ukemi::landing
