// The predicted drop log of a robot: its outputs at the log's times, and on request their exact derivatives.
//
// The acceleration of the peak point jumps where a contact touches down, its pad bottoms out, or it lifts off; these
// times are reported. Between events the derivatives of the outputs are at a fixed time, as y_p of
// landing/derivatives/gradient.hpp. Ours. Tests: test/legs/drops.cpp, test/property/drop_rollout.cpp.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <vector>

#include "landing/derivatives/body_gradient.hpp"
#include "landing/drops/drop_log.hpp"

namespace ukemi::landing {

/// A number of a scene by which the outputs have exact derivatives.
struct DropParameter {
  const char* name;
  BodyParameter is;
};
/// Those of the drop, and of the floor's law, all contacts together.
inline constexpr std::array<DropParameter, 6> kDropParameters = {
    {{"height", {BodyParameter::Of::kDrop, -1, 0}},
     {"forward_speed", {BodyParameter::Of::kDrop, -1, 1}},
     {"pitch", {BodyParameter::Of::kDrop, -1, 2}},
     {"stiffness", {BodyParameter::Of::kContact, -1, 0}},
     {"damping_normal", {BodyParameter::Of::kContact, -1, 1}},
     {"damping_tangential", {BodyParameter::Of::kContact, -1, 2}}}};

struct DropRollout {
  std::vector<std::vector<double>> value;  ///< of each requested channel, one per time; fewer if the run failed
  std::vector<double> jumps;               ///< times at which accelerations may jump, from release [s], in order
  bool complete = false;                   ///< every time has values
  long steps = 0;                          ///< accepted or rejected

  // Of a run without derivatives:
  double first_touchdown = std::numeric_limits<double>::infinity();  ///< from release [s]
  double peak = 0;  ///< largest acceleration of the peak point up to the last time [m/s^2]

  /// Of a run with derivatives: of each channel those by kDropParameters, at a fixed time, then that by time, in
  /// columns, at the times of `value`.
  std::vector<Eigen::MatrixXd> slope;
};

/// The drop at `times` [s from release], nonnegative and not decreasing; at an event's time the left limit. Uses of the
/// options accuracy, max_step, max_steps and over; ignores t_end. Throws InputError as `simulate`, and for bad times.
[[nodiscard]] DropRollout roll_drop(const BodyScene& scene, const BodyMotion& motion,
                                    const std::vector<DropChannel>& channels, const std::vector<double>& times,
                                    const SimulateOptions& options = {});
/// The same with derivatives. The scene, which must be valid, is of a robot of two links.
[[nodiscard]] DropRollout differentiated_drop(const BodyScene& scene, const BodyMotion& motion,
                                              const std::vector<DropChannel>& channels,
                                              const std::vector<double>& times, const SimulateOptions& options = {});
/// The thigh_channels of the paper's robot with derivatives; those by the constants of an absent floor are 0.
[[nodiscard]] DropRollout roll_drop(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                                    const std::vector<double>& times, const SimulateOptions& options = {});

}  // namespace ukemi::landing
