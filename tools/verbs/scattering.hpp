// Options that several verbs share: how drops scatter.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "landing/scatter/drop_model.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

struct ScatterArguments {
  std::optional<std::string> scatter;  ///< NAME=STD,...
  std::optional<double> inflate;
  std::string drops;  ///< a file of measured ones
};
void add_scatter(CLI::App& verb, ScatterArguments& arguments);
/// --samples of a plan for drops that scatter.
void add_samples(CLI::App& verb, std::optional<long>& samples);

/// Their --inflate, 1 where it is not given. Throws InputError.
double checked_inflate(const ScatterArguments& arguments);

/// What they say. Throws InputError.
struct Scattering {
  std::optional<landing::Scatter> scatter;       ///< none: the scene's, or what is assumed
  double inflate = 1;                            ///< of the constants' standard errors
  std::vector<landing::ScatteredDrop> measured;  ///< instead of drawn drops
};
Scattering scattering_of(const ScatterArguments& arguments, const landing::Scene& scene, const Actuator& actuator,
                         Run& run);

}  // namespace ukemi::tools
