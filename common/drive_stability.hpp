// Stability of a drive: whether it comes to rest by itself.
#pragma once

#include "common/sea.hpp"

namespace ukemi {

/// How fast a small disturbance of the drive at rest grows: the largest real part of the eigenvalues of Eq. 2-4, linear
/// and with the torque limit not reached, with a link of `inertia` M [kg m^2] on the spring [1/s]. Below 0 it decays;
/// 0 where what is found is within rounding of it. Eq. 3 feeds back the output angle: not every set of gains that looks
/// sound is stable, and none is without damping in the spring; a delay makes it less so. Dry friction and stiffening do
/// not count. Test: test/unit/sea.cpp against the Routh criterion.
double growth_rate(const SeaParameters<double>& sea, double inertia);

}  // namespace ukemi
