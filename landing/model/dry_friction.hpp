// Dry friction between events, as on the rig (identify/rig/one_link.hpp): a place that rubs slips against Coulomb's
// torque until its rate is zero; it is then stuck, rate and acceleration exactly 0, as long as friction holds what
// moves it. Ours. Tests: test/unit/sea.cpp, test/legs/sticking.cpp.
#pragma once

#include "common/sea.hpp"

namespace ukemi::landing {

/// What a place with dry friction does between events: the sign of its motion, or 0 where it is stuck.
inline bool slips_forward(int slip) { return slip > 0; }
inline bool slips_back(int slip) { return slip < 0; }
template <class Slip>
auto is_stuck(const Slip& slip) {
  return !(slips_forward(slip) | slips_back(slip));
}
/// +1, -1, or 0 where it is stuck.
template <class T, class Slip>
T direction_of(const Slip& slip) {
  return select(slips_forward(slip), T(1), select(slips_back(slip), T(-1), T(0)));
}

/// What moves a place that is stuck, and what its friction holds in either direction: it stays as long as
/// -down <= torque <= up [Nm].
template <class T>
struct Hold {
  T torque{0}, up{0}, down{0};

  Hold() = default;
  Hold(const SeaParameters<T>& p, const T& mean, const T& asymmetry, const T& moved_by)
      : torque(moved_by), up(coulomb_level(mean, asymmetry, T(1))), down(coulomb_level(mean, asymmetry, T(-1))) {
    up *= T(1) + p.breakaway, down *= T(1) + p.breakaway;
  }
  /// What is left until it slips forward, and back. It holds a little more than it says: what is at rest and what
  /// nothing moves stays, whatever rounding makes of that.
  T left_up() const { return up - torque + T(kRounding); }
  T left_down() const { return down + torque + T(kRounding); }
  static constexpr double kRounding = 1e-9;
};
/// In which direction a side starts to slip whose friction has so much left; 0: it stays.
inline int breaks_loose(double left_up, double left_down) { return left_up < 0 ? 1 : left_down < 0 ? -1 : 0; }

/// Guards of a place: of a hold what is left of it, forward and back; of a slip its rate. `next`: the hold kApart
/// later; v and a: rate and acceleration; set(0 or 1, value, rate, active).
inline constexpr double kApart = 1e-7;  ///< [s]
template <class T, class Slip, class Set>
void guard_friction(const Slip& slip, const Hold<T>& now, const Hold<T>& next, const T& v, const T& a, Set&& set) {
  constexpr double kNotMoved = 1e-12;  // of what breaks loose with no acceleration [rad/s], [m/s]
  using Lane = typename MaskOf<T>::type;
  const Lane stays = is_stuck(slip);
  const T direction = direction_of<T>(slip);
  const auto rate = [](const T& from, const T& to) { return T((to - from) * T(1 / kApart)); };
  set(0, select(stays, now.left_up(), T(direction * v + T(kNotMoved))),
      select(stays, rate(now.left_up(), next.left_up()), T(direction * a)), Lane(true));
  set(1, now.left_down(), rate(now.left_down(), next.left_down()), stays);
}
/// The state kApart later.
template <class State>
State soon(const State& y, const State& dy) {
  using T = typename State::Scalar;
  State out;
  for (int k = 0; k < State::RowsAtCompileTime; ++k) out[k] = y[k] + T(kApart) * dy[k];
  return out;
}

}  // namespace ukemi::landing
