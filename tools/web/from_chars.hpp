// std::from_chars of doubles, which Emscripten's standard library lacks as of 3.1. Included before every file.
#pragma once

#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <string>

namespace std {

/// As in the standard, general format: no leading blanks or '+', no hexadecimals.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  const string text(first, last);
  const size_t sign = text.rfind('-', 0) == 0 ? 1 : 0;
  const bool is_number = text.size() > sign && text.find_first_of("0123456789.iInN", sign) == sign;
  if (!is_number || text.compare(sign, 2, "0x") == 0 || text.compare(sign, 2, "0X") == 0)
    return {first, errc::invalid_argument};
  char* end = nullptr;
  errno = 0;
  const double parsed = strtod(text.c_str(), &end);
  if (end == text.c_str()) return {first, errc::invalid_argument};
  const char* stop = first + (end - text.c_str());
  if (errno == ERANGE) return {stop, errc::result_out_of_range};
  value = parsed;
  return {stop, errc{}};
}

}  // namespace std
