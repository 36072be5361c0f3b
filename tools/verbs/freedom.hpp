// Options that several verbs share: the objective; what motions of a scene may have besides the paper's three numbers,
// and how the joint hangs at release, which stand for [motion] and [release] of the scene.
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
/// --objective peak or tolerant.
void add_objective(CLI::App& verb, landing::Goal& goal);
void add_freedom(CLI::App& verb, FreedomArguments& arguments);
/// What they say of bumps and gains, instead of what a scene says. Throws InputError.
void apply(const FreedomArguments& arguments, landing::Freedom& freedom);
/// The release of a scene of one driven joint as they change it. Throws InputError.
std::optional<landing::Release> release_of(const FreedomArguments& arguments,
                                           const std::optional<landing::Release>& scene);
/// Warns of a --release-phi that was perhaps meant in radians.
void warn_of_radians(const FreedomArguments& arguments, Run& run);
/// The scene of a file, an input of the run, with a warning of what its calibration did not trust. Throws InputError.
landing::Scene scene_of(const std::string& path, Run& run);
/// The scene, with the arguments instead of its own keys. Throws InputError.
landing::Scene scene_of(const std::string& path, const FreedomArguments& arguments, Run& run);

}  // namespace ukemi::tools
