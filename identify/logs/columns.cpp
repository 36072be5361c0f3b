#include "identify/logs/columns.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "common/degrees.hpp"
#include "common/text.hpp"

namespace ukemi::identify {

namespace {

/// A suffix of column names and its unit in SI.
struct Unit {
  Quantity of;
  std::string_view suffix;
  double scale;
};
constexpr Unit kUnits[] = {
    {Quantity::kTime, "_ms", 1e-3},           {Quantity::kAngle, "_deg", kDegree}, {Quantity::kAngle, "_mrad", 1e-3},
    {Quantity::kRate, "_deg", kDegree},       {Quantity::kRate, "_mrad", 1e-3},    {Quantity::kForce, "_N", 1},
    {Quantity::kForce, "_kN", 1e3},           {Quantity::kTorque, "_Nm", 1},       {Quantity::kTorque, "_mNm", 1e-3},
    {Quantity::kAcceleration, "_g", 9.80665}, {Quantity::kLength, "_mm", 1e-3}};

double unit_of(const std::string& column, Quantity quantity) {
  for (const Unit& u : kUnits)
    if (u.of == quantity && column.size() > u.suffix.size() && column.ends_with(u.suffix)) return u.scale;
  return 1;
}

/// "-0.001*Fy", "-Fy", "Fy": the scale and the column.
Source parse_source(const std::string& option, const std::string& text) {
  if (const std::size_t star = text.find('*'); star != std::string::npos && star + 1 < text.size())
    if (const auto scale = parsed_number<double>(text.substr(0, star))) {
      if (*scale == 0 || !std::isfinite(*scale))
        throw InputError(option + ": " + quoted(text) + ": a finite scale other than 0 is needed");
      return {text.substr(star + 1), *scale};
    }
  if (text.front() == '-' && text.size() > 1) return {text.substr(1), -1};
  return {text, 1};
}

}  // namespace

ColumnMap::ColumnMap(const std::string& option, const std::string& map, std::vector<Column> known)
    : known_(std::move(known)) {
  for (std::size_t begin = 0; begin < map.size();) {
    const std::size_t end = std::min(map.find(',', begin), map.size());
    const std::string item = map.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t equals = item.find('=');
    if (equals == std::string::npos || equals + 1 == item.size())
      throw InputError(option + ": " + quoted(item) + ": NAME=COLUMN is needed");
    const std::string name = item.substr(0, equals);
    const auto it = std::find_if(known_.begin(), known_.end(), [&](const Column& c) { return c.name == name; });
    if (it == known_.end()) {
      std::vector<std::string> names;
      for (const Column& c : known_) names.push_back(c.name);
      throw InputError(option + ": " + one_of(name, names));
    }
    if (mapped_.contains(name)) throw InputError(option + ": " + quoted(name) + ": named twice");
    Source s = parse_source(option, item.substr(equals + 1));
    s.scale *= unit_of(s.column, it->quantity);
    mapped_[name] = s;
  }
}

std::vector<Source> ColumnMap::candidates(const std::string& name) const {
  if (const auto it = mapped_.find(name); it != mapped_.end()) return {it->second};
  std::vector<Source> out{{name, 1}};
  for (const Column& c : known_)
    if (c.name == name)
      for (const Unit& u : kUnits)
        if (u.of == c.quantity) out.push_back({name + std::string(u.suffix), u.scale});
  return out;
}

bool ColumnMap::wants(const std::string& column) const {
  for (const Column& c : known_)
    for (const Source& s : candidates(c.name))
      if (s.column == column) return true;
  return false;
}

std::vector<std::string> ColumnMap::missing_from(const CsvTable& table) const {
  std::vector<std::string> out;
  for (const Column& c : known_) {
    const std::vector<Source> names = candidates(c.name);
    if (mapped_.contains(c.name) ||
        std::any_of(names.begin(), names.end(), [&](const Source& s) { return table.find(s.column) >= 0; }))
      continue;
    for (const Source& s : names) out.push_back(s.column);
  }
  return out;
}

int ColumnMap::find(const CsvTable& table, const std::string& name, Source& source) const {
  int found = -1;
  for (const Source& s : candidates(name)) {
    const int c = table.find(s.column);
    if (c < 0) continue;
    if (found >= 0)
      throw InputError({table.file, table.header_line, table.header_column[std::size_t(c)]},
                       "column " + quoted(s.column) + ": '" + name + "' is given twice");
    found = c, source = s;
  }
  if (const auto it = mapped_.find(name); found < 0 && it != mapped_.end())
    throw InputError({table.file, table.header_line},
                     "no column " + quoted(it->second.column) + hint(it->second.column, table.header));
  return found;
}

std::optional<double> ColumnMap::constant(const CsvTable& table, const std::string& name) const {
  const auto it = mapped_.find(name);
  if (it == mapped_.end() || table.find(it->second.column) >= 0) return std::nullopt;
  const auto value = parsed_number<double>(it->second.column);
  return value && std::isfinite(*value) ? std::optional(*value * it->second.scale) : std::nullopt;
}

std::vector<std::string> near_misses(const CsvTable& table, const ColumnMap& map) {
  std::vector<std::string> out;
  const std::vector<std::string> missing = map.missing_from(table);
  const auto wants = [&](const std::string& column) { return map.wants(column); };
  for (std::size_t c = 0; c < table.header.size(); ++c)
    for (const std::string& name : wants(table.header[c]) ? std::vector<std::string>{} : missing)
      if (lower_case(name) == lower_case(table.header[c])) table.refuse_unread(c, " (did you mean \"" + name + "\"?)");
  for (const auto& [c, suggestion] : table.near_misses(wants, missing))
    out.push_back("column " + quoted(table.header[c]) + " is not read" + suggestion);
  return out;
}

}  // namespace ukemi::identify
