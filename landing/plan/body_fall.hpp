// What a robot of links measures in the air, as the scene that is planned for.
#pragma once

#include <string>

#include "landing/plan/body_planner.hpp"

namespace ukemi::landing {

/// What is wrong with the first number of a drop, or of a fall of a robot of so many joints, that is out of its range
/// or NaN; empty: nothing.
std::string fault_of(const Drop& drop);
std::string fault_of(const BodyFallState& state, std::size_t joints);
/// The scene let go as it falls now, its references free to move from `from` on [s].
BodyScene falling(BodyScene scene, const BodyFallState& state, double from);

}  // namespace ukemi::landing
