// The fast path of one kernel: nothing but the peak. Instantiated for each in body_kernel.cpp; private to landing.
#pragma once

#include "landing/body/body_run.hpp"
#include "landing/body/equations.hpp"

namespace ukemi::landing {

template <Capacity kSize>
BodyLanding peak_in_kernel(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options);

}  // namespace ukemi::landing
