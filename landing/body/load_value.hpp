// What a robot's parts bear at a state of a run, in any scalar: a double, derivatives, lanes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "landing/body/body_scene.hpp"
#include "landing/body/body_system.hpp"

namespace ukemi::landing {

/// Force of contact i on the robot, in the floor's frame: along it and normal to it [N].
template <class System>
Vec2<typename System::State::Scalar> contact_force(const System& s, int i, const typename System::Pose& p,
                                                   const typename System::State& y) {
  using T = typename System::State::Scalar;
  const auto& m = s.contact[i];
  if (!any(m.touching)) return {T(0), T(0)};
  const auto at = s.point_at(i, p);
  const T normal = normal_force(s.point[i], m, at.y, at.v, T(0)).value;
  return {masked(m.touching, T(-tangential_force(s.point[i], m, s.held(i, y, at), normal))),
          masked(m.touching, normal)};
}

/// Of a driven joint: torque of its motor [Nm].
template <class System, class Time>
typename System::State::Scalar torque_of_motor(const System& s, int i, const Time& t,
                                               const SeaState<typename System::State::Scalar>& q) {
  const auto& drive = s.drive[i];
  return drive.kind == DriveKind::kGeared
             ? limited_torque<System::kSea>(drive.sea, s.geared_torque(i, t, q), s.joint[i].saturation)
             : motor_torque<System::kSea>(drive.sea, q, s.reference(i, t));
}

/// Where in a step, and by which weight, a force is integrated: Gauss and Legendre's five points.
inline constexpr std::array<std::array<double, 2>, 5> kImpulseNodes = {{{0.5, 0.28444444444444444},
                                                                        {0.23076534494715845, 0.23931433524968324},
                                                                        {0.7692346550528415, 0.23931433524968324},
                                                                        {0.04691007703066802, 0.11846344252809454},
                                                                        {0.9530899229693319, 0.11846344252809454}}};

/// The square by which a run with loads is judged to rest: of the smallest acceleration that is asked for; where
/// another load stands near its largest value, of a ten-thousandth of it.
class RestSquare {
 public:
  explicit RestSquare(double own) : square_(own) {}  ///< of the acceleration that counts
  /// The largest square of a load so far, and that at the end of the last step.
  void add(Load::Kind kind, double largest, double last) {
    constexpr double kNear = 0.81;
    if (largest == 0) return;
    if (kind == Load::Kind::kAcceleration)
      square_ = std::min(square_, largest);
    else
      near_ = near_ || last > kNear * largest;
  }
  double value() const { return near_ ? 1e-8 * square_ : square_; }

 private:
  double square_;
  bool near_ = false;
};

/// A load on a system: one that has its value at every state, neither a touch nor an impulse.
template <class System>
class LoadValue {
 public:
  using T = typename System::State::Scalar;
  using State = typename System::State;
  using Kind = Load::Kind;

  LoadValue(const Load& load, const System& s) : load_(load), index_(load.index) {
    if (load.kind == Kind::kAcceleration)
      arms_ = shifted(s.body, s.body.origin[std::size_t(load.index)], load.index, load.at);
    for (int i = 0; i < s.body.joints; ++i)
      if (of_joint(load.kind) && s.body.joint[i].joint == load.index) index_ = i;
  }
  const Load& load() const { return load_; }
  const Arms<T, System::kB>& arms() const { return arms_; }
  /// Takes the lever arms of the same load on another system, for one that lacks Body::origin; set(T&, its number).
  template <class Other, class Set>
  void take_arms(const Other& of, Set&& set) {
    Arms<T, System::kB>::for_each(arms_, of.arms(), set);
  }

  /// The square of what is tracked: the load; of an angle its distance from the middle of the range.
  template <class Time>
  T square(const System& s, const Time& t, const State& y, const State& dy) const {
    if (load_.kind == Kind::kAcceleration)
      return acceleration(arms_, s.pose(y), s.accelerations_of(dy), s.body.bodies).squaredNorm();
    if (load_.kind == Kind::kForce)
      return index_ < s.body.contacts ? contact_force(s, index_, s.pose(y), y).squaredNorm() : T(0);
    const SeaState<T> q = s.joint_state(index_, y);
    const auto& drive = s.drive[index_];
    switch (load_.kind) {
      case Kind::kDeflection:
        return squared(q.phi_m - q.phi);
      case Kind::kMotorSpeed:
        return squared(drive.kind == DriveKind::kGeared ? q.dphi : q.dphi_m);
      case Kind::kAngle:
        return squared(q.phi - T(middle()));
      case Kind::kMotorTorque:
        return drive.kind == DriveKind::kGeared ? geared(s, t, q) : squared(torque_of_motor(s, index_, t, q));
      default:
        break;
    }
    if (drive.kind == DriveKind::kGeared) return geared(s, t, q);
    if (drive.kind == DriveKind::kPassive)
      return squared(drive.stiffness * (q.phi - drive.rest) + drive.damping * q.dphi);
    return limited(squared(spring_torque<System::kSea>(drive.sea, q)), drive.sea.tau_max);
  }
  /// The load from what is tracked.
  template <class U>
  U value(const U& tracked) const {
    if (load_.kind != Kind::kAngle) return tracked;
    const U beyond = tracked - U(half_range(load_));
    return beyond < U(0.0) ? U(0.0) : beyond;
  }
  /// What is tracked where the load has a value: that of a rating.
  double tracked(double value) const { return value + half_range(load_); }
  /// Of an angle; else 0.
  static double half_range(const Load& l) { return l.kind == Kind::kAngle ? 0.5 * (l.phi[1] - l.phi[0]) : 0; }

 private:
  static bool of_joint(Kind k) {
    return k == Kind::kTorque || k == Kind::kDeflection || k == Kind::kMotorSpeed || k == Kind::kMotorTorque ||
           k == Kind::kAngle;
  }
  static T squared(const T& x) { return x * x; }
  double middle() const { return 0.5 * (load_.phi[0] + load_.phi[1]); }
  /// A step may end a rounding beyond the limit of a torque.
  static T limited(const T& square, const T& limit) {
    const T most = limit * limit;
    return select(square > most, most, square);
  }
  template <class Time>
  T geared(const System& s, const Time& t, const SeaState<T>& q) const {
    return limited(squared(torque_of_motor(s, index_, t, q)), s.drive[index_].sea.tau_max);
  }

  Load load_;
  int index_;  ///< of the system's joints or contacts
  Arms<T, System::kB> arms_{};
};

}  // namespace ukemi::landing
