// A verb of the program. It registers itself in its own source file; there is no central list.
#pragma once

#include <string>
#include <vector>

#include "tools/program/command.hpp"

namespace ukemi::tools {

/// Headings of `ukemi --help`, in this order.
enum class VerbGroup { kConstants, kLandings, kProgram };
const char* name(VerbGroup group);

/// The constructor registers the verb; construct it as a constant of its source file.
struct Verb {
  VerbGroup group;
  const char *name, *purpose;
  void (*add)(CLI::App* verb, Action& chosen);  ///< adds options and action to its subcommand

  Verb(VerbGroup group, const char* name, const char* purpose, void (*add)(CLI::App* verb, Action& chosen));
};

/// Every verb that is linked, sorted by group and name.
std::vector<Verb> verbs();

}  // namespace ukemi::tools
