// What the fit that found constants says of each, as [verdict] of a file has it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/toml.hpp"

namespace ukemi {

/// Constants, each with "trusted", "weak", "not identifiable", "at its bound" or "fixed".
using Verdicts = std::vector<std::pair<std::string, std::string>>;

/// Of [verdict]; keys are some of `constants`, the result is in their order. Empty where the file has no such table.
/// Throws InputError with file:line:column.
Verdicts read_verdicts(TomlFile& file, const std::vector<std::string>& constants);
/// The table as a file has it; empty where there is no verdict.
std::string verdict_table(const Verdicts& verdicts);
/// Those that are neither trusted nor fixed.
Verdicts doubted(const Verdicts& verdicts);
/// The doubted in words: "k_sea is weak, c_sea is not identifiable".
std::string doubts(const Verdicts& verdicts);

}  // namespace ukemi
