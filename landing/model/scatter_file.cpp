#include "landing/model/scatter_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <optional>
#include <vector>

#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/error.hpp"

namespace ukemi::landing {

namespace {

using Kind = ScatterTerm::Kind;

std::string key_of(const ScatterTerm& t) { return std::string(t.name) + (t.kind == Kind::kAngle ? "_deg" : ""); }

std::optional<double> number(const std::string& text) {
  char* end = nullptr;
  const double x = std::strtod(text.c_str(), &end);
  return text.empty() || *end || !std::isfinite(x) || x < 0 ? std::nullopt : std::optional(x);
}

/// "10%" as 0.1.
std::optional<double> percentage(const std::string& text) {
  if (!text.ends_with('%')) return std::nullopt;
  const auto x = number(text.substr(0, text.size() - 1));
  return x ? std::optional(*x / 100) : x;
}

constexpr const char* kPercentRule = "a standard deviation as 10% is needed, at least 0%";

std::string shown_value(const ScatterTerm& t, double x) {
  if (t.kind == Kind::kRelative) return shortest(std::round(x * 1e14) / 1e12) + "%";
  return shortest(t.kind == Kind::kAngle ? std::round(x * kDegrees * 1e12) / 1e12 : x);
}

}  // namespace

Scatter read_scatter(TomlSection& section, bool of_links) {
  Scatter out;
  for (const ScatterTerm& t : kScatterTerms) {
    if (t.of_links && !of_links) continue;
    double& deviation = out.*t.deviation;
    const std::string key = key_of(t);
    if (t.kind == Kind::kRelative) {
      const auto text = section.optional_text(key);
      if (!text) continue;
      const auto part = percentage(*text);
      if (!part) section.fail(key, quoted(*text) + ": " + kPercentRule);
      deviation = *part;
    } else if (t.kind == Kind::kAngle) {
      deviation = section.optional_rate(t.name).value_or(0);  // an angle or a rate, in either unit
      if (deviation < 0) section.fail(section.has(key) ? key : t.name, "at least 0 is needed: a standard deviation");
    } else {
      deviation = section.optional_number(key, Range::non_negative()).value_or(0);
    }
  }
  return out;
}

ExecutionTolerance read_execution(TomlSection& section) {
  ExecutionTolerance out;
  if (const auto phi = section.optional_angle("phi")) {
    out.phi = *phi;
    if (*phi < 0) section.fail("phi_deg", shortest(*phi) + ": must be at least 0");
  }
  out.duration = section.optional_number("duration", Range::non_negative()).value_or(out.duration);
  return out;
}

std::string toml_lines(const Scatter& scatter) {
  std::string out;
  for (const ScatterTerm& t : kScatterTerms)
    if (const double x = scatter.*t.deviation; x > 0)
      out += t.kind == Kind::kRelative ? fmt::format("{} = \"{}\"\n", key_of(t), shown_value(t, x))
                                       : fmt::format("{} = {}\n", key_of(t), shown_value(t, x));
  return out;
}

Scatter parse_scatter(const std::string& option, const std::string& text) {
  Scatter out;
  std::vector<std::string> names, given;
  for (const ScatterTerm& t : kScatterTerms) names.push_back(key_of(t));
  for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
    end = text.find(',', begin);
    const std::string item = text.substr(begin, end == std::string::npos ? end : end - begin);
    const std::size_t sign = item.find('=');
    if (sign == std::string::npos) throw InputError(option + ": " + quoted(item) + ": NAME=VALUE is needed");
    const std::string name = item.substr(0, sign), value = item.substr(sign + 1);
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end()) throw InputError(option + ": " + one_of(name, names));
    if (std::find(given.begin(), given.end(), name) != given.end())
      throw InputError(option + ": " + quoted(name) + " is given twice");
    given.push_back(name);
    const ScatterTerm& t = kScatterTerms[std::size_t(at - names.begin())];
    const auto x = t.kind == Kind::kRelative ? percentage(value) : number(value);
    if (!x)
      throw InputError(fmt::format(
          "{}: {}: {}", option, quoted(item),
          t.kind == Kind::kRelative ? kPercentRule : "a standard deviation is needed, a number of at least 0"));
    out.*t.deviation = t.kind == Kind::kAngle ? *x / kDegrees : *x;
  }
  return out;
}

std::string text_of(const Scatter& scatter) {
  std::string out;
  for (const ScatterTerm& t : kScatterTerms)
    if (const double x = scatter.*t.deviation; x > 0)
      out += (out.empty() ? "" : ",") + key_of(t) + "=" + shown_value(t, x);
  return out;
}

}  // namespace ukemi::landing
