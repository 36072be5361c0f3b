#include "common/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace ukemi {

namespace {

/// Length in bytes of the UTF-8 character that starts with `first_byte`; 0: no character does.
std::size_t length_of(unsigned char first_byte) {
  if (first_byte < 0x80) return 1;
  if (first_byte >= 0xC2 && first_byte < 0xE0) return 2;
  if (first_byte >= 0xE0 && first_byte < 0xF0) return 3;
  return first_byte >= 0xF0 && first_byte < 0xF5 ? 4 : 0;
}

std::string escaped(const Character& c) {
  switch (c.code) {
    case '\n':
      return "\\n";
    case '\r':
      return "\\r";
    case '\t':
      return "\\t";
    default:
      return c.code < 0x80 ? fmt::format("\\x{:02x}", static_cast<unsigned char>(c.bytes.front()))
                           : fmt::format("\\u{:04x}", c.code);
  }
}

}  // namespace

bool Character::printable() const {
  const bool control = code < 0x20 || (code >= 0x7F && code < 0xA0);
  const bool line_or_direction = (code >= 0x2028 && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
  return !control && !line_or_direction;
}

Character first_character(std::string_view text) {
  const Character none{text.substr(0, 1), -1};
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::size_t length = length_of(byte(0));
  if (length == 0 || length > text.size()) return none;
  std::int32_t code = length == 1 ? byte(0) : byte(0) & (0x7F >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return none;
    code = code << 6 | (byte(i) & 0x3F);
  }
  constexpr std::int32_t kSmallest[] = {0, 0, 0x80, 0x800, 0x10000};  // smallest code that needs 1, 2, 3, 4 bytes
  const bool surrogate = code >= 0xD800 && code < 0xE000;
  if (code < kSmallest[length] || code > 0x10FFFF || surrogate) return none;
  return {text.substr(0, length), code};
}

std::string shown(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const Character c = first_character(text);
    out += c.printable() ? std::string(c.bytes) : escaped(c);
    text.remove_prefix(c.bytes.size());
  }
  return out;
}

std::string lower_case(std::string text) {
  for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string shell_quoted(const std::string& argument) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || std::string_view("_@%+=:,./-").find(c) != std::string::npos;
  };
  if (!argument.empty() && std::all_of(argument.begin(), argument.end(), plain)) return argument;
  const bool raw = shown(argument) == argument;
  std::string out = raw ? "'" : "$'";
  for (std::string_view remaining = argument; !remaining.empty();) {
    const Character c = first_character(remaining);
    if (c.bytes == "'")
      out += raw ? "'\\''" : "\\'";
    else if (c.bytes == "\\")
      out += raw ? "\\" : "\\\\";
    else
      out += shown(c.bytes);
    remaining.remove_prefix(c.bytes.size());
  }
  return out + "'";
}

}  // namespace ukemi
