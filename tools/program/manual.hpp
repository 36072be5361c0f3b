// Sources of the manual: bash completion and the list of man pages, generated from the program's options.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

namespace ukemi::tools {

/// File name -> text: "ukemi.bash", the completion, and "pages", a line for the program and for each verb that --help
/// names, which help2man makes a man page of (tools/cmake/manual.sh).
std::map<std::string, std::string> manual(const CLI::App& app);

}  // namespace ukemi::tools
