// Runs gnuplot as a child process.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace ukemi::tools {

/// Runs gnuplot on a script in a temporary working directory and returns the contents of the files `names` that it
/// wrote. Empty where that fails; `why` is then the reason in one line.
std::map<std::string, std::string> gnuplot(const std::string& script, const std::vector<std::string>& names,
                                           std::string& why);

/// A text as a gnuplot string literal, in which nothing is expanded or executed.
std::string gnuplot_text(const std::string& text);

}  // namespace ukemi::tools
