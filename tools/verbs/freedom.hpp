// Options that several verbs share: what motions of a scene may have beside the paper's three numbers, and how the
// joint hangs at release. They stand for [motion] and [release] of the scene.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "landing/model/scene.hpp"

namespace ukemi::tools {

struct FreedomArguments {
  std::optional<int> bumps;
  std::optional<std::string> gains;                       ///< LO:HI
  std::optional<double> release_phi, release_rate, from;  ///< deg, deg/s, s
};
void add_freedom(CLI::App& verb, FreedomArguments& arguments);
/// In place of what the scene says. Throws InputError.
void apply(const FreedomArguments& arguments, landing::Scene& scene);

}  // namespace ukemi::tools
