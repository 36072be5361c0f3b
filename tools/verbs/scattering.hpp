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
  std::string drops;  ///< file of measured drops
  /// Throws InputError where `option`, which is for drawn drops, is given beside --drops.
  void refuse_beside_drops(bool given, const char* option) const;
  /// The same of --scatter and --inflate.
  void check_measured() const;
};
/// Adds --scatter and --inflate.
void add_scatter(CLI::App& verb, ScatterArguments& arguments);
void add_drops(CLI::App& verb, ScatterArguments& arguments);
/// Adds --samples of a plan for drops that scatter.
void add_samples(CLI::App& verb, std::optional<long>& samples);

/// --inflate, by default 1. Throws InputError.
double checked_inflate(const ScatterArguments& arguments);

/// The scatter that the arguments describe.
struct Scattering {
  std::optional<landing::Scatter> scatter;       ///< absent: the scene's, else the default
  double inflate = 1;                            ///< of the constants' standard errors
  std::vector<landing::ScatteredDrop> measured;  ///< instead of drawn drops
};
Scattering scattering_of(const ScatterArguments& arguments, const landing::Scene& scene, const Actuator& actuator,
                         Run& run);

}  // namespace ukemi::tools
