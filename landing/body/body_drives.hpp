// The drives of a robot of links: references, torques on links and motors, delays, dry friction's levels.
#pragma once

#include <array>

#include "landing/body/joint.hpp"
#include "landing/model/dry_friction.hpp"
#include "landing/model/motion.hpp"

namespace ukemi::landing {

/// CRTP base of BodySystem, whose mode and robot it uses; T is the scalar.
template <class System, class T>
class BodyDrives {
 public:
  template <class Time>
  Reference<T> reference(int i, const Time& t) const {
    const System& self = system();
    const ReferencePiece<T>& r = self.piece[i];
    const auto& phase = self.joint[i].phase;
    const T constant = select(after(phase), r.b, r.a);
    if (!any(moving(phase))) return {constant, T(0)};
    const Reference<T> played = r.at(T(t), self.shaped);
    return {select(moving(phase), played.phi, constant), masked(moving(phase), played.dphi)};
  }

  /// Torque of joint i on its child [Nm]; of an elastic drive also the motor's acceleration and, in `dy`, lag rates.
  template <class Time, class State>
  T torque(int i, const Time& t, const State& y, T* motor = nullptr, State* dy = nullptr) const {
    const System& self = system();
    const JointConstants<T>& d = self.drive[i];
    const SeaState<T> s = self.joint_state(i, y);
    return joint_torque(i, s, motor, [&]() UKEMI_INLINE_LAMBDA {
      if (self.kind(i) == DriveKind::kGeared)
        return limited_torque<System::kSea>(d.sea, geared_torque(i, t, s), self.joint[i].saturation);
      return elastic_motor_torque(i, t, y, s, dy);
    });
  }
  /// Torques of all joints on their children, less the reactions of sticking friction [Nm].
  template <class Time, class State>
  auto torques(const Time& t, const State& y) const {
    const System& self = system();
    std::array<T, System::kJ> out{};
    for (int i = 0; i < self.body.joints; ++i) out[i] = torque(i, t, y);
    if constexpr (System::kPlainDrives) return out;
    if (!self.has_friction || !any(self.any_stuck())) return out;
    const auto hold = self.holds(t, y);
    for (int i = 0; i < self.body.joints; ++i) out[i] -= masked(self.stuck(i, kOutputSide), hold[kSides * i].torque);
    return out;
  }
  /// Torque of the motor of an elastic drive, delayed if the drive is late [Nm].
  template <class Time, class State>
  UKEMI_INLINE T elastic_motor_torque(int i, const Time& t, const State& y, const SeaState<T>& s,
                                      [[maybe_unused]] State* dy = nullptr) const {
    const System& self = system();
    if constexpr (System::kSize.late) {
      const auto x = y.template segment<System::kLags>(System::kLag + System::kLags * i);
      const DriveLag<T> lag(self.drive[i].sea);
      const T requested = requested_torque(i, t, lag.filtered(s, x));
      if (dy) dy->template segment<System::kLags>(System::kLag + System::kLags * i) = lag.derivative(requested, s, x);
      return lag.torque(requested, x);
    } else {
      return requested_torque(i, t, s);
    }
  }
  /// Eq. 3 for the state that an elastic drive measures [Nm].
  template <class Time>
  UKEMI_INLINE T requested_torque(int i, const Time& t, const SeaState<T>& s) const {
    const System& self = system();
    const JointConstants<T>& d = self.drive[i];
    return self.extended(i) ? motor_torque<System::kSea>(d.sea, s, reference(i, t))
                            : motor_torque<System::kPlainSea>(d.sea, s, reference(i, t));
  }
  /// Sets the states of late drives as if the rates of y and the torque requested(i, state) had always been constant.
  template <class Requested, class State>
  void settle_lags(State& y, Requested&& requested) const {
    const System& self = system();
    if constexpr (System::kSize.late)
      for (int i = 0; i < self.body.joints; ++i) {
        if (self.drive[i].kind != DriveKind::kElastic) continue;
        const SeaState<T> s = self.joint_state(i, y);
        y.template segment<System::kLags>(System::kLag + System::kLags * i) =
            DriveLag<T>(self.drive[i].sea).steady(requested(i, s), s);
      }
  }
  /// The same with Eq. 3 at t.
  template <class Time, class State>
  void settle_lags_at(const Time& t, State& y) const {
    settle_lags(y, [&](int i, const SeaState<T>& s) { return requested_torque(i, t, s); });
  }
  /// The torque of joint i on its child, its motor's torque being requested() [Nm]; `motor`: as in torque().
  template <class Requested>
  UKEMI_INLINE T joint_torque(int i, const SeaState<T>& s, T* motor, Requested&& requested) const {
    const System& self = system();
    const JointConstants<T>& d = self.drive[i];
    T out(0), tau(0);
    if constexpr (!System::kStraight) out = -d.parallel_stiffness * (s.phi - d.parallel_rest);
    if (self.kind(i) == DriveKind::kElastic) {
      tau = elastic_torque(i, s);
      if (self.extended(i)) {
        out += output_torque<System::kSea>(d.sea, s.dphi, tau);
        if (motor) *motor = torque_on_motor<System::kSea>(d.sea, s.dphi_m, requested(), tau);
        if (motor && d.has_friction[kMotorSide])
          *motor = masked(!self.stuck(i, kMotorSide), T(*motor - coulomb(i, kMotorSide, s.dphi_m, tau)));
      } else {
        out += tau;
        if (motor) *motor = torque_on_motor<System::kPlainSea>(d.sea, s.dphi_m, requested(), tau);
      }
      if (motor) *motor *= d.inverse_i_motor;
    } else if (self.kind(i) == DriveKind::kGeared) {
      tau = requested();
      out += tau;
      if (self.extended(i)) out -= d.sea.viscous * s.dphi;
    } else {
      out -= d.stiffness * (s.phi - d.rest) + d.damping * s.dphi;
    }
    if (!System::kPlainDrives && d.has_friction[kOutputSide]) out -= coulomb(i, kOutputSide, s.dphi, tau);
    return out;
  }
  /// Torque of the spring of an elastic drive in its mode [Nm].
  UKEMI_INLINE T elastic_torque(int i, const SeaState<T>& s) const {
    const System& self = system();
    return limited_torque<System::kSea>(self.drive[i].sea, spring_torque<System::kSea>(self.drive[i].sea, s),
                                        self.joint[i].saturation);
  }
  template <class Time>
  T geared_torque(int i, const Time& t, const SeaState<T>& s) const {
    const System& self = system();
    const Reference<T> r = reference(i, t);
    return self.drive[i].sea.k_p * (r.phi - s.phi) + self.drive[i].sea.k_d * (r.dphi - s.dphi);
  }

  /// Mean dry friction of a side of joint i at torque tau [Nm], and its asymmetry. A geared motor's is on the output.
  T mean_friction(int i, Side side, const T& tau) const {
    const System& self = system();
    const JointConstants<T>& d = self.drive[i];
    if (side == kOutputSide && d.kind == DriveKind::kElastic) return d.sea.output_friction;
    return d.kind == DriveKind::kPassive ? d.sea.friction : loaded_friction(d.sea.friction, d.sea.spring_loss, tau);
  }
  const T& asymmetry(int i, Side side) const {
    const System& self = system();
    const bool output = side == kOutputSide && self.drive[i].kind == DriveKind::kElastic;
    return output ? self.drive[i].sea.output_friction_asymmetry : self.drive[i].sea.friction_asymmetry;
  }
  /// Dry friction on a side that slips at the rate v [Nm].
  T coulomb(int i, Side side, const T& v, const T& tau) const {
    const System& self = system();
    return coulomb_torque(self.drive[i].sea, mean_friction(i, side, tau), asymmetry(i, side),
                          direction_of<T>(self.joint[i].slip[side]), v);
  }

 private:
  const System& system() const { return static_cast<const System&>(*this); }
};

}  // namespace ukemi::landing
