// Options that several verbs share: the objective; variables of a motion besides the paper's three, and the joint's
// state at release, which override [motion] and [release] of the scene.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "landing/model/scene.hpp"
#include "landing/search/goal.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

struct FreedomArguments {
  std::optional<int> bumps;
  std::optional<std::string> gains;                       ///< LO:HI
  std::optional<double> release_phi, release_rate, from;  ///< deg, deg/s, s
};
/// Adds --objective: peak or tolerant.
void add_objective(CLI::App& verb, landing::Goal& goal);
void add_freedom(CLI::App& verb, FreedomArguments& arguments);
/// Overrides a scene's bumps and gains. Throws InputError.
void apply(const FreedomArguments& arguments, landing::Freedom& freedom);
/// The release of a scene with one driven joint, overridden by the arguments. Throws InputError.
std::optional<landing::Release> release_of(const FreedomArguments& arguments,
                                           const std::optional<landing::Release>& scene);
/// Warns of a --release-phi that may be in radians.
void warn_of_radians(const FreedomArguments& arguments, Run& run);
/// Reads a scene as an input of the run; warns of constants that its calibration did not trust. Throws InputError.
landing::Scene scene_of(const std::string& path, Run& run);
/// Reads a scene as above and overrides its keys by the arguments.
landing::Scene scene_of(const std::string& path, const FreedomArguments& arguments, Run& run);

}  // namespace ukemi::tools
