// Headings of --help, by the subject of an option, defined once for all verbs.
#pragma once

#include <CLI/CLI.hpp>

namespace ukemi::tools {

/// Puts every option of the verbs under its heading, in one order of headings. An option without one stays under
/// "Options", as --help does. Call after all verbs have added their options.
void group_options(CLI::App& app);

}  // namespace ukemi::tools
