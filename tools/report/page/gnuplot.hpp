// gnuplot as a process of its own: a script goes in, the files that it wrote come out.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace ukemi::tools {

/// Runs gnuplot on a script in a temporary folder, which is its working directory, and returns the files of these names
/// that it left there. Empty where that fails, and `why` says it in one line: not installed, no room, its own message.
std::map<std::string, std::string> gnuplot(const std::string& script, const std::vector<std::string>& names,
                                           std::string& why);

/// A text as a string of gnuplot's, in which nothing is expanded or executed.
std::string gnuplot_text(const std::string& text);

}  // namespace ukemi::tools
