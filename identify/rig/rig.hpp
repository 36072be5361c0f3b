// The impact-test rig of Sec. 3 of [1]: one link on a fixed base, horizontal plane.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/sea_parameters.hpp"

namespace ukemi::identify {

/// What drives the motor. Its torque follows from Eq. 3, K_p and K_d being constants of the actuator; or its command
/// is known but for the factor K_t (ours).
struct Drive {
  enum class Kind {
    kGains,       ///< Eq. 3
    kController,  ///< K_t clamp(gain (phi_ref - phi), -limit, limit): a proportional controller that is known
    kCommand,     ///< K_t times the logged command, held from sample to sample; K_p and K_d are nowhere
  } kind = Kind::kGains;
  double gain = 0;                                         ///< of a controller [V or A per rad], > 0
  double limit = std::numeric_limits<double>::infinity();  ///< of its command [V or A], > 0
  double rate =
      std::numeric_limits<double>::infinity();  ///< of a command that is known: its largest change [V/s or A/s], > 0
  std::optional<Feedback> feedback = {};        ///< the side that a controller feeds back, where it is known
  /// Which angle of that side: the one that the rollout predicts, or the logged one, as a drive sees its encoder. The
  /// command of the latter is known before the rig's motion is, sampled, and may be delayed and limited in its rate.
  enum class Angle { kPredicted, kLogged } angle = Angle::kPredicted;
  /// Where they are known, the actuator's constants of these names [s], 0 to kMostLate (common/actuator.hpp).
  std::optional<double> control_delay = {}, velocity_filter = {};

  bool by_command() const { return kind == Kind::kCommand || (kind == Kind::kController && angle == Angle::kLogged); }
};

/// Of a rig whose link does not turn in the horizontal plane: it pulls the link to where it hangs with
/// moment sin(phi_1 - hanging). Ours: the rig of [1] is horizontal.
struct Gravity {
  double moment = 0;   ///< m g times the distance of the centre of mass from the joint [Nm], >= 0; 0: none
  double hanging = 0;  ///< phi_1 where the link hangs straight down [rad]
};

/// Standard deviations of what a rig states and of what its drive does unseen: terms that are not fitted count with
/// them (Considered). A rig file without [errors] has these.
struct RigErrors {
  double inertia = 0.01, length = 0.005, force_gain = 0.01, encoder_gain = 0.001;  ///< parts of the value, >= 0
  double delay = 1e-3, filter = 1e-3, time_shift = 0;                              ///< [s], >= 0

  /// All are 0: simulated logs.
  static constexpr RigErrors exact() { return {0, 0, 0, 0, 0, 0, 0}; }
};
/// A key of [errors], and where it stands.
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
  RigErrors errors = {};                        ///< of all this

  /// An actuator as it is on this rig: limit, feedback and how late its drive is are the rig's, where it names them.
  template <class T = double>
  SeaParameters<T> mounted(SeaParameters<T> sea) const {
    if (tau_max) sea.tau_max = T(*tau_max);
    if (const auto side = stated_feedback()) sea.feedback = *side;
    if (drive.control_delay) sea.control_delay = T(*drive.control_delay);
    if (drive.velocity_filter) sea.velocity_filter = T(*drive.velocity_filter);
    return sea;
  }
  /// The side that its drive feeds back, where it says so.
  std::optional<Feedback> stated_feedback() const {
    return drive.kind == Drive::Kind::kController ? drive.feedback : feedback;
  }
  /// Whether its drive feeds back an angle that is predicted, of a side that is not stated.
  bool feedback_unknown() const { return !drive.by_command() && !stated_feedback(); }
  void validate() const;  ///< throws InputError
};

/// Reads rig.toml: [rig] length and inertia_joint, or mass + inertia_com (then M = I + m (l/2)^2, Eq. 5);
/// gravity_moment, hanging_deg; [drive], a controller that is known: command_gain, command_limit, command_rate,
/// feedback, angle; without command_gain the logged command drives. With control_delay and velocity_filter alone it is
/// Eq. 3 that does. [errors], or exact = true there. Throws InputError.
Rig read_rig(const std::string& path);

}  // namespace ukemi::identify
