// Landings by one kernel. Instantiated for each kernel in body_kernel.cpp and report_kernel.cpp; private to landing.
#pragma once

#include "landing/body/body_run.hpp"
#include "landing/body/equations.hpp"

namespace ukemi::landing {

/// peak_acceleration of inputs that have been validated.
BodyLanding peak_of_valid(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options);
/// The same by the single method of the options, to compare integrators; for robots that fit kPair or kLateLeg.
BodyLanding peak_by_method(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options);

/// See peak_acceleration and simulate; inputs have been validated.
template <Capacity kSize>
BodyLanding peak_in_kernel(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options);
template <Capacity kSize>
BodyLanding report_in_kernel(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options,
                             double rate);

}  // namespace ukemi::landing
