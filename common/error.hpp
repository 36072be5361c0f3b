// Bad input: one exception, one line that says where, what, the value and the rule.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace ukemi {

/// A place in a file; line and column count from 1, 0: not known.
struct Location {
  std::string file;
  long line = 0, column = 0;
  std::string text() const;  ///< "file:line:column", as far as known
};

/// Bad usage or bad input. what() is `file:line:column: what: value (rule)` on one line, whatever the file is called.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message);
  InputError(const Location& where, const std::string& message) : InputError(where.text() + ": " + message) {}
};

/// The key of `known` nearest to `given`: with the same letters, else by edit distance, or empty where none is near
/// (more than 2 edits and a third of its length).
std::string nearest(const std::string& given, const std::vector<std::string>& known);

/// ` (did you mean "x"?)` for the nearest key, or an empty text.
std::string hint(const std::string& given, const std::vector<std::string>& known);

/// `'given': one of a, b, c is needed (did you mean "a"?)`.
std::string one_of(const std::string& given, const std::vector<std::string>& known);

/// A value from a file for an error message: as `shown`, cut after the character that reaches 40 bytes.
std::string quoted(const std::string& value);

}  // namespace ukemi
