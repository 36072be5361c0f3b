// The page's style and script, style.css and the scripts of this folder, as the build puts them into the program.
#pragma once

namespace ukemi::tools {

extern const char* const kStyle;
extern const char* const kScript;
extern const char* const kScriptSha256;  ///< hexadecimal

}  // namespace ukemi::tools
