// Gradients of a landing with one kernel. Instantiated for each kernel in gradient_kernel.cpp; private to landing.
#pragma once

#include "landing/body/equations.hpp"
#include "landing/derivatives/body_gradient.hpp"

namespace ukemi::landing {

/// Maximum number of parameters of one run, and of one with few derivatives, which kernels of plain links have too.
inline constexpr int kParametersPerRun = 8, kFewParameters = 4;

/// See gradients(); at most P parameters.
template <Capacity kSize, int P>
BodyGradients gradients_in_kernel(const BodyScene& scene, const BodyMotion& motion,
                                  std::span<const BodyParameter> parameters, const SimulateOptions& options,
                                  int max_peaks);

}  // namespace ukemi::landing
