// The landing robot as a hybrid system: Eq. 1 with the actuator of Eq. 2-4 and the floor of Sec. 2.4, one smooth mode
// at a time. State: see Component; with kAccounts three further components integrate the work of the joint torque, of
// the floor and on the motor, for the energy check.
#pragma once

#include "common/integrate/hybrid.hpp"
#include "common/trigonometry.hpp"
#include "landing/motion.hpp"
#include "landing/scene.hpp"

namespace ukemi::landing {

/// Work accounts behind the mechanical components [J].
enum Account { kWorkJoint = kMechanical, kWorkFloor, kWorkMotor, kWithAccounts };

/// Where the reference stands.
enum class Phase : unsigned char { kBefore, kMoving, kAfter };

/// Which terms a kernel is compiled with. A kernel without a term pays nothing for it.
struct LandingTerms {
  SeaTerms sea;
  bool floor;  ///< contact points that may touch
  constexpr LandingTerms(SeaTerms s, bool f = true) : sea(s), floor(f) {}
};

template <LandingTerms kAllTerms, bool kAccounts, Scalar T = double>
class LandingSystem {
  static constexpr SeaTerms kTerms = kAllTerms.sea;

 public:
  static constexpr int kControlled = kMechanical, kPositions = kVx, kGuards = 2 * kPoints + 2;
  static constexpr int kTorqueUpper = 2 * kPoints, kTorqueLower = kTorqueUpper + 1;
  using State = Eigen::Matrix<T, kAccounts ? int(kWithAccounts) : int(kMechanical), 1>;

  /// Torques and forces of a state.
  struct Field {
    Pose<T> pose;
    SeaState<T> sea;
    T tau_sea;
    Reference<T> reference;
    std::array<Vec2<T>, kPoints> force;
  };

  LandingSystem(const Scene& scene, const SeaParameters<T>& actuator, const Motion& played)
      : link(scene.robot.template cast<T>()),
        floor(scene.floor.value_or(Floor<double>{1, 0, 0}).template cast<T>()),
        sea(actuator),
        motion(played) {
    for (int j = 0; j < kPoints; ++j) present[j] = scene.floor && scene.contacts[j];
    if constexpr (kTerms.torque_limit)
      if (sea.tau_max == T(0)) saturation = 1;  // no torque at all: one branch, never left
  }

  /// The same system, in its present mode, in another scalar.
  template <class U>
  explicit LandingSystem(const LandingSystem<kAllTerms, kAccounts, U>& o)
      : link(o.link.template cast<T>()),
        floor(o.floor.template cast<T>()),
        sea(o.sea.template cast<T>()),
        motion(o.motion),
        present(o.present),
        contact(o.contact),
        saturation(o.saturation),
        phase(o.phase),
        motion_start(o.motion_start) {}

  const TwoLinkDynamics<T> link;
  const Floor<T> floor;
  const SeaParameters<T> sea;
  const Motion motion;
  std::array<bool, kPoints> present{};

  // The mode.
  std::array<Contact, kPoints> contact{};
  int saturation = 0;
  Phase phase = Phase::kBefore;
  double motion_start = 0;  ///< time of the first touchdown [s]

  /// Sines, cosines and rates of a state. The last angles are remembered: the field, the guards and the peak ask in
  /// turn.
  UKEMI_INLINE Pose<T> pose(const State& y) const {
    if (!(y[kTheta0] == theta0_ && y[kTheta1] == theta1_)) {
      theta0_ = y[kTheta0], theta1_ = y[kTheta1];
      turn_ = sin_cos(theta0_, theta1_);
    }
    return {y[kX],        y[kY],        y[kVx],       y[kVy],     turn_[0].sin,
            turn_[0].cos, turn_[1].sin, turn_[1].cos, y[kOmega0], y[kOmega1]};
  }

  template <class Time>
  Reference<T> reference(const Time& t) const {
    if (phase == Phase::kMoving)
      return quintic(T(motion.phi_i), T(motion.phi_f), T(motion.duration), T(t - motion_start));
    return {T(phase == Phase::kBefore ? motion.phi_i : motion.phi_f), T(0)};
  }

  static SeaState<T> sea_state(const State& y) {
    return {y[kTheta1] - y[kTheta0], y[kPhiM], y[kOmega1] - y[kOmega0], y[kOmegaM]};
  }

  /// Force of the floor on a point that is below y = 0, in its present mode [N].
  UKEMI_INLINE Vec2<T> force(const Pose<T>& p, int j) const {
    return {tangential_force(floor, velocity_x(link, p, j)),
            contact[j] == Contact::kPressed ? normal_force(floor, height(link, p, j), velocity_y(link, p, j)) : T(0)};
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
    Loads<T> load;
    [[maybe_unused]] T floor_power(0);
    if constexpr (kAllTerms.floor)
      for (int j = 0; j < kPoints; ++j)
        if (contact[j] != Contact::kClear) {
          const Vec2<T> f = force(p, j);
          load.add(link, p, j, f.x(), f.y());
          if constexpr (kAccounts) floor_power += f.x() * velocity_x(link, p, j) + f.y() * velocity_y(link, p, j);
        }
    const SeaState<T> joint = sea_state(y);
    const T tau = limited_torque<kTerms>(sea, spring_torque<kTerms>(sea, joint), saturation);
    const Accelerations<T> acc = solve(link, p, tau, load);
    for (int i = 0; i < kVx; ++i) dy[i] = y[kVx + i];
    dy[kVx] = acc.x, dy[kVy] = acc.y, dy[kOmega0] = acc.theta0, dy[kOmega1] = acc.theta1;
    dy[kOmegaM] = motor_acceleration<kTerms>(sea, joint, reference(t), tau);
    if constexpr (kAccounts) {
      dy[kWorkJoint] = tau * joint.dphi;
      dy[kWorkFloor] = floor_power;
      dy[kWorkMotor] = sea.i_motor * dy[kOmegaM] * y[kOmegaM];
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
    Field f{pose(y), sea_state(y), T(0), reference(t), {}};
    for (int j = 0; j < kPoints; ++j)
      f.force[j] = contact[j] == Contact::kClear ? Vec2<T>(T(0), T(0)) : force(f.pose, j);
    f.tau_sea = limited_torque<kTerms>(sea, spring_torque<kTerms>(sea, f.sea), saturation);
    return f;
  }

  T motor_torque_of(const Field& f) const { return motor_torque<kTerms>(sea, f.sea, f.reference); }

  /// Guards: heights 0..2, normal forces 3..5, torque limit 6, 7; `dy` is the field at y.
  void guards(double, const State& y, const State& dy, integrate::Guards<kGuards>& out) const {
    out = {};
    const Accelerations<T> acc{dy[kVx], dy[kVy], dy[kOmega0], dy[kOmega1]};
    if constexpr (kAllTerms.floor) contact_guards(pose(y), acc, out);
    if constexpr (kTerms.torque_limit) {
      if (value_of(sea.tau_max) == 0) return;
      const SeaState<T> s = sea_state(y);
      const double tau = value_of(spring_torque<kTerms>(sea, s)), limit = value_of(sea.tau_max),
                   rate = value_of(spring_torque_rate<kTerms>(sea, s, T(acc.theta1 - acc.theta0), dy[kOmegaM]));
      if (saturation >= 0) out.set(kTorqueUpper, saturation ? tau - limit : limit - tau, saturation ? rate : -rate);
      if (saturation <= 0) out.set(kTorqueLower, saturation ? -limit - tau : limit + tau, saturation ? -rate : rate);
    }
  }

  void contact_guards(const Pose<T>& p, const Accelerations<T>& acc, integrate::Guards<kGuards>& out) const {
    for (int j = 0; j < kPoints; ++j) {
      if (!present[j]) continue;
      const T h = height(link, p, j), v = velocity_y(link, p, j);
      const double side = contact[j] == Contact::kClear ? 1 : -1;
      out.set(j, side * value_of(h), side * value_of(v));
      if (contact[j] == Contact::kClear || value_of(floor.damping_normal) == 0) continue;
      const double sign = contact[j] == Contact::kPressed ? 1 : -1;
      out.set(kPoints + j, sign * value_of(normal_force(floor, h, v)),
              sign * value_of(normal_force_rate(floor, v, acceleration_y(link, p, acc, j))));
    }
  }

  /// The mode beyond the zero of guard `i`.
  void cross(int i) {
    if (i < kPoints) {
      contact[i] = contact[i] == Contact::kClear ? Contact::kPressed : Contact::kClear;
    } else if (i < kTorqueUpper) {
      Contact& c = contact[i - kPoints];
      c = c == Contact::kPressed ? Contact::kLoose : Contact::kPressed;
    } else {
      saturation = saturation ? 0 : (i == kTorqueUpper ? 1 : -1);
    }
  }

  /// Sizes below which a component need not be relatively exact: a link's length, 1 rad, and those at 10 1/s.
  double tolerance_unit(int i) const {
    constexpr double kRate = 10;
    const double length = 2 * value_of(link.a);
    const double unit = i == kX || i == kY || i == kVx || i == kVy ? length : 1;
    return i >= kVx ? unit * kRate : unit;
  }

  /// Potential and kinetic energy of the links, and the motor's kinetic energy [J].
  T link_energy(const State& y) const { return kinetic_energy(link, pose(y)) + link.total_mass * link.gravity * y[kY]; }
  T motor_energy(const State& y) const { return T(0.5) * sea.i_motor * y[kOmegaM] * y[kOmegaM]; }

 private:
  mutable T theta0_{std::numeric_limits<double>::quiet_NaN()}, theta1_{};
  mutable std::array<SinCos<T>, 2> turn_{};
};

}  // namespace ukemi::landing
