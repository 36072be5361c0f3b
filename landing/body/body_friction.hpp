// The places of a robot of links where dry friction acts (dry_friction.hpp): on the output of each joint, on its motor,
// and along the rail. What holds or slips there, its guards, and what crossing them changes.
#pragma once

#include <algorithm>
#include <array>

#include "common/integrate/guards.hpp"
#include "landing/body/contact.hpp"
#include "landing/body/equations.hpp"
#include "landing/model/dry_friction.hpp"

namespace ukemi::landing {

/// Base of BodySystem, whose mode, robot and rates it reads: `System` has mode and state, T is its scalar.
template <class System, int kJoints, class T>
class BodyFriction {
 public:
  /// A place of a joint is kSides * joint + side.
  static constexpr int kRailPlace = kSides * kJoints, kPlaces = kRailPlace + 1;
  /// Guards of a place: a slip's end, or forward and back out of a hold.
  static constexpr int kOfPlace = 2;
  using Lane = typename MaskOf<T>::type;
  using PlaceHolds = std::array<Hold<T>, kPlaces>;

  /// What a place does, see dry_friction.hpp.
  auto& slip_of(int place) {
    return place == kRailPlace ? system().rail_slip : system().joint[place / kSides].slip[place % kSides];
  }
  const auto& slip_of(int place) const {
    return place == kRailPlace ? system().rail_slip : system().joint[place / kSides].slip[place % kSides];
  }
  bool rubs_at(int place) const {
    const System& s = system();
    return place == kRailPlace ? s.rail_rubs
                               : place / kSides < s.body.joints && s.drive[place / kSides].rubs[place % kSides];
  }
  /// In lanes, those where it is.
  Lane stuck(int place) const { return Lane(rubs_at(place)) & is_stuck(slip_of(place)); }
  Lane some_stuck() const {
    Lane some(false);
    for (int k = 0; k < kPlaces; ++k) some = some | stuck(k);
    return some;
  }
  /// The rate of a place, or its acceleration where y is dy.
  template <class State>
  T rate_of(int place, const State& y) const {
    if (place == kRailPlace) return y[System::kVx];
    const int i = place / kSides;
    if (place % kSides == kMotorSide) return y[System::kOmegaM + i];
    const JointPlace& at = system().body.joint[i];
    const T& child = y[System::kOmega + at.child];
    return at.parent < 0 ? child : T(child - y[System::kOmega + at.parent]);
  }

  /// Of each place: what a hold has left, forward and back, or the rate of a slip. Guards are numbered from `first` on.
  template <class Time, class State, class Guards>
  [[gnu::noinline]] void friction_guards(int first, const Time& t, const State& y, const State& dy, Guards& out) const {
    PlaceHolds now, next;
    if (any(some_stuck())) now = system().holds(t, y), next = system().holds(Time(t + Time(kApart)), soon(y, dy));
    guard_places(first, y, dy, now, next, out);
  }
  template <class State, int kGuards, class G>
  void guard_places(int first, const State& y, const State& dy, const PlaceHolds& now, const PlaceHolds& next,
                    integrate::Guards<kGuards, G>& out) const {
    for (int k = 0; k < kPlaces; ++k)
      if (rubs_at(k))
        guard_friction(slip_of(k), now[k], next[k], rate_of(k, y), rate_of(k, dy),
                       [&](int of, const T& value, const T& rate, const Lane& active) {
                         out.set(first + kOfPlace * k + of, narrowed<G>(value), narrowed<G>(rate), active);
                       });
  }
  /// Beyond guard `guard` of those: what slipped is at rest, what held slips.
  template <class State>
  void cross_friction(int guard, State& y) {
    const int place = guard / kOfPlace;
    int& slip = slip_of(place);
    slip = slip != 0 ? 0 : guard % kOfPlace == 0 ? 1 : -1;
    if (slip == 0) rest(place, y);
  }

  /// A run starts: what moves slips. holds_of(y): as BodySystem::holds.
  template <class State, class HoldsOf>
  void settle_by(HoldsOf&& holds_of, State& y) {
    for (int k = 0; k < kPlaces; ++k) {
      if (!rubs_at(k)) continue;
      const double v = value_of(rate_of(k, y));
      slip_of(k) = v > 0 ? 1 : v < 0 ? -1 : 0;
    }
    hold_or_slip_by(holds_of, y);
  }
  template <class Time, class State>
  void settle(const Time& t, State& y) {
    settle_by([&](const State& at) { return system().holds(t, at); }, y);
  }
  /// What is stuck and what friction cannot hold slips, the farthest beyond its hold first. The rest has a rate of 0.
  template <class State, class HoldsOf>
  void hold_or_slip_by(HoldsOf&& holds_of, State& y) {
    if (!system().rubs) return;
    for (int n = 0; n < kPlaces && any(some_stuck()); ++n) {
      const PlaceHolds hold = holds_of(y);
      int worst = -1;
      double most = 0;
      for (int k = 0; k < kPlaces; ++k) {
        if (!stuck(k)) continue;
        const double left = std::min(value_of(hold[k].left_up()), value_of(hold[k].left_down()));
        if (left < most) most = left, worst = k;
      }
      if (worst < 0) break;
      slip_of(worst) = breaks_loose(value_of(hold[worst].left_up()), value_of(hold[worst].left_down()));
    }
    for (int k = 0; k < kPlaces; ++k)
      if (stuck(k)) rest(k, y);
  }
  template <class Time, class State>
  void hold_or_slip(const Time& t, State& y) {
    hold_or_slip_by([&](const State& at) { return system().holds(t, at); }, y);
  }
  /// What may be stuck is so, where friction holds it.
  template <class Time, class State>
  void stand_still(const Time& t, State& y) {
    for (int k = 0; k < kPlaces; ++k)
      if (rubs_at(k)) slip_of(k) = 0;
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
    const JointPlace& at = system().body.joint[i];
    y[System::kOmega + at.child] = at.parent < 0 ? T(0) : y[System::kOmega + at.parent];
  }
};

}  // namespace ukemi::landing
