// A landing as a rollout: what a drop log measures, at the log's times, with exact derivatives through the events.
//
// Between events the derivatives y_p of gradient.hpp are those at a fixed time, and so are the outputs'. ddr_0 jumps
// where a point touches or leaves the floor; those times are given. Tests: test/property/drop_rollout.cpp.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "landing/derivatives/gradient.hpp"

namespace ukemi::landing {

/// What may be measured of the thigh.
enum DropOutput {
  kAcc,         ///< |ddr_0|, coordinate acceleration of the centre of mass: g in free fall [m/s^2]
  kAccX,        ///< its components in the world [m/s^2]
  kAccY,        ///<
  kThighX,      ///< x_0, from the release [m]
  kThighY,      ///< y_0, above the floor [m]
  kThighAngle,  ///< phi_0 [rad]
  kOutputs
};
inline constexpr std::array<const char*, kOutputs> kOutputNames = {"acc", "ax", "ay", "x_0", "y_0", "phi_0"};
inline constexpr std::array<const char*, kOutputs> kOutputUnits = {"m/s^2", "m/s^2", "m/s^2", "m", "m", "rad"};
/// True for what jumps at a touchdown and a lift-off.
inline bool jumps(DropOutput o) { return o == kAcc || o == kAccX || o == kAccY; }

/// A drop is differentiated by Parameter kHeight .. kDampingTangential, in this order.
inline constexpr int kDropParameters = 6;
inline constexpr int drop_slot(Parameter p) { return int(p) - int(Parameter::kHeight); }
using DropDerivatives = Eigen::Matrix<double, kDropParameters, 1>;

/// One instant of a drop.
struct DropSample {
  std::array<double, kOutputs> value;
  std::array<double, kOutputs> rate;            ///< by time, along the motion [per s]
  std::array<DropDerivatives, kOutputs> slope;  ///< by each parameter, at a fixed time
};

struct DropRollout {
  std::vector<DropSample> samples;  ///< one a time; fewer where the run failed
  std::vector<double> jumps;        ///< touchdowns and lift-offs, where ddr_0 may jump, from release [s], in order
  integrate::Status status = integrate::Status::kStepped;  ///< why it failed, where it did
  bool complete = false;                                   ///< every time has its sample
  long steps = 0;                                          ///< integrated, taken or rejected
};

/// The drop at `times` [s from release], which must not decrease and not be negative; a sample at an event's time is
/// the left limit. Of the options, accuracy, max_step, max_steps and over count; the scene's t_end does not.
/// Derivatives by the constants of an absent floor are 0. A run that fails is a status. Throws InputError as
/// peak_acceleration does, and for times that are none.
[[nodiscard]] DropRollout roll_drop(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                                    const std::vector<double>& times, const SimulateOptions& options = {});

}  // namespace ukemi::landing
