// Untrusted text, made safe to show: on one line, without control characters, in a form that our own readers accept.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
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

/// The number that the text is, in decimal digits; none where it is another text.
template <class Number>
std::optional<Number> parsed_number(std::string_view text) {
  Number out{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, out);
  return error == std::errc() && stop == end ? std::optional(out) : std::nullopt;
}

/// `text` with the letters A to Z in lower case.
std::string lower_case(std::string text);

/// An argument as a shell reads it back: quoted where needed, and printable.
std::string shell_quoted(const std::string& argument);

}  // namespace ukemi
