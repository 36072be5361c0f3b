// --export and --joint: results as other programs read them.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tools/report/exports.hpp"

namespace ukemi::tools {

/// Formats by their names, and what they are for.
struct ExportChoices {
  std::vector<std::pair<std::string, Exports::Format>> formats;
  std::string help;
};
/// Formats of a motion and its landing.
ExportChoices landing_exports();
/// Formats of an actuator.
ExportChoices actuator_exports();
/// Throws InputError unless the joints of a robot of links can be exported so: --joint is the name of one alone.
void check_exports(const Exports& exports, const landing::Robot& robot);
void add_export(CLI::App& verb, Exports& exports, const ExportChoices& choices);

}  // namespace ukemi::tools
