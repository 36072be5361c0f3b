// Python bindings of scene, motion and player.
#include <fmt/format.h>

#include "landing/body/body_scene.hpp"
#include "landing/body/load.hpp"
#include "landing/model/player.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/plan/design_numbers.hpp"
#include "landing/plan/scene_doubts.hpp"
#include "tools/python/arguments.hpp"
#include "tools/report/body.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/results.hpp"

namespace ukemi::python {

using namespace landing;

Drop dropped(Drop drop, const DropNumbers& n) {
  if (n.height) drop.height = checked("height", *n.height, Range::non_negative());
  if (n.forward_speed) drop.forward_speed = checked("forward_speed", *n.forward_speed, Range::any());
  if (n.pitch) drop.pitch = angle("pitch", *n.pitch);
  if (n.pitch_rate) drop.pitch_rate = checked("pitch_rate", *n.pitch_rate, Range::any());
  return drop;
}

BodyMotion motions_of(const BodyScene& scene, const JointMotions& motions) {
  BodyMotion out = held_posture(scene);
  std::vector<std::string> driven;
  for (const Joint& j : scene.robot.joints)
    if (j.driven()) driven.push_back(j.name);
  for (const auto& [name, motion] : motions) {
    if (std::find(driven.begin(), driven.end(), name) == driven.end())
      throw InputError("motions: " + one_of(name, driven));
    for (std::size_t i = 0; i < out.size(); ++i)
      if (scene.robot.joints[i].name == name) out[i] = motion;
  }
  return out;
}

py::dict by_joint(const Robot& robot, const BodyMotion& motion) {
  py::dict out;
  for (std::size_t i = 0; i < motion.size(); ++i)
    if (robot.joints[i].driven()) out[py::str(robot.joints[i].name)] = motion[i];
  return out;
}

py::dict loads_of_scene(const BodyScene& scene) {
  py::dict out;
  for (const Load& l : scene.loads) {
    py::dict load;
    load["kind"] = name(l.kind), load["of"] = place_of(l, scene.robot), load["rating"] = l.rating;
    load["unit"] = unit(l.kind), load["limit"] = l.limit;
    out[l.name.c_str()] = load;
  }
  return out;
}
py::dict loads_of_landing(const BodyScene& scene, const BodyLanding& landing) {
  py::dict out = loads_of_scene(scene);
  const std::vector<LoadPeak> peaks = loads_of(scene, landing);
  for (std::size_t i = 0; i < scene.loads.size(); ++i) {
    const Load& l = scene.loads[i];
    py::object load = out[l.name.c_str()];
    load["value"] = peaks[i].value, load["t"] = peaks[i].t;
    load["ratio"] = l.rating > 0 ? py::cast(peaks[i].value / l.rating) : py::none();
  }
  return out;
}

namespace {

using Drives = std::map<std::string, Path>;
std::vector<GivenDrive> drives_of(const Drives& actuators) {
  std::vector<GivenDrive> out;
  for (const auto& [joint, file] : actuators) out.push_back({joint, file});
  return out;
}

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

/// Binds the numbers of a scene's drop and dropped(...); check(scene) throws InputError for one that cannot be.
template <class T, class Check>
void bind_drop_of(py::class_<T>& c, const char* height, const char* pitch, Check check) {
  property(c, "height", height, [](auto& s) { return s.drop.height; });
  property(c, "forward_speed", "At release [m/s].", [](auto& s) { return s.drop.forward_speed; });
  property(c, "pitch", pitch, [](auto& s) { return s.drop.pitch; });
  property(c, "pitch_rate", "At release [rad/s].", [](auto& s) { return s.drop.pitch_rate; });
  define(
      c, "dropped",
      [check](const DropNumbers& numbers, T s) {
        s.drop = dropped(s.drop, numbers);
        check(s);
        return s;
      },
      Argument{"height", &DropNumbers::height}, Argument{"forward_speed", &DropNumbers::forward_speed},
      Argument{"pitch", &DropNumbers::pitch}, Argument{"pitch_rate", &DropNumbers::pitch_rate},
      "The same scene with another drop: height [m], forward_speed [m/s], pitch [rad], pitch_rate [rad/s].");
}

void bind_scene_class(py::module_& m) {
  Value<Scene> c(m, "Scene", "The robot, the floor, the drop, and what a motion may be.");
  c.def_readonly("name", &Scene::name, "What it is called.");
  property(c, "verdicts", "How far the calibration that found a constant of the floor may be relied on, by its name.",
           [](auto& s) { return std::map<std::string, std::string>(s.verdicts.begin(), s.verdicts.end()); });
  bind_drop_of(c, "Clearance of the lowest contact point at release [m].",
               "Of the thigh at release [rad]; 0: vertical, the knee below the hip.", [](const Scene& s) {
                 if (const auto wrong = release_fault(s)) throw InputError(wrong->key + ": " + wrong->message);
               });
  c.repr([](auto& s) {
    return fmt::format(" '{}': {:g} m, {:g} m/s, {:.4g} deg", s.name, s.drop.height, s.drop.forward_speed,
                       s.drop.pitch * kDegrees);
  });
  bind_file(c, "a scene file", [](const Scene& s) { return to_toml(s, ""); });
  bind_reader(m, "read_scene", "Reads a scene file (TOML).", [](const Path& path) { return read_scene(path); });
}

void bind_motion(py::module_& m) {
  Value<Motion> c(m, "Motion", "What a robot plays: the knee's reference from the first touchdown on.");
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
  Value<PlannedMotion, Motion> planned(m, "PlannedMotion", "A motion that a search found, with what it minimised.");
  planned.def_readonly("goal", &PlannedMotion::goal, "What was minimised.")
      .def_readonly("value", &PlannedMotion::value, "Its value [m/s^2].")
      .def("__repr__", [](const PlannedMotion& x) {
        return fmt::format("<ukemi.PlannedMotion {}; {}>", tools::motion_words(x), minimised(x.goal, x.value));
      });
  bind_reader(m, "read_motion", "Reads a motion file: TOML, or the rows of a motion.csv.",
              [](const Path& path) { return read_motion(path); });
  m.def("motion_deg", &motion_of_degrees, py::arg("phi_i_deg"), py::arg("phi_f_deg"), py::arg("duration"),
        py::arg("bumps_deg") = std::vector<double>{}, py::arg("gain_p") = 1.0, py::arg("gain_d") = 1.0,
        "A Motion of angles in degrees [deg]; else as its constructor.");
  m.def(
      "hold", [](double degrees) { return motion_of_degrees(degrees, degrees, 1, {}, 1, 1); }, py::arg("phi_deg"),
      "Holds the reference at an angle [deg]; the joint stays compliant.");
}

void bind_robot_scene(py::module_& m) {
  Value<BodyScene> c(m, "RobotScene", "A robot of links, its floor, its drop, and what a plan may be.");
  c.def_readonly("name", &BodyScene::name, "What it is called.");
  property(c, "links", "Names of the links.", [](auto& s) { return names_of(s.robot.links); });
  property(c, "joints", "Names of the driven joints, in the robot's order.", [](auto& s) {
    std::vector<std::string> out;
    for (const Joint& j : s.robot.joints)
      if (j.driven()) out.push_back(j.name);
    return out;
  });
  property(c, "contacts", "Names of the contact points.", [](auto& s) { return names_of(s.robot.contacts); });
  property(c, "mass", "Of the whole robot [kg].", [](auto& s) { return s.robot.mass(); });
  property(c, "doubts", "What looks wrong, a sentence each.", [](auto& s) { return doubts(s); });
  bind_drop_of(c, "Clearance of the lowest contact at release [m].", "Angle of the first link at release [rad].",
               [](const BodyScene& s) { s.validate(); });
  property(c, "loads", "What its parts bear, by name: a dict of kind, of, rating, unit and limit.", loads_of_scene);
  property(c, "design_names", "Every number of the design that has a name, see `design`.", design_names);
  c.def("design", design_number, py::arg("name"),
        "A number by the way to it in the files, as \"drive.knee.k_sea\", in their unit; NaN: there is none.")
      .def(
          "with_design",
          [](BodyScene s, const std::map<std::string, double>& numbers) {
            for (const auto& [name, value] : numbers) set_design_number(s, name, value);
            return s;
          },
          py::arg("numbers"), "The same scene with other numbers: a dict of names and values, see `design`.");
  c.def(
      "held", [](const BodyScene& s) { return by_joint(s.robot, held_posture(s)); },
      "The posture that it holds without a plan: a Motion for each driven joint by its name.");
  c.repr([](auto& s) {
    return fmt::format(" '{}': {} links, {} joints, {:.4g} kg", s.name, s.robot.links.size(), s.robot.joints.size(),
                       s.robot.mass());
  });
  bind_report(c, tools::kRobotOutputs, kNoSeed, [](auto& s, tools::Run& run) { return report_robot(s, {}, run); });
}

void bind_files(py::module_& m) {
  m.def(
      "robot", [](const Path& path, const Drives& actuators) { return read_robot(path, drives_of(actuators)); },
      py::arg("path"), py::arg("actuators") = Drives{},
      "A robot of links from its own file or a scene's (TOML), before anything falls, as `ukemi robot`. actuators: a "
      "file for a joint by its name.");
  m.def(
      "read_robot_scene",
      [](const Path& path, const Drives& actuators) { return read_body_scene(path, drives_of(actuators)); },
      py::arg("path"), py::arg("actuators") = Drives{},
      "Reads the scene file (TOML) of a robot of links. actuators: a file for a joint by its name.");
  m.def(
      "read_motions",
      [](const Path& path, const Path& scene) {
        const Robot robot = read_body_scene(scene).robot;
        return by_joint(robot, read_body_motion(path, robot));
      },
      py::arg("path"), py::arg("scene"),
      "Reads a motion file of a robot of links: the motion of each driven joint by its name, in the robot's order; "
      "scene: its file or a RobotScene.");
  m.def(
      "read_motions",
      [](const Path& path, const BodyScene& scene) {
        return by_joint(scene.robot, read_body_motion(path, scene.robot));
      },
      py::arg("path"), py::arg("scene"), "The same for a scene that has been read.");
  m.def(
      "save_motions",
      [](const Path& path, const BodyScene& scene, const JointMotions& motions) {
        write_file(path, body_motion_toml(motions_of(scene, motions), scene.robot, ""));
      },
      py::arg("path"), py::arg("scene"), py::arg("motions"),
      "Writes a motion file of a robot of links: motions of its joints by name.");
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

void bind_scene(py::module_& m) {
  bind_scene_class(m), bind_motion(m), bind_player(m), bind_robot_scene(m), bind_files(m);
}

}  // namespace ukemi::python
