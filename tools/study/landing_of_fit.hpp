// The effect of an identified actuator's uncertainty on the peak of a motion.
#pragma once

#include "common/actuator.hpp"
#include "landing/model/motion_space.hpp"
#include "landing/model/scene.hpp"

namespace ukemi::tools {

/// The peak of one motion in one scene, everything as planned except the actuator, which is drawn from the covariance
/// of its five constants (normal, cut at three deviations, no constant below 0). Peaks in m/s^2.
struct LandingOfFit {
  landing::Scene scene;
  landing::Motion motion;
  double peak = 0;         ///< with the fitted constants; infinite where the landing cannot be followed
  double mean = 0;         ///< over the drawn actuators
  double deviation = 0;    ///< standard deviation over them: further measurements could remove it
  double worst_tenth = 0;  ///< mean of the worst tenth
  long samples = 0;        ///< number of drawn landings; 0: the fit has no covariance
  long failed = 0;         ///< further drawn landings that could not be followed, and are left out
};

/// Simulates 1024 scrambled Sobol points of the covariance. The result depends on inputs and seed, not on the threads
/// (0: all cores). Throws InputError for a covariance that is not positive semidefinite.
[[nodiscard]] LandingOfFit landing_of_fit(const landing::Scene& scene, const Actuator& actuator,
                                          const landing::Motion& motion, std::uint64_t seed, int threads = 0);

}  // namespace ukemi::tools
