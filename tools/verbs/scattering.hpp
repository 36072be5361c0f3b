// Options that several verbs share: how drops scatter.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "landing/model/scatter.hpp"

namespace ukemi::tools {

struct ScatterArguments {
  std::optional<std::string> scatter;  ///< NAME=STD,...
  double inflate = 1;
};
void add_scatter(CLI::App& verb, ScatterArguments& arguments);
/// The scatter that was asked for; none: the scene's, or what is assumed. Throws InputError.
std::optional<landing::Scatter> scatter_of(const ScatterArguments& arguments);

}  // namespace ukemi::tools
