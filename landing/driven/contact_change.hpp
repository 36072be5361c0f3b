// When a contact of a driven robot touches its surface.
#pragma once

namespace ukemi::landing {

/// A contact that touches its surface or leaves it.
struct ContactChange {
  double t;      ///< [s]
  int contact;   ///< of Robot::contacts
  bool touches;  ///< else it leaves
};

}  // namespace ukemi::landing
