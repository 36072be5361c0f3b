#include "common/verdict.hpp"

#include <fmt/format.h>

#include "common/toml.hpp"
#include "common/uncertainty_file.hpp"

namespace ukemi {

Verdicts read_verdicts(TomlFile& file, const std::vector<std::string>& constants) {
  Verdicts out;
  if (auto section = file.optional("verdict"))
    for (const std::string& name : constants)
      if (const auto verdict =
              section->optional_choice(name, {"trusted", "weak", "not identifiable", "at its bound", "fixed"}))
        out.emplace_back(name, *verdict);
  return out;
}

std::string verdict_table(const Verdicts& verdicts) {
  std::string t = verdicts.empty() ? "" : "\n[verdict]\n";
  for (const auto& [constant, verdict] : verdicts) {
    const char* quote = constant.find('.') == std::string::npos ? "" : "\"";  // a dot would be a table
    t += fmt::format("{0}{1}{0} = \"{2}\"\n", quote, constant, verdict);
  }
  return t;
}

Verdicts doubted(const Verdicts& verdicts) {
  Verdicts out;
  for (const auto& entry : verdicts)
    if (entry.second != "trusted" && entry.second != "fixed") out.push_back(entry);
  return out;
}

std::string doubts(const Verdicts& verdicts) {
  std::string t;
  for (const auto& [constant, verdict] : doubted(verdicts))
    t += fmt::format("{}{} is {}", t.empty() ? "" : ", ", constant, verdict);
  return t;
}

}  // namespace ukemi
