#include <cctype>
#include <cmath>
#include <limits>
#include <map>

#include "common/csv.hpp"
#include "common/text.hpp"
#include "identify/logs/hebilog.hpp"

namespace ukemi::identify {

namespace {

using Values = std::vector<double> HebiModule::*;

/// The fields that are read, in lower case without '_' and blanks, "command" abbreviated to "cmd".
const std::map<std::string, Values> kFields = {{"time", &HebiModule::t},
                                               {"position", &HebiModule::position},
                                               {"velocity", &HebiModule::velocity},
                                               {"effort", &HebiModule::effort},
                                               {"deflection", &HebiModule::deflection},
                                               {"motorvelocity", &HebiModule::motor_velocity},
                                               {"motorposition", &HebiModule::motor_position},
                                               {"positioncmd", &HebiModule::position_command},
                                               {"velocitycmd", &HebiModule::velocity_command},
                                               {"effortcmd", &HebiModule::effort_command}};

struct Field {
  Values values = nullptr;  ///< null: not a field that is read
  int index = 0;            ///< of the module, from 1; 0: no index
};

/// "positionCmd(2)", "position_cmd_2", "PositionCmd2": the field and the module.
Field parse_name(const std::string& name) {
  std::size_t end = name.size();
  const bool closed = end > 0 && (name[end - 1] == ')' || name[end - 1] == ']');
  if (closed) --end;
  std::size_t digits = end;
  while (digits > 0 && std::isdigit(static_cast<unsigned char>(name[digits - 1]))) --digits;
  Field f;
  if (digits < end && end - digits <= 4) f.index = std::stoi(name.substr(digits, end - digits));
  if (closed && (digits == end || digits == 0 || (name[digits - 1] != '(' && name[digits - 1] != '['))) return {};
  std::string base = lower_case(name.substr(0, closed ? digits - 1 : digits));
  std::erase_if(base, [](char c) { return c == '_' || c == ' '; });
  if (base.ends_with("command")) base.replace(base.size() - 7, 7, "cmd");
  if (const auto it = kFields.find(base); it != kFields.end()) f.values = it->second;
  return f;
}

}  // namespace

bool is_hebi_csv(const std::string& path) {
  bool time = false, position = false, t = false;
  for (const std::string& name : csv_header(path)) {
    const Field f = parse_name(name);
    time = time || f.values == &HebiModule::t;
    position = position || f.values == &HebiModule::position;
    t = t || name == "t" || name == "t_ms";
  }
  return time && position && !t;
}

HebiLog read_hebi_csv(const std::string& path) {
  const CsvTable table = read_csv(
      path, [](const std::string& name) { return parse_name(name).values != nullptr; }, NanCells::kAsEmpty);
  HebiLog log;
  log.file = path;
  std::map<int, HebiModule> modules;  // by index; fields without one are common to all
  HebiModule common;
  for (std::size_t c = 0; c < table.header.size(); ++c) {
    const Field f = parse_name(table.header[c]);
    if (!f.values) continue;
    std::vector<double>& column = (f.index > 0 ? modules[f.index] : common).*f.values;
    if (!column.empty())
      throw InputError({path, table.header_line, table.header_column[c]},
                       "column " + quoted(table.header[c]) + ": this field is given twice");
    column = table.columns[c];
  }
  if (modules.empty()) modules[1] = HebiModule();
  for (auto& [index, m] : modules) {
    m.name = std::to_string(index);
    for (const auto& [name, values] : kFields) {
      std::vector<double>& column = m.*values;
      if (column.empty()) column = common.*values;
      if (column.empty()) column.assign(table.rows(), std::numeric_limits<double>::quiet_NaN());
    }
    log.modules.push_back(std::move(m));
  }
  return log;
}

}  // namespace ukemi::identify
