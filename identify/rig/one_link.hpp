// The rig as a hybrid system: Eq. 5 with the actuator of Eq. 2-4. No floor: nothing of one is in this kernel.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/integrate/hybrid.hpp"
#include "common/jet.hpp"
#include "common/sea.hpp"
#include "identify/rig/rig.hpp"

namespace ukemi::identify {

/// Force and reference on one stretch of a trial: the force cubic, the rest linear in time from `t`.
template <class T>
struct Excitation {
  double t = 0;                                    ///< start [s]
  bool pushed = false;                             ///< there is a force, or a derivative by one of its terms
  bool curved = false;                             ///< the force's last two coefficients are not 0
  std::array<T, 4> force{T(0), T(0), T(0), T(0)};  ///< F_e = force[0] + force[1] u + ... [N], u = time - t [s]
  double phi_ref = 0, phi_ref_rate = 0;            ///< [rad], [rad/s]
  double dphi_ref = 0, dphi_ref_rate = 0;          ///< what Eq. 3 sees as the reference's rate [rad/s], [rad/s^2]
  double command = 0;                              ///< what the motor is told, where that is logged [V, A or Nm]

  /// F_e at t + u.
  template <class Time>
  UKEMI_INLINE T force_at(const Time& u) const {
    if (!curved) return force[0] + force[1] * u;
    return force[0] + u * (force[1] + u * (force[2] + u * force[3]));
  }

  template <class U>
  Excitation<U> with_force(bool is_pushed, const std::array<U, 4>& f = {U(0), U(0), U(0), U(0)}) const {
    return {t, is_pushed, is_pushed && curved, f, phi_ref, phi_ref_rate, dphi_ref, dphi_ref_rate, command};
  }
};

/// What is held between events.
struct RigMode {
  int saturation = 0;      ///< branch of Eq. 2's clamp: -1, 0, +1
  int command = 0;         ///< branch of the command's limit
  bool rubs[kSides] = {};  ///< the side has Coulomb friction
  int slip[kSides] = {};   ///< of such a side: the sign of its motion, or 0 where it is stuck
  bool stuck(int side) const { return rubs[side] && slip[side] == 0; }
  bool rubbing() const { return rubs[kOutputSide] || rubs[kMotorSide]; }
  bool operator==(const RigMode&) const = default;
};

/// M ddphi_1 = tau_SEA + l cos(phi_1) F_e(t) - friction - gravity, Eq. 5 of [1]; state [phi_1, phi_m, dphi_1, dphi_m],
/// and of a drive that is late the states of DriveLag.
///
/// Coulomb friction sticks (ours). With T_s what moves side s (`torques`) and L(+-, v) its level in each direction at
/// the speed v (`level`), a side slips with I_s a_s = T_s - slip L(slip, v), slip = +-1 the sign of its rate, until
/// that rate is zero. It is then stuck, rate and acceleration exactly 0, as long as -L(-, 0) <= T_s <= L(+, 0). The
/// mode is held between events; in a mode the field is smooth. Tests: test/unit/one_link.cpp against the closed-form
/// linear response; test/unit/sticking.cpp.
template <SeaTerms kTerms, Scalar T>
class OneLinkSystem {
 public:
  using Lag = std::conditional_t<kTerms.late, DriveLag<T>, NoLag<T>>;
  enum { kPhi, kPhiM, kOmega, kOmegaM, kLag, kLags = Lag::kStates, kStates = int(kLag) + int(kLags) };
  enum { kTorqueUpper, kTorqueLower, kCommandUpper, kCommandLower, kRub };  ///< guards; from kRub on two for each side
  static constexpr int kControlled = kStates, kPositions = 2,
                       kGuards = kTerms.extended ? int(kRub) + 2 * kSides : int(kTorqueLower) + 1;
  using State = Eigen::Matrix<T, kStates, 1>;

  OneLinkSystem(const SeaParameters<T>& actuator, const Rig& rig)
      : sea(actuator), lag(actuator), length_(rig.length), inverse_inertia_(1 / rig.inertia), gravity_(rig.gravity) {
    if (kTerms.torque_limit && value_of(sea.tau_max) == 0) mode.saturation = 1;
  }

  SeaParameters<T> sea;
  [[no_unique_address]] Lag lag;
  T command_limit = T(std::numeric_limits<double>::infinity());  ///< of |tau_mot| [Nm], >= 0
  Excitation<T> input;
  RigMode mode;
  bool stribeck = false;  ///< friction falls with speed, or a derivative by it does
  bool lossy = false;     ///< the same of `spring_loss`

  static SeaState<T> sea_state(const State& y) { return {y[kPhi], y[kPhiM], y[kOmega], y[kOmegaM]}; }

  /// tau_SEA of Eq. 2 [Nm].
  T spring_on_output(const State& y) const {
    return limited_torque<kTerms>(sea, spring_torque<kTerms>(sea, sea_state(y)), mode.saturation);
  }

  /// What moves each side, Coulomb friction apart [Nm]: tau_SEA + l cos(phi_1) F_e - viscous friction on the output -
  /// gravity, tau_mot - tau_SEA - viscous friction on the motor. tau_mot is Eq. 3 within `command_limit`, as late as
  /// the drive is, and K_t times a logged command. `t` may be a double or, to differentiate by it, a T.
  template <class Time>
  UKEMI_INLINE std::array<T, kSides> torques(const Time& t, const State& y) const {
    return torques(t, y, asked(t, y));
  }
  /// The same where the drive asks for `ask` now.
  template <class Time>
  UKEMI_INLINE std::array<T, kSides> torques(const Time& t, const State& y, const T& ask) const {
    const Time u = t - input.t;
    const SeaState<T> s = sea_state(y);
    const T tau = spring_on_output(y);
    T on_output = tau, on_motor = -tau;
    if (input.pushed) {
      using std::cos;
      on_output += T(length_) * input.force_at(u) * cos(y[kPhi]);
    }
    if constexpr (kTerms.extended) {
      using std::sin;
      if (gravity_.moment != 0) on_output -= T(gravity_.moment) * sin(y[kPhi] - T(gravity_.hanging));
      on_output -= sea.output_viscous * s.dphi, on_motor += sea.k_t * T(input.command) - sea.viscous * s.dphi_m;
    }
    if constexpr (kTerms.late) return {on_output, on_motor + lag.torque(ask, y.template tail<kLags>())};
    return {on_output, on_motor + ask};
  }
  /// What the drive asks for now, Eq. 3 within the command's limit, of what it sees [Nm].
  template <class Time>
  UKEMI_INLINE T asked(const Time& t, const State& y) const {
    if constexpr (kTerms.extended)
      if (mode.command != 0) return T(mode.command) * command_limit;
    return unlimited(t, y);
  }
  /// L(direction) of a side in the angles of y, at a speed >= 0 in that direction [Nm].
  T level(int side, int direction, const State& y, const T& speed = T(0)) const {
    const T of_motor =
        lossy && side == kMotorSide ? loaded(sea.friction, sea.spring_loss, spring_on_output(y)) : sea.friction;
    const T sliding = side == kMotorSide
                          ? coulomb_level(of_motor, sea.friction_asymmetry, T(direction))
                          : coulomb_level(sea.output_friction, sea.output_friction_asymmetry, T(direction));
    return stribeck ? T(sliding * ukemi::stribeck(sea.breakaway, sea.stribeck_speed, speed)) : sliding;
  }

  /// Flattened: operations on Jets are worth no calls.
  template <class Time>
  UKEMI_FLATTEN void derivative(const Time& t, const State& y, State& dy) const {
    const T ask = asked(t, y);
    std::array<T, kSides> torque = torques(t, y, ask);
    if constexpr (kTerms.extended)
      for (const int side : {kOutputSide, kMotorSide})
        if (mode.rubs[side]) torque[side] = mode.slip[side] == 0 ? T(0) : T(torque[side] - friction_of(side, y));
    dy[kPhi] = y[kOmega];
    dy[kPhiM] = y[kOmegaM];
    dy[kOmega] = torque[kOutputSide] * T(inverse_inertia_);
    dy[kOmegaM] = torque[kMotorSide] / sea.i_motor;
    if constexpr (kTerms.late) dy.template tail<kLags>() = lag.derivative(ask, sea_state(y), y.template tail<kLags>());
  }

  /// The same system and mode in another scalar, by values.
  template <class U>
  OneLinkSystem<kTerms, U> in_values() const {
    SeaParameters<U> values{};
    SeaParameters<U>::for_each(values, sea, [](U& to, const T& from) { to = U(value_of(from)); });
    values.feedback = sea.feedback;
    OneLinkSystem<kTerms, U> out(values, {.length = length_, .inertia = 1 / inverse_inertia_, .gravity = gravity_});
    if constexpr (kTerms.late) out.lag = DriveLag<U>(lag);
    out.command_limit = U(value_of(command_limit));
    std::array<U, 4> force;
    for (std::size_t i = 0; i < force.size(); ++i) force[i] = U(value_of(input.force[i]));
    out.input = input.with_force(input.pushed, force);
    out.mode = mode, out.stribeck = stribeck, out.lossy = lossy;
    return out;
  }

  /// d(dy/dt)/dy and d(dy/dt)/dt of the present mode, exact; values only, so for T = double.
  template <class Matrix>
  void linearize(double t, const State& y, Matrix& jacobian, State& rate) const {
    using Dual = ceres::Jet<double, kStates + 1>;
    const OneLinkSystem<kTerms, Dual> dual = in_values<Dual>();
    Eigen::Matrix<Dual, kStates, 1> x, dx;
    for (int i = 0; i < kStates; ++i) x[i] = Dual(y[i], i);
    dual.derivative(Dual(t, kStates), x, dx);
    for (int i = 0; i < kStates; ++i)
      jacobian.row(i) = dx[i].v.template head<kStates>().transpose(), rate[i] = dx[i].v[kStates];
  }

  void guards(double t, const State& y, const State& dy, integrate::Guards<kGuards>& out) const {
    out = {};
    if constexpr (kTerms.torque_limit) torque_guards(y, dy, out);
    if constexpr (kTerms.extended) {
      if (mode.rubbing() || std::isfinite(value_of(command_limit))) held_guards(t, y, dy, out);
    }
  }

  /// Changes the mode as the guard's zero asks at t, y; see `stops`.
  void cross(int guard, double t, const State& y) {
    if (guard <= kTorqueLower) {
      mode.saturation = mode.saturation ? 0 : (guard == kTorqueUpper ? 1 : -1);
    } else if (guard < kRub) {
      mode.command = mode.command ? 0 : (guard == kCommandUpper ? 1 : -1);
    } else {
      const int side = side_of(guard);
      if (mode.stuck(side)) {
        mode.slip[side] = guard == upward(side) ? 1 : -1;
      } else {  // it stays, or turns where what moves it is beyond the level of the other direction
        const int back = -mode.slip[side];
        mode.slip[side] = back * value_of(torques(t, y)[std::size_t(side)]) > value_of(level(side, back, y)) ? back : 0;
      }
    }
  }
  /// Whether a guard's zero ends a slip: the side's rate is zero there, and its acceleration jumps.
  bool stops(int guard) const { return guard >= kRub && !mode.stuck(side_of(guard)); }
  static constexpr int side_of(int guard) { return (guard - kRub) / 2; }
  static constexpr int rate_of(int side) { return kOmega + side; }  ///< its place in the state

  /// The modes that hold at t, y where an input has jumped, or a run starts: limits of the command; sides that are at
  /// rest and cannot stay; sides that move.
  void settle(double t, const State& y) {
    if constexpr (kTerms.extended) {
      settle_command(t, y);
      if (!mode.rubbing()) return;
      const std::array<T, kSides> torque = torques(t, y);
      for (const int side : {kOutputSide, kMotorSide}) {
        if (!mode.stuck(side)) continue;
        const double rate = value_of(y[rate_of(side)]), moving = value_of(torque[std::size_t(side)]);
        if (rate != 0)
          mode.slip[side] = rate > 0 ? 1 : -1;
        else if (moving > value_of(level(side, 1, y)))
          mode.slip[side] = 1;
        else if (-moving > value_of(level(side, -1, y)))
          mode.slip[side] = -1;
      }
    }
  }

  /// The drive has seen the rates of y, and asked for the torque that it asks for at t, for ever.
  template <class Time>
  void steady(const Time& t, State& y) {
    if constexpr (kTerms.late) {
      y.template tail<kLags>() = lag.steady(T(0), sea_state(y));
      settle_command(value_of(t), y);
      y.template tail<kLags>() = lag.steady(asked(t, y), sea_state(y));
    }
  }

  /// 0.1 rad, and that at 10 1/s; of torques, what Eq. 3 makes of both.
  double tolerance_unit(int i) const {
    constexpr double kAngle = 0.1, kRate = 1;
    if (i < kOmega) return kAngle;
    if (i < kLag || i == int(kLag) + int(DriveLag<T>::kRate)) return kRate;
    return std::max(1e-6, value_of(sea.k_p) * kAngle + value_of(sea.k_d) * kRate);
  }

 private:
  template <SeaTerms, Scalar U>
  friend class OneLinkSystem;

  /// Eq. 3 of what the drive sees.
  template <class Time>
  UKEMI_INLINE T unlimited(const Time& t, const State& y) const {
    SeaState<T> s = sea_state(y);
    if constexpr (kTerms.late) s = lag.seen(s, y.template tail<kLags>());
    return motor_torque<kTerms>(sea, s, reference(t - input.t));
  }
  void settle_command(double t, const State& y) {
    const double most = value_of(command_limit);
    if (!std::isfinite(most)) return;
    const double ask = value_of(unlimited(t, y));
    mode.command = ask > most ? 1 : ask < -most ? -1 : 0;
  }
  static constexpr int upward(int side) { return kRub + 2 * side; }

  /// Of a side that slips, along its rate [Nm].
  T friction_of(int side, const State& y) const {
    const T direction(mode.slip[side]);
    return direction * level(side, mode.slip[side], y, T(direction * y[rate_of(side)]));
  }

  template <class Time>
  UKEMI_INLINE Reference<T> reference(const Time& u) const {
    return {T(input.phi_ref + input.phi_ref_rate * u), T(input.dphi_ref + input.dphi_ref_rate * u)};
  }

  /// Of Eq. 2's clamp.
  void torque_guards(const State& y, const State& dy, integrate::Guards<kGuards>& out) const {
    if (value_of(sea.tau_max) == 0) return;
    const SeaState<double> s{value_of(y[kPhi]), value_of(y[kPhiM]), value_of(y[kOmega]), value_of(y[kOmegaM])};
    const SeaParameters<double> p{
        0, 0, value_of(sea.k_sea), value_of(sea.c_sea), 1, value_of(sea.tau_max), 0, value_of(sea.k_sea_cubic)};
    const double tau = spring_torque<kTerms>(p, s), limit = p.tau_max,
                 rate = spring_torque_rate<kTerms>(p, s, value_of(dy[kOmega]), value_of(dy[kOmegaM]));
    if (mode.saturation >= 0)
      out.set(kTorqueUpper, mode.saturation ? tau - limit : limit - tau, mode.saturation ? rate : -rate);
    if (mode.saturation <= 0)
      out.set(kTorqueLower, mode.saturation ? -limit - tau : limit + tau, mode.saturation ? -rate : rate);
  }

  /// Of the command's limit and of friction: torques and their rates along the field.
  void held_guards(double t, const State& y, const State& dy, integrate::Guards<kGuards>& out) const {
    using Rate = ceres::Jet<double, 1>;
    constexpr double kRounding = 1e-12;  // a side that breaks away with no acceleration has not turned [rad/s]
    const OneLinkSystem<kTerms, Rate> moving = in_values<Rate>();
    Eigen::Matrix<Rate, kStates, 1> x;
    for (int i = 0; i < kStates; ++i) x[i].a = value_of(y[i]), x[i].v[0] = value_of(dy[i]);
    const Rate now(t, 0);
    const auto set = [&](int guard, const Rate& g) { out.set(guard, g.a, g.v[0]); };
    if (const Rate most = moving.command_limit; std::isfinite(most.a)) {
      const Rate ask = moving.unlimited(now, x);
      if (mode.command >= 0) set(kCommandUpper, mode.command ? ask - most : most - ask);
      if (mode.command <= 0) set(kCommandLower, mode.command ? -most - ask : most + ask);
    }
    if (!mode.rubbing()) return;
    const std::array<Rate, kSides> torque = moving.torques(now, x);
    for (const int side : {kOutputSide, kMotorSide}) {
      if (!mode.rubs[side]) continue;
      if (const int slip = mode.slip[side]; slip != 0) {
        set(upward(side), Rate(slip) * x[rate_of(side)] + Rate(kRounding));
      } else {
        set(upward(side), moving.level(side, 1, x) - torque[std::size_t(side)]);
        set(upward(side) + 1, moving.level(side, -1, x) + torque[std::size_t(side)]);
      }
    }
  }

  double length_, inverse_inertia_;
  Gravity gravity_;
};

}  // namespace ukemi::identify
