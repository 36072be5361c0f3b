// A verb of the program, told once: in its own file, which no list names.
#pragma once

#include <string>
#include <vector>

#include "tools/program/command.hpp"

namespace ukemi::tools {

/// Headings of `ukemi --help`, in this order.
enum class VerbGroup { kConstants, kLandings, kProgram };
const char* name(VerbGroup group);

/// A verb enrols itself where it is constructed, as a constant of its source file.
struct Verb {
  VerbGroup group;
  const char *name, *purpose;
  void (*add)(CLI::App* verb, Action& chosen);  ///< its options and what it does, into its subcommand

  Verb(VerbGroup group, const char* name, const char* purpose, void (*add)(CLI::App* verb, Action& chosen));
};

/// Every verb that is linked, by group and name.
std::vector<Verb> verbs();

}  // namespace ukemi::tools
