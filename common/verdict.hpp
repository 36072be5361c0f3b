// The verdict of a fit on each constant that it found, as in [verdict] of a file.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace ukemi {

/// Constants, each with "trusted", "weak", "not identifiable", "at its bound" or "fixed".
using Verdicts = std::vector<std::pair<std::string, std::string>>;

/// Those that are neither trusted nor fixed.
Verdicts doubted(const Verdicts& verdicts);
/// The doubted verdicts in words: "k_sea is weak, c_sea is not identifiable".
std::string doubts(const Verdicts& verdicts);

}  // namespace ukemi
