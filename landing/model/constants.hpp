// The constants of the paper's robot and of its floor (Sec. 2.1, 2.4 of [1]). Their equations: landing/body.
#pragma once

#include <array>

namespace ukemi::landing {

/// The points that may touch the floor, in the order of the paper's j = 0, 1, 2.
enum Point { kHip = 0, kKnee = 1, kFoot = 2 };
inline constexpr int kPoints = 3;
inline constexpr std::array<const char*, kPoints> kPointNames = {"hip", "knee", "foot"};

/// Masses, inertias and lengths of the paper's robot.
template <class T>
struct TwoLink {
  std::array<T, 2> mass;         ///< m_0, m_1 [kg], > 0
  std::array<T, 2> inertia_com;  ///< I_0, I_1 about each centre of mass [kg m^2], > 0
  T link_length;                 ///< l, of each link [m], > 0
  T gravity;                     ///< g [m/s^2], >= 0
};

/// Constants of the floor.
template <class T>
struct Floor {
  T stiffness;           ///< K_f [N/m], > 0
  T damping_normal;      ///< C_fy [N/(m/s)], >= 0
  T damping_tangential;  ///< C_fx [N/(m/s)], >= 0

  /// Calls f(constant of a, same constant of b) for every constant.
  template <class A, class B, class F>
  static void for_each(A& a, const B& b, F&& f) {
    f(a.stiffness, b.stiffness), f(a.damping_normal, b.damping_normal), f(a.damping_tangential, b.damping_tangential);
  }
};

}  // namespace ukemi::landing
