// What looks wrong with a scene of a robot of links before anything falls.
#pragma once

#include <string>
#include <vector>

#include "landing/body/body_scene.hpp"

namespace ukemi::landing {

/// `doubts` of the robot, then those of how it is let go: beyond a stop, below the floor, by two numbers that differ,
/// with a move in the air that the floor comes before, in radians for degrees. Tests: test/legs/plans.cpp.
std::vector<std::string> doubts(const BodyScene& scene);

}  // namespace ukemi::landing
