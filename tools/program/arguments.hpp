// What the text of an option holds: lists, numbers, names, NAME=VALUE. Each throws InputError "OPTION: 'text': rule".
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace ukemi::tools {

std::vector<std::string> split(const std::string& list);  ///< at commas
double to_number(const std::string& option, const std::string& text);
/// A warning of each file that was named before.
std::vector<std::string> given_twice(const std::vector<std::string>& files);
/// A warning of each file that is to validate a fit of the others, and is among them.
std::vector<std::string> fitted_too(const std::vector<std::string>& fitted, const std::vector<std::string>& unseen);
/// "'text': rule" where it is no number, or no whole one; else empty. Decimal: "0x10" is none.
enum class Whole { kNo, kYes };
std::string number_fault(const std::string& text, Whole whole);
std::uint64_t to_seed(const std::string& option, const std::string& text);  ///< decimal digits, up to 64 bits

/// NAME=VALUE, at the last '='; `form`: as the option's help has it.
struct Assignment {
  std::string name, value;
};
Assignment assignment(const std::string& option, const std::string& item, const char* form = "NAME=VALUE");

/// Puts a number into a list of options by its name. Throws InputError where it is there: `given` was named twice.
void set_once(const std::string& option, const std::string& given, const std::string& name, double value,
              std::map<std::string, double>& to);

/// NAME=VALUE:STD.
struct NamedPrior {
  std::string name;
  double value, std;
};
NamedPrior named_prior(const std::string& option, const std::string& item);

/// LO:HI or, counted, LO:HI:N; the numbers rise, the count is 2 to 1000.
struct NumberRange {
  double lower, upper;
  int count = 2;
};
NumberRange number_range(const std::string& option, const std::string& text, bool counted);

/// K/N, both from 1: part K of N.
std::pair<std::uint64_t, std::uint64_t> part_of(const std::string& option, const std::string& text);

/// Index of `text` in `choices`, of which there are few; the error names them all, and the nearest.
std::size_t choice_index(const std::string& option, const std::string& text, const std::vector<std::string>& choices);
/// The value of the choice.
template <class T>
T choice(const std::string& option, const std::string& text, const std::vector<std::pair<std::string, T>>& choices) {
  std::vector<std::string> names;
  for (const auto& c : choices) names.push_back(c.first);
  return choices[choice_index(option, text, names)].second;
}
/// Index of one of the actuator's five constants.
std::size_t constant_index(const std::string& option, const std::string& name);

}  // namespace ukemi::tools
