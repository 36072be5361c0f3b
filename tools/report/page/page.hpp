// A self-contained HTML page, light and dark, readable without script. Text from outside cannot run: it is escaped, and
// the page's Content-Security-Policy allows its own script only.
#pragma once

#include <string>

namespace ukemi::tools {

/// A text escaped for HTML and for attributes; unprintable characters as in `shown`.
std::string escaped(const std::string& text);
/// A text with m/s² for m/s^2.
std::string printed(std::string text);
/// escaped(printed(text)): a sentence, a heading or a cell.
std::string prose(const std::string& text);
/// JSON in a <script> element, which no text in it can end.
std::string json_block(const std::string& id, const std::string& json);

/// The page with a body, style and script.
std::string page(const std::string& title, const std::string& body);

}  // namespace ukemi::tools
