// Exact gradients of every local maximum of the peak point's acceleration, for a robot of links, by any of its numbers;
// the method is that of gradient.hpp. Tests: test/legs/gradient.cpp.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "landing/body/body_run.hpp"
#include "landing/derivatives/peak_kind.hpp"

namespace ukemi::landing {

/// A parameter of derivatives.
struct BodyParameter {
  enum class Of {
    kMotion,   ///< of a driven joint, `which` as motion_numbers(): phi_i, phi_f [rad], duration [s], b0..b3 [rad],
               ///< gain_p, gain_d, to [s]
    kDrop,     ///< `which`: height [m], forward_speed [m/s], pitch [rad], pitch_rate [rad/s], vertical_speed [m/s]
    kDrive,    ///< of a joint's drive, `which` as actuator_constants()
    kContact,  ///< of a contact, `which` as kContactKeys
  } of;
  int index;  ///< of Robot::joints, with kContact of Robot::contacts; -1 with kMotion: all driven joints together, with
              ///< kContact: all contacts together
  int which;
};
/// "phi_i_hip", "duration", "drop.height", "drive.hip.k_p", "contact.foot.friction".
std::string name(const BodyParameter& parameter, const Robot& robot);
/// All parameters that a landing of the scene depends on smoothly: of the motion with shape terms and gains, of the
/// drop, of the terms present in the drives, and of the contact laws present.
std::vector<BodyParameter> parameters_of(const BodyScene& scene, const BodyMotion& motion);
/// The number of a parameter.
double& number(BodyScene& scene, BodyMotion& motion, const BodyParameter& parameter);

/// One local maximum, and its derivatives d by the parameters, in order [unit of value / unit of parameter].
struct BodyPeakGradient {
  double t;      ///< from release [s]
  double value;  ///< [m/s^2]; of a load in the unit of its kind
  Eigen::VectorXd d;
  PeakKind kind;
  int contact = -1;  ///< last touchdown before it, as RunEnd::peak_contact
};

struct BodyGradients {
  std::vector<BodyPeakGradient> peaks;  ///< the largest first; the first is the landing's peak
  /// For each of BodyScene::loads, as `peaks`; impulses at the end of their touch, none for touches.
  std::vector<std::vector<BodyPeakGradient>> loads;
  double t_end = 0;  ///< from release [s]
  End end = End::kFailed;
  integrate::Status status = integrate::Status::kStepped;  ///< with kFailed; kNotFinite: an event at zero rate
  integrate::Counters work;
};

/// The `max_peaks` largest local maxima. At events of one instant the gradient is one-sided, in the order in which they
/// are handled. Uses of the options accuracy, max_step, max_steps, rest and over; ignores limits of the scene. A failed
/// run is reported in `status`. Throws InputError as peak_acceleration does, and for unknown parameters.
[[nodiscard]] BodyGradients gradients(const BodyScene& scene, const BodyMotion& motion,
                                      std::span<const BodyParameter> parameters, const SimulateOptions& options = {},
                                      int max_peaks = 1);

}  // namespace ukemi::landing
