// A scene: robot, floor, drop and search range; everything but the actuator and the motion.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "common/uncertainty.hpp"
#include "common/verdict.hpp"
#include "landing/model/constants.hpp"
#include "landing/model/scatter.hpp"

namespace ukemi::landing {

/// How the robot is thrown (Sec. 4 of [1]): at rest relative to itself, from `height`.
template <class T>
struct DropOf {
  T height = T(0);          ///< h, clearance of the lowest contact point at release [m], >= 0
  T forward_speed = T(0);   ///< V_H = dx_0 [m/s]
  T pitch = T(0);           ///< phi_0, thigh pitch; 0: vertical with the knee below the hip [rad]
  T pitch_rate = T(0);      ///< d phi_0 at release [rad/s]; 0 in [1]
  T vertical_speed = T(0);  ///< dy_0, upwards [m/s]; 0 in [1]. Not 0 where a plan begins in the air.
};
using Drop = DropOf<double>;

/// State of the joint when the robot lets go, or when a plan arrives. Ours; absent: at phi_I, as in [1].
struct Release {
  double phi;       ///< joint angle, the spring relaxed [rad]
  double rate = 0;  ///< [rad/s]
  double from = 0;  ///< when the reference may begin to move, from release [s], >= 0
};

/// Ranges of Eq. 6 / Table 3 of [1]: -90..0 deg for both angles, 0.1..1 s.
struct SearchRange {
  std::array<double, 2> phi{-1.5707963267948966, 0};  ///< of phi_I and phi_F [rad]
  std::array<double, 2> duration{0.1, 1.0};           ///< [s]
};

/// Variables of motions besides the three of Eq. 6 (landing/model/motion.hpp). Ours; absent by default.
struct Freedom {
  int bumps = 0;                                                        ///< shape terms, 0..kMaxBumps
  std::array<double, 2> bump{-2.0943951023931953, 2.0943951023931953};  ///< range of each: +-120 deg [rad]
  std::optional<std::array<double, 2>> gains;                           ///< range of gain_p and gain_d; absent: 1
};

/// How exactly the robot plays a motion; half sides of the box of the tolerant peak. Ours: 0.2 deg, 2 ms.
struct ExecutionTolerance {
  double phi = 0.2 * 0.017453292519943295;  ///< of phi_I and phi_F [rad], >= 0
  double duration = 0.002;                  ///< [s], >= 0
};

/// Names of a scene's [uncertainty]: the floor's constants, and the pitch that was estimated with them.
inline constexpr std::array<const char*, 4> kUncertainNames = {"stiffness", "damping_normal", "damping_tangential",
                                                               "pitch"};

struct Scene {
  std::string name;
  TwoLink<double> robot;
  std::array<bool, kPoints> contacts{};  ///< which points may touch
  std::optional<Floor<double>> floor;    ///< absent: no contact
  std::string floor_source;              ///< where the floor's constants come from
  Drop drop;
  std::optional<Release> release;              ///< absent: released at phi_I
  std::optional<std::array<double, 2>> joint;  ///< stops of the joint angle phi_1 [rad]
  std::optional<Uncertainty> uncertainty;      ///< of stiffness, damping_normal, damping_tangential, pitch
  Verdicts verdicts;                           ///< on those, by the calibration that wrote them; empty: none
  std::optional<Scatter> scatter;              ///< of its drops; absent: the scene does not state it
  double detection_delay = 0;                  ///< from the first touchdown to the motion's start [s], >= 0
  SearchRange search;
  Freedom freedom;
  ExecutionTolerance execution;
  std::optional<double> t_end;  ///< upper bound of a run, from release [s]; absent: 10 s after the first touchdown

  /// A run lasts at most this long after the first touchdown where t_end is absent [s].
  static constexpr double kFollow = 10;

  /// Throws InputError for a number outside its documented range, or that read_scene refuses.
  void validate() const;
  bool touches() const { return floor.has_value() && (contacts[kHip] || contacts[kKnee] || contacts[kFoot]); }
};

}  // namespace ukemi::landing
