// Python bindings of landings.
#include "tools/python/landing.hpp"

#include <fmt/format.h>

#include "tools/program/arguments.hpp"
#include "tools/report/exports.hpp"
#include "tools/report/results.hpp"

namespace ukemi::python {

using namespace landing;

Figure figure(const std::vector<std::pair<std::string, const Landing*>>& landings) {
  std::vector<tools::Series> curves;
  for (const auto& [name, l] : landings)
    if (!l->trajectory.empty()) curves.push_back(tools::curve(name, l->trajectory, &Sample::acc));
  return {tools::lines_svg("t [s] after release", "|ddr_0| [m/s^2]", curves)};
}

std::array<bool, kPoints> points_of(const std::vector<std::string>& names) {
  std::array<bool, kPoints> out{};
  for (const std::string& n : names)
    out[tools::choice_index("forbid", n, {kPointNames.begin(), kPointNames.end()})] = true;
  return out;
}

Goal goal_of(const std::string& text) {
  return tools::choice<Goal>("objective", text, {{"peak", Goal::kPeak}, {"tolerant", Goal::kTolerant}});
}

std::string minimised(const std::string& goal, double value) {
  return value < kNoMotion ? fmt::format("{} {:.6g} m/s^2", goal, value) : goal + " not known: nothing was found";
}

std::vector<NamedTouch> named(const std::vector<Touch>& touches, const tools::PointName& name) {
  std::vector<NamedTouch> out;
  for (const Touch& t : touches) out.push_back({t, name(t.point)});
  return out;
}

namespace {

void bind_trajectory(py::class_<Played>& c) {
  const std::pair<const char*, std::pair<double Sample::*, const char*>> columns[] = {
      {"t", {&Sample::t, "Times from release [s]; an event has two rows, its left and right limits."}},
      {"x_0", {&Sample::x0, "Thigh's centre of mass, forward [m]."}},
      {"y_0", {&Sample::y0, "Thigh's centre of mass, above the floor [m]."}},
      {"phi_0", {&Sample::phi0, "Thigh's pitch [rad]."}},
      {"phi_1", {&Sample::phi1, "Joint angle [rad]."}},
      {"phi_m", {&Sample::phi_m, "Motor angle [rad]."}},
      {"dx_0", {&Sample::dx0, "Rate of x_0 [m/s]."}},
      {"dy_0", {&Sample::dy0, "Rate of y_0 [m/s]."}},
      {"dphi_0", {&Sample::dphi0, "Rate of phi_0 [rad/s]."}},
      {"dphi_1", {&Sample::dphi1, "Rate of phi_1 [rad/s]."}},
      {"dphi_m", {&Sample::dphi_m, "Rate of phi_m [rad/s]."}},
      {"ddx_0", {&Sample::ddx0, "Acceleration of x_0 [m/s^2]."}},
      {"ddy_0", {&Sample::ddy0, "Acceleration of y_0 [m/s^2]."}},
      {"acc", {&Sample::acc, "Acceleration of the thigh's centre of mass, |ddr_0| [m/s^2]."}},
      {"tau_sea", {&Sample::tau_sea, "Torque of the spring [Nm]."}},
      {"phi_ref", {&Sample::phi_ref, "Reference [rad]."}}};
  for (const auto& [name, what] : columns)
    row_property(c, name, what.second, [member = what.first](auto& s) { return &(s.*member); });
  for (std::size_t j = 0; j < std::size_t(kPoints); ++j)
    for (const int axis : {0, 1})
      row_property(c, fmt::format("f_{}_{}", kPointNames[j], "xy"[axis]).c_str(),
                   fmt::format("Force of the floor on the {}, {} [N].", kPointNames[j], axis == 0 ? "forward" : "up"),
                   [j, axis](auto& s) { return s.force[j].data() + axis; });
}

void bind_landing_class(py::module_& m) {
  py::class_<NamedTouch> contact(m, "Contact", "A point meets the floor and leaves it.");
  contact.def_readonly("point", &NamedTouch::name, "hip, knee or foot; of a robot of links its contact's name.")
      .def_readonly("t_touchdown", &NamedTouch::t_touchdown, "From release [s].")
      .def_readonly("t_liftoff", &NamedTouch::t_liftoff, "When it rises through y = 0 again [s]; NaN if it never does.")
      .def_readonly("peak_force", &NamedTouch::peak_force, "Largest force of this contact [N].")
      .def_readonly("peak_acc", &NamedTouch::peak_acc,
                    "Largest acceleration that counts from this touchdown to the next of any point [m/s^2].");
  bind_value(contact);
  py::class_<Played> c(m, "Landing", "One landing: released, in flight, through its contacts, to rest.");
  bind_checked(
      c, [](auto&) { return tools::point_name; }, "point");
  property(c, "joint_lost", "Whether the joint turned right round: the drive has lost it.",
           [](auto& p) { return p.checked.landing.joint_lost; });
  property(c, "motor_speed", "Largest |dphi_m| [rad/s].",
           [](auto& p) { return p.checked.landing.demands.motor_speed; });
  property(c, "motor_torque", "Largest |tau_mot| [Nm].",
           [](auto& p) { return p.checked.landing.demands.motor_torque; });
  c.def("__repr__", [](const Played& p) {
    return fmt::format("<ukemi.Landing: peak {:.6g} m/s^2 at {:.4g} s, {}>", p.checked.landing.peak,
                       p.checked.landing.t_peak, tools::contact_order(p.checked.landing.contacts));
  });
  bind_figure(
      c,
      [](const Played& p) {
        return figure({{"|ddr_0|", &p.checked.landing}});
      },
      "|ddr_0| [m/s^2] over time [s].");
  bind_trajectory(c);
  bind_value(c);
  bind_report(c, tools::kSimulateOutputs, kNoSeed, [](auto& p, tools::Run& run) {
    return report(p.checked, p.actuator, held_landing(p.checked, p.actuator.sea, p.rate), {}, run);
  });
}

}  // namespace

void bind_landing(py::module_& m) {
  bind_landing_class(m);
  m.def(
      "simulate",
      [](const Scene& scene, const Actuator& actuator, const Motion& motion, double rate, double accuracy) {
        require_gains(actuator);
        SimulateOptions options{.accuracy = accuracy};
        options.validate();
        checked_rate(rate);
        CheckedLanding c = long_call([&](const std::function<bool()>& stop) {
          options.over = &stop;
          return checked_landing(scene, actuator, motion, options, rate);
        });
        return Played{std::move(c), actuator, rate};
      },
      py::arg("scene"), py::arg("actuator"), py::arg("motion"), py::arg("rate") = 1000.0, py::arg("accuracy") = 1e-9,
      "One landing, as `ukemi simulate`. rate: rows of the trajectory a second [Hz]; accuracy: relative tolerance of "
      "each step [1].");
}

}  // namespace ukemi::python
