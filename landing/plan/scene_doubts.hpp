// Implausible values of a scene of a robot of links, before any simulation.
#pragma once

#include <string>
#include <vector>

#include "landing/body/body_scene.hpp"

namespace ukemi::landing {

/// `doubts` of the robot, then of its release: beyond a stop, below the floor, two numbers of one angle that differ, a
/// move in the air that would start after touchdown, radians for degrees. Tests: test/legs/plans.cpp.
std::vector<std::string> doubts(const BodyScene& scene);

}  // namespace ukemi::landing
