// Rollouts of a driven robot with one kernel. Instantiated for each kernel in driven_kernel.cpp; private to landing.
#pragma once

#include "landing/body/equations.hpp"
#include "landing/driven/driven_rollout.hpp"

namespace ukemi::landing {

/// See stable_step.
template <Capacity kSize>
double stable_in_kernel(const Robot& robot, const CommandPath& path, const Commands& commands,
                        const DrivenStart& start);
/// See roll_driven; options.step > 0.
template <Capacity kSize>
DrivenRollout roll_in_kernel(const Robot& robot, const CommandPath& path, const Commands& commands,
                             const DrivenStart& start, const std::vector<double>& times, const DrivenOptions& options);

}  // namespace ukemi::landing
