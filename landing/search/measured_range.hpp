// Ranges of what a robot measures of its fall.
#pragma once

#include "landing/model/scene.hpp"

namespace ukemi::landing {

// The rule of the first number that is out of its range or NaN; null: none.

const char* fault_of(const Drop& drop);
const char* fault_of_deadline(double deadline);       ///< [s]
const char* fault_of_joint(double phi, double rate);  ///< [rad], [rad/s]
const char* fault_of_elapsed(double elapsed);         ///< since release [s]

}  // namespace ukemi::landing
