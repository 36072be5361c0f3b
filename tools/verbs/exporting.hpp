// --export and --joint: results in formats of other programs.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tools/report/exports.hpp"

namespace ukemi::tools {

/// Formats by name, and the option's help.
struct ExportChoices {
  std::vector<std::pair<std::string, Exports::Format>> formats;
  std::string help;
};
/// Formats of a motion and its landing.
ExportChoices landing_exports();
/// Formats of an actuator.
ExportChoices actuator_exports();
/// Throws InputError where a robot of links cannot be exported so: --joint requires a single driven joint.
void check_exports(const Exports& exports, const landing::Robot& robot);
void add_export(CLI::App& verb, Exports& exports, const ExportChoices& choices);

}  // namespace ukemi::tools
