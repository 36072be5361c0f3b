// Touchdowns and lift-offs of a driven robot.
#pragma once

namespace ukemi::landing {

/// A touchdown or lift-off of a contact.
struct ContactChange {
  double t;      ///< [s]
  int contact;   ///< of Robot::contacts
  bool touches;  ///< touchdown; else lift-off
};

}  // namespace ukemi::landing
