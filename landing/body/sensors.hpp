// Calibration of the columns of a robot's log. Ours.
//
//     logged(t) = gain actual(t) + bias
//
// A push logged at t acted at t + time_shift; between rows it is interpolated (common/force_curve.hpp).
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "common/toml.hpp"
#include "landing/body/robot.hpp"

namespace ukemi::landing {

/// Measured signals of a joint; kTorque is the torque requested of its drive.
enum JointSignal { kAngle, kRate, kTorque, kJointSignals };
inline constexpr std::array<const char*, kJointSignals> kJointSignalNames = {"phi", "dphi", "torque"};
inline constexpr std::array<const char*, kJointSignals> kJointSignalUnits = {"rad", "rad/s", "Nm"};

/// Measured signals of the first link of a free base: origin, absolute angle and its rate.
enum BaseSignal { kOriginX, kOriginY, kPitch, kPitchRate, kBaseSignals };
inline constexpr std::array<const char*, kBaseSignals> kBaseSignalNames = {"x", "y", "theta", "dtheta"};
inline constexpr std::array<const char*, kBaseSignals> kBaseSignalUnits = {"m", "m", "rad", "rad/s"};

/// Measured signals of the peak point: norm of its acceleration, its components along and across the floor, and its
/// specific force along and across the link, as an accelerometer reads it.
enum AccelerationSignal { kNorm, kAlong, kAcross, kSpecificAlong, kSpecificAcross, kAccelerationSignals };
inline constexpr std::array<const char*, kAccelerationSignals> kAccelerationSignalNames = {"acc", "ax", "ay",
                                                                                           "sf_along", "sf_across"};
/// Suffixes of the force on the robot at a contact or push, along and across the floor.
inline constexpr std::array<const char*, 2> kForceNames = {"_x", "_y"};

struct MeasuredColumn {
  std::string name, unit;
};
/// phi_JOINT, dphi_JOINT and torque_JOINT of every joint; of a free base x_LINK, y_LINK, theta_LINK and dtheta_LINK of
/// the first link; then acc, ax, ay, sf_along, sf_across, and f_CONTACT_x, f_CONTACT_y of every contact.
std::vector<MeasuredColumn> measured_columns(const Robot& robot);
/// push_NAME_x, push_NAME_y of every push.
std::vector<MeasuredColumn> push_columns(const Robot& robot);

/// Largest |time_shift| of Sensors [s].
inline constexpr double kMaxTimeShift = 0.1;

struct Sensor {
  double gain = 1, bias = 0;  ///< gain > 0; bias in the column's unit

  double logged(double actual) const { return gain * actual + bias; }
  double actual(double logged) const { return (logged - bias) / gain; }
};

struct Sensors {
  std::map<std::string, Sensor> column;  ///< by name; a missing column has gain 1, bias 0
  double time_shift = 0;                 ///< delay of pushes against their log [s]
  double push_smooth = 0;                ///< interpolation of pushes: 0 linear, 1 smooth

  Sensor of(const std::string& name) const;
};

/// A number by its name: "time_shift", "push_smooth", "COLUMN.gain" or "COLUMN.bias"; null if there is none.
double* sensor_number(Sensors& sensors, const Robot& robot, const std::string& name);
/// Reads [sensor] time_shift, push_smooth and [sensor.COLUMN] gain, bias of a robot's file.
Sensors read_sensors(TomlFile& file, const Robot& robot);

}  // namespace ukemi::landing
