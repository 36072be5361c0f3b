// The impact-test rig of Sec. 3 of [1]: one link on a fixed base, horizontal plane.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/sea_parameters.hpp"

namespace ukemi::identify {

/// What drives the motor: Eq. 3, or a command that is known but for the factor K_t (ours).
struct Drive {
  enum class Kind {
    kGains,       ///< Eq. 3
    kController,  ///< K_t clamp(gain (phi_ref - phi), -limit, limit): a proportional controller that is known
    kCommand,     ///< K_t times the logged command, held from sample to sample, without K_p and K_d
  } kind = Kind::kGains;
  double gain = 0;                                         ///< of a controller [V or A per rad], > 0
  double limit = std::numeric_limits<double>::infinity();  ///< of its command [V or A], > 0
  double rate = std::numeric_limits<double>::infinity();   ///< limit of a known command's rate [V/s or A/s], > 0
  std::optional<Feedback> feedback = {};                   ///< side that a controller feeds back, if known
  /// Which angle of that side: the predicted one, or the logged one, as a drive reads its encoder. With the latter the
  /// command is known before the rollout, sampled, and may be delayed and limited in its rate.
  enum class Angle { kPredicted, kLogged } angle = Angle::kPredicted;
  /// The actuator's constants of these names, if known [s]; 0 to kMaxDelay (common/actuator_constants.hpp).
  std::optional<double> control_delay = {}, velocity_filter = {};

  bool known_command() const {
    return kind == Kind::kCommand || (kind == Kind::kController && angle == Angle::kLogged);
  }
};

/// Gravity on a link that does not turn in the horizontal plane: a torque moment sin(phi_1 - hanging) towards where it
/// hangs. Ours: the rig of [1] is horizontal.
struct Gravity {
  double moment = 0;   ///< m g times the distance of the centre of mass from the joint [Nm], >= 0; 0: none
  double hanging = 0;  ///< phi_1 where the link hangs straight down [rad]
};

/// Standard deviations of a rig's stated values and of unmodelled lags of its drive: terms that are not fitted enter
/// the uncertainty with them (Considered). Defaults of a rig file without [errors].
struct RigErrors {
  double inertia = 0.01, length = 0.005, force_gain = 0.01, encoder_gain = 0.001;  ///< relative, >= 0
  double delay = 1e-3, filter = 1e-3, time_shift = 0;                              ///< [s], >= 0

  /// All are 0: simulated logs.
  static constexpr RigErrors exact() { return {0, 0, 0, 0, 0, 0, 0}; }
};
/// A key of [errors] and its member.
struct RigErrorKey {
  const char* key;
  double RigErrors::*at;
  enum class Unit { kPart, kSeconds } unit;
};
const std::vector<RigErrorKey>& rig_error_keys();

struct Rig {
  double length;                                ///< l, from the joint to where the force acts [m], > 0, <= 10
  double inertia;                               ///< M, of the link about the joint [kg m^2], > 0
  std::optional<double> tau_max;                ///< torque limit of the spring [Nm]
  std::optional<double> gear_ratio;             ///< a log's phi_motor is divided by it
  std::optional<Feedback> feedback;             ///< what Eq. 3 feeds back
  Drive drive = {};                             ///< what drives the motor
  Gravity gravity = {};                         ///< of a link that hangs
  std::optional<double> speed_max = {};         ///< rated motor speed at the output [rad/s], for the actuator file
  std::optional<double> motor_torque_max = {};  ///< rated motor torque there [Nm], the same
  RigErrors errors = {};                        ///< of the above

  /// An actuator on this rig: torque limit, feedback, delay and filter are the rig's, where it states them.
  template <class T = double>
  SeaParameters<T> mounted(SeaParameters<T> sea) const {
    if (tau_max) sea.tau_max = T(*tau_max);
    if (const auto side = stated_feedback()) sea.feedback = *side;
    if (drive.control_delay) sea.control_delay = T(*drive.control_delay);
    if (drive.velocity_filter) sea.velocity_filter = T(*drive.velocity_filter);
    return sea;
  }
  /// The side that its drive feeds back, if stated.
  std::optional<Feedback> stated_feedback() const {
    return drive.kind == Drive::Kind::kController ? drive.feedback : feedback;
  }
  /// Whether its drive feeds back a predicted angle of a side that is not stated.
  bool feedback_unknown() const { return !drive.known_command() && !stated_feedback(); }
  void validate() const;  ///< throws InputError
};

/// Reads rig.toml: [rig] length and inertia_joint, or mass + inertia_com (then M = I + m (l/2)^2, Eq. 5);
/// gravity_moment, hanging_deg; [drive], a known controller: command_gain, command_limit, command_rate,
/// feedback, angle; without command_gain the logged command drives, or Eq. 3 with control_delay and velocity_filter
/// alone. [errors], or exact = true there. Throws InputError.
Rig read_rig(const std::string& path);

}  // namespace ukemi::identify
