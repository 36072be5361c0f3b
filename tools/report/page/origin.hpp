// A figure that leaves its folder says where it comes from.
#pragma once

#include <string>

namespace ukemi::tools {

/// An SVG, PNG or PDF file, told by the ending of its name, with a text inside: SVG's <metadata>, PNG's text chunk
/// "Comment", the Keywords of a PDF's information. A file that is not as gnuplot writes it stays as it is.
std::string with_origin(const std::string& name, std::string content, const std::string& text);

}  // namespace ukemi::tools
