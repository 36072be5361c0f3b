// Stability of a drive: whether it comes to rest by itself.
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/sea.hpp"

namespace ukemi {

/// How fast a small disturbance of the drive at rest grows: the largest real part of the eigenvalues of Eq. 2-4, linear
/// and with the torque limit not reached, with a link of `inertia` M [kg m^2] on the spring [1/s]. Below 0 it decays;
/// 0 where what is found is within rounding of it. Eq. 3 feeds back the output angle: not every set of gains that looks
/// sound is stable, and none is without damping in the spring; a delay makes it less so. Dry friction and stiffening do
/// not count. Test: test/unit/sea.cpp against the Routh criterion.
double growth_rate(const SeaParameters<double>& sea, double inertia);

/// A joint of a robot at rest.
struct LinearJoint {
  const SeaParameters<double>* elastic = nullptr;  ///< a motor behind a spring; null: none
  /// Beside it: of springs and dampers, of the gains of a motor that turns with the joint [Nm/rad], [Nm/(rad/s)].
  double stiffness = 0, damping = 0;
};
struct Growth {
  double rate = 0;  ///< as growth_rate [1/s]
  int joint = 0;    ///< whose rates are the largest in what grows
};
/// The same of all joints of a robot together. `compliance`: what a torque of joint k (column) accelerates joint i
/// (row), motors that turn with them included [1/(kg m^2)]. Test: test/legs/plans.cpp against a landing's own rates.
Growth growth(std::span<const LinearJoint> joints, const Eigen::MatrixXd& compliance);

}  // namespace ukemi
