// Peak only, with one kernel. Instantiated for each kernel in body_kernel.cpp; private to landing.
#pragma once

#include "landing/body/body_run.hpp"
#include "landing/body/equations.hpp"

namespace ukemi::landing {

template <Capacity kSize>
BodyLanding peak_in_kernel(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options);

}  // namespace ukemi::landing
