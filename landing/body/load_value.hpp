// Loads on a robot's parts in a state of a run, for any scalar: double, derivatives, lanes.
#pragma once

#include <algorithm>
#include <array>

#include "landing/body/body_scene.hpp"
#include "landing/body/body_system.hpp"

namespace ukemi::landing {

/// Force of contact i on the robot, along and normal to the floor [N].
template <class System>
Vec2<typename System::State::Scalar> contact_force(const System& s, int i, const typename System::Pose& p,
                                                   const typename System::State& y) {
  using T = typename System::State::Scalar;
  const auto& m = s.contact[i];
  if (!any(m.touching)) return {T(0), T(0)};
  const auto at = s.point_at(i, p);
  const T normal = normal_force(s.point[i], m, at.y, at.v, T(0)).value;
  return {masked(m.touching, T(-tangential_force(s.point[i], m, s.sticking_force(i, y, at), normal))),
          masked(m.touching, normal)};
}

/// Torque of the motor of a driven joint [Nm].
template <class System, class Time>
typename System::State::Scalar motor_torque_at(const System& s, int i, const Time& t, const typename System::State& y) {
  const auto& drive = s.drive[i];
  const auto q = s.joint_state(i, y);
  return drive.kind == DriveKind::kGeared
             ? limited_torque<System::kSea>(drive.sea, s.geared_torque(i, t, q), s.joint[i].saturation)
             : s.elastic_motor_torque(i, t, y, q);
}

/// Nodes in a step (0..1) and weights of the five-point Gauss-Legendre rule, for integrals of forces.
inline constexpr std::array<std::array<double, 2>, 5> kImpulseNodes = {{{0.5, 0.28444444444444444},
                                                                        {0.23076534494715845, 0.23931433524968324},
                                                                        {0.7692346550528415, 0.23931433524968324},
                                                                        {0.04691007703066802, 0.11846344252809454},
                                                                        {0.9530899229693319, 0.11846344252809454}}};

/// Square of the acceleration for the rest test of a run with loads: the smallest maximum of an acceleration; a
/// ten-thousandth of it while any other load is close to its maximum, or a kept limit close to its rating.
class RestSquare {
 public:
  explicit RestSquare(double peak_square) : square_(peak_square) {}  ///< of the peak point
  /// `largest`: reference_square of a load; `last`: its square at the end of the last step.
  void add(Load::Kind kind, double largest, double last) {
    constexpr double kNear = 0.81;
    if (largest == 0) return;
    if (kind == Load::Kind::kAcceleration)
      square_ = std::min(square_, largest);
    else
      near_maximum_ = near_maximum_ || last > kNear * largest;
  }
  double value() const { return near_maximum_ ? 1e-8 * square_ : square_; }

 private:
  double square_;
  bool near_maximum_ = false;
};

/// Whether a load is a function of the state: not a touch, an impulse or a rate of a reference.
inline bool is_state_function(Load::Kind k) {
  return k != Load::Kind::kTouch && k != Load::Kind::kImpulse && k != Load::Kind::kReferenceRate;
}

/// An angle this little beyond its range is at its end [rad].
inline constexpr double kAngleTolerance = 1e-12;
/// Half the range of an angle; 0 for other loads.
inline double half_range(const Load& l) { return l.kind == Load::Kind::kAngle ? 0.5 * (l.phi[1] - l.phi[0]) : 0; }
/// The quantity that LoadValue tracks, from the value of a load.
inline double tracked_value(const Load& l, double value) {
  return value + half_range(l) + (l.kind == Load::Kind::kAngle ? kAngleTolerance : 0);
}
/// The largest square so far for RestSquare; for a limit `limit_square` until it is broken, then 0.
inline double reference_square(const Load& l, double square, double limit_square) {
  return !l.limit ? square : square > limit_square ? 0 : limit_square;
}
inline double reference_square(const Load& l, double square) {
  const double limit = tracked_value(l, l.rating);
  return reference_square(l, square, limit * limit);
}

/// Evaluates a load that is a function of the state.
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
  /// Copies the lever arms of the same load on another system, for systems without Body::origin, by set(T&, number).
  template <class Other, class Set>
  void copy_arms(const Other& of, Set&& set) {
    Arms<T, System::kB>::for_each(arms_, of.arms(), set);
  }

  /// Square of the tracked quantity: the load or, for an angle, its distance from the middle of its range.
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
        return drive.kind == DriveKind::kGeared ? geared(s, t, y) : squared(motor_torque_at(s, index_, t, y));
      default:
        break;
    }
    if (drive.kind == DriveKind::kGeared) return geared(s, t, y);
    if (drive.kind == DriveKind::kPassive)
      return squared(drive.stiffness * (q.phi - drive.rest) + drive.damping * q.dphi);
    return limited(squared(spring_torque<System::kSea>(drive.sea, q)), drive.sea.tau_max);
  }
  /// The load from the tracked quantity.
  template <class U>
  U value(const U& x) const {
    if (load_.kind != Kind::kAngle) return x;
    const U beyond = x - U(half_range(load_));
    return beyond < U(kAngleTolerance) ? U(0.0) : beyond;
  }

 private:
  static bool of_joint(Kind k) {
    return k == Kind::kTorque || k == Kind::kDeflection || k == Kind::kMotorSpeed || k == Kind::kMotorTorque ||
           k == Kind::kAngle;
  }
  static T squared(const T& x) { return x * x; }
  double middle() const { return 0.5 * (load_.phi[0] + load_.phi[1]); }
  /// A step may end beyond a torque limit by a rounding error.
  static T limited(const T& square, const T& limit) {
    const T largest = limit * limit;
    return select(square > largest, largest, square);
  }
  template <class Time>
  T geared(const System& s, const Time& t, const State& y) const {
    return limited(squared(motor_torque_at(s, index_, t, y)), s.drive[index_].sea.tau_max);
  }

  Load load_;
  int index_;  ///< of the system's joints or contacts
  Arms<T, System::kB> arms_{};
};

}  // namespace ukemi::landing
