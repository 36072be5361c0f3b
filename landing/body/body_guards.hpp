// The guards of a robot of links: touchdown and lift-off, forces that change sign, sliding, torque limits.
#pragma once

#include <limits>

#include "common/integrate/guards.hpp"
#include "landing/body/contact.hpp"
#include "landing/body/joint.hpp"

namespace ukemi::landing {

/// CRTP base of BodySystem, whose mode and robot it uses; T is the scalar.
template <class System, class T>
class BodyGuards {
 public:
  /// All guards; G: doubles, scalars with derivatives, or lanes.
  template <class Time, class G, class State, int kGuards>
  void guards(const Time& t, const State& y, const State& dy, integrate::Guards<kGuards, G>& out) const {
    const System& self = system();
    out = {};
    const auto p = self.pose(y);
    const auto acc = self.accelerations_of(dy);
    contact_guards(p, acc, y, dy, out);
    for (int i = 0; i < self.body.joints; ++i) joint_guards(i, t, y, dy, out);
    if constexpr (!System::kPlainDrives)
      if (self.has_friction) [[unlikely]]
        self.friction_guards(System::kFrictionGuards, t, y, dy, out);
  }
  int guards_used() const { return system().has_friction ? System::kGuards : System::kFrictionGuards; }
  template <class G, class State, class Pose, class Accelerations, int kGuards>
  void contact_guards(const Pose& p, const Accelerations& acc, const State& y, const State& dy,
                      integrate::Guards<kGuards, G>& out) const {
    const System& self = system();
    for (int i = 0; i < System::kC; ++i) {
      if (i >= self.body.contacts) break;  // a constant bound is unrolled
      if constexpr (!kIsPack<T>)
        if (!self.contact[i].touching) {  // its guard needs no acceleration
          surface_guard(i, self.point_at(i, p), out);
          continue;
        }
      point_guards(i, self.point_at(i, p, &acc), y, dy, out);
    }
    if (self.has_stops()) [[unlikely]]
      stop_guards(p, acc, y, dy, out);
  }
  template <class G, class State, class Pose, class Accelerations, int kGuards>
  [[gnu::noinline]] void stop_guards(const Pose& p, const Accelerations& acc, const State& y, const State& dy,
                                     integrate::Guards<kGuards, G>& out) const {
    const System& self = system();
    for (int i = self.body.stops_begin; i < self.body.stops_end; ++i)
      point_guards(i, self.stop_at(i, p, y, &acc), y, dy, out);
  }
  template <class G, class Point, int kGuards>
  void surface_guard(int i, const Point& at, integrate::Guards<kGuards, G>& out) const {
    const System& self = system();
    const auto touching = self.contact[i].touching;
    const G height = narrowed<G>(T(at.y - self.point[i].thickness)), speed = narrowed<G>(at.v);
    out.set(System::kGuardsPerContact * i + System::kSurface, select(touching, G(-height), height),
            select(touching, G(-speed), speed));
  }
  /// Guards of a contact at its present height.
  template <class G, class State, class Point, int kGuards>
  void point_guards(int i, const Point& at, const State& y, const State& dy, integrate::Guards<kGuards, G>& out) const {
    const System& self = system();
    const ContactConstants<T>& x = self.point[i];
    const auto& m = self.contact[i];
    const int first = System::kGuardsPerContact * i;
    surface_guard(i, at, out);
    const auto touching = m.touching;
    if (!any(touching)) return;
    const WithRate<T> floor = floor_force(x, at.y, at.v, at.a);
    if (self.is_padded(i)) {
      const WithRate<T> pad = pad_force(x, at.y, at.v, at.a);
      set_guard(out, first + System::kPadForce, m.pad, pad.value, pad.rate, touching);
      set_guard(out, first + System::kBottom, !m.below, at.y, at.v, touching);
    }
    if (!(x.hunt_crossley && !any(x.dissipation != T(0))))
      set_guard(out, first + System::kFloorForce, m.floor, floor.value, floor.rate, m.below);
    if constexpr (System::kStraight) return;
    if (!x.has_friction) return;
    const WithRate<T> normal = normal_force(x, m, at.y, at.v, at.a);
    const T f = self.sticking_force(i, y, at), df = x.k_t * dy[System::kSlip + i] + x.c_t * at.a_t;
    const T limit = x.mu * normal.value + T(kStickTolerance), d_limit = x.mu * normal.rate;
    const auto forward = slides_forward(m), back = slides_back(m);
    const auto sticks = touching & !forward & !back;
    set_guard(out, first + System::kSlideUp, sticks, T(limit - select(back, T(-f), f)),
              T(d_limit - select(back, T(-df), df)), touching);
    set_guard(out, first + System::kSlideDown, sticks, T(limit + f), T(d_limit + df), sticks);
  }
  template <class Time, class G, class State, int kGuards>
  void joint_guards(int i, const Time& t, const State& y, const State& dy, integrate::Guards<kGuards, G>& out) const {
    const System& self = system();
    const JointConstants<T>& d = self.drive[i];
    if (self.kind(i) == DriveKind::kPassive) return;
    using Value = typename System::Value;
    const Value limit = value_of(d.sea.tau_max);
    const auto limited = (limit > Value(0)) & (limit < Value(std::numeric_limits<double>::infinity()));
    if (!any(limited)) return;
    const SeaState<T> s = self.joint_state(i, y);
    const int parent = self.parent_of(i);
    const T ddphi = dy[System::kOmega + self.child_of(i)] - (parent < 0 ? T(0) : T(dy[System::kOmega + parent]));
    T tau, rate;
    if (self.kind(i) == DriveKind::kElastic) {
      tau = spring_torque<System::kSea>(d.sea, s);
      rate = spring_torque_rate<System::kSea>(d.sea, s, ddphi, T(dy[System::kOmegaM + i]));
    } else {
      constexpr double kStep = 1e-7;  // for the reference's acceleration by a difference [s]
      const Reference<T> r = self.reference(i, t), next = self.reference(i, t + Time(kStep));
      tau = self.geared_torque(i, t, s);
      rate = d.sea.k_p * (r.dphi - s.dphi) + d.sea.k_d * ((next.dphi - r.dphi) / T(kStep) - ddphi);
    }
    const auto upper = at_upper(self.joint[i].saturation), lower = at_lower(self.joint[i].saturation);
    const int first = System::kJointGuards + System::kGuardsPerJoint * i;
    set_guard(out, first + System::kUpper, upper, T(tau - d.sea.tau_max), rate, limited & !lower);
    set_guard(out, first + System::kLower, !lower, T(tau + d.sea.tau_max), rate, limited & !upper);
  }

 private:
  /// `holds`: whether `value` is positive in the mode.
  template <int kGuards, class G, class Holds, class Active>
  UKEMI_INLINE static void set_guard(integrate::Guards<kGuards, G>& out, int guard, const Holds& holds, const T& value,
                                     const T& rate, const Active& active) {
    const G v = narrowed<G>(value), r = narrowed<G>(rate);
    out.set(guard, select(holds, v, G(-v)), select(holds, r, G(-r)), active);
  }
  const System& system() const { return static_cast<const System&>(*this); }
};

}  // namespace ukemi::landing
