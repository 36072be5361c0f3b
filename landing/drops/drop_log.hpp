// The log of one drop in SI units, and its reader.
#pragma once

#include <string>
#include <vector>

#include "landing/body/robot.hpp"

namespace ukemi::landing {

/// A measured signal of a robot, in the true frame (as BodySample).
struct DropChannel {
  std::string name, unit;  ///< unit: "m/s^2", "m" or "rad"
  bool jumps = false;      ///< it jumps at touchdowns and lift-offs
  enum class Kind {
    kOther,    ///< not of a drop
    kAcc,      ///< norm of the coordinate acceleration of the peak point, g in free fall [m/s^2]
    kAccX,     ///< its forward component [m/s^2]
    kAccY,     ///< its upward component [m/s^2]
    kPeakX,    ///< of the peak point, forward [m]
    kPeakY,    ///< of the peak point, up [m]
    kOriginX,  ///< of a link's origin, forward [m]
    kOriginY,  ///< of a link's origin, up [m]
    kTheta,    ///< a link's absolute angle [rad]
    kPhi,      ///< a joint's angle [rad]
  } kind = Kind::kOther;
  int index = 0;  ///< of Robot::links or Robot::joints
};
/// The channels of the paper's robot: of the thigh, whose centre of mass is the peak point, acc, ax, ay [m/s^2], x_0
/// from the release, y_0 above the floor [m] and phi_0 [rad].
enum DropOutput { kAcc, kAccX, kAccY, kThighX, kThighY, kThighAngle, kOutputs };
const std::vector<DropChannel>& thigh_channels();
/// acc, ax, ay; x_LINK, y_LINK, theta_LINK of each link; phi_JOINT of each joint that is not locked.
std::vector<DropChannel> body_channels(const Robot& robot);
/// The names of channels: "acc, ax, ay or phi_0".
std::string names_of(const std::vector<DropChannel>& channels);

/// A log of one drop. An output has as many samples as `t`, NaN where it was not measured, or none at all.
struct DropLog {
  std::string file;
  std::vector<double> t;  ///< from release [s], increasing, >= 0
  std::vector<std::vector<double>> output = std::vector<std::vector<double>>(kOutputs);  ///< of each channel
  long before_release = 0;              ///< number of rows with t < 0, which are skipped
  std::vector<std::string> notes = {};  ///< on columns that are not read but look like known ones

  /// Number of measured values of an output.
  long count(std::size_t output) const;
};

/// Reads a drop (CSV). Columns by name: t [s] or t_ms, and at least one of the channels, each in its unit or, by the
/// end of its name, in another: NAME_g of an acceleration (times 9.80665), NAME_mm of a length, NAME_deg of an angle;
/// other columns are not read. An empty cell of an output: not measured then, so that sensors of several rates share a
/// file. Throws InputError with file:line:column on whatever read_csv refuses, on a missing column (nearest name
/// given), an output in two units, fewer than two rows from the release on, an empty time, a time_fault, rows that
/// begin 1e5 s or more after the release (then t counts from elsewhere), and an angle beyond 2 pi.
DropLog read_drop(const std::string& path, const std::vector<DropChannel>& channels = thigh_channels());

}  // namespace ukemi::landing
