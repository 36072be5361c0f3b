// Plays a plan on a robot: the reference of every joint at any time of the robot's clock.
#pragma once

#include <optional>
#include <vector>

#include "landing/model/motion_data.hpp"

namespace ukemi::landing {

/// What a drive is sent: Eq. 3's reference, and the factors of its gains.
struct DriveCommand {
  double phi, dphi;   ///< phi_ref [rad], dphi_ref [rad/s]
  double gain_p = 1;  ///< factor of K_p
  double gain_d = 1;  ///< factor of K_d
};

/// Holds the angles of release until `released` is called, moves in the air by the clock, and plays the landing
/// motion of every joint from the touchdown on, interrupting the move in the air if it is not over. After the end of
/// each motion its last angle is held. After construction nothing allocates or throws: made for a control loop.
class Player {
 public:
  /// One motion per joint, in the robot's order. Throws InputError for an invalid motion, and for none.
  explicit Player(std::vector<Motion> motions);

  int joints() const noexcept { return int(motions_.size()); }
  /// When the robot lets go, or for a plan made in the air when the planner was called: from then on the times of moves
  /// in the air count [s of any clock]. A touchdown before is forgotten. Returns false, and changes nothing, for a time
  /// that is not finite.
  bool released(double t) noexcept;
  /// When the first touchdown was noticed, by the same clock: the landing motions start. Counts once after a release;
  /// returns false, and changes nothing, for a second one, one before the release, or a time that is not finite.
  bool touchdown(double t) noexcept;
  bool landing() const noexcept { return touchdown_.has_value(); }
  /// What joint 0 .. joints() - 1 is sent at a time of that clock, before, between and after the events; for a time
  /// that is not finite, and for times before the release, the angle of release.
  DriveCommand at(int joint, double t) const noexcept;
  /// When the last landing motion ends, by the clock; infinite before the touchdown.
  double end() const noexcept;

 private:
  std::vector<Motion> motions_, landings_;  ///< as planned; as started at the touchdown
  std::optional<double> released_, touchdown_;
};

}  // namespace ukemi::landing
