// Python bindings of scene, motion and player.
#include <fmt/format.h>

#include "landing/body/body_scene.hpp"
#include "landing/model/player.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/python/landing.hpp"
#include "tools/report/landing.hpp"

namespace ukemi::python {

using namespace landing;

Drop dropped(Drop drop, const DropNumbers& n) {
  if (n.height) drop.height = checked("height", *n.height, Range::non_negative());
  if (n.forward_speed) drop.forward_speed = checked("forward_speed", *n.forward_speed, Range::any());
  if (n.pitch) drop.pitch = angle("pitch", *n.pitch);
  if (n.pitch_rate) drop.pitch_rate = checked("pitch_rate", *n.pitch_rate, Range::any());
  return drop;
}

namespace {

Motion motion_of(double phi_i, double phi_f, double duration, const std::vector<double>& bumps, double gain_p,
                 double gain_d) {
  Motion m{angle("phi_i", phi_i), angle("phi_f", phi_f), checked("duration", duration, Range::positive())};
  if (bumps.size() > kMaxBumps)
    throw InputError(fmt::format("bumps: {} terms: at most {} are needed", bumps.size(), kMaxBumps));
  for (std::size_t k = 0; k < bumps.size(); ++k) m.bumps[k] = checked("bumps", bumps[k], Range::any());
  m.gain_p = checked("gain_p", gain_p, Range::non_negative());
  m.gain_d = checked("gain_d", gain_d, Range::non_negative());
  return m;
}
double radians(const std::string& what, double degrees) {
  return checked(what, degrees, {-360, 360, false, "-360 to 360 deg"}) / kDegrees;
}
Motion motion_of_degrees(double phi_i, double phi_f, double duration, std::vector<double> bumps, double gain_p,
                         double gain_d) {
  for (double& b : bumps) b = checked("bumps_deg", b, Range::any()) / kDegrees;
  return motion_of(radians("phi_i_deg", phi_i), radians("phi_f_deg", phi_f), duration, bumps, gain_p, gain_d);
}

void bind_scene_class(py::module_& m) {
  py::class_<Scene> c(m, "Scene", "The robot, the floor, the drop, and what a motion may be.");
  const std::pair<const char*, std::pair<double Drop::*, const char*>> numbers[] = {
      {"height", {&Drop::height, "Clearance of the lowest contact point at release [m]."}},
      {"forward_speed", {&Drop::forward_speed, "At release [m/s]."}},
      {"pitch", {&Drop::pitch, "Of the thigh at release [rad]; 0: vertical, the knee below the hip."}},
      {"pitch_rate", {&Drop::pitch_rate, "At release [rad/s]."}}};
  for (const auto& [name, what] : numbers)
    property(c, name, what.second, [member = what.first](auto& s) { return s.drop.*member; });
  c.def_readonly("name", &Scene::name, "What it is called.");
  property(c, "verdicts", "How far the calibration that found a constant of the floor may be relied on, by its name.",
           [](auto& s) { return std::map<std::string, std::string>(s.verdicts.begin(), s.verdicts.end()); });
  bind_dropped(c, [](const Scene& s) {
    if (const auto wrong = release_fault(s)) throw InputError(wrong->key + ": " + wrong->message);
  });
  c.def("__repr__", [](const Scene& s) {
    return fmt::format("<ukemi.Scene '{}': {:g} m, {:g} m/s, {:.4g} deg>", s.name, s.drop.height, s.drop.forward_speed,
                       s.drop.pitch * kDegrees);
  });
  bind_file(c, "a scene file", [](const Scene& s) { return to_toml(s, ""); });
  bind_value(c);
  bind_reader(m, "read_scene", "Reads a scene file (TOML).", [](const Path& path) { return read_scene(path); });
}

void bind_motion(py::module_& m) {
  py::class_<Motion> c(m, "Motion", "What a robot plays: the knee's reference from the first touchdown on.");
  c.def(py::init(&motion_of),
        "phi_i, phi_f: the reference before and after the motion [rad]; duration [s]; bumps: shape terms [rad]; "
        "gain_p, gain_d: factors of K_p and K_d from the touchdown on.",
        py::arg("phi_i"), py::arg("phi_f"), py::arg("duration"), py::arg("bumps") = std::vector<double>{},
        py::arg("gain_p") = 1.0, py::arg("gain_d") = 1.0)
      .def_readonly("phi_i", &Motion::phi_i, "Reference until the first touchdown [rad].")
      .def_readonly("phi_f", &Motion::phi_f, "Reference after the motion [rad].")
      .def_readonly("duration", &Motion::duration, "From phi_i to phi_f [s].")
      .def_readonly("bumps", &Motion::bumps, "Shape terms [rad].")
      .def_readonly("gain_p", &Motion::gain_p, "Factor of K_p from the start of the motion on.")
      .def_readonly("gain_d", &Motion::gain_d, "Factor of K_d from the start of the motion on.")
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
      .def("__repr__", [](const Motion& x) { return "<ukemi.Motion " + tools::motion_words(x) + ">"; });
  bind_file(c, "a motion file", [](const Motion& x) { return to_toml(x, ""); });
  bind_value(c);
  py::class_<PlannedMotion, Motion> planned(m, "PlannedMotion",
                                            "A motion that a search found, with what it minimised.");
  planned.def_readonly("goal", &PlannedMotion::goal, "What was minimised.")
      .def_readonly("value", &PlannedMotion::value, "Its value [m/s^2].")
      .def("__repr__", [](const PlannedMotion& x) {
        return fmt::format("<ukemi.PlannedMotion {}; {}>", tools::motion_words(x), minimised(x.goal, x.value));
      });
  bind_value(planned);
  bind_reader(m, "read_motion", "Reads a motion file: TOML, or the rows of a motion.csv.",
              [](const Path& path) { return read_motion(path); });
  m.def("motion_deg", &motion_of_degrees, py::arg("phi_i_deg"), py::arg("phi_f_deg"), py::arg("duration"),
        py::arg("bumps_deg") = std::vector<double>{}, py::arg("gain_p") = 1.0, py::arg("gain_d") = 1.0,
        "A Motion of angles in degrees [deg]; else as its constructor.");
  m.def(
      "hold", [](double degrees) { return motion_of_degrees(degrees, degrees, 1, {}, 1, 1); }, py::arg("phi_deg"),
      "Holds the reference at an angle [deg]; the joint stays compliant.");
}

void bind_player(py::module_& m) {
  py::class_<Player> c(m, "Player",
                       "A plan played on a robot: what each drive is sent at any time of the robot's own clock.");
  c.def(py::init([](const Motion& motion) { return Player({motion}); }), py::arg("motion"),
        "Of the paper's robot, or of one joint.")
      .def(py::init<std::vector<Motion>>(), py::arg("motions"), "A motion for each joint, in the robot's order.");
  property(c, "joints", "How many joints it plays.", &Player::joints);
  property(c, "landing", "Whether the touchdown was told.", &Player::landing);
  property(c, "end", "When the last landing motion ends [s]; infinite before the touchdown.", &Player::end);
  c.def("released", &Player::released, py::arg("t"),
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
}

}  // namespace

void bind_scene(py::module_& m) { bind_scene_class(m), bind_motion(m), bind_player(m); }

}  // namespace ukemi::python
