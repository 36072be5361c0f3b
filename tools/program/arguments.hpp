// Parsers of option texts: lists, numbers, names, NAME=VALUE. Each throws InputError "OPTION: 'text': rule".
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace ukemi::tools {

std::vector<std::string> split(const std::string& list);  ///< the items between commas
double to_number(const std::string& option, const std::string& text);
/// A warning for each file that is listed more than once.
std::vector<std::string> duplicate_warnings(const std::vector<std::string>& files);
/// A warning for each validation file that is fitted too.
std::vector<std::string> overlap_warnings(const std::vector<std::string>& fitted,
                                          const std::vector<std::string>& validation);
/// "'text': rule" where the text is not a finite number, or not a whole one; else empty. Decimal only: no "0x10".
enum class Whole { kNo, kYes };
std::string number_fault(const std::string& text, Whole whole);
std::uint64_t to_seed(const std::string& option, const std::string& text);  ///< decimal digits, up to 64 bits

/// Splits NAME=VALUE at the last '='; `form`: the syntax that the error message names.
struct Assignment {
  std::string name, value;
};
Assignment assignment(const std::string& option, const std::string& item, const char* form = "NAME=VALUE");

/// Sets values[name]. Throws InputError where it is set already: `given`, the user's spelling, is named twice.
void set_once(const std::string& option, const std::string& given, const std::string& name, double value,
              std::map<std::string, double>& values);

/// NAME=VALUE:STD.
struct NamedPrior {
  std::string name;
  double value, std;
};
NamedPrior named_prior(const std::string& option, const std::string& item);

/// LO:HI or, with `counted`, LO:HI:N; LO < HI, N from 2 to 1000.
struct NumberRange {
  double lower, upper;
  int count = 2;
};
NumberRange number_range(const std::string& option, const std::string& text, bool counted);

/// The rows a second of --rate [Hz]. Throws InputError unless they are above 0 and at most 1e6.
double checked_rate(double rate);

/// K/N as the pair K, N: part K of N, counted from 1.
std::pair<std::uint64_t, std::uint64_t> part_of(const std::string& option, const std::string& text);

/// Index of `text` in `choices`; the error lists them all and hints at the closest one.
std::size_t choice_index(const std::string& option, const std::string& text, const std::vector<std::string>& choices);
/// The value that belongs to the choice `text`.
template <class T>
T choice(const std::string& option, const std::string& text, const std::vector<std::pair<std::string, T>>& choices) {
  std::vector<std::string> names;
  for (const auto& c : choices) names.push_back(c.first);
  return choices[choice_index(option, text, names)].second;
}
/// Index of one of the actuator's five constants.
std::size_t constant_index(const std::string& option, const std::string& name);

}  // namespace ukemi::tools
