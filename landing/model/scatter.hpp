// Scatter of the drops of a scene about the planned one. Ours; the paper has one drop.
#pragma once

#include <algorithm>
#include <array>

namespace ukemi::landing {

/// Standard deviations, 0 for numbers that do not scatter. Numbers are independent and normal, truncated at three
/// deviations; floor constants and delay also at 0.
struct Scatter {
  double pitch = 0;                                   ///< of the thigh at release [rad]
  double height = 0;                                  ///< of the drop [m]
  double forward_speed = 0;                           ///< [m/s]
  double pitch_rate = 0;                              ///< [rad/s]
  double phi = 0;                                     ///< of joint and reference at release, spring relaxed [rad]
  double rate = 0;                                    ///< of the joint at release [rad/s]
  double stiffness = 0;                               ///< of the floor: deviation of its logarithm, 0.1 for 10 %
  double damping_normal = 0, damping_tangential = 0;  ///< as `stiffness`
  double delay = 0;                                   ///< of the touchdown's detection [s]
  double slope = 0;  ///< of the floor [rad]; this and the rest: only for robots of links
  double friction = 0, stiffness_tangential = 0, dissipation = 0;  ///< of every contact, as `stiffness`
  double pad_thickness = 0, pad_stiffness = 0, pad_damping = 0;    ///< of every pad, as `stiffness`

  /// Default: 1 deg, 1 cm, 3 cm/s.
  static constexpr Scatter assumed() { return {.pitch = 0.017453292519943295, .height = 0.01, .forward_speed = 0.03}; }
  bool any() const;
  void validate() const;  ///< throws InputError for a deviation below 0 or not finite
};

/// One number of a scatter, as files and options name it.
struct ScatterTerm {
  enum class Kind { kPlain, kAngle, kRelative };
  const char* name;  ///< without the _deg of an angle
  const char* unit;  ///< SI
  Kind kind;
  double Scatter::*deviation;
  bool of_links = false;  ///< only for robots of links
};
inline constexpr std::array<ScatterTerm, 17> kScatterTerms = {{
    {"pitch", "rad", ScatterTerm::Kind::kAngle, &Scatter::pitch},
    {"height", "m", ScatterTerm::Kind::kPlain, &Scatter::height},
    {"forward_speed", "m/s", ScatterTerm::Kind::kPlain, &Scatter::forward_speed},
    {"pitch_rate", "rad/s", ScatterTerm::Kind::kAngle, &Scatter::pitch_rate},
    {"phi", "rad", ScatterTerm::Kind::kAngle, &Scatter::phi},
    {"rate", "rad/s", ScatterTerm::Kind::kAngle, &Scatter::rate},
    {"stiffness", "1", ScatterTerm::Kind::kRelative, &Scatter::stiffness},
    {"damping_normal", "1", ScatterTerm::Kind::kRelative, &Scatter::damping_normal},
    {"damping_tangential", "1", ScatterTerm::Kind::kRelative, &Scatter::damping_tangential},
    {"delay", "s", ScatterTerm::Kind::kPlain, &Scatter::delay},
    {"slope", "rad", ScatterTerm::Kind::kAngle, &Scatter::slope, true},
    {"friction", "1", ScatterTerm::Kind::kRelative, &Scatter::friction, true},
    {"stiffness_tangential", "1", ScatterTerm::Kind::kRelative, &Scatter::stiffness_tangential, true},
    {"dissipation", "1", ScatterTerm::Kind::kRelative, &Scatter::dissipation, true},
    {"pad_thickness", "1", ScatterTerm::Kind::kRelative, &Scatter::pad_thickness, true},
    {"pad_stiffness", "1", ScatterTerm::Kind::kRelative, &Scatter::pad_stiffness, true},
    {"pad_damping", "1", ScatterTerm::Kind::kRelative, &Scatter::pad_damping, true},
}};
inline bool Scatter::any() const {
  return std::any_of(kScatterTerms.begin(), kScatterTerms.end(), [&](auto& t) { return this->*t.deviation > 0; });
}

}  // namespace ukemi::landing
