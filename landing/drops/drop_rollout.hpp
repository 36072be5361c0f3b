// The predicted drop log of the paper's robot at the log's times, with exact derivatives through the events.
//
// Between events the derivatives y_p of gradient.hpp, and those of the outputs, are at a fixed time. ddr_0 jumps where
// a point touches or leaves the floor; these times are reported. Tests: test/property/drop_rollout.cpp.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "landing/derivatives/gradient.hpp"

namespace ukemi::landing {

/// The measured signals of the thigh.
enum DropOutput {
  kAcc,         ///< |ddr_0|, coordinate acceleration of the centre of mass: g in free fall [m/s^2]
  kAccX,        ///< its horizontal component [m/s^2]
  kAccY,        ///< its vertical component [m/s^2]
  kThighX,      ///< x_0, from the release [m]
  kThighY,      ///< y_0, above the floor [m]
  kThighAngle,  ///< phi_0 [rad]
  kOutputs
};
inline constexpr std::array<const char*, kOutputs> kOutputNames = {"acc", "ax", "ay", "x_0", "y_0", "phi_0"};
inline constexpr std::array<const char*, kOutputs> kOutputUnits = {"m/s^2", "m/s^2", "m/s^2", "m", "m", "rad"};
/// Whether an output jumps at touchdowns and lift-offs.
inline bool jumps(DropOutput o) { return o == kAcc || o == kAccX || o == kAccY; }

/// Parameters of the derivatives: kHeight .. kDampingTangential of Parameter, in this order.
inline constexpr int kDropParameters = 6;
inline constexpr int drop_slot(Parameter p) { return int(p) - int(Parameter::kHeight); }
using DropDerivatives = Eigen::Matrix<double, kDropParameters, 1>;

/// One instant of a drop.
struct DropSample {
  std::array<double, kOutputs> value;
  std::array<double, kOutputs> rate;            ///< time derivative [unit/s]
  std::array<DropDerivatives, kOutputs> slope;  ///< derivatives by the parameters, at a fixed time
};

struct DropRollout {
  std::vector<DropSample> samples;  ///< one per time; fewer if the run failed
  std::vector<double> jumps;        ///< touchdowns and lift-offs, where ddr_0 may jump, from release [s], in order
  integrate::Status status = integrate::Status::kStepped;  ///< of the integrator, if it failed
  bool complete = false;                                   ///< every time has a sample
  long steps = 0;                                          ///< accepted or rejected
};

/// Throws InputError for times that are not finite, below 0 or decrease.
void check_drop_times(const std::vector<double>& times);

/// The drop at `times` [s from release], nonnegative and not decreasing; at an event's time the left limit. Uses of the
/// options accuracy, max_step, max_steps and over; ignores the scene's t_end. Derivatives by the constants of an absent
/// floor are 0. A failed run is reported in `status`. Throws InputError as peak_acceleration, and for invalid times.
[[nodiscard]] DropRollout roll_drop(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                                    const std::vector<double>& times, const SimulateOptions& options = {});

}  // namespace ukemi::landing
