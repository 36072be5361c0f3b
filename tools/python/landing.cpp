// Scene, motion and one landing for Python.
#include "tools/python/landing.hpp"

#include <fmt/format.h>

#include "common/files.hpp"
#include "landing/body/body_scene.hpp"
#include "landing/model/player.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/arguments.hpp"
#include "tools/report/landing.hpp"

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

namespace {

double radians(const std::string& what, double degrees) {
  return checked(what, degrees, {-360, 360, false, "-360 to 360 deg"}) / kDegrees;
}

Motion motion_of(double phi_i_deg, double phi_f_deg, double duration, const std::vector<double>& bumps_deg,
                 double gain_p, double gain_d) {
  Motion m{radians("phi_i_deg", phi_i_deg), radians("phi_f_deg", phi_f_deg),
           checked("duration", duration, Range::positive())};
  if (bumps_deg.size() > kMostBumps)
    throw InputError(fmt::format("bumps_deg: {} terms: at most {} are needed", bumps_deg.size(), kMostBumps));
  for (std::size_t k = 0; k < bumps_deg.size(); ++k)
    m.bumps[k] = checked("bumps_deg", bumps_deg[k], Range::any()) / kDegrees;
  m.gain_p = checked("gain_p", gain_p, Range::non_negative());
  m.gain_d = checked("gain_d", gain_d, Range::non_negative());
  return m;
}

/// Another drop of the same scene.
Scene dropped(Scene s, std::optional<double> height, std::optional<double> forward_speed,
              std::optional<double> pitch_deg, std::optional<double> pitch_rate_deg) {
  if (height) s.drop.height = checked("height", *height, Range::non_negative());
  if (forward_speed) s.drop.forward_speed = checked("forward_speed", *forward_speed, Range::any());
  if (pitch_deg) s.drop.pitch = radians("pitch_deg", *pitch_deg);
  if (pitch_rate_deg) s.drop.pitch_rate = checked("pitch_rate_deg", *pitch_rate_deg, Range::any()) / kDegrees;
  if (const auto wrong = release_fault(s)) throw InputError(wrong->key + ": " + wrong->message);
  return s;
}

void bind_scene(py::module_& m) {
  py::class_<Scene> c(m, "Scene", "The robot, the floor, the drop, and what a motion may be.");
  const std::pair<const char*, std::pair<double Drop::*, const char*>> numbers[] = {
      {"height", {&Drop::height, "Clearance of the lowest contact point at release [m]."}},
      {"forward_speed", {&Drop::forward_speed, "At release [m/s]."}},
      {"pitch", {&Drop::pitch, "Of the thigh at release [rad]; 0: vertical, the knee below the hip."}},
      {"pitch_rate", {&Drop::pitch_rate, "At release [rad/s]."}}};
  for (const auto& [name, what] : numbers)
    c.def_property_readonly(
        name, [member = what.first](const Scene& s) { return s.drop.*member; }, what.second);
  c.def_readonly("name", &Scene::name, "What it is called.")
      .def_property_readonly(
          "verdicts",
          [](const Scene& s) { return std::map<std::string, std::string>(s.verdicts.begin(), s.verdicts.end()); },
          "How far the calibration that found a constant of the floor may be relied on, by its name.")
      .def(
          "dropped", &dropped, py::arg("height") = py::none(), py::arg("forward_speed") = py::none(),
          py::arg("pitch_deg") = py::none(), py::arg("pitch_rate_deg") = py::none(),
          "The same scene with another drop: height [m], forward_speed [m/s], pitch_deg [deg], pitch_rate_deg [deg/s].")
      .def(
          "toml", [](const Scene& s) { return to_toml(s, ""); }, "The text of a scene file.")
      .def(
          "save", [](const Scene& s, const std::string& path) { write_file(path, to_toml(s, "")); }, py::arg("path"),
          "Writes a scene file.")
      .def("__repr__", [](const Scene& s) {
        return fmt::format("<ukemi.Scene '{}': {:g} m, {:g} m/s, {:.4g} deg>", s.name, s.drop.height,
                           s.drop.forward_speed, s.drop.pitch * kDegrees);
      });
  m.def("read_scene", &read_scene, py::arg("path"), "Reads a scene file (TOML).");
}

void bind_motion(py::module_& m) {
  py::class_<Motion> c(m, "Motion", "What a robot plays: the knee's reference from the first touchdown on.");
  c.def(py::init(&motion_of),
        "phi_i_deg, phi_f_deg: the reference before and after the motion [deg]; duration [s]; bumps_deg: shape terms "
        "[deg]; "
        "gain_p, gain_d: factors of K_p and K_d from the touchdown on.",
        py::arg("phi_i_deg"), py::arg("phi_f_deg"), py::arg("duration"), py::arg("bumps_deg") = std::vector<double>{},
        py::arg("gain_p") = 1.0, py::arg("gain_d") = 1.0)
      .def_readonly("phi_i", &Motion::phi_i, "Reference until the first touchdown [rad].")
      .def_readonly("phi_f", &Motion::phi_f, "Reference after the motion [rad].")
      .def_readonly("duration", &Motion::duration, "From phi_i to phi_f [s].")
      .def_readonly("bumps", &Motion::bumps, "Shape terms [rad].")
      .def_readonly("gain_p", &Motion::gain_p, "Factor of K_p from the start of the motion on.")
      .def_readonly("gain_d", &Motion::gain_d, "Factor of K_d from the start of the motion on.")
      .def_property_readonly(
          "phi_i_deg", [](const Motion& x) { return x.phi_i * kDegrees; }, "phi_i [deg].")
      .def_property_readonly(
          "phi_f_deg", [](const Motion& x) { return x.phi_f * kDegrees; }, "phi_f [deg].")
      .def(
          "reference",
          [](const Motion& x, const Numbers& t) {
            const std::vector<double> times = column("t", t);
            py::array_t<double> phi(py::ssize_t(times.size())), dphi(py::ssize_t(times.size()));
            for (std::size_t i = 0; i < times.size(); ++i) {
              const Reference<double> r = reference_of(x, times[i]);
              phi.mutable_at(py::ssize_t(i)) = r.phi, dphi.mutable_at(py::ssize_t(i)) = r.dphi;
            }
            return std::pair(phi, dphi);
          },
          py::arg("t"), "Angle [rad] and rate [rad/s] of the reference at times [s] after its start.")
      .def(
          "toml", [](const Motion& x) { return to_toml(x, ""); }, "The text of a motion file.")
      .def(
          "save", [](const Motion& x, const std::string& path) { write_file(path, to_toml(x, "")); }, py::arg("path"),
          "Writes a motion file.")
      .def("__repr__", [](const Motion& x) { return "<ukemi.Motion " + tools::motion_words(x) + ">"; });
  m.def("read_motion", py::overload_cast<const std::string&>(&read_motion), py::arg("path"),
        "Reads a motion file: TOML, or the rows of a motion.csv.");
  m.def(
      "hold", [](double degrees) { return motion_of(degrees, degrees, 1, {}, 1, 1); }, py::arg("deg"),
      "Holds the reference at an angle [deg]; the joint stays compliant.");
}

void bind_player(py::module_& m) {
  py::class_<Player> c(m, "Player",
                       "A plan played on a robot: what each drive is sent at any time of the robot's own clock.");
  c.def(py::init([](const Motion& motion) { return Player({motion}); }), py::arg("motion"),
        "Of the paper's robot, or of one joint.")
      .def(py::init<std::vector<Motion>>(), py::arg("motions"), "A motion for each joint, in the robot's order.")
      .def_property_readonly("joints", &Player::joints, "How many joints it plays.")
      .def_property_readonly("landing", &Player::landing, "Whether the touchdown was told.")
      .def_property_readonly("end", &Player::end,
                             "When the last landing motion ends [s]; infinite before the touchdown.")
      .def("released", &Player::released, py::arg("t"),
           "The robot lets go at a time of its clock [s]. False, and nothing changes, for one that is not finite.")
      .def("touchdown", &Player::touchdown, py::arg("t"),
           "The first touchdown was noticed [s]. Counts once after a release; else False, and nothing changes.")
      .def(
          "at",
          [](const Player& x, double t) {
            std::vector<std::array<double, 4>> out;
            for (int k = 0; k < x.joints(); ++k) {
              const DriveCommand command = x.at(k, t);
              out.push_back({command.phi, command.dphi, command.gain_p, command.gain_d});
            }
            return out;
          },
          py::arg("t"), "(phi_ref [rad], dphi_ref [rad/s], factor of K_p, factor of K_d) of every joint at a time [s].")
      .def("__repr__", [](const Player& x) { return fmt::format("<ukemi.Player of {} joints>", x.joints()); });
  m.def(
      "read_motions",
      [](const std::string& path, const std::string& scene) {
        const Robot robot = read_body_scene(scene).robot;
        const BodyMotion motion = read_body_motion(path, robot);
        py::dict out;
        for (std::size_t i = 0; i < motion.size(); ++i)
          if (robot.joints[i].driven()) out[py::str(robot.joints[i].name)] = motion[i];
        return out;
      },
      py::arg("path"), py::arg("scene"),
      "Reads a motion file of a robot of links: the motion of each driven joint by its name, in the robot's order.");
}

void bind_trajectory(py::class_<Played>& c) {
  const auto add = [&](const char* name, auto address, const char* words) {
    c.def_property_readonly(
        name,
        [address](const py::object& self) {
          const std::vector<Sample>& rows = self.cast<const Played&>().landing.trajectory;
          return view(rows.empty() ? nullptr : address(rows.front()), rows.size(), sizeof(Sample), self);
        },
        words);
  };
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
    add(
        name, [member = what.first](const Sample& s) { return &(s.*member); }, what.second);
  for (std::size_t j = 0; j < std::size_t(kPoints); ++j)
    for (const int axis : {0, 1})
      add(
          fmt::format("f_{}_{}", kPointNames[j], "xy"[axis]).c_str(),
          [j, axis](const Sample& s) { return s.force[j].data() + axis; },
          fmt::format("Force of the floor on the {}, {} [N].", kPointNames[j], axis == 0 ? "forward" : "up").c_str());
}

void bind_landing_class(py::module_& m) {
  py::class_<Touch>(m, "Contact", "A point meets the floor and leaves it.")
      .def_property_readonly(
          "point", [](const Touch& t) { return kPointNames[std::size_t(t.point)]; }, "hip, knee or foot.")
      .def_readonly("t_touchdown", &Touch::t_touchdown, "From release [s].")
      .def_readonly("t_liftoff", &Touch::t_liftoff, "When it rises through y = 0 again [s]; NaN if it never does.")
      .def_readonly("peak_force", &Touch::peak_force, "Largest force of this contact [N].")
      .def_readonly("peak_acc", &Touch::peak_acc,
                    "Largest |ddr_0| from this touchdown to the next of any point [m/s^2].");
  py::class_<Played> c(m, "Landing", "One landing: released, in flight, through its contacts, to rest.");
  c.def_property_readonly(
       "peak", [](const Played& p) { return p.landing.peak; }, "Largest |ddr_0|, f(x) of Eq. 6 [m/s^2].")
      .def_property_readonly(
          "t_peak", [](const Played& p) { return p.landing.t_peak; }, "When, from release [s].")
      .def_property_readonly(
          "end", [](const Played& p) { return name(p.landing.end); }, "Why the run ended: rest, t_end, failed, ...")
      .def_property_readonly(
          "failure",
          [](const Played& p) { return no_landing(p.landing.end) ? tools::failure_words(p.landing) : std::string(); },
          "Why there is no landing; empty where there is one.")
      .def_property_readonly(
          "contacts", [](const Played& p) { return p.landing.touches; },
          "Every contact, in the order of the touchdowns.")
      .def_property_readonly(
          "error_estimate",
          [](const Played& p) {
            return p.sensitivity && p.sensitivity->checked ? std::optional(p.sensitivity->error_estimate)
                                                           : std::nullopt;
          },
          "Estimated relative error of the peak [1], or None where it was not looked at.")
      .def_property_readonly(
          "sensitive",
          [](const Played& p) {
            return p.sensitivity && p.sensitivity->checked ? std::optional(p.sensitivity->sensitive) : std::nullopt;
          },
          "Whether the motion stands beside a cliff of the objective, or None where it was not looked at.")
      .def_property_readonly(
          "joint_lost", [](const Played& p) { return p.landing.joint_lost; },
          "Whether the joint turned right round: the drive has lost it.")
      .def_property_readonly(
          "energy_residual", [](const Played& p) { return p.landing.energy_residual; },
          "Mismatch of the energy check over the energy turned over [1].")
      .def_property_readonly(
          "motor_speed", [](const Played& p) { return p.landing.demands.motor_speed; }, "Largest |dphi_m| [rad/s].")
      .def_property_readonly(
          "motor_torque", [](const Played& p) { return p.landing.demands.motor_torque; }, "Largest |tau_mot| [Nm].")
      .def(
          "figure",
          [](const Played& p) {
            return figure({{"|ddr_0|", &p.landing}});
          },
          "|ddr_0| [m/s^2] over time [s].")
      .def(
          "_repr_svg_",
          [](const Played& p) {
            return figure({{"|ddr_0|", &p.landing}}).svg;
          },
          "What a notebook shows.")
      .def("__repr__", [](const Played& p) {
        return fmt::format("<ukemi.Landing: peak {:.6g} m/s^2 at {:.4g} s, {}>", p.landing.peak, p.landing.t_peak,
                           tools::contact_order(p.landing.peaks));
      });
  bind_trajectory(c);
}

}  // namespace

void bind_landing(py::module_& m) {
  bind_scene(m), bind_motion(m), bind_player(m), bind_landing_class(m);
  m.def(
      "simulate",
      [](const Scene& scene, const Actuator& actuator, const Motion& motion, double rate, double accuracy) {
        require_gains(actuator);
        SimulateOptions options{.accuracy = accuracy};
        options.validate();
        checked("rate", rate, {0, 1e6, true, "above 0 to 1e6 Hz"});
        CheckedLanding c = long_call([&](const std::function<bool()>& stop) {
          options.over = &stop;
          return checked_landing(scene, actuator, motion, options, rate);
        });
        return Played{std::move(c.landing), c.sensitivity};
      },
      py::arg("scene"), py::arg("actuator"), py::arg("motion"), py::arg("rate") = 1000.0, py::arg("accuracy") = 1e-9,
      "One landing, as `ukemi simulate`. rate: rows of the trajectory a second [Hz]; accuracy: relative tolerance of "
      "each "
      "step [1].");
}

}  // namespace ukemi::python
