// Python bindings of landings.
#include "tools/python/landing.hpp"

#include <fmt/format.h>

#include "tools/program/arguments.hpp"
#include "tools/python/arguments.hpp"
#include "tools/report/body.hpp"
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

/// Binds a column of the rows of a landing's trajectory, shown without a copy; address(row): of its number.
template <class T, class Address>
void row_property(py::class_<T>& c, const char* name, const std::string& words, Address address) {
  c.def_property_readonly(
      name,
      [address](const py::object& self) {
        const auto& rows = self.cast<const T&>().checked.landing.trajectory;
        return view(rows.empty() ? nullptr : address(rows.front()), rows.size(), sizeof(rows[0]), self);
      },
      words.c_str());
}
/// The same of members of the rows: name, member, words.
template <class Row, class T>
void bind_rows(py::class_<T>& c, const std::vector<std::tuple<const char*, double Row::*, const char*>>& columns) {
  for (const auto& [name, member, words] : columns)
    row_property(c, name, words, [member = member](auto& s) { return &(s.*member); });
}

void bind_trajectory(py::class_<Played>& c) {
  bind_rows<Sample>(c, {{"t", &Sample::t, "Times from release [s]; an event has two rows, its left and right limits."},
                        {"x_0", &Sample::x0, "Thigh's centre of mass, forward [m]."},
                        {"y_0", &Sample::y0, "Thigh's centre of mass, above the floor [m]."},
                        {"phi_0", &Sample::phi0, "Thigh's pitch [rad]."},
                        {"phi_1", &Sample::phi1, "Joint angle [rad]."},
                        {"phi_m", &Sample::phi_m, "Motor angle [rad]."},
                        {"dx_0", &Sample::dx0, "Rate of x_0 [m/s]."},
                        {"dy_0", &Sample::dy0, "Rate of y_0 [m/s]."},
                        {"dphi_0", &Sample::dphi0, "Rate of phi_0 [rad/s]."},
                        {"dphi_1", &Sample::dphi1, "Rate of phi_1 [rad/s]."},
                        {"dphi_m", &Sample::dphi_m, "Rate of phi_m [rad/s]."},
                        {"ddx_0", &Sample::ddx0, "Acceleration of x_0 [m/s^2]."},
                        {"ddy_0", &Sample::ddy0, "Acceleration of y_0 [m/s^2]."},
                        {"acc", &Sample::acc, "Acceleration of the thigh's centre of mass, |ddr_0| [m/s^2]."},
                        {"tau_sea", &Sample::tau_sea, "Torque of the spring [Nm]."},
                        {"phi_ref", &Sample::phi_ref, "Reference [rad]."}});
  for (std::size_t j = 0; j < std::size_t(kPoints); ++j)
    for (const int axis : {0, 1})
      row_property(c, fmt::format("f_{}_{}", kPointNames[j], "xy"[axis]).c_str(),
                   fmt::format("Force of the floor on the {}, {} [N].", kPointNames[j], axis == 0 ? "forward" : "up"),
                   [j, axis](auto& s) { return s.force[j].data() + axis; });
}

void bind_landing_class(py::module_& m) {
  Value<NamedTouch> contact(m, "Contact", "A point meets the floor and leaves it.");
  contact.def_readonly("point", &NamedTouch::name, "hip, knee or foot; of a robot of links its contact's name.")
      .def_readonly("t_touchdown", &NamedTouch::t_touchdown, "From release [s].")
      .def_readonly("t_liftoff", &NamedTouch::t_liftoff, "When it rises through y = 0 again [s]; NaN if it never does.")
      .def_readonly("peak_force", &NamedTouch::peak_force, "Largest force of this contact [N].")
      .def_readonly("peak_acc", &NamedTouch::peak_acc,
                    "Largest acceleration that counts from this touchdown to the next of any point [m/s^2].");
  Value<Played> c(m, "Landing", "One landing: released, in flight, through its contacts, to rest.");
  bind_checked(
      c, [](auto&) { return tools::point_name; }, "point");
  property(c, "joint_lost", "Whether the joint turned right round: the drive has lost it.",
           [](auto& p) { return p.checked.landing.joint_lost; });
  property(c, "motor_speed", "Largest |dphi_m| [rad/s].",
           [](auto& p) { return p.checked.landing.demands.motor_speed; });
  property(c, "motor_torque", "Largest |tau_mot| [Nm].",
           [](auto& p) { return p.checked.landing.demands.motor_torque; });
  c.repr([](auto& p) {
    return fmt::format(": peak {:.6g} m/s^2 at {:.4g} s, {}", p.checked.landing.peak, p.checked.landing.t_peak,
                       tools::contact_order(p.checked.landing.contacts));
  });
  bind_figure(
      c,
      [](const Played& p) {
        return figure({{"|ddr_0|", &p.checked.landing}});
      },
      "|ddr_0| [m/s^2] over time [s].");
  bind_trajectory(c);
  bind_report(c, tools::kSimulateOutputs, kNoSeed, [](auto& p, tools::Run& run) {
    return report(p.checked, p.actuator, held_landing(p.checked, p.actuator.sea, p.rate), {}, run);
  });
}

/// Binds a dict of columns of the trajectory: an array for each of `names`.
template <std::size_t N>
void bind_columns(py::class_<BodyPlayed>& c, const char* name, std::array<double, N> BodySample::*at,
                  std::vector<std::string> (*names)(const Robot&), const char* words) {
  c.def_property_readonly(
      name,
      [at, names](const py::object& self) {
        const CheckedBody& b = self.cast<const BodyPlayed&>().checked;
        const std::vector<BodySample>& rows = b.landing.trajectory;
        py::dict out;
        const std::vector<std::string> all = names(b.scene.robot);
        for (std::size_t i = 0; i < all.size(); ++i)
          out[py::str(all[i])] =
              view(rows.empty() ? nullptr : &(rows.front().*at)[i], rows.size(), sizeof(BodySample), self);
        return out;
      },
      words);
}

void bind_trajectory(py::class_<BodyPlayed>& c) {
  bind_rows<BodySample>(
      c, {{"t", &BodySample::t, "Times from release [s]; an event has two rows, its left and right limits."},
          {"acc", &BodySample::acc, "Acceleration of the point that counts [m/s^2]."},
          {"acc_x", &BodySample::acc_x, "Its forward component [m/s^2]."},
          {"acc_y", &BodySample::acc_y, "Its upward component [m/s^2]."},
          {"energy", &BodySample::energy, "Of the links [J]."}});
  const auto links = +[](const Robot& r) { return names_of(r.links); };
  const auto joints = +[](const Robot& r) { return names_of(r.joints); };
  const auto contacts = +[](const Robot& r) { return names_of(r.contacts); };
  bind_columns(c, "x", &BodySample::x, links, "Origin of each link by its name, forward [m].");
  bind_columns(c, "y", &BodySample::y, links, "Origin of each link by its name, up [m].");
  bind_columns(c, "theta", &BodySample::theta, links, "Absolute angle of each link by its name [rad].");
  bind_columns(c, "vx", &BodySample::vx, links, "Velocity of each link's origin by its name, forward [m/s].");
  bind_columns(c, "vy", &BodySample::vy, links, "Velocity of each link's origin by its name, up [m/s].");
  bind_columns(c, "omega", &BodySample::omega, links, "Rate of each link's absolute angle by its name [rad/s].");
  bind_columns(c, "phi", &BodySample::phi, joints, "Angle of each joint by its name [rad].");
  bind_columns(c, "dphi", &BodySample::dphi, joints, "Rate of each joint by its name [rad/s].");
  bind_columns(c, "phi_m", &BodySample::phi_m, joints, "Angle of each motor by its joint's name [rad].");
  bind_columns(c, "dphi_m", &BodySample::dphi_m, joints, "Rate of each motor by its joint's name [rad/s].");
  bind_columns(c, "drive_torque", &BodySample::drive_torque, joints,
               "Torque of each driven joint's spring, of a geared drive its motor's, by its name [Nm].");
  bind_columns(c, "tau", &BodySample::tau, joints, "Torque on the child of each joint by its name [Nm].");
  bind_columns(c, "phi_ref", &BodySample::phi_ref, joints, "Reference of each joint by its name [rad].");
  bind_columns(c, "force_x", &BodySample::force_x, contacts, "Force of the floor on each contact, forward [N].");
  bind_columns(c, "force_y", &BodySample::force_y, contacts, "Force of the floor on each contact, up [N].");
}

Figure body_figure(const BodyPlayed& p) {
  const std::vector<BodySample>& rows = p.checked.landing.trajectory;
  tools::Series s{"acceleration", {}, {}};
  for (const BodySample& row : rows) s.x.push_back(row.t), s.y.push_back(row.acc);
  return {tools::lines_svg("t [s] after release", "acceleration [m/s^2]",
                           rows.empty() ? std::vector<tools::Series>{} : std::vector{s})};
}

void bind_body_landing(py::module_& m) {
  Value<BodyPlayed> c(m, "RobotLanding", "One landing of a robot of links, from release to rest.");
  bind_checked(
      c, [](auto& p) { return tools::contact_name(p.checked.scene.robot); }, "contact");
  property(c, "motions", "What was played: a Motion of each driven joint by its name.",
           [](auto& p) { return by_joint(p.checked.scene.robot, p.checked.motion); });
  property(c, "loads",
           "The largest value of each load of the scene, by name: a dict of value, t [s], ratio (value / rating) and "
           "what RobotScene.loads has.",
           [](auto& p) { return loads_of_landing(p.checked.scene, p.checked.landing); });
  c.repr([](auto& p) {
    return fmt::format(": peak {:.6g} m/s^2 at {:.4g} s", p.checked.landing.peak, p.checked.landing.t_peak);
  });
  bind_figure(c, body_figure, "The acceleration that counts [m/s^2] over time [s].");
  bind_trajectory(c);
  bind_report(c, tools::kSimulateOutputs, kNoSeed,
              [](auto& p, tools::Run& run) { return report(p.checked, held_landing(p.checked, p.rate), {}, run); });
}

/// run(options) as a long call.
template <class Run>
auto simulated(const Arguments& a, Run run) {
  SimulateOptions options{.accuracy = a.accuracy};
  options.validate();
  checked_rate(a.rate);
  return long_call([&](const std::function<bool()>& stop) {
    options.over = &stop;
    return run(options);
  });
}

}  // namespace

void bind_landing(py::module_& m) {
  bind_landing_class(m), bind_body_landing(m);
  define(
      m, "simulate",
      [](const Arguments& a, const Scene& scene, const Actuator& actuator, const Motion& motion) {
        require_gains(actuator);
        return simulated(a, [&](const SimulateOptions& options) {
          return Played{checked_landing(scene, actuator, motion, options, a.rate), actuator, a.rate};
        });
      },
      py::arg("scene"), py::arg("actuator"), py::arg("motion"), kRate, kAccuracy,
      "One landing, as `ukemi simulate`. rate: rows of the trajectory a second [Hz]; accuracy: relative tolerance of "
      "each step [1].");
  define(
      m, "simulate",
      [](const Arguments& a, const BodyScene& scene, const JointMotions& motions) {
        return simulated(a, [&](const SimulateOptions& options) {
          return BodyPlayed{checked_body(scene, motions_of(scene, motions), options, a.rate), a.rate};
        });
      },
      py::arg("scene"), py::arg("motions") = JointMotions{}, kRate, kAccuracy,
      "The same of a robot of links. motions: of its joints by name; one that is not named is held as its scene says.");
}

}  // namespace ukemi::python
