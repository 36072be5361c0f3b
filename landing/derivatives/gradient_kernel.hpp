// Gradients of a landing with one kernel. Instantiated for each kernel in gradient_kernel.cpp; private to landing.
#pragma once

#include "landing/body/equations.hpp"
#include "landing/derivatives/body_gradient.hpp"

namespace ukemi::landing {

/// Maximum number of parameters of one run.
inline constexpr int kParametersPerRun = 8;

/// See gradients(); at most kParametersPerRun parameters.
template <Capacity kSize>
BodyGradients gradients_in_kernel(const BodyScene& scene, const BodyMotion& motion,
                                  std::span<const BodyParameter> parameters, const SimulateOptions& options,
                                  int max_peaks);

}  // namespace ukemi::landing
