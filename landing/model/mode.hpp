// The discrete state of a landing: contacts, active torque limit, friction modes, phase of the reference.
#pragma once

#include <array>

#include "common/scalar.hpp"
#include "landing/model/dry_friction.hpp"
#include "landing/model/floor.hpp"
#include "landing/model/motion.hpp"

namespace ukemi::landing {

/// The guards of a landing: heights of the points 0..2, their normal forces 3..5, the torque limit 6, 7; then, where
/// there may be dry friction, two for each side: the end of a slip, or breaking loose forward and back.
inline constexpr int kTorqueUpper = 2 * kPoints, kTorqueLower = kTorqueUpper + 1, kLandingGuards = kTorqueLower + 1,
                     kFrictionGuards = 2 * kSides;

struct Mode {
  std::array<Contact, kPoints> contact{};
  int saturation = 0;              ///< of the spring's torque: -1 at the lower limit, 1 at the upper, else 0
  std::array<int, kSides> slip{};  ///< by side with dry friction: sign of its rate; 0: it sticks
  Phase phase = Phase::kBefore;

  /// Changes the mode at the zero of a guard; the schedule sets the phase (landing/run/schedule.hpp).
  void cross(int guard) {
    if (guard >= kLandingGuards) {
      int& side_slip = slip[std::size_t(side_of(guard))];
      side_slip = side_slip != 0 ? 0 : (guard - kLandingGuards) % 2 == 0 ? 1 : -1;
      return;
    }
    if (guard < kPoints)
      contact[std::size_t(guard)] = crossed(contact[std::size_t(guard)]);
    else if (guard < kTorqueUpper)
      contact[std::size_t(guard - kPoints)] = loosened(contact[std::size_t(guard - kPoints)]);
    else
      saturation = saturation ? 0 : (guard == kTorqueUpper ? 1 : -1);
  }
  /// The side of a friction guard, numbered from kLandingGuards.
  static constexpr Side side_of(int guard) { return Side((guard - kLandingGuards) / 2); }
};

/// The mode of a system by scalar: Mode, but for packs a mode per lane (landing/lanes).
template <class T>
struct ModeOf {
  using type = Mode;
};

}  // namespace ukemi::landing
