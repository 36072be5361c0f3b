// The predicted drop log of a robot of links: its outputs at the log's times. Ours.
//
// The acceleration of the peak point jumps where a contact touches down, its pad bottoms out, or it lifts off; these
// times are reported. Tests: test/legs/drops.cpp.
#pragma once

#include <vector>

#include "landing/body/body_run.hpp"
#include "landing/drops/drop_log.hpp"

namespace ukemi::landing {

/// A measured signal of a robot of links, in the true frame (as BodySample).
struct BodyChannel : DropChannel {
  enum class Kind {
    kAcc,      ///< norm of the coordinate acceleration of the peak point, g in free fall [m/s^2]
    kAccX,     ///< its forward component [m/s^2]
    kAccY,     ///< its upward component [m/s^2]
    kOriginX,  ///< of a link's origin, forward [m]
    kOriginY,  ///< of a link's origin, up [m]
    kTheta,    ///< a link's absolute angle [rad]
    kPhi,      ///< a joint's angle [rad]
  } kind;
  int index = 0;  ///< of Robot::links or Robot::joints
};
/// acc, ax, ay; x_LINK, y_LINK, theta_LINK of each link; phi_JOINT of each joint that is not locked.
std::vector<BodyChannel> body_channels(const Robot& robot);
/// The channels without their kinds and indices.
std::vector<DropChannel> drop_channels(const std::vector<BodyChannel>& channels);

struct BodyRollout {
  std::vector<std::vector<double>> value;  ///< of each requested channel, one per time
  std::vector<double> jumps;               ///< times at which accelerations may jump, from release [s], in order
  double first_touchdown = std::numeric_limits<double>::infinity();  ///< from release [s]
  double peak = 0;        ///< largest acceleration of the peak point up to the last time [m/s^2]
  bool complete = false;  ///< every time has values
  long steps = 0;         ///< accepted or rejected
};

/// The drop at `times` [s from release], nonnegative and not decreasing; at an event's time the left limit. Uses of the
/// options accuracy, max_step, max_steps and over; ignores t_end. Throws InputError as `simulate`, and for bad times.
[[nodiscard]] BodyRollout roll_drop(const BodyScene& scene, const BodyMotion& motion,
                                    const std::vector<BodyChannel>& channels, const std::vector<double>& times,
                                    const SimulateOptions& options = {});

}  // namespace ukemi::landing
