// The page's style and scripts, which the build embeds from this folder (assets.cpp.in).
#pragma once

namespace ukemi::tools {

extern const char* const kStyle;
extern const char* const kScript;
extern const char* const kScriptSha256;  ///< hexadecimal

}  // namespace ukemi::tools
