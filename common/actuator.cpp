#include "common/actuator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/csv.hpp"
#include "common/uncertainty.hpp"

namespace ukemi {

const char* name(Feedback feedback) { return feedback == Feedback::kOutput ? "output" : "motor"; }

std::optional<Feedback> read_feedback(TomlSection& section) {
  const auto v = section.optional_choice("feedback", {"output", "motor"});
  if (!v) return std::nullopt;
  return *v == "motor" ? Feedback::kMotor : Feedback::kOutput;
}

std::optional<double> Actuator::standard_error(const std::string& constant) const {
  const auto it = std::find(uncertain.begin(), uncertain.end(), constant);
  if (it == uncertain.end()) return std::nullopt;
  const auto i = it - uncertain.begin();
  return std::sqrt(covariance(i, i));
}

Actuator read_actuator(const std::string& path) {
  TomlFile file(path);
  TomlSection s = file.require("actuator");
  Actuator a;
  a.name = s.text("name");
  const Range constant = Range::non_negative();
  a.sea.k_p = s.number("k_p", constant);
  a.sea.k_d = s.number("k_d", constant);
  a.sea.k_sea = s.number("k_sea", constant);
  a.sea.c_sea = s.number("c_sea", constant);
  a.sea.i_motor = s.number("i_motor", Range::positive());
  if (const auto v = s.optional_number("tau_max", constant)) a.sea.tau_max = *v;
  a.sea.friction = s.optional_number("friction", constant).value_or(0);
  a.sea.viscous = s.optional_number("viscous_friction", constant).value_or(0);
  a.sea.k_sea_cubic = s.optional_number("k_sea_cubic", constant).value_or(0);
  a.sea.feedback = read_feedback(s).value_or(Feedback::kOutput);
  a.speed_max = s.optional_number("speed_max", Range::positive());
  if (auto u = file.optional("uncertainty")) {
    Uncertainty read = read_uncertainty(
        *u, {"k_p", "k_d", "k_sea", "c_sea", "i_motor", "friction", "viscous_friction", "k_sea_cubic"}, "the actuator");
    a.uncertain = std::move(read.order), a.covariance = std::move(read.covariance);
    u->accept("std"), u->accept("ci95");  // follow from the covariance
  }
  if (auto v = file.optional("verdict"))
    for (const char* name : kConstantNames)
      if (const auto verdict =
              v->optional_choice(name, {"trusted", "weak", "not identifiable", "at its bound", "fixed"}))
        a.verdicts.emplace_back(name, *verdict);
  if (auto p = file.optional("provenance")) p->accept_all();
  file.finish();
  return a;
}

std::string to_toml(const Actuator& a, double half_width) {
  std::string t = fmt::format("[actuator]\nname = \"{}\"\n", toml_text(a.name));
  const auto u = constants(a.sea);
  for (int i = 0; i < kConstants; ++i)
    t += fmt::format("{} = {}  # {}\n", kConstantNames[i], shortest(u[i]), kConstantUnits[i]);
  if (std::isfinite(a.sea.tau_max)) t += fmt::format("tau_max = {}  # Nm\n", shortest(a.sea.tau_max));
  if (a.speed_max) t += fmt::format("speed_max = {}  # rad/s\n", shortest(*a.speed_max));
  if (a.sea.friction != 0) t += fmt::format("friction = {}  # Nm\n", shortest(a.sea.friction));
  if (a.sea.viscous != 0) t += fmt::format("viscous_friction = {}  # Nm/(rad/s)\n", shortest(a.sea.viscous));
  if (a.sea.k_sea_cubic != 0) t += fmt::format("k_sea_cubic = {}  # Nm/rad^3\n", shortest(a.sea.k_sea_cubic));
  t += fmt::format("feedback = \"{}\"\n", name(a.sea.feedback));
  if (!a.verdicts.empty()) {
    t += "\n[verdict]\n";
    for (const auto& [constant, verdict] : a.verdicts) t += fmt::format("{} = \"{}\"\n", constant, verdict);
  }
  if (!a.uncertain.empty()) {
    const auto list = [&](const char* key, auto&& item) {
      t += fmt::format("{} = [", key);
      for (std::size_t i = 0; i < a.uncertain.size(); ++i) t += (i ? ", " : "") + item(i);
      t += "]\n";
    };
    const auto value = [&](std::size_t i) {
      for (int k = 0; k < kConstants; ++k)
        if (a.uncertain[i] == kConstantNames[k]) return u[k];
      if (a.uncertain[i] == "friction") return a.sea.friction;
      return a.uncertain[i] == "viscous_friction" ? a.sea.viscous : a.sea.k_sea_cubic;
    };
    const auto error = [&](std::size_t i) { return std::sqrt(a.covariance(long(i), long(i))); };
    t += "\n[uncertainty]\n";
    list("order", [&](std::size_t i) { return "\"" + a.uncertain[i] + "\""; });
    list("std", [&](std::size_t i) { return shortest(error(i)); });
    list("ci95", [&](std::size_t i) {
      return fmt::format("[{}, {}]", shortest(value(i) - half_width * error(i)),
                         shortest(value(i) + half_width * error(i)));
    });
    t += covariance_lines(a.covariance);
  }
  if (!a.provenance.empty()) {
    t += "\n[provenance]\n";
    for (const auto& [key, text] : a.provenance) t += fmt::format("\"{}\" = \"{}\"\n", toml_text(key), toml_text(text));
  }
  return t;
}

}  // namespace ukemi
