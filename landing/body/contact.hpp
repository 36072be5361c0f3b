// The floor under a point at the height y over it. Ours, but for the first line of the normal force and the viscous
// part of the tangential one, which are Sec. 2.4 of [1].
//
//     normal      F_n = max(0, -K y - C dy)                     below y = 0
//                   or max(0, K delta^p (1 + c ddelta)), delta = -y               (Hunt, Crossley, J. Appl. Mech. 1975)
//                 + max(0, K_p (d - y) - C_p dy)                below y = d, of a pad of thickness d
//     tangential  F_t = -clamp(K_t z + C_t v, +- mu F_n),   dz = (-F_t - K_t z) / C_t:
//                 a spring and a damper in series with Coulomb's slider; sticking, dz = v
//
// The inequalities are the mode of a point, held between events. Friction sticks where |K_t z + C_t v| < mu F_n and
// slides in the direction s where s (K_t z + C_t v) > mu F_n: a function of the state alone.
#pragma once

#include <cmath>

#include "common/scalar.hpp"
#include "landing/body/robot.hpp"

namespace ukemi::landing {

/// Friction sticks up to this much beyond mu F_n [N]: too small to matter, it decides where both sides are rounding
/// errors, as at a vertical touchdown under Hunt and Crossley, whose F_n starts with slope 0.
inline constexpr double kStickTolerance = 1e-9;

/// The mode of a contact point, constant between events.
struct PointMode {
  bool touching = false;   ///< below its surface: the pad's, else y = 0
  bool pad = false;        ///< the pad pushes
  bool below = false;      ///< below y = 0
  bool floor = false;      ///< the floor pushes
  signed char slides = 0;  ///< direction in which it slides; 0: it sticks
};

inline bool slides_forward(const PointMode& m) { return m.slides > 0; }
inline bool slides_back(const PointMode& m) { return m.slides < 0; }

/// Constants of a point's contact.
template <class T>
struct ContactConstants {
  T k, c, k_t, c_t, mu, p, dissipation;  ///< see ContactLaw
  T thickness, k_pad, c_pad;             ///< see Pad; 0: none
  bool hunt_crossley = false, padded = false, has_friction = false;

  /// Calls f(constant of a, same constant of b) for every constant.
  template <class A, class B, class F>
  static void for_each(A& a, const B& b, F&& f) {
    f(a.k, b.k), f(a.c, b.c), f(a.k_t, b.k_t), f(a.c_t, b.c_t), f(a.mu, b.mu), f(a.p, b.p);
    f(a.dissipation, b.dissipation), f(a.thickness, b.thickness), f(a.k_pad, b.k_pad), f(a.c_pad, b.c_pad);
  }
  template <class Other>
  void copy_structure(const Other& o) {
    hunt_crossley = o.hunt_crossley, padded = o.padded, has_friction = o.has_friction;
  }
  template <class Other>
  bool same_structure(const Other& o) const {
    return hunt_crossley == o.hunt_crossley && padded == o.padded && has_friction == o.has_friction;
  }
  ContactConstants() = default;
  explicit ContactConstants(const Stop& s) : ContactConstants(ContactPoint{.law = {s.stiffness, s.damping}}) {}
  explicit ContactConstants(const ContactPoint& x)
      : k(x.law.stiffness),
        c(x.law.damping_normal),
        k_t(x.law.stiffness_tangential),
        c_t(x.law.damping_tangential),
        mu(std::isfinite(x.law.friction) ? x.law.friction : 0),
        p(x.law.exponent),
        dissipation(x.law.dissipation),
        thickness(x.pad ? x.pad->thickness : 0),
        k_pad(x.pad ? x.pad->stiffness : 0),
        c_pad(x.pad ? x.pad->damping : 0),
        hunt_crossley(x.law.hunt_crossley),
        padded(x.pad.has_value()),
        has_friction(std::isfinite(x.law.friction)) {}
};

/// A value and its time derivative along the motion.
template <class T>
struct WithRate {
  T value{0}, rate{0};
};

/// Normal force of the floor if it were active, and its rate, at height y, velocity v and acceleration a [N], [N/s].
/// In lanes only the linear law.
template <class T>
WithRate<T> floor_force(const ContactConstants<T>& x, const T& y, const T& v, const T& a) {
  if constexpr (!kIsPack<T>) {
    if (x.hunt_crossley) {
      using std::pow;
      const T depth = select(y < T(0), T(-y), T(0));
      if (!any(depth > T(0))) return {T(0), T(0)};
      const T power = x.k * pow(depth, x.p), damped = T(1) - x.dissipation * v;
      return {power * damped, -x.p * power / depth * v * damped - power * x.dissipation * a};
    }
  }
  return {-x.k * y - x.c * v, -x.k * v - x.c * a};
}
/// Normal force of the pad if it were active, and its rate [N], [N/s].
template <class T>
WithRate<T> pad_force(const ContactConstants<T>& x, const T& y, const T& v, const T& a) {
  return {x.k_pad * (x.thickness - y) - x.c_pad * v, -x.k_pad * v - x.c_pad * a};
}
/// F_n and its rate in a mode [N], [N/s].
template <class T, class Mode>
WithRate<T> normal_force(const ContactConstants<T>& x, const Mode& m, const T& y, const T& v, const T& a) {
  WithRate<T> out;
  const auto add = [&](const auto& acts, const WithRate<T>& f) {
    out.value += masked(acts, f.value), out.rate += masked(acts, f.rate);
  };
  if (any(m.floor)) add(m.floor, floor_force(x, y, v, a));
  if (any(m.pad)) add(m.pad, pad_force(x, y, v, a));
  return out;
}
/// -F_t in a mode, from f = K_t z + C_t v [N].
template <class T, class Mode>
T tangential_force(const ContactConstants<T>& x, const Mode& m, const T& f, const T& normal) {
  if (!x.has_friction || !(any(slides_forward(m)) || any(slides_back(m)))) return f;
  const T limit = x.mu * normal;
  return select(slides_forward(m), limit, select(slides_back(m), T(-limit), f));
}

}  // namespace ukemi::landing
