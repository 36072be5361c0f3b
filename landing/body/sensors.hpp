// What the columns of a robot's log say of what they measure. Ours.
//
//     logged(t) = gain actual(t) + bias
//
// Of a force that pushes the robot, what was logged at t acted at t + time_shift; between its rows it is a curve
// (common/force_curve.hpp).
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "common/toml.hpp"
#include "landing/body/robot.hpp"

namespace ukemi::landing {

/// What is measured of a joint; the torque is that asked of its drive.
enum Sensed { kAngle, kRate, kTorque, kSensed };
inline constexpr std::array<const char*, kSensed> kSensedNames = {"phi", "dphi", "torque"};
inline constexpr std::array<const char*, kSensed> kSensedUnits = {"rad", "rad/s", "Nm"};

/// What is measured of the first link of a free base: its origin, absolute angle and its rate.
enum BaseSensed { kOriginX, kOriginY, kPitch, kPitchRate, kBaseSensed };
inline constexpr std::array<const char*, kBaseSensed> kBaseSensedNames = {"x", "y", "theta", "dtheta"};
inline constexpr std::array<const char*, kBaseSensed> kBaseSensedUnits = {"m", "m", "rad", "rad/s"};

/// What is measured at the point that counts: its acceleration, as landings have it, norm and parts along and across
/// the floor; and what an accelerometer there reads, the acceleration less gravity along and across its link.
enum BodySensed { kNorm, kAlong, kAcross, kSpecificAlong, kSpecificAcross, kBodySensed };
inline constexpr std::array<const char*, kBodySensed> kBodySensedNames = {"acc", "ax", "ay", "sf_along", "sf_across"};
/// And of each contact, or push: the force on the robot, along and across the floor.
inline constexpr std::array<const char*, 2> kForceNames = {"_x", "_y"};

struct MeasuredColumn {
  std::string name, unit;
};
/// phi_JOINT, dphi_JOINT and torque_JOINT of every joint; of a free base x_LINK, y_LINK, theta_LINK and dtheta_LINK of
/// the first link; then acc, ax, ay, sf_along, sf_across, and f_CONTACT_x, f_CONTACT_y of every contact.
std::vector<MeasuredColumn> measured_columns(const Robot& robot);
/// push_NAME_x, push_NAME_y of every push.
std::vector<MeasuredColumn> push_columns(const Robot& robot);

/// Largest Sensors::time_shift either way [s].
inline constexpr double kMostTimeShift = 0.1;

struct Sensor {
  double gain = 1, bias = 0;  ///< gain > 0; bias in the column's unit

  double logged(double actual) const { return gain * actual + bias; }
  double actual(double logged) const { return (logged - bias) / gain; }
};

struct Sensors {
  std::map<std::string, Sensor> column;  ///< by its name; one that is missing says what is
  double time_shift = 0;                 ///< by which the pushes came later than logged [s]
  double push_smooth = 0;                ///< of pushes between their rows; 0: linear, 1: smooth

  Sensor of(const std::string& name) const;
};

/// A number of them by its name, "time_shift", "push_smooth", "COLUMN.gain" or "COLUMN.bias"; null: there is none.
double* sensor_number(Sensors& sensors, const Robot& robot, const std::string& name);
/// [sensor] time_shift, push_smooth and [sensor.COLUMN] gain, bias of a robot's file.
Sensors read_sensors(TomlFile& file, const Robot& robot);

}  // namespace ukemi::landing
