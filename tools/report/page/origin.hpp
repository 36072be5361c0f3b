// Provenance embedded in figure files.
#pragma once

#include <string>

namespace ukemi::tools {

/// Contents of an SVG, PNG or PDF file, by the ending of its name, with an embedded text: <metadata> of SVG, text chunk
/// "Comment" of PNG, Keywords of PDF. A file that is not as gnuplot writes it is returned unchanged.
std::string with_origin(const std::string& name, std::string content, const std::string& text);

}  // namespace ukemi::tools
