// From a measured fall of a robot of links to the scene that is planned for.
#pragma once

#include <string>

#include "landing/plan/body_planner.hpp"
#include "landing/search/measured_range.hpp"

namespace ukemi::landing {

/// The rule of the first number of a fall of a robot with `joints` that is out of its range or NaN; empty: none.
std::string fault_of(const BodyFallState& state, std::size_t joints);
/// The scene released in the measured state, its references free to move after `from` [s].
BodyScene falling(BodyScene scene, const BodyFallState& state, double from);

}  // namespace ukemi::landing
