// What the fit that found constants says of each, as [verdict] of a file has it.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace ukemi {

/// Constants, each with "trusted", "weak", "not identifiable", "at its bound" or "fixed".
using Verdicts = std::vector<std::pair<std::string, std::string>>;

/// Those that are neither trusted nor fixed.
Verdicts doubted(const Verdicts& verdicts);
/// The doubted in words: "k_sea is weak, c_sea is not identifiable".
std::string doubts(const Verdicts& verdicts);

}  // namespace ukemi
