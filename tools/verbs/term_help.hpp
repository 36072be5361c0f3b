// The help of --nuisance, generated from a table of terms.
#pragma once

#include <string>
#include <vector>

#include "identify/estimate/term.hpp"

namespace ukemi::tools {

/// "fitted along; one for all: friction [Nm], dry friction on the motor; ...".
template <class T>
std::string nuisance_help(const std::vector<T>& table, const std::string& each) {
  std::string out = "fitted along";
  for (const auto scope : {identify::Scope::kShared, identify::Scope::kEach}) {
    std::string list;
    for (const T& t : table)
      if (!t.is_constant() && t.scope == scope)
        list += (list.empty() ? "" : "; ") + t.name + " [" + t.unit + "], " + t.words;
    if (!list.empty()) out += (scope == identify::Scope::kShared ? ". One for all: " : ". " + each + ": ") + list;
  }
  return out;
}

}  // namespace ukemi::tools
