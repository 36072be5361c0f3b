// Untrusted text, made safe to show: on one line, without control characters, in a form that our own readers accept.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace ukemi {

/// One character of UTF-8.
struct Character {
  std::string_view bytes;
  std::int32_t code;  ///< code point; -1: one byte that belongs to no character
  /// Neither a control character nor a mark that ends a line or changes the writing direction.
  bool printable() const;
};
/// The first character of a text that is not empty.
Character first_character(std::string_view text);

/// `text` with unprintable characters escaped as \n, \r, \t, \x1b, \u202e. Idempotent.
std::string shown(std::string_view text);

/// An argument as a shell reads it back: quoted where needed, and printable.
std::string shell_quoted(const std::string& argument);

}  // namespace ukemi
