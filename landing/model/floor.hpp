// The floor of Sec. 2.4 of [1]: a linear spring and damper normal to it that cannot pull, viscous friction along it.
//
//     F_x = -C_fx v_x                     if p_y < 0, else 0        (acts also while F_y = 0: the paper's own form)
//     F   = -K_f p_y - C_fy v_y;  F_y = F if p_y < 0 and F > 0, else 0
//
// The two inequalities are the mode of a point, held by the driver between events.
#pragma once

#include "landing/model/two_link.hpp"

namespace ukemi::landing {

/// Mode of a contact point.
enum class Contact : unsigned char {
  kClear,    ///< above the floor
  kPressed,  ///< below y = 0 and the floor pushes
  kLoose,    ///< below y = 0, but the damper outweighs the spring: no normal force
};
inline bool below(Contact c) { return c != Contact::kClear; }
inline bool pressed(Contact c) { return c == Contact::kPressed; }
/// The mode after crossing a guard: the height's, y = 0; the normal force's, F = 0.
inline Contact crossed(Contact c) { return c == Contact::kClear ? Contact::kPressed : Contact::kClear; }
inline Contact loosened(Contact c) { return c == Contact::kPressed ? Contact::kLoose : Contact::kPressed; }

/// F = -K_f p_y - C_fy v_y [N].
template <class T>
T normal_force(const Floor<T>& f, const T& height, const T& velocity) {
  return -f.stiffness * height - f.damping_normal * velocity;
}
/// dF/dt [N/s].
template <class T>
T normal_force_rate(const Floor<T>& f, const T& velocity, const T& acceleration) {
  return -f.stiffness * velocity - f.damping_normal * acceleration;
}
/// F_x = -C_fx v_x [N].
template <class T>
T tangential_force(const Floor<T>& f, const T& velocity) {
  return -f.damping_tangential * velocity;
}

}  // namespace ukemi::landing
