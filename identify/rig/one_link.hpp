// The rig as a hybrid system: Eq. 5 with the actuator of Eq. 2-4, without a floor.
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

/// Inputs on one segment of a trial: the force cubic, the reference linear, the command constant in time from `t` on.
template <class T>
struct Excitation {
  double t = 0;                                    ///< start [s]
  bool has_force = false;                          ///< the force is not 0, or derivatives by one of its terms are
  bool curved = false;                             ///< the force's last two coefficients are not 0
  std::array<T, 4> force{T(0), T(0), T(0), T(0)};  ///< F_e = force[0] + force[1] u + ... [N], u = time - t [s]
  double phi_ref = 0, phi_ref_rate = 0;            ///< [rad], [rad/s]
  double dphi_ref = 0, dphi_ref_rate = 0;          ///< rate of the reference in Eq. 3 [rad/s], [rad/s^2]
  double command = 0;                              ///< command of the motor, where it is logged [V, A or Nm]

  /// F_e at t + u.
  template <class Time>
  UKEMI_INLINE T force_at(const Time& u) const {
    if (!curved) return force[0] + force[1] * u;
    return force[0] + u * (force[1] + u * (force[2] + u * force[3]));
  }

  template <class U>
  Excitation<U> with_force(bool acts, const std::array<U, 4>& f = {U(0), U(0), U(0), U(0)}) const {
    return {t, acts, acts && curved, f, phi_ref, phi_ref_rate, dphi_ref, dphi_ref_rate, command};
  }
};

/// The discrete mode, constant between events.
struct RigMode {
  int saturation = 0;      ///< branch of Eq. 2's clamp: -1, 0, +1
  int command = 0;         ///< branch of the command's limit
  bool rubs[kSides] = {};  ///< the side has Coulomb friction
  int slip[kSides] = {};   ///< of a side with friction: the sign of its rate, 0 where it is stuck
  bool stuck(int side) const { return rubs[side] && slip[side] == 0; }
  bool rubbing() const { return rubs[kOutputSide] || rubs[kMotorSide]; }
  bool operator==(const RigMode&) const = default;
};

/// M ddphi_1 = tau_SEA + l cos(phi_1) F_e(t) - friction - gravity, Eq. 5 of [1]; state [phi_1, phi_m, dphi_1, dphi_m],
/// then the states of DriveLag of a late drive.
///
/// Coulomb friction sticks (ours). With T_s the torque on side s (`torques`) and L(+-, v) its friction in each
/// direction at the speed v (`level`), a side slips with I_s a_s = T_s - slip L(slip, v), slip = +-1 the sign of its
/// rate, until that is zero. It is then stuck, rate and acceleration exactly 0, while -L(-, 0) <= T_s <= L(+, 0). In
/// each mode the field is smooth. Tests: test/unit/one_link.cpp (closed-form response), test/unit/sticking.cpp.
template <SeaTerms kTerms, Scalar T>
class OneLinkSystem {
 public:
  using Lag = std::conditional_t<kTerms.late, DriveLag<T>, NoLag<T>>;
  enum { kPhi, kPhiM, kOmega, kOmegaM, kLag, kLags = Lag::kStates, kStates = int(kLag) + int(kLags) };
  enum { kTorqueUpper, kTorqueLower, kCommandUpper, kCommandLower, kRub };  ///< guards; from kRub on two per side
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
  bool stribeck = false;  ///< the Stribeck term is active: `breakaway` is present
  bool lossy = false;     ///< `spring_loss` is present

  static SeaState<T> sea_state(const State& y) { return {y[kPhi], y[kPhiM], y[kOmega], y[kOmegaM]}; }

  /// tau_SEA of Eq. 2 [Nm].
  T spring_on_output(const State& y) const {
    return limited_torque<kTerms>(sea, spring_torque<kTerms>(sea, sea_state(y)), mode.saturation);
  }

  /// Torque on each side without Coulomb friction [Nm]: tau_SEA + l cos(phi_1) F_e - viscous friction on the output -
  /// gravity, tau_mot - tau_SEA - viscous friction on the motor. tau_mot is Eq. 3 within `command_limit`, with the
  /// drive's lag, plus K_t times a logged command. `t`: a double or, to differentiate by it, a T.
  template <class Time>
  UKEMI_INLINE std::array<T, kSides> torques(const Time& t, const State& y) const {
    return torques(t, y, demanded_torque(t, y));
  }
  /// The torques for a known `demanded_torque`.
  template <class Time>
  UKEMI_INLINE std::array<T, kSides> torques(const Time& t, const State& y, const T& demand) const {
    const Time u = t - input.t;
    const SeaState<T> s = sea_state(y);
    const T tau = spring_on_output(y);
    T on_output = tau, on_motor = -tau;
    if (input.has_force) {
      using std::cos;
      on_output += T(length_) * input.force_at(u) * cos(y[kPhi]);
    }
    if constexpr (kTerms.extended) {
      using std::sin;
      if (gravity_.moment != 0) on_output -= T(gravity_.moment) * sin(y[kPhi] - T(gravity_.hanging));
      on_output -= sea.output_viscous * s.dphi, on_motor += sea.k_t * T(input.command) - sea.viscous * s.dphi_m;
    }
    if constexpr (kTerms.late) return {on_output, on_motor + lag.torque(demand, y.template tail<kLags>())};
    return {on_output, on_motor + demand};
  }
  /// Eq. 3 of the filtered state, within the command's limit, before the delay [Nm].
  template <class Time>
  UKEMI_INLINE T demanded_torque(const Time& t, const State& y) const {
    if constexpr (kTerms.extended)
      if (mode.command != 0) return T(mode.command) * command_limit;
    return unlimited_demand(t, y);
  }
  /// L(direction, speed) of a side at the state y; speed >= 0 [Nm].
  T level(int side, int direction, const State& y, const T& speed = T(0)) const {
    const bool grows = lossy && side == kMotorSide;  // with the spring's torque
    const T motor = grows ? loaded_friction(sea.friction, sea.spring_loss, spring_on_output(y)) : sea.friction;
    const T sliding = side == kMotorSide
                          ? coulomb_level(motor, sea.friction_asymmetry, T(direction))
                          : coulomb_level(sea.output_friction, sea.output_friction_asymmetry, T(direction));
    return stribeck ? T(sliding * ukemi::stribeck(sea.breakaway, sea.stribeck_speed, speed)) : sliding;
  }

  /// Flattened: an operation on Jets is cheaper than a call.
  template <class Time>
  UKEMI_FLATTEN void derivative(const Time& t, const State& y, State& dy) const {
    const T demand = demanded_torque(t, y);
    std::array<T, kSides> torque = torques(t, y, demand);
    if constexpr (kTerms.extended)
      for (const int side : {kOutputSide, kMotorSide})
        if (mode.rubs[side]) torque[side] = mode.slip[side] == 0 ? T(0) : T(torque[side] - sliding_friction(side, y));
    dy[kPhi] = y[kOmega];
    dy[kPhiM] = y[kOmegaM];
    dy[kOmega] = torque[kOutputSide] * T(inverse_inertia_);
    dy[kOmegaM] = torque[kMotorSide] / sea.i_motor;
    if constexpr (kTerms.late)
      dy.template tail<kLags>() = lag.derivative(demand, sea_state(y), y.template tail<kLags>());
  }

  /// This system and mode in another scalar, without derivatives.
  template <class U>
  OneLinkSystem<kTerms, U> cast_values() const {
    SeaParameters<U> values{};
    SeaParameters<U>::for_each(values, sea, [](U& to, const T& from) { to = U(value_of(from)); });
    values.feedback = sea.feedback;
    OneLinkSystem<kTerms, U> out(values, {.length = length_, .inertia = 1 / inverse_inertia_, .gravity = gravity_});
    if constexpr (kTerms.late) out.lag = DriveLag<U>(lag);
    out.command_limit = U(value_of(command_limit));
    std::array<U, 4> force;
    for (std::size_t i = 0; i < force.size(); ++i) force[i] = U(value_of(input.force[i]));
    out.input = input.with_force(input.has_force, force);
    out.mode = mode, out.stribeck = stribeck, out.lossy = lossy;
    return out;
  }

  /// d(dy/dt)/dy and d(dy/dt)/dt of the present mode, exact; for T = double.
  template <class Matrix>
  void linearize(double t, const State& y, Matrix& jacobian, State& rate) const {
    using Dual = ceres::Jet<double, kStates + 1>;
    const OneLinkSystem<kTerms, Dual> dual = cast_values<Dual>();
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
      if (mode.rubbing() || std::isfinite(value_of(command_limit))) limit_and_friction_guards(t, y, dy, out);
    }
  }

  /// Changes the mode at a guard's zero at t, y; see `ends_slip`.
  void cross(int guard, double t, const State& y) {
    if (guard <= kTorqueLower) {
      mode.saturation = mode.saturation ? 0 : (guard == kTorqueUpper ? 1 : -1);
    } else if (guard < kRub) {
      mode.command = mode.command ? 0 : (guard == kCommandUpper ? 1 : -1);
    } else {
      const int side = side_of(guard);
      if (mode.stuck(side)) {
        mode.slip[side] = guard == upward_guard(side) ? 1 : -1;
      } else {  // it sticks, or reverses where the torque exceeds the friction in the other direction
        const int opposite = -mode.slip[side];
        const double torque = value_of(torques(t, y)[std::size_t(side)]);
        mode.slip[side] = opposite * torque > value_of(level(side, opposite, y)) ? opposite : 0;
      }
    }
  }
  /// Whether a guard's zero ends a slip: the side's rate is zero there, and its acceleration jumps.
  bool ends_slip(int guard) const { return guard >= kRub && !mode.stuck(side_of(guard)); }
  static constexpr int side_of(int guard) { return (guard - kRub) / 2; }
  static constexpr int rate_index(int side) { return kOmega + side; }  ///< index of its rate in the state

  /// Sets the mode at t, y after a jump of an input, or at the start: branch of the command's limit, slip of the sides.
  void settle(double t, const State& y) {
    if constexpr (kTerms.extended) {
      settle_command(t, y);
      if (!mode.rubbing()) return;
      const std::array<T, kSides> torque = torques(t, y);
      for (const int side : {kOutputSide, kMotorSide}) {
        if (!mode.stuck(side)) continue;
        const double rate = value_of(y[rate_index(side)]), driving = value_of(torque[std::size_t(side)]);
        if (rate != 0)
          mode.slip[side] = rate > 0 ? 1 : -1;
        else if (driving > value_of(level(side, 1, y)))
          mode.slip[side] = 1;
        else if (-driving > value_of(level(side, -1, y)))
          mode.slip[side] = -1;
      }
    }
  }

  /// Sets the lag's states to the steady state of the rates and the demanded torque at t, y.
  template <class Time>
  void steady(const Time& t, State& y) {
    if constexpr (kTerms.late) {
      y.template tail<kLags>() = lag.steady(T(0), sea_state(y));
      settle_command(value_of(t), y);
      y.template tail<kLags>() = lag.steady(demanded_torque(t, y), sea_state(y));
    }
  }

  /// Unit of the error tolerance: 0.1 rad; 1 rad/s; of the lag's torques Eq. 3 of both.
  double tolerance_unit(int i) const {
    constexpr double kAngle = 0.1, kRate = 1;
    if (i < kOmega) return kAngle;
    if (i < kLag || i == int(kLag) + int(DriveLag<T>::kRate)) return kRate;
    return std::max(1e-6, value_of(sea.k_p) * kAngle + value_of(sea.k_d) * kRate);
  }

 private:
  template <SeaTerms, Scalar U>
  friend class OneLinkSystem;

  /// Eq. 3 of the filtered state, without the command's limit [Nm].
  template <class Time>
  UKEMI_INLINE T unlimited_demand(const Time& t, const State& y) const {
    SeaState<T> s = sea_state(y);
    if constexpr (kTerms.late) s = lag.filtered(s, y.template tail<kLags>());
    return motor_torque<kTerms>(sea, s, reference(t - input.t));
  }
  void settle_command(double t, const State& y) {
    const double limit = value_of(command_limit);
    if (!std::isfinite(limit)) return;
    const double demand = value_of(unlimited_demand(t, y));
    mode.command = demand > limit ? 1 : demand < -limit ? -1 : 0;
  }
  static constexpr int upward_guard(int side) { return kRub + 2 * side; }

  /// Coulomb torque of a side that slips, signed by its direction [Nm].
  T sliding_friction(int side, const State& y) const {
    const T direction(mode.slip[side]);
    return direction * level(side, mode.slip[side], y, T(direction * y[rate_index(side)]));
  }

  template <class Time>
  UKEMI_INLINE Reference<T> reference(const Time& u) const {
    return {T(input.phi_ref + input.phi_ref_rate * u), T(input.dphi_ref + input.dphi_ref_rate * u)};
  }

  /// Guards of Eq. 2's clamp.
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

  /// Guards of the command's limit and of friction: torques and their rates along the field.
  void limit_and_friction_guards(double t, const State& y, const State& dy, integrate::Guards<kGuards>& out) const {
    using Rate = ceres::Jet<double, 1>;
    constexpr double kRounding = 1e-12;  // a side that breaks away with zero acceleration has not reversed [rad/s]
    const OneLinkSystem<kTerms, Rate> with_rate = cast_values<Rate>();
    Eigen::Matrix<Rate, kStates, 1> x;
    for (int i = 0; i < kStates; ++i) x[i].a = value_of(y[i]), x[i].v[0] = value_of(dy[i]);
    const Rate now(t, 0);
    const auto set = [&](int guard, const Rate& g) { out.set(guard, g.a, g.v[0]); };
    if (const Rate limit = with_rate.command_limit; std::isfinite(limit.a)) {
      const Rate demand = with_rate.unlimited_demand(now, x);
      if (mode.command >= 0) set(kCommandUpper, mode.command ? demand - limit : limit - demand);
      if (mode.command <= 0) set(kCommandLower, mode.command ? -limit - demand : limit + demand);
    }
    if (!mode.rubbing()) return;
    const std::array<Rate, kSides> torque = with_rate.torques(now, x);
    for (const int side : {kOutputSide, kMotorSide}) {
      if (!mode.rubs[side]) continue;
      if (const int slip = mode.slip[side]; slip != 0) {
        set(upward_guard(side), Rate(slip) * x[rate_index(side)] + Rate(kRounding));
      } else {
        set(upward_guard(side), with_rate.level(side, 1, x) - torque[std::size_t(side)]);
        set(upward_guard(side) + 1, with_rate.level(side, -1, x) + torque[std::size_t(side)]);
      }
    }
  }

  double length_, inverse_inertia_;
  Gravity gravity_;
};

}  // namespace ukemi::identify
