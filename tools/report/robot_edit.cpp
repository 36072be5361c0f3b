#include "tools/report/robot_edit.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/error.hpp"

namespace ukemi::tools {

namespace {

using Path = TomlEdit::Place;

/// Sets KEY, KEY.SUBKEY of an inline table, or KEY.along and KEY.across of a place, an array.
void set_nested(TomlEdit& file, const Path& table, const std::vector<std::string>& key, double value) {
  if (key.size() == 1) return set_key(file, table, key[0], value);
  if (key[1] == "along" || key[1] == "across") return set_element(file, table, key[0], key[1] == "across", value);
  if (!file.has(table, key[0]))
    return file.set_raw(table, key[0], fmt::format("{{ {} = {} }}", key[1], shortest(value)));
  Path inner = table;
  inner.push_back(key[0]);
  set_key(file, inner, key[1], value);
}

void set_drive(TomlEdit& file, const std::string& joint, const std::string& key, double value) {
  const Path table = {"drive", joint};
  if (const std::string other = file.text_at(table, "file"); !other.empty())
    throw InputError(
        fmt::format("drive.{}.{}: the drive stands in a file of its own, {}: its constants are needed here", joint, key,
                    quoted(other)));
  set_key(file, table, key, value);
}

void set_stop(TomlEdit& file, const std::string& name, const std::string& key, double value) {
  const Path table = {"stop", name};
  if (key == "stiffness" || key == "damping") return file.set(table, key, value);
  const std::vector<double> radians = file.numbers_at(table, "phi");
  if (radians.size() == 2) {
    file.remove(table, "phi");
    file.set_raw(table, "phi_deg",
                 fmt::format("[{}, {}]", shortest(radians[0] * kDegrees), shortest(radians[1] * kDegrees)));
  }
  set_element(file, table, key.ends_with("_deg") ? "phi_deg" : "s", key.starts_with("high"), value);
}

}  // namespace

std::vector<std::string> split_name(const std::string& name) {
  std::vector<std::string> out;
  for (std::size_t begin = 0, end; begin <= name.size(); begin = end + 1) {
    end = std::min(name.find('.', begin), name.size());
    out.push_back(name.substr(begin, end - begin));
  }
  return out;
}

std::string index_of(const TomlEdit& file, const Path& list, const std::string& name) {
  Path table = list;
  for (int k = 0;; ++k) {
    table.resize(list.size()), table.push_back(std::to_string(k));
    if (!file.has(table, "name")) break;
    if (file.text_at(table, "name") == name) return table.back();
  }
  throw InputError(list.back() + " " + quoted(name) + ": it stands in the file in a way that cannot be followed");
}

void set_key(TomlEdit& file, const Path& table, const std::string& key, double value) {
  if (key.ends_with("_deg")) file.remove(table, key.substr(0, key.size() - 4));
  file.set(table, key, value);
}

void set_element(TomlEdit& file, const Path& table, const std::string& key, std::size_t which, double value) {
  std::vector<double> pair = file.numbers_at(table, key);
  pair.resize(2, 0);
  if (pair[which] == value && file.has(table, key)) return;
  pair[which] = value;
  file.set_raw(table, key, fmt::format("[{}, {}]", shortest(pair[0]), shortest(pair[1])));
}

void set_number(TomlEdit& file, const std::string& name, double value) {
  const std::vector<std::string> parts = split_name(name);
  if (parts[0] == "drive") return set_drive(file, parts[1], parts[2], value);
  if (parts[0] == "stop") return set_stop(file, parts[1], parts[2], value);
  if (parts[1] != "link" && parts[1] != "contact")
    return set_nested(file, {"robot"}, {parts.begin() + 1, parts.end()}, value);
  const Path table = {"robot", parts[1], index_of(file, {"robot", parts[1]}, parts[2])};
  set_nested(file, table, {parts.begin() + 3, parts.end()}, value);
}

}  // namespace ukemi::tools
