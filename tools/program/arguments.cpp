#include "tools/program/arguments.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <sstream>

#include "common/actuator.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace ukemi::tools {

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> out;
  std::stringstream s(list);
  for (std::string item; std::getline(s, item, ',');) out.push_back(item);
  return out;
}

double to_number(const std::string& option, const std::string& text) {
  const std::string fault = number_fault(text, Whole::kNo);
  if (fault.empty()) return std::stod(text);
  throw InputError(option + ": " + fault);
}

namespace {

/// The canonical path: one for all spellings of a file's path.
std::filesystem::path canonical_path(const std::string& file) {
  std::error_code ignored;
  return std::filesystem::weakly_canonical(file, ignored);
}

}  // namespace

std::vector<std::string> duplicate_warnings(const std::vector<std::string>& files) {
  std::vector<std::string> out;
  std::set<std::filesystem::path> seen;
  for (const std::string& file : files)
    if (!seen.insert(canonical_path(file)).second)
      out.push_back(quoted(file) + " is given twice: it counts as two logs, and errors come out too small");
  return out;
}

std::vector<std::string> overlap_warnings(const std::vector<std::string>& fitted,
                                          const std::vector<std::string>& validation) {
  std::vector<std::string> out;
  for (const std::string& file : validation)
    if (std::any_of(fitted.begin(), fitted.end(), [&](auto& f) { return canonical_path(f) == canonical_path(file); }))
      out.push_back("--validate: " + quoted(file) + " is fitted too: what it shows is no validation");
  return out;
}

std::string number_fault(const std::string& text, Whole whole) {
  const std::string digits = text.substr(text.size() > 1 && text[0] == '+' && text[1] != '-');
  if (whole == Whole::kYes ? parsed_number<long>(digits).has_value()
                           : std::isfinite(parsed_number<double>(digits).value_or(NAN)))
    return "";
  return quoted(text) + (whole == Whole::kYes ? ": a whole number is needed" : ": a finite number is needed") +
         (text.find_first_of("xX") != std::string::npos ? ", in decimal digits" : "");
}

std::uint64_t to_seed(const std::string& option, const std::string& text) {
  if (const auto value = parsed_number<std::uint64_t>(text)) return *value;
  throw InputError(fmt::format("{}: {}: a whole number from 0 to {} is needed", option, quoted(text),
                               std::numeric_limits<std::uint64_t>::max()));
}

double checked_rate(double rate) {
  if (!(rate > 0 && rate <= 1e6)) throw InputError(fmt::format("--rate: {}: above 0 to 1e6 Hz is needed", rate));
  return rate;
}

std::pair<std::uint64_t, std::uint64_t> part_of(const std::string& option, const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) throw InputError(option + ": " + quoted(text) + ": K/N is needed, as in 1/3");
  return {to_seed(option, text.substr(0, slash)), to_seed(option, text.substr(slash + 1))};
}

Assignment assignment(const std::string& option, const std::string& item, const char* form) {
  const std::size_t equals = item.rfind('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == item.size())
    throw InputError(option + ": " + quoted(item) + ": " + form + " is needed");
  return {item.substr(0, equals), item.substr(equals + 1)};
}

void set_once(const std::string& option, const std::string& given, const std::string& name, double value,
              std::map<std::string, double>& values) {
  if (!values.emplace(name, value).second) throw InputError(option + ": " + quoted(given) + ": named twice");
}

NamedPrior named_prior(const std::string& option, const std::string& item) {
  const std::size_t equals = item.rfind('='), colon = item.rfind(':');
  if (equals == std::string::npos || colon == std::string::npos || colon < equals)
    throw InputError(option + ": " + quoted(item) + ": NAME=VALUE:STD is needed");
  return {item.substr(0, equals), to_number(option, item.substr(equals + 1, colon - equals - 1)),
          to_number(option, item.substr(colon + 1))};
}

NumberRange number_range(const std::string& option, const std::string& text, bool counted) {
  std::vector<double> numbers;
  for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
    end = text.find(':', begin);
    numbers.push_back(to_number(option, text.substr(begin, end == std::string::npos ? end : end - begin)));
  }
  const bool valid = numbers.size() == (counted ? 3U : 2U) && numbers[0] < numbers[1];
  const double count = valid && counted ? numbers[2] : 2;
  if (!valid || !(count >= 2 && count <= 1000 && count == std::floor(count)))
    throw InputError(
        option + ": " + quoted(text) + ": " +
        (counted ? "LO:HI:N, numbers that rise and a count from 2 to 1000," : "LO:HI, numbers that rise,") +
        " is needed");
  return {numbers[0], numbers[1], int(count)};
}

std::size_t choice_index(const std::string& option, const std::string& text, const std::vector<std::string>& choices) {
  const auto found = std::find(choices.begin(), choices.end(), text);
  if (found != choices.end()) return std::size_t(found - choices.begin());
  const std::string others = fmt::format("{}", fmt::join(choices.begin(), choices.end() - 1, ", "));
  throw InputError(fmt::format("{}: {}: {}{}{} is needed{}", option, quoted(text), others, others.empty() ? "" : " or ",
                               choices.back(), hint(text, choices)));
}

std::size_t constant_index(const std::string& option, const std::string& name) {
  const auto found = std::find(kConstantNames.begin(), kConstantNames.end(), name);
  if (found != kConstantNames.end()) return std::size_t(found - kConstantNames.begin());
  throw InputError(option + ": " + one_of(name, {kConstantNames.begin(), kConstantNames.end()}));
}

}  // namespace ukemi::tools
