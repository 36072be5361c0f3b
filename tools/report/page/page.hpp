// One page: HTML in one file that fetches nothing, light and dark, readable without script. Text from outside is shown
// and never run: it is escaped, and the page's policy allows its own script alone.
#pragma once

#include <string>

namespace ukemi::tools {

/// A text as HTML shows it, in an attribute too; what is not printable as `shown` has it.
std::string escaped(const std::string& text);
/// Units as they are printed: m/s² where a terminal and files have m/s^2.
std::string printed(std::string text);
/// A sentence, a heading or a cell: escaped, with units as they are printed.
std::string prose(const std::string& text);
/// JSON as a page carries it in a <script>, which no text in it can end.
std::string json_block(const std::string& id, const std::string& json);

/// The page around its body, with the style and the script.
std::string page(const std::string& title, const std::string& body);

}  // namespace ukemi::tools
