// A landing of a robot of links as a drop log measures it: its outputs at the log's times. Ours.
//
// ddr of the point that counts jumps where a contact meets its surface, its pad bottoms out, or it lifts off; those
// times are given. Tests: test/legs/drops.cpp.
#pragma once

#include <string>
#include <vector>

#include "landing/body/body_run.hpp"
#include "landing/drops/drop_log.hpp"

namespace ukemi::landing {

/// What may be measured of a robot of links, in the true frame (as BodySample).
struct BodyChannel : DropChannel {
  enum class Kind {
    kAcc,      ///< of the point that counts: norm of its coordinate acceleration, g in free fall [m/s^2]
    kAccX,     ///< its components, forward and up [m/s^2]
    kAccY,     ///<
    kOriginX,  ///< of a link's origin [m]
    kOriginY,  ///<
    kTheta,    ///< a link's absolute angle [rad]
    kPhi,      ///< a joint's angle [rad]
  } kind;
  int index = 0;  ///< of Robot::links or Robot::joints
};
/// acc, ax, ay; x_LINK, y_LINK, theta_LINK of each link; phi_JOINT of each joint that is not locked.
std::vector<BodyChannel> body_channels(const Robot& robot);
/// The same without what they are taken from.
std::vector<DropChannel> drop_channels(const std::vector<BodyChannel>& channels);

struct BodyRollout {
  std::vector<std::vector<double>> value;  ///< of each channel that was asked for, one a time
  std::vector<double> jumps;               ///< where accelerations may jump, from release [s], in order
  double first_touchdown = std::numeric_limits<double>::infinity();  ///< from release [s]
  double peak = 0;        ///< largest acceleration of the point that counts up to the last time [m/s^2]
  bool complete = false;  ///< every time has its values
  long steps = 0;         ///< integrated, taken or rejected
};

/// The drop at `times` [s from release], which must not decrease and not be negative; at an event's time the left
/// limit. Of the options accuracy, max_step, max_steps and over count; the scene's t_end does not. Throws InputError as
/// `simulate` does, and for times that are none.
[[nodiscard]] BodyRollout roll_drop(const BodyScene& scene, const BodyMotion& motion,
                                    const std::vector<BodyChannel>& channels, const std::vector<double>& times,
                                    const SimulateOptions& options = {});

}  // namespace ukemi::landing
