// Text from outside, made safe to show: one line, nothing that a terminal acts on, nothing that a reader of ours
// refuses.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace ukemi {

/// One character of UTF-8.
struct Character {
  std::string_view bytes;
  std::int32_t code;  ///< code point; -1: one byte that belongs to no character
  /// Neither a control character nor a mark that ends a line or turns the direction of writing.
  bool printable() const;
};
/// The first character of a text that is not empty.
Character first_character(std::string_view text);

/// `text` with what is not printable as \n, \r, \t, \x1b, \u202e, and the rest as it is. What is shown already stays.
std::string shown(std::string_view text);

/// An argument as a shell takes it back: quoted where it must be, and printable.
std::string shell_quoted(const std::string& argument);

}  // namespace ukemi
