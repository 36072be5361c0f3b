// Landings by one kernel. Instantiated for each kernel in body_kernel.cpp and report_kernel.cpp; private to landing.
#pragma once

#include "landing/body/body_run.hpp"
#include "landing/body/equations.hpp"

namespace ukemi::landing {

/// See peak_acceleration and simulate; inputs have been validated.
template <Capacity kSize>
BodyLanding peak_in_kernel(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options);
template <Capacity kSize>
BodyLanding report_in_kernel(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options,
                             double rate);

}  // namespace ukemi::landing
