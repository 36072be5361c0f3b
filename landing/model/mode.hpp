// The discrete state of a landing: what touches, which torque limit acts, which part of the reference is played.
#pragma once

#include <array>

#include "common/scalar.hpp"
#include "landing/model/dry_friction.hpp"
#include "landing/model/floor.hpp"
#include "landing/model/motion.hpp"

namespace ukemi::landing {

/// The guards of a landing: heights of the points 0..2, their normal forces 3..5, the torque limit 6, 7; then, where
/// there may be dry friction, two for each side: its end of a slip, or forward and back out of a hold.
inline constexpr int kTorqueUpper = 2 * kPoints, kTorqueLower = kTorqueUpper + 1, kLandingGuards = kTorqueLower + 1,
                     kFrictionGuards = 2 * kSides;

struct Mode {
  std::array<Contact, kPoints> contact{};
  int saturation = 0;              ///< of the spring's torque: -1 at the lower limit, 1 at the upper, else 0
  std::array<int, kSides> slip{};  ///< of a side with dry friction: the sign of its motion, or 0 where it is stuck
  Phase phase = Phase::kBefore;

  /// The mode beyond the zero of a guard; the phase is the schedule's (landing/run/schedule.hpp).
  void cross(int guard) {
    if (guard >= kLandingGuards) {
      int& of = slip[std::size_t(side_of(guard))];
      of = of != 0 ? 0 : (guard - kLandingGuards) % 2 == 0 ? 1 : -1;
      return;
    }
    if (guard < kPoints)
      contact[std::size_t(guard)] = crossed(contact[std::size_t(guard)]);
    else if (guard < kTorqueUpper)
      contact[std::size_t(guard - kPoints)] = loosened(contact[std::size_t(guard - kPoints)]);
    else
      saturation = saturation ? 0 : (guard == kTorqueUpper ? 1 : -1);
  }
  /// Whose friction a guard beyond kLandingGuards is.
  static constexpr Side side_of(int guard) { return Side((guard - kLandingGuards) / 2); }
};

/// The mode of a system in a scalar: one for a double and all its derivatives; lanes of it in landing/lanes.
template <class T>
struct ModeOf {
  using type = Mode;
};

}  // namespace ukemi::landing
