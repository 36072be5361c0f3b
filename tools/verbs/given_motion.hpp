// The motion of a verb's options: a file, or an angle at which the reference is held.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "landing/body/body_scene.hpp"
#include "landing/model/motion.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

struct MotionArguments {
  std::string file;
  std::optional<std::string> hold;  ///< [deg]; of a robot of links JOINT=DEG,...
};
/// Adds --motion and --hold.
void add_motion(CLI::App& verb, MotionArguments& arguments);
/// Throws InputError unless exactly one of the two is given. A file becomes an input of the run.
landing::Motion motion_of(const MotionArguments& arguments, const std::string& verb, Run& run);
/// Of a robot of links; where none of the two is given, the posture that the scene holds.
landing::BodyMotion motion_of(const landing::BodyScene& scene, const MotionArguments& arguments, Run& run);

}  // namespace ukemi::tools
