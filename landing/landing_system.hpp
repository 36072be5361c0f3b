// The landing robot as a hybrid system: Eq. 1 with the actuator of Eq. 2-4 and the floor of Sec. 2.4, one smooth mode
// at a time. State: see Component; with kAccounts three further components integrate the work of the joint torque, of
// the floor and on the motor, for the energy check.
#pragma once

#include "common/integrate/hybrid.hpp"
#include "landing/motion.hpp"
#include "landing/scene.hpp"

namespace ukemi::landing {

/// Work accounts behind the mechanical components [J].
enum Account { kWorkJoint = kMechanical, kWorkFloor, kWorkMotor, kWithAccounts };

/// Where the reference stands.
enum class Phase : unsigned char { kBefore, kMoving, kAfter };

template <SeaTerms kTerms, bool kAccounts, Scalar T = double>
class LandingSystem {
 public:
  static constexpr int kControlled = kMechanical, kGuards = 2 * kPoints + 2;
  static constexpr int kTorqueUpper = 2 * kPoints, kTorqueLower = kTorqueUpper + 1;
  using State = Eigen::Matrix<T, kAccounts ? int(kWithAccounts) : int(kMechanical), 1>;

  /// Everything that one evaluation of the field yields.
  struct Field {
    Pose<T> pose;
    SeaState<T> sea;
    T tau_sea;
    Reference<T> reference;
    std::array<Vec2<T>, kPoints> force;
    Accelerations<T> acc;
    T ddphi_m;
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
  Pose<T> pose(const State& y) const {
    if (!(y[kTheta0] == theta0_ && y[kTheta1] == theta1_)) {
      using std::cos, std::sin;
      theta0_ = y[kTheta0], theta1_ = y[kTheta1];
      s0_ = sin(theta0_), c0_ = cos(theta0_), s1_ = sin(theta1_), c1_ = cos(theta1_);
    }
    return {y[kX], y[kY], y[kVx], y[kVy], s0_, c0_, s1_, c1_, y[kOmega0], y[kOmega1]};
  }

  Reference<T> reference(double t) const {
    if (phase == Phase::kMoving)
      return quintic(T(motion.phi_i), T(motion.phi_f), T(motion.duration), T(t - motion_start));
    return {T(phase == Phase::kBefore ? motion.phi_i : motion.phi_f), T(0)};
  }

  static SeaState<T> sea_state(const State& y) {
    return {y[kTheta1] - y[kTheta0], y[kPhiM], y[kOmega1] - y[kOmega0], y[kOmegaM]};
  }

  /// Eq. 1-4 and Sec. 2.4 in the present mode.
  Field evaluate(double t, const State& y) const {
    Field f{.pose = pose(y),
            .sea = sea_state(y),
            .tau_sea = T(0),
            .reference = reference(t),
            .force = {},
            .acc = {},
            .ddphi_m = T(0)};
    Loads<T> load;
    for (int j = 0; j < kPoints; ++j) {
      f.force[j].setZero();
      if (contact[j] == Contact::kClear) continue;
      f.force[j].x() = tangential_force(floor, velocity_x(link, f.pose, j));
      if (contact[j] == Contact::kPressed)
        f.force[j].y() = normal_force(floor, height(link, f.pose, j), velocity_y(link, f.pose, j));
      load.add(link, f.pose, j, f.force[j].x(), f.force[j].y());
    }
    f.tau_sea = limited_torque<kTerms>(sea, spring_torque<kTerms>(sea, f.sea), saturation);
    f.acc = solve(link, f.pose, f.tau_sea, load);
    f.ddphi_m = motor_acceleration<kTerms>(sea, f.sea, f.reference, f.tau_sea);
    return f;
  }

  State derivative(double t, const State& y) const {
    const Field f = evaluate(t, y);
    State dy;
    for (int i = 0; i < kVx; ++i) dy[i] = y[kVx + i];
    dy[kVx] = f.acc.x, dy[kVy] = f.acc.y, dy[kOmega0] = f.acc.theta0, dy[kOmega1] = f.acc.theta1,
    dy[kOmegaM] = f.ddphi_m;
    if constexpr (kAccounts) {
      dy[kWorkJoint] = f.tau_sea * f.sea.dphi;
      T floor_power(0);
      for (int j = 0; j < kPoints; ++j)
        if (contact[j] != Contact::kClear)
          floor_power += f.force[j].x() * velocity_x(link, f.pose, j) + f.force[j].y() * velocity_y(link, f.pose, j);
      dy[kWorkFloor] = floor_power;
      dy[kWorkMotor] = sea.i_motor * f.ddphi_m * y[kOmegaM];
    }
    return dy;
  }

  T motor_torque_of(const Field& f) const { return motor_torque<kTerms>(sea, f.sea, f.reference); }

  /// Guards: heights 0..2, normal forces 3..5, torque limit 6, 7; `dy` is the field at y.
  void guards(double, const State& y, const State& dy, integrate::Guards<kGuards>& out) const {
    out = {};
    const Pose<T> p = pose(y);
    const Accelerations<T> acc{dy[kVx], dy[kVy], dy[kOmega0], dy[kOmega1]};
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
    if constexpr (kTerms.torque_limit) {
      if (value_of(sea.tau_max) == 0) return;
      const SeaState<T> s = sea_state(y);
      const double tau = value_of(spring_torque<kTerms>(sea, s)), limit = value_of(sea.tau_max),
                   rate = value_of(spring_torque_rate<kTerms>(sea, s, T(acc.theta1 - acc.theta0), dy[kOmegaM]));
      if (saturation >= 0) out.set(kTorqueUpper, saturation ? tau - limit : limit - tau, saturation ? rate : -rate);
      if (saturation <= 0) out.set(kTorqueLower, saturation ? -limit - tau : limit + tau, saturation ? -rate : rate);
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
  mutable T theta0_{std::numeric_limits<double>::quiet_NaN()}, theta1_{}, s0_{}, c0_{}, s1_{}, c1_{};
};

}  // namespace ukemi::landing
