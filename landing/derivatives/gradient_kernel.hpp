// A landing with its derivatives by one kernel. Instantiated for each in gradient_kernel.cpp; private to landing.
#pragma once

#include "landing/body/equations.hpp"
#include "landing/derivatives/body_gradient.hpp"

namespace ukemi::landing {

/// Parameters of one run.
inline constexpr int kAtOnce = 8;

/// Of at most kAtOnce parameters.
template <Capacity kSize>
BodyGradients gradients_in_kernel(const BodyScene& scene, const BodyMotion& motion,
                                  std::span<const BodyParameter> parameters, const SimulateOptions& options, int most);

}  // namespace ukemi::landing
