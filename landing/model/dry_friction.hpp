// Dry friction between events, as on the rig (identify/rig/one_link.hpp): a place with dry friction slips against
// Coulomb's torque until its rate is zero; it then sticks, rate and acceleration exactly 0, until the driving torque
// exceeds what friction holds. Ours. Tests: test/unit/sea.cpp, test/legs/sticking.cpp.
#pragma once

#include "common/sea.hpp"

namespace ukemi::landing {

/// `slip`: the sign of the rate of a place with dry friction, or 0 where it sticks.
inline bool slips_forward(int slip) { return slip > 0; }
inline bool slips_back(int slip) { return slip < 0; }
template <class Slip>
auto is_stuck(const Slip& slip) {
  return !(slips_forward(slip) | slips_back(slip));
}
/// +1, -1, or 0 where it sticks.
template <class T, class Slip>
T direction_of(const Slip& slip) {
  return select(slips_forward(slip), T(1), select(slips_back(slip), T(-1), T(0)));
}

/// Driving torque of a stuck place and the limits of its friction: it sticks while -down <= torque <= up [Nm].
template <class T>
struct Hold {
  T torque{0}, up{0}, down{0};

  Hold() = default;
  Hold(const SeaParameters<T>& p, const T& mean, const T& asymmetry, const T& driving_torque)
      : torque(driving_torque), up(coulomb_level(mean, asymmetry, T(1))), down(coulomb_level(mean, asymmetry, T(-1))) {
    up *= T(1) + p.breakaway, down *= T(1) + p.breakaway;
  }
  /// Margins to slipping forward and back [Nm], enlarged so that rounding moves nothing that is at rest.
  T margin_up() const { return up - torque + T(kRounding); }
  T margin_down() const { return down + torque + T(kRounding); }
  static constexpr double kRounding = 1e-9;
};
/// Direction in which a stuck place with these margins starts to slip; 0: none.
inline int breakaway_direction(double margin_up, double margin_down) {
  return margin_up < 0 ? 1 : margin_down < 0 ? -1 : 0;
}

/// Guards of a place: where it sticks its margins, where it slips its rate. `next`: the hold kDifferenceStep later; v,
/// a: rate and acceleration; calls set(guard 0 or 1, value, rate, active).
inline constexpr double kDifferenceStep = 1e-7;  ///< [s]
template <class T, class Slip, class Set>
void guard_friction(const Slip& slip, const Hold<T>& now, const Hold<T>& next, const T& v, const T& a, Set&& set) {
  constexpr double kRateTolerance = 1e-12;  // for places that start without acceleration [rad/s], [m/s]
  using Lane = typename MaskOf<T>::type;
  const Lane stuck = is_stuck(slip);
  const T direction = direction_of<T>(slip);
  const auto rate = [](const T& from, const T& to) { return T((to - from) * T(1 / kDifferenceStep)); };
  set(0, select(stuck, now.margin_up(), T(direction * v + T(kRateTolerance))),
      select(stuck, rate(now.margin_up(), next.margin_up()), T(direction * a)), Lane(true));
  set(1, now.margin_down(), rate(now.margin_down(), next.margin_down()), stuck);
}
/// The state kDifferenceStep later, to first order.
template <class State>
State extrapolate(const State& y, const State& dy) {
  using T = typename State::Scalar;
  State out;
  for (int k = 0; k < State::RowsAtCompileTime; ++k) out[k] = y[k] + T(kDifferenceStep) * dy[k];
  return out;
}

}  // namespace ukemi::landing
