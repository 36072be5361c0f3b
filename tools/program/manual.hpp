// Man pages and bash completion, made from the program's own options.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

namespace ukemi::tools {

/// File name -> text: a man page for the program and for each verb that --help names ("ukemi-optimize.1"), and
/// "ukemi.bash", the completion. `version` is printed at the foot of the pages.
std::map<std::string, std::string> manual(const CLI::App& app, const std::string& version);

}  // namespace ukemi::tools
