// The program's command line: its verbs, and what one call runs.
#pragma once

#include "tools/program/command.hpp"

namespace ukemi::tools {

/// Every verb with its options; what is parsed next sets `chosen`.
void add_verbs(CLI::App& app, Action& chosen);

/// What the words ask for, the first being the program's name. Nothing is read or written before the action is called;
/// that of --help and --version prints. Throws InputError.
Action action_of(int argc, const char* const* argv);

}  // namespace ukemi::tools
