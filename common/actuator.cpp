#include "common/actuator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/actuator_constants.hpp"
#include "common/csv.hpp"
#include "common/error.hpp"
#include "common/toml.hpp"
#include "common/uncertainty_file.hpp"

namespace ukemi {

constexpr int kGains = 2;  ///< number of constants that are K_p and K_d, the first ones

const char* name(Feedback feedback) { return feedback == Feedback::kOutput ? "output" : "motor"; }

std::optional<Feedback> read_feedback(TomlSection& section) {
  const auto v = section.optional_choice("feedback", {"output", "motor"});
  if (!v) return std::nullopt;
  return *v == "motor" ? Feedback::kMotor : Feedback::kOutput;
}

Range delay_range() { return {0, kMaxDelay, false, fmt::format("from 0 to {} s", kMaxDelay)}; }

// Every member of the struct must be in its for_each and, by the type of the table below, in that table.
static_assert([] {
  SeaParameters<double> sea{};
  int constants = 0;
  SeaParameters<double>::for_each(sea, sea, [&](double&, double) { ++constants; });
  return constants;
}() == kActuatorConstants);

const std::array<ActuatorConstant, kActuatorConstants>& actuator_constants() {
  using Sea = SeaParameters<double>;
  static const Range level = Range::non_negative(), part{-1, 1, false, "from -1 to 1"}, late = delay_range();
  static const auto list = std::to_array<ActuatorConstant>({
      {kConstantNames[0], &Sea::k_p, kConstantUnits[0], "Proportional gain", level},
      {kConstantNames[1], &Sea::k_d, kConstantUnits[1], "Derivative gain", level},
      {kConstantNames[2], &Sea::k_sea, kConstantUnits[2], "Stiffness of the spring", level},
      {kConstantNames[3], &Sea::c_sea, kConstantUnits[3], "Damping of the spring", level},
      {kConstantNames[4], &Sea::i_motor, kConstantUnits[4], "Reflected inertia of the motor", Range::positive()},
      {"tau_max", &Sea::tau_max, "Nm", "Limit of the spring's torque, infinite: none", level,
       std::numeric_limits<double>::infinity()},
      {"k_t", &Sea::k_t, "Nm for a unit of the command", "Torque of the motor for a unit of its command", level},
      {"friction", &Sea::friction, "Nm", "Dry friction on the motor", level},
      {"friction_asymmetry", &Sea::friction_asymmetry, "of friction",
       "Half the difference of both directions' levels over their mean", part},
      {"viscous_friction", &Sea::viscous, "Nm/(rad/s)", "Viscous friction on the motor", level},
      {"output_friction", &Sea::output_friction, "Nm", "Dry friction on the output", level},
      {"output_friction_asymmetry", &Sea::output_friction_asymmetry, "of output_friction",
       "Half the difference of both directions' levels over their mean", part},
      {"output_viscous", &Sea::output_viscous, "Nm/(rad/s)", "Viscous friction on the output", level},
      {"breakaway", &Sea::breakaway, "of both dry frictions", "By how much they are larger near rest", level},
      {"stribeck_speed", &Sea::stribeck_speed, "rad/s", "Speed by which that has fallen to 1/e", Range::positive(),
       Sea{}.stribeck_speed},
      {"spring_loss", &Sea::spring_loss, "of the spring's torque", "Dry friction on the motor that grows with it",
       level},
      {"k_sea_cubic", &Sea::k_sea_cubic, "Nm/rad^3", "Cubic stiffness of the spring, below 0: softening", Range::any()},
      {"control_delay", &Sea::control_delay, "s", "From what the drive measures to its torque", late},
      {"velocity_filter", &Sea::velocity_filter, "s", "Time constant of the filter of the rate that K_d sees", late},
  });
  return list;
}

std::span<const ActuatorConstant> optional_constants() {
  return std::span(actuator_constants()).subspan(kConstants + 1);
}

const std::vector<std::string>& uncertain_constants() {
  static const std::vector<std::string> list = [] {
    std::vector<std::string> out;
    for (const ActuatorConstant& c : actuator_constants()) out.emplace_back(c.key);
    return out;
  }();
  return list;
}

std::vector<int> constant_indices(const std::vector<std::string>& names) {
  const std::vector<std::string>& known = uncertain_constants();
  std::vector<int> out;
  for (const std::string& name : names) {
    const auto at = std::find(known.begin(), known.end(), name);
    if (at == known.end()) throw InputError("constant: " + one_of(name, known));
    out.push_back(int(at - known.begin()));
  }
  return out;
}

std::string Actuator::unknown_ratings() const {
  if (!speed_max) return motor_torque_max ? "speed_max" : "speed_max, motor_torque_max";
  return motor_torque_max ? "" : "motor_torque_max";
}

std::optional<double> Actuator::standard_error(const std::string& constant) const {
  const auto it = std::find(uncertain.begin(), uncertain.end(), constant);
  if (it == uncertain.end()) return std::nullopt;
  const auto i = it - uncertain.begin();
  return std::sqrt(covariance(i, i));
}

bool known_command(const SeaParameters<double>& sea) { return sea.k_t > 0 && sea.k_p == 0 && sea.k_d == 0; }

void read_constants(TomlSection& s, Actuator& a) {
  const std::span all(actuator_constants());
  const auto read = [&](const ActuatorConstant& c) {
    a.sea.*c.at = s.optional_number(c.key, c.range).value_or(c.absent);
  };
  for (const ActuatorConstant& c : all.subspan(kConstants)) read(c);
  const std::size_t omissible = a.sea.k_t == 0 ? 0 : kGains;  // with K_t the gains may be absent
  for (const ActuatorConstant& c : all.first(omissible)) read(c);
  for (const ActuatorConstant& c : all.subspan(omissible, kConstants - omissible))
    a.sea.*c.at = s.number(c.key, c.range);
  a.sea.feedback = read_feedback(s).value_or(Feedback::kOutput);
  a.speed_max = s.optional_number("speed_max", Range::positive());
  a.motor_torque_max = s.optional_number("motor_torque_max", Range::positive());
}

Actuator read_actuator(const std::string& path) {
  TomlFile file(path);
  TomlSection s = file.require("actuator");
  Actuator a;
  a.name = s.text("name");
  read_constants(s, a);
  if (auto u = file.optional("uncertainty")) {
    Uncertainty read = read_uncertainty(*u, uncertain_constants(), "the actuator");
    a.uncertain = std::move(read.order), a.covariance = std::move(read.covariance);
    u->accept("std"), u->accept("ci95");  // follow from the covariance
  }
  a.verdicts = read_verdicts(file, {kConstantNames.begin(), kConstantNames.end()});
  if (auto p = file.optional("provenance")) p->accept_all();
  file.finish();
  return a;
}

std::string to_toml(const Actuator& a, double half_width) {
  std::string t = fmt::format("[actuator]\nname = \"{}\"\n", toml_text(a.name));
  const auto u = constants(a.sea);
  for (int i = known_command(a.sea) ? kGains : 0; i < kConstants; ++i)
    t += fmt::format("{} = {}  # {}\n", kConstantNames[i], shortest(u[i]), kConstantUnits[i]);
  if (std::isfinite(a.sea.tau_max)) t += fmt::format("tau_max = {}  # Nm, of the spring\n", shortest(a.sea.tau_max));
  if (a.speed_max) t += fmt::format("speed_max = {}  # rad/s, of the motor\n", shortest(*a.speed_max));
  if (a.motor_torque_max) t += fmt::format("motor_torque_max = {}  # Nm\n", shortest(*a.motor_torque_max));
  for (const ActuatorConstant& c : optional_constants())
    if (const double v = a.sea.*c.at; v != c.absent) t += fmt::format("{} = {}  # {}\n", c.key, shortest(v), c.unit);
  t += fmt::format("feedback = \"{}\"\n", name(a.sea.feedback));
  t += verdict_table(a.verdicts);
  if (!a.uncertain.empty()) {
    const auto list = [&](const char* key, auto&& item) {
      t += fmt::format("{} = [", key);
      for (std::size_t i = 0; i < a.uncertain.size(); ++i) t += (i ? ", " : "") + item(i);
      t += "]\n";
    };
    const std::vector<int> indices = constant_indices(a.uncertain);
    const auto value = [&](std::size_t i) { return a.sea.*actuator_constants()[std::size_t(indices[i])].at; };
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
