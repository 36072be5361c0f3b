// Stability of a drive: whether it comes to rest by itself.
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/sea.hpp"

namespace ukemi {

/// Growth rate of a small disturbance of the drive at rest [1/s]: the largest real part of the eigenvalues of Eq. 2-4,
/// linearised below the torque limit, with a link of `inertia` M [kg m^2] on the spring. Below 0 it decays; 0 where it
/// is within rounding of 0. With Eq. 3 feeding back the output angle, not every plausible set of gains is stable, none
/// is without damping in the spring, and a delay destabilises. Dry friction and stiffening are left out.
/// Test: test/unit/sea.cpp against the Routh criterion.
double growth_rate(const SeaParameters<double>& sea, double inertia);

/// A joint of a robot at rest.
struct LinearJoint {
  const SeaParameters<double>* elastic = nullptr;  ///< a motor behind a spring; null: none
  /// In parallel to it: springs, dampers, the gains of a motor that turns with the joint [Nm/rad], [Nm/(rad/s)].
  double stiffness = 0, damping = 0;
};
struct Growth {
  double rate = 0;  ///< as growth_rate [1/s]
  int joint = 0;    ///< with the largest rates in the mode that grows
};
/// Growth rate of all joints of a robot together. `compliance`: acceleration of joint i (row) by a unit torque of joint
/// k (column), motors that turn with them included [1/(kg m^2)]. Test: test/legs/plans.cpp against rates of a landing.
Growth growth(std::span<const LinearJoint> joints, const Eigen::MatrixXd& compliance);

}  // namespace ukemi
