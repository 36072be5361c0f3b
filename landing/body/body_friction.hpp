// Dry friction (dry_friction.hpp) of a robot of links: at the output and at the motor of each joint, and along the
// rail. Sticking and slipping at these places, their guards, and the mode changes.
#pragma once

#include <algorithm>
#include <array>

#include "common/integrate/guards.hpp"
#include "landing/body/contact.hpp"
#include "landing/body/equations.hpp"
#include "landing/model/dry_friction.hpp"

namespace ukemi::landing {

/// CRTP base of BodySystem, whose mode and robot it uses; T is the scalar. kRail: the base may be on a rail.
template <class System, int kJoints, bool kRail, class T>
class BodyFriction {
 public:
  /// Place of a joint's side: kSides * joint + side.
  static constexpr int kRailPlace = kSides * kJoints, kPlaces = kRailPlace + kRail;
  /// Guards of a place: the end of a slip, or breaking loose forward and back.
  static constexpr int kGuardsPerPlace = 2;
  using Lane = typename MaskOf<T>::type;
  using PlaceHolds = std::array<Hold<T>, kPlaces>;

  /// Sign of the slip of a place, 0 where it sticks.
  auto& slip_of(int place) {
    return place == kRailPlace ? system().rail_slip : system().joint[place / kSides].slip[place % kSides];
  }
  const auto& slip_of(int place) const {
    return place == kRailPlace ? system().rail_slip : system().joint[place / kSides].slip[place % kSides];
  }
  bool has_friction_at(int place) const {
    const System& s = system();
    return place == kRailPlace ? s.rail_has_friction
                               : place / kSides < s.body.joints && s.drive[place / kSides].has_friction[place % kSides];
  }
  /// Whether a place sticks; a mask for lanes.
  Lane stuck(int place) const { return Lane(has_friction_at(place)) & is_stuck(slip_of(place)); }
  Lane any_stuck() const {
    Lane some(false);
    for (int k = 0; k < kPlaces; ++k) some = some | stuck(k);
    return some;
  }
  /// The rate of a place in state y; with dy for y its acceleration.
  template <class State>
  T rate_of(int place, const State& y) const {
    if (place == kRailPlace) return y[System::kVx];
    const int i = place / kSides;
    if (place % kSides == kMotorSide) return y[System::kOmegaM + i];
    const TreeJoint& at = system().body.joint[i];
    const T& child = y[System::kOmega + at.child];
    return at.parent < 0 ? child : T(child - y[System::kOmega + at.parent]);
  }

  /// Guards of all places, numbered from `first`: the margins of a hold, or the rate of a slip.
  template <class Time, class State, class Guards>
  [[gnu::noinline]] void friction_guards(int first, const Time& t, const State& y, const State& dy, Guards& out) const {
    PlaceHolds now, next;
    if (any(any_stuck()))
      now = system().holds(t, y), next = system().holds(Time(t + Time(kDifferenceStep)), extrapolate(y, dy));
    guard_places(first, y, dy, now, next, out);
  }
  template <class State, int kGuards, class G>
  void guard_places(int first, const State& y, const State& dy, const PlaceHolds& now, const PlaceHolds& next,
                    integrate::Guards<kGuards, G>& out) const {
    for (int k = 0; k < kPlaces; ++k)
      if (has_friction_at(k))
        guard_friction(slip_of(k), now[k], next[k], rate_of(k, y), rate_of(k, dy),
                       [&](int of, const T& value, const T& rate, const Lane& active) {
                         out.set(first + kGuardsPerPlace * k + of, narrowed<G>(value), narrowed<G>(rate), active);
                       });
  }
  /// Crosses guard `guard`, counted from the first of friction: slipping becomes sticking, sticking slipping.
  template <class State>
  void cross_friction(int guard, State& y) {
    const int place = guard / kGuardsPerPlace;
    int& slip = slip_of(place);
    slip = slip != 0 ? 0 : guard % kGuardsPerPlace == 0 ? 1 : -1;
    if (slip == 0) rest(place, y);
  }

  /// Modes at the start of a run: places that move slip. holds_of(y) as BodySystem::holds.
  template <class State, class HoldsOf>
  void settle_with(HoldsOf&& holds_of, State& y) {
    for (int k = 0; k < kPlaces; ++k) {
      if (!has_friction_at(k)) continue;
      const double v = value_of(rate_of(k, y));
      slip_of(k) = v > 0 ? 1 : v < 0 ? -1 : 0;
    }
    hold_or_slip_with(holds_of, y);
  }
  template <class Time, class State>
  void settle(const Time& t, State& y) {
    if constexpr (!System::kPlainDrives) settle_with([&](const State& at) { return system().holds(t, at); }, y);
  }
  /// Stuck places that friction cannot hold start to slip, the most overloaded first; the others get a rate of 0.
  template <class State, class HoldsOf>
  void hold_or_slip_with(HoldsOf&& holds_of, State& y) {
    if (!system().has_friction) return;
    for (int n = 0; n < kPlaces && any(any_stuck()); ++n) {
      const PlaceHolds hold = holds_of(y);
      int worst = -1;
      double least_margin = 0;
      for (int k = 0; k < kPlaces; ++k) {
        if (!stuck(k)) continue;
        const double margin = std::min(value_of(hold[k].margin_up()), value_of(hold[k].margin_down()));
        if (margin < least_margin) least_margin = margin, worst = k;
      }
      if (worst < 0) break;
      slip_of(worst) = breakaway_direction(value_of(hold[worst].margin_up()), value_of(hold[worst].margin_down()));
    }
    for (int k = 0; k < kPlaces; ++k)
      if (stuck(k)) rest(k, y);
  }
  template <class Time, class State>
  void hold_or_slip(const Time& t, State& y) {
    if constexpr (!System::kPlainDrives) hold_or_slip_with([&](const State& at) { return system().holds(t, at); }, y);
  }
  /// Every place with friction sticks that friction can hold.
  template <class Time, class State>
  void stick_where_possible(const Time& t, State& y) {
    for (int k = 0; k < kPlaces; ++k)
      if (has_friction_at(k)) slip_of(k) = 0;
    hold_or_slip(t, y);
  }

 private:
  System& system() { return static_cast<System&>(*this); }
  const System& system() const { return static_cast<const System&>(*this); }
  template <class State>
  void rest(int place, State& y) const {
    if (place == kRailPlace) return void(y[System::kVx] = T(0));
    const int i = place / kSides;
    if (place % kSides == kMotorSide) return void(y[System::kOmegaM + i] = T(0));
    const TreeJoint& at = system().body.joint[i];
    y[System::kOmega + at.child] = at.parent < 0 ? T(0) : y[System::kOmega + at.parent];
  }
};

}  // namespace ukemi::landing
