// The landing robot as a hybrid system: Eq. 1 with the actuator of Eq. 2-4 and the floor of Sec. 2.4, one smooth mode
// at a time (mode.hpp). State: Component, then the states of DriveLag of a late drive, and with kAccounts the work of
// the joint torque, of the floor and on the motor, for the energy check.
#pragma once

#include "common/integrate/hybrid.hpp"
#include "common/jet.hpp"
#include "common/trigonometry.hpp"
#include "landing/model/mode.hpp"
#include "landing/model/scene.hpp"

namespace ukemi::landing {

/// Terms that a kernel is compiled with; absent terms cost nothing.
struct LandingTerms {
  SeaTerms sea;
  bool floor;  ///< contact points that may touch
  constexpr LandingTerms(SeaTerms s, bool f = true) : sea(s), floor(f) {}
};
/// Terms of the compiled kernels. A scene runs the first that holds all of its own.
inline constexpr LandingTerms kFlightTerms{SeaTerms{.torque_limit = true, .extended = true}, false},  ///< no floor
    kPlainTerms{SeaTerms{.torque_limit = false}},                                ///< no torque limit
    kLimitedTerms{SeaTerms{.torque_limit = true}},                               ///< the paper's scene
    kExtendedTerms{SeaTerms{.torque_limit = true, .extended = true}},            ///< see is_extended
    kLateTerms{SeaTerms{.torque_limit = true, .extended = true, .late = true}};  ///< and a late drive

/// `Constant`: scalar of the robot's constants; double is faster where T has no derivatives by them.
template <LandingTerms kAllTerms, bool kAccounts, Scalar T = double, Scalar Constant = T>
class LandingSystem : public ModeOf<T>::type {
  static constexpr SeaTerms kTerms = kAllTerms.sea;

 public:
  using Mode = typename ModeOf<T>::type;
  using Mode::contact, Mode::saturation, Mode::slip, Mode::phase;
  using Lag = std::conditional_t<kTerms.late, DriveLag<T>, NoLag<T>>;
  static constexpr int kLags = Lag::kStates, kStates = kMechanical + kLags;
  static constexpr int kControlled = kStates, kPositions = kVx,
                       kGuards = kLandingGuards + (kTerms.extended ? kFrictionGuards : 0);
  enum Account { kWorkJoint = kStates, kWorkFloor, kWorkMotor, kWithAccounts };  ///< work [J]
  using State = Eigen::Matrix<T, kAccounts ? int(kWithAccounts) : kStates, 1>;
  using Lane = typename MaskOf<T>::type;
  using Value = std::remove_cvref_t<decltype(value_of(std::declval<T>()))>;
  using GuardValues = integrate::Guards<kGuards, Value>;

  /// Torques and forces of a state.
  struct Field {
    Pose<T> pose;
    SeaState<T> sea;
    T tau_sea, tau_mot;
    Reference<T> reference;
    std::array<Vec2<T>, kPoints> force;
  };

  LandingSystem(const Scene& scene, const SeaParameters<T>& actuator, const MotionOf<T>& motion)
      : LandingSystem(scene.robot.template cast<Constant>(),
                      scene.floor.value_or(Floor<double>{1, 0, 0}).template cast<T>(), actuator, motion) {
    for (int j = 0; j < kPoints; ++j) present[j] = scene.floor && scene.contacts[j];
  }
  /// With constants that may carry derivatives; no point may touch until `present` says so.
  LandingSystem(const TwoLink<Constant>& robot, const Floor<T>& f, const SeaParameters<T>& actuator,
                const MotionOf<T>& motion)
      : link(robot), floor(f), sea(actuator), lag(actuator), piece(constant_reference(motion.release_phi())) {
    if constexpr (kTerms.torque_limit && !kIsPack<T>)
      if (value_of(sea.tau_max) == 0) saturation = 1;  // no torque at all: one branch, never left
    has_friction = {Lane(ukemi::present(sea.output_friction)),
                    Lane(ukemi::present(sea.friction) | ukemi::present(sea.spring_loss))};
  }

  /// This system, in its present mode, in another scalar.
  template <class U, class UConstant>
  explicit LandingSystem(const LandingSystem<kAllTerms, kAccounts, U, UConstant>& o)
      : Mode(o),
        link(o.link.template cast<Constant>()),
        floor(o.floor.template cast<T>()),
        sea(o.sea.template cast<T>()),
        lag(o.lag),
        piece(o.piece.template cast<T>()),
        shaped(o.shaped),
        present(o.present),
        has_friction(o.has_friction) {}

  TwoLinkDynamics<Constant> link;
  Floor<T> floor;
  SeaParameters<T> sea;
  [[no_unique_address]] Lag lag;
  ReferencePiece<T> piece;  ///< current piece of the reference
  bool shaped = false;      ///< the piece has bumps
  std::array<Lane, kPoints> present{};
  std::array<Lane, kSides> has_friction{};  ///< by side: dry friction, or derivatives by it

  /// Changes the reference at time t, and the gains if the landing motion starts; the schedule has set the phase.
  void change(ReferenceChange to, const MotionOf<T>& motion, const T& t) {
    piece = piece_after(to, motion, piece, t);
    if (to != ReferenceChange::kLand) return;
    shaped = has_bumps(motion);
    sea = with_landing_gains(sea, motion);
  }

  /// Sines, cosines and rates of a state. The last ones are cached: field, guards and peak use the same state.
  UKEMI_INLINE Pose<T> pose(const State& y) const {
    // Angles that compare equal may still differ in their derivatives.
    if (kDerivatives < T >> 0 || any((y[kTheta0] != theta0_) | (y[kTheta1] != theta1_))) {
      theta0_ = y[kTheta0], theta1_ = y[kTheta1];
      sin_cos_ = sin_cos(theta0_, theta1_);
    }
    return {y[kX],           y[kY],           y[kVx],          y[kVy],     sin_cos_[0].sin,
            sin_cos_[0].cos, sin_cos_[1].sin, sin_cos_[1].cos, y[kOmega0], y[kOmega1]};
  }

  template <class Time>
  Reference<T> reference(const Time& t) const {
    const Reference<T> held = held_reference();
    if (!any(moving(phase))) return held;
    const Reference<T> played = piece.at(T(t), shaped);
    return {select(moving(phase), played.phi, held.phi), select(moving(phase), played.dphi, held.dphi)};
  }

  static SeaState<T> sea_state(const State& y) {
    return {y[kTheta1] - y[kTheta0], y[kPhiM], y[kOmega1] - y[kOmega0], y[kOmegaM]};
  }

  /// Force of the floor on a point that is below y = 0, in its present mode [N].
  UKEMI_INLINE Vec2<T> force(const Pose<T>& p, int j) const {
    return {tangential_force(floor, velocity_x(link, p, j)),
            select(pressed(contact[j]), normal_force(floor, height(link, p, j), velocity_y(link, p, j)), T(0))};
  }

  /// Eq. 1-4 and Sec. 2.4 in the present mode.
  State derivative(double t, const State& y) const {
    State dy;
    derivative(t, y, dy);
    return dy;
  }
  /// `t` may be a double or, to differentiate by it, a T.
  template <class Time>
  void derivative(const Time& t, const State& y, State& dy) const {
    const Pose<T> p = pose(y);
    [[maybe_unused]] T floor_power(0);
    const Loads<T> load = loads(p, floor_power);
    const SeaState<T> joint = sea_state(y);
    const T tau = limited_torque<kTerms>(sea, spring_torque<kTerms>(sea, joint), saturation);
    T tau_joint = output_torque<kTerms>(sea, joint.dphi, tau);
    if constexpr (kTerms.extended)
      if (any(has_friction[kOutputSide])) tau_joint -= coulomb(kOutputSide, joint.dphi, tau);
    Accelerations<T> acc = solve(link, p, tau_joint, load);
    if constexpr (kTerms.extended)
      if (const Lane held = stuck(kOutputSide); any(held)) apply_sticking(held, p, acc);
    for (int i = 0; i < kVx; ++i) dy[i] = y[kVx + i];
    dy[kVx] = acc.x, dy[kVy] = acc.y, dy[kOmega0] = acc.theta0, dy[kOmega1] = acc.theta1;
    T tau_motor = requested_torque(t, y);
    if constexpr (kTerms.late) {
      dy.template segment<kLags>(kMechanical) = lag.derivative(tau_motor, joint, lags(y));
      tau_motor = lag.torque(tau_motor, lags(y));
    }
    T on_motor = torque_on_motor<kTerms>(sea, joint.dphi_m, tau_motor, tau);
    if constexpr (kTerms.extended)
      if (any(has_friction[kMotorSide]))
        on_motor = select(stuck(kMotorSide), T(0), T(on_motor - coulomb(kMotorSide, joint.dphi_m, tau)));
    dy[kOmegaM] = on_motor / sea.i_motor;
    if constexpr (kAccounts) {
      dy[kWorkJoint] = tau_joint * joint.dphi;
      dy[kWorkFloor] = floor_power;
      dy[kWorkMotor] = sea.i_motor * dy[kOmegaM] * y[kOmegaM];
    }
  }

  /// Forces of the floor and, with kAccounts, their power.
  UKEMI_INLINE Loads<T> loads(const Pose<T>& p, [[maybe_unused]] T& power) const {
    Loads<T> load;
    if constexpr (kAllTerms.floor)
      for (int j = 0; j < kPoints; ++j)
        if (any(below(contact[j]))) {
          const Vec2<T> f = force(p, j);
          load.add(link, p, j, select(below(contact[j]), f.x(), T(0)), f.y());
          if constexpr (kAccounts) power += f.x() * velocity_x(link, p, j) + f.y() * velocity_y(link, p, j);
        }
    return load;
  }

  // Dry friction, see dry_friction.hpp.

  Lane stuck(Side side) const { return has_friction[side] & is_stuck(slip[side]); }
  static T rate(Side side, const State& y) { return side == kMotorSide ? y[kOmegaM] : T(y[kOmega1] - y[kOmega0]); }
  /// Driving torque and friction limits of each side as if both were stuck.
  template <class Time>
  std::array<Hold<T>, kSides> holds(const Time& t, const State& y) const {
    const Pose<T> p = pose(y);
    const SeaState<T> s = sea_state(y);
    T power(0);
    const T tau = limited_torque<kTerms>(sea, spring_torque<kTerms>(sea, s), saturation),
            tau_joint = output_torque<kTerms>(sea, s.dphi, tau);
    const Loads<T> load = loads(p, power);
    const Accelerations<T> acc = solve(link, p, tau_joint, load), unit = unit_response(p);
    const T reaction = (acc.theta1 - acc.theta0) / (unit.theta1 - unit.theta0);
    return {Hold<T>(sea, sea.output_friction, sea.output_friction_asymmetry, reaction),
            Hold<T>(sea, loaded_friction(sea.friction, sea.spring_loss, tau), sea.friction_asymmetry,
                    torque_on_motor<kTerms>(sea, s.dphi_m, motor_torque_of(t, y), tau))};
  }
  /// Friction modes at the start of a landing: sides that move slip.
  template <class Time>
  void settle(const Time& t, const State& y) {
    if constexpr (kTerms.extended)
      for (const Side side : {kOutputSide, kMotorSide}) {
        const double v = value_of(rate(side, y));
        slip[side] = v > 0 ? 1 : v < 0 ? -1 : 0;
      }
    hold_or_slip(t, y);
  }
  /// Friction modes after guard `event`, or (event -1) after a jump of the field.
  template <class Time>
  void settle(int event, const Time& t, State& y) {
    if constexpr (kTerms.extended)
      if (event >= kLandingGuards && stuck(Mode::side_of(event))) set_rate_zero(Mode::side_of(event), y);
    hold_or_slip(t, y);
  }
  /// Sets the rate of a side to exactly 0.
  static void set_rate_zero(Side side, State& y) {
    if (side == kMotorSide)
      y[kOmegaM] = T(0);
    else
      y[kOmega1] = y[kOmega0];
  }
  /// Stuck sides that friction cannot hold start to slip.
  template <class Time>
  void hold_or_slip(const Time& t, const State& y) {
    if constexpr (kTerms.extended) {
      if (!stuck(kOutputSide) && !stuck(kMotorSide)) return;
      const std::array<Hold<T>, kSides> hold = holds(t, y);
      for (const Side side : {kOutputSide, kMotorSide})
        if (stuck(side))
          slip[side] = breakaway_direction(value_of(hold[side].margin_up()), value_of(hold[side].margin_down()));
    }
  }

  /// d(dy/dt)/dy and d(dy/dt)/dt of the present mode, exact.
  template <class Matrix>
  void linearize(double t, const State& y, Matrix& jacobian, State& rate) const {
    constexpr int n = State::RowsAtCompileTime;
    using Dual = ceres::Jet<double, n + 1>;
    const LandingSystem<kAllTerms, kAccounts, Dual> dual(*this);
    Eigen::Matrix<Dual, n, 1> x, dx;
    for (int i = 0; i < n; ++i) x[i] = Dual(y[i], i);
    dual.derivative(Dual(t, n), x, dx);
    for (int i = 0; i < n; ++i) jacobian.row(i) = dx[i].v.template head<n>().transpose(), rate[i] = dx[i].v[n];
  }

  /// The torques and forces of a state, for reports.
  Field evaluate(double t, const State& y) const {
    Field f{pose(y), sea_state(y), T(0), motor_torque_of(t, y), reference(t), {}};
    for (int j = 0; j < kPoints; ++j) f.force[j] = below(contact[j]) ? force(f.pose, j) : Vec2<T>(T(0), T(0));
    f.tau_sea = limited_torque<kTerms>(sea, spring_torque<kTerms>(sea, f.sea), saturation);
    return f;
  }

  /// |Unbalanced torque| on the motor at zero rates in the angles of y, less what dry friction holds [Nm].
  T unbalanced_motor_torque(const State& y) const {
    using std::abs;
    const SeaState<T> still{y[kTheta1] - y[kTheta0], y[kPhiM], T(0), T(0)};
    const Reference<T> held = held_reference();
    const T static_torque = motor_torque<kTerms>(sea, still, held);
    T torque = abs(T(static_torque - spring_torque<kTerms>(sea, still)));
    if constexpr (kTerms.late)
      torque += abs(T(lag.torque(static_torque, lags(y)) - static_torque));  // torque still in the lag
    if constexpr (!kTerms.extended) return torque;
    const T friction_limit = sea.friction * (T(1) - abs(sea.friction_asymmetry));
    return select(torque > friction_limit, T(torque - friction_limit), T(0));
  }

  /// |ddr_0|^2 [m^2/s^4].
  UKEMI_INLINE T peak_square(const State& y, const State& dy) const {
    return thigh_acceleration(link, pose(y), {dy[kVx], dy[kVy], dy[kOmega0], dy[kOmega1]}).squaredNorm();
  }

  /// tau_mot of a state, delayed if the drive is late [Nm].
  template <class Time>
  T motor_torque_of(const Time& t, const State& y) const {
    if constexpr (kTerms.late)
      return lag.torque(requested_torque(t, y), lags(y));
    else
      return requested_torque(t, y);
  }
  /// Sets a late drive as if the rates of y and the requested torque had always been constant.
  void steady([[maybe_unused]] State& y) const {
    if constexpr (kTerms.late) {
      const SeaState<T> s = sea_state(y);
      y.template segment<kLags>(kMechanical) = lag.steady(motor_torque<kTerms>(sea, s, held_reference()), s);
    }
  }

  /// Guards: heights 0..2, normal forces 3..5, torque limit 6, 7, dry friction; dy: field at y; Out = T: derivatives.
  template <class Time, class Out>
  void guards(const Time& t, const State& y, const State& dy, integrate::Guards<kGuards, Out>& out) const {
    out = {};
    if constexpr (kTerms.extended)
      if (any(has_friction[kOutputSide] | has_friction[kMotorSide])) friction_guards(t, y, dy, out);
    const Accelerations<T> acc{dy[kVx], dy[kVy], dy[kOmega0], dy[kOmega1]};
    if constexpr (kAllTerms.floor) contact_guards(pose(y), acc, out);
    if constexpr (kTerms.torque_limit) {
      const Out limit = narrowed<Out>(sea.tau_max), infinite(std::numeric_limits<double>::infinity());
      const auto limited = (limit > Out(0)) & (limit < infinite);
      if (!any(limited)) return;
      const SeaState<T> s = sea_state(y);
      const Out tau = narrowed<Out>(spring_torque<kTerms>(sea, s)),
                rate = narrowed<Out>(spring_torque_rate<kTerms>(sea, s, T(acc.theta1 - acc.theta0), dy[kOmegaM]));
      const auto upper = at_upper(saturation), lower = at_lower(saturation);
      out.set(kTorqueUpper, select(upper, tau - limit, limit - tau), select(upper, rate, -rate), limited & !lower);
      out.set(kTorqueLower, select(lower, -limit - tau, limit + tau), select(lower, -rate, rate), limited & !upper);
    }
  }

  /// Guards of each side: the margins of a hold, or the rate of a slip.
  template <class Time, class Out>
  void friction_guards(const Time& t, const State& y, const State& dy, integrate::Guards<kGuards, Out>& out) const {
    std::array<Hold<T>, kSides> now, next;
    if (any(stuck(kOutputSide) | stuck(kMotorSide)))
      now = holds(t, y), next = holds(Time(t + Time(kDifferenceStep)), extrapolate(y, dy));
    for (const Side side : {kOutputSide, kMotorSide})
      guard_friction(slip[side], now[side], next[side], rate(side, y), rate(side, dy),
                     [&](int k, const T& value, const T& value_rate, const Lane& active) {
                       out.set(kLandingGuards + 2 * side + k, narrowed<Out>(value), narrowed<Out>(value_rate),
                               active & has_friction[side]);
                     });
  }

  template <class Out>
  void contact_guards(const Pose<T>& p, const Accelerations<T>& acc, integrate::Guards<kGuards, Out>& out) const {
    for (int j = 0; j < kPoints; ++j) {
      if (!any(present[j])) continue;
      const T h = height(link, p, j), v = velocity_y(link, p, j);
      const auto under = below(contact[j]);
      const Out height_value = narrowed<Out>(h), speed = narrowed<Out>(v);
      out.set(j, select(under, -height_value, height_value), select(under, -speed, speed), present[j]);
      const auto damped = under & (value_of(floor.damping_normal) != Value(0));
      if (!any(damped)) continue;
      const auto pushes = pressed(contact[j]);
      const Out force = narrowed<Out>(normal_force(floor, h, v)),
                rate = narrowed<Out>(normal_force_rate(floor, v, acceleration_y(link, p, acc, j)));
      out.set(kPoints + j, select(pushes, force, -force), select(pushes, rate, -rate), damped & present[j]);
    }
  }

  /// Scale of a component for the absolute part of the error tolerance: a link's length, 1 rad, rates 10 1/s times
  /// those; of the drive's torques a tenth of Eq. 3 at these scales.
  Value tolerance_unit(int i) const {
    constexpr double kRate = 10;
    if (i >= kMechanical && i != kMechanical + int(DriveLag<T>::kRate))
      return Value(0.1) * (value_of(sea.k_p) + Value(kRate) * value_of(sea.k_d)) + Value(1e-6);
    const Value length = Value(2) * value_of(link.a);
    const Value unit = i == kX || i == kY || i == kVx || i == kVy ? length : Value(1);
    return i >= kVx ? unit * Value(kRate) : unit;
  }

  /// Number of guards in use: those of dry friction come last.
  int guards_used() const {
    if constexpr (kTerms.extended)
      if (any(has_friction[kOutputSide] | has_friction[kMotorSide])) return kGuards;
    return kLandingGuards;
  }

  /// Potential and kinetic energy of the links, and the motor's kinetic energy [J].
  T link_energy(const State& y) const { return kinetic_energy(link, pose(y)) + link.total_mass * link.gravity * y[kY]; }
  T motor_energy(const State& y) const { return T(0.5) * sea.i_motor * y[kOmegaM] * y[kOmegaM]; }

 private:
  T coulomb(Side side, const T& v, const T& tau_sea) const {
    const bool motor = side == kMotorSide;
    return coulomb_torque(sea, motor ? loaded_friction(sea.friction, sea.spring_loss, tau_sea) : sea.output_friction,
                          motor ? sea.friction_asymmetry : sea.output_friction_asymmetry, direction_of<T>(slip[side]),
                          v);
  }
  /// Accelerations per unit of joint torque.
  Accelerations<T> unit_response(const Pose<T>& p) const {
    Pose<T> still = p;
    still.omega0 = still.omega1 = T(0);
    return solve(link, still, T(1), Loads<T>());
  }
  /// Applies the reaction of a stuck joint: where `held`, both links get the same angular acceleration.
  void apply_sticking(const Lane& held, const Pose<T>& p, Accelerations<T>& acc) const {
    const Accelerations<T> unit = unit_response(p);
    const T reaction = (acc.theta1 - acc.theta0) / (unit.theta1 - unit.theta0),
            common = acc.theta0 - reaction * unit.theta0;
    acc.theta0 = select(held, common, acc.theta0), acc.theta1 = select(held, common, acc.theta1);
  }
  static auto lags(const State& y) { return y.template segment<kLags>(kMechanical); }
  /// The torque that the drive requests now, Eq. 3 of what it measures [Nm].
  template <class Time>
  T requested_torque(const Time& t, const State& y) const {
    SeaState<T> s = sea_state(y);
    if constexpr (kTerms.late) s = lag.filtered(s, lags(y));
    return motor_torque<kTerms>(sea, s, reference(t));
  }
  Reference<T> held_reference() const { return {select(after(phase), piece.b, piece.a), T(0)}; }

  mutable T theta0_{std::numeric_limits<double>::quiet_NaN()}, theta1_{};
  mutable std::array<SinCos<T>, 2> sin_cos_{};
};

}  // namespace ukemi::landing
