#include "tools/report/landing.hpp"

#include <fmt/format.h>

#include <cmath>

namespace ukemi::tools {

using namespace landing;

namespace {
std::string peak_text(int digits, double peak) {
  return std::isnan(peak)   ? "not played"
         : std::isinf(peak) ? "not to be followed"
                            : fmt::format("{:.{}g}", peak, digits);
}
}  // namespace
std::string peak_words(double peak) { return peak_text(6, peak); }
std::string short_peak_words(double peak) { return peak_text(4, peak); }
std::string percent_words(double fraction) {
  return std::isfinite(fraction) ? fmt::format("{:.1f} %", 100 * fraction) : "";
}

Display display(const Variable& v, const std::string& middle) {
  if (v.unit == "rad") return {kDegrees, v.name + middle + "_deg", v.words + " [deg]"};
  return {1, v.name + middle, v.words + " [" + v.unit + "]"};
}

Quantities<Motion> motion_quantities(const Motion& like) {
  Quantities<Motion> out = {
      {"phi_i_deg", "phi_i_deg", "phi_I [deg]", "{:.6g}", [](auto& m) { return m.phi_i * kDegrees; }},
      {"phi_f_deg", "phi_f_deg", "phi_F [deg]", "{:.6g}", [](auto& m) { return m.phi_f * kDegrees; }},
      {"duration", "duration", "duration [s]", "{:.6g}", &Motion::duration}};
  if (has_bumps(like)) {
    out.push_back({"", "bumps_deg", [](auto& m) {
                     Json bumps = Json::array();
                     for (const double b : m.bumps) bumps.push_back(b * kDegrees);
                     return bumps;
                   }});
    for (std::size_t k = 0; k < kMaxBumps; ++k)
      if (like.bumps[k] != 0)
        out.push_back({fmt::format("b{}_deg", k), "", fmt::format("b_{} [deg]", k), "{:.6g}",
                       [k](auto& m) { return m.bumps[k] * kDegrees; }});
  }
  if (like.gain_p != 1 || like.gain_d != 1) {
    out.push_back({"gain_p", "gain_p", "factor of K_p", "{:.6g}", &Motion::gain_p});
    out.push_back({"gain_d", "gain_d", "factor of K_d", "{:.6g}", &Motion::gain_d});
  }
  if (like.reposition) {
    const auto add_reposition = [&](const char* name, const char* words, double Reposition::*value, double factor) {
      out.push_back(
          {std::string("reposition_") + name, std::string("reposition/") + name, words, "{:.6g}",
           [value, factor](const Motion& m) { return m.reposition ? Json((*m.reposition).*value * factor) : Json(); }});
    };
    add_reposition("phi_deg", "released at [deg]", &Reposition::phi, kDegrees);
    add_reposition("rate_deg", "turning at [deg/s]", &Reposition::rate, kDegrees);
    add_reposition("from", "moved in the air from [s]", &Reposition::from, 1);
    add_reposition("to", "to [s]", &Reposition::to, 1);
  }
  return out;
}
Json motion_json(const Motion& motion) { return Table::of(motion_quantities(motion), motion).object(); }
std::string motion_words(const Motion& motion) { return Table::of(motion_quantities(motion), motion).line(); }

RobotWords words_of(const TwoLink<double>&) { return {"|ddr_0|", "point", point_name}; }
RobotWords words_of(const Robot& robot) { return {"|a|", "contact", contact_name(robot)}; }

Quantities<Touch> contact_quantities(const RobotWords& words) {
  return {
      {"point", "point", "point", {}, [name = words.point](auto& t) { return name(t.point); }},
      {"t_touchdown", "t", "touchdown [s]", "{:.6f}", &Touch::t_touchdown},
      {"t_liftoff", "", "lift-off [s]", "{:.6f}", &Touch::t_liftoff},
      {"peak_force", "", "peak force [N]", "{:.4g}", &Touch::peak_force},
      {"peak_acc", "", "peak " + words.acceleration + " [m/s^2]", "{:.4g}", &Touch::peak_acc},
  };
}

std::string contact_order(const ContactOrder& contacts, const PointName& name) {
  std::string s;
  for (int i = 0; i < contacts.size(); ++i) s += (s.empty() ? "" : ", ") + name(contacts[i]);
  if (contacts.size() == ContactOrder::kCapacity) s += ", ...";
  return s.empty() ? "none" : s;
}
std::string failure_words(const RunEnd& r, const char* point) {
  if (r.end == End::kNoContact) return fmt::format("no {} touches the floor within {:.4g} s", point, r.t_end);
  return fmt::format("{}, at t = {:.6g} s after {} steps", reason(r), r.t_end, r.work.steps);
}

void warn_of(const RunEnd& r, const landing::Sensitivity& sensitivity, const char* point, Run& run) {
  const bool failed = r.end == End::kFailed;
  if (failed) run.warn("refused: " + failure_words(r, point) + "; what was computed so far is kept");
  if (r.end == End::kNoContact) run.warn(failure_words(r, point) + ": the peak is that of a flight");
  if (!sensitivity.checked && !failed)
    run.warn("the peak could not be checked: at a hundredth of the tolerance the landing cannot be followed");
}
void warn_of(const landing::Sensitivity& s, bool wrong, double accuracy, Run& run) {
  if (wrong)
    run.warn(
        fmt::format("wrong: the peak moves by {:.2g} with the tolerance and not with the scene; try --accuracy {:g}",
                    s.error_estimate, std::max(1e-14, accuracy / 100)));
  if (s.sensitive)
    run.warn(fmt::format("sensitive: a scene moved by 1e-6 moves the peak by {:.2g}: the motion stands beside a cliff",
                         s.change));
}

void warn_of_edges(const std::vector<Variable>& variables, const Edges& edges, Run& run) {
  for (std::size_t k = 0; k < variables.size(); ++k) {
    const Variable& v = variables[k];
    const double unit = v.unit == "rad" ? kDegrees : 1;
    if (const int edge = edges[k]; edge != 0)
      run.warn(fmt::format("{} lies on the {} edge of its search range, {:.4g} {}: beyond it may be better", v.words,
                           edge < 0 ? "lower" : "upper", (edge < 0 ? v.lower : v.upper) * unit,
                           v.unit == "rad" ? "deg"
                           : v.unit == "1" ? ""
                                           : v.unit));
  }
}

Quantities<Evidence> deviation_quantities() {
  const auto peak = [](const char* key, const char* words, double Evidence::*value) {
    return Quantity<Evidence>{key, key, words, short_peak_words, value};
  };
  return {peak("one_degree", "with the angles off by 1 deg", &Evidence::one_degree),
          peak("ten_milliseconds", "with the duration off by 10 ms", &Evidence::ten_milliseconds),
          peak("one_centimetre", "with the height off by 1 cm", &Evidence::one_centimetre),
          peak("pitch_one_degree", "with the pitch off by 1 deg", &Evidence::pitch_one_degree),
          peak("damping_ten_percent", "with the floor's damping off by 10 %", &Evidence::damping_ten_percent)};
}

Quantities<Evidence> evidence_quantities(const std::vector<Variable>& variables, const std::string& tolerant_peak) {
  Quantities<Evidence> out;
  for (std::size_t k = 0; k < variables.size(); ++k)
    for (const std::size_t side : {0, 1}) {
      const Display whole = display(variables[k]), margin = display(variables[k], side == 0 ? "_down" : "_up");
      out.push_back({margin.key, "width_of_5_percent/" + whole.key + (side ? "/1" : "/0"),
                     (side == 0 ? "room below " : "room above ") + whole.words, "{:.2g}",
                     [k, side, factor = whole.factor](const Evidence& e) { return e.width[k][side] * factor; }});
    }
  out.push_back({"tolerant_peak", "tolerant_peak", tolerant_peak, peak_words,
                 [](const Evidence& e) { return e.tolerant.value; }});
  for (Quantity<Evidence> q : deviation_quantities()) q.words += " [m/s^2]", out.push_back(q);
  out.push_back({"", "complete", &Evidence::complete});
  return out;
}

Json ratings_json(const Ratings& r) {
  Json unknown = Json::array();
  if (!r.speed_max) unknown.push_back("speed_max");
  if (!r.motor_torque_max) unknown.push_back("motor_torque_max");
  return {{"peak_reference_rate", r.reference_rate},
          {"motor_speed", r.demands.motor_speed},
          {"speed_max", number(r.speed_max)},
          {"motor_torque", r.demands.motor_torque},
          {"sea_torque", r.demands.sea_torque},
          {"motor_torque_max", number(r.motor_torque_max)},
          {"tau_max", number(r.tau_max)},
          {"unknown", unknown},
          {"phi_1_deg", {r.demands.phi_min * kDegrees, r.demands.phi_max * kDegrees}}};
}
void warn_of(const std::vector<std::string>& doubts, Run& run, const std::string& whose) {
  for (const std::string& doubt : doubts) run.warn(whose + doubt);
}

void floor_source(Report& report, const std::string& source) {
  if (!source.empty()) report.paragraph("Floor constants: " + source + ".");
}
void constants_table(Report& report, const Scene& scene, const Actuator& actuator) {
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const std::string& what, double value, const std::string& unit) {
    if (std::isfinite(value)) rows.push_back({what, fmt::format("{:.6g}", value), unit});
  };
  const TwoLink<double>& r = scene.robot;
  add("link length", r.link_length, "m");
  for (const std::size_t i : {0, 1}) add(fmt::format("mass m_{}", i), r.mass[i], "kg");
  for (const std::size_t i : {0, 1}) add(fmt::format("inertia I_{}", i), r.inertia_com[i], "kg m^2");
  add("gravity", r.gravity, "m/s^2");
  if (scene.floor) {
    add("floor stiffness", scene.floor->stiffness, "N/m");
    add("floor damping, normal", scene.floor->damping_normal, "N/(m/s)");
    add("floor damping, tangential", scene.floor->damping_tangential, "N/(m/s)");
  }
  add("drop height", scene.drop.height, "m");
  add("forward speed", scene.drop.forward_speed, "m/s");
  add("pitch at release", scene.drop.pitch * kDegrees, "deg");
  for (std::size_t k = 0; k < kConstants; ++k) add(kConstantNames[k], constants(actuator.sea)[k], kConstantUnits[k]);
  add("tau_max", actuator.sea.tau_max, "Nm");
  if (actuator.speed_max) add("speed_max", *actuator.speed_max, "rad/s");
  if (actuator.motor_torque_max) add("motor_torque_max", *actuator.motor_torque_max, "Nm");
  report.heading("Scene and actuator");
  report.paragraph("Scene: " + scene.name + ". Actuator: " + actuator.name + ".");
  report.table({"constant", "value", "unit"}, rows);
}

}  // namespace ukemi::tools
