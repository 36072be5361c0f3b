// Exact gradients of every local maximum of the peak point's acceleration, for a robot of links: the law of
// gradient.hpp, by whatever numbers are named. Tests: test/legs/gradient.cpp.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "landing/body/body_run.hpp"
#include "landing/derivatives/peak_kind.hpp"

namespace ukemi::landing {

/// A number that a landing may be differentiated by.
struct BodyParameter {
  enum class Of {
    kMotion,   ///< of a driven joint, `which` as motion_numbers(): phi_i, phi_f [rad], duration [s], b0..b3 [rad],
               ///< gain_p, gain_d, to [s]
    kDrop,     ///< `which`: height [m], forward_speed [m/s], pitch [rad], pitch_rate [rad/s], vertical_speed [m/s]
    kDrive,    ///< of a joint's drive, `which` as actuator_constants()
    kContact,  ///< of a contact, `which` as kContactKeys
  } of;
  int index;  ///< of Robot::joints, of kContact of Robot::contacts; -1: of a motion, of all driven joints together
  int which;
};
/// "phi_i_hip", "duration", "drop.height", "drive.hip.k_p", "contact.foot.friction".
std::string name(const BodyParameter& parameter, const Robot& robot);
/// All numbers that a landing of the scene depends on smoothly: those of the motion, shape terms and gains included, of
/// the drop, of the drives the terms that they have, of the contacts the laws that they have.
std::vector<BodyParameter> parameters_of(const BodyScene& scene, const BodyMotion& motion);
/// The same number itself.
double& number(BodyScene& scene, BodyMotion& motion, const BodyParameter& parameter);

/// One local maximum, and its derivative by each parameter, in their order [its unit per theirs].
struct BodyPeakGradient {
  double t;      ///< from release [s]
  double value;  ///< [m/s^2]; of a load in the unit of its kind
  Eigen::VectorXd d;
  PeakKind kind;
};

struct BodyGradients {
  std::vector<BodyPeakGradient> peaks;  ///< the largest first; the first is the landing's peak
  /// Of each of BodyScene::loads, as `peaks`; an impulse at the end of its touch, of a touch none.
  std::vector<std::vector<BodyPeakGradient>> loads;
  double t_end = 0;  ///< from release [s]
  End end = End::kFailed;
  integrate::Status status = integrate::Status::kStepped;  ///< with kFailed; an event met at no speed: kNotFinite
};

/// The `most` largest local maxima. Events at one instant are taken in the order in which they happen: the gradient is
/// one-sided there. Of the options, accuracy, max_step, max_steps, rest and over count; limits of the scene do not. A
/// run that fails is a status. Throws InputError as peak_acceleration does, and for a parameter that the robot has not.
[[nodiscard]] BodyGradients gradients(const BodyScene& scene, const BodyMotion& motion,
                                      std::span<const BodyParameter> parameters, const SimulateOptions& options = {},
                                      int most = 1);

}  // namespace ukemi::landing
