// Python bindings of robots of links: reading, landing.
#include "tools/python/body.hpp"

#include <fmt/format.h>

#include "landing/body/load.hpp"
#include "landing/plan/design_numbers.hpp"
#include "landing/plan/scene_doubts.hpp"
#include "tools/report/body.hpp"
#include "tools/report/results.hpp"

namespace ukemi::python {

using namespace landing;

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

namespace {

using Drives = std::map<std::string, Path>;
std::vector<GivenDrive> drives_of(const Drives& actuators) {
  std::vector<GivenDrive> out;
  for (const auto& [joint, file] : actuators) out.push_back({joint, file});
  return out;
}

template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& all) {
  std::vector<std::string> out;
  for (const Named& x : all) out.push_back(x.name);
  return out;
}

void bind_drop_of_scene(py::class_<BodyScene>& c) {
  property(c, "height", "Clearance of the lowest contact at release [m].", [](auto& s) { return s.drop.height; });
  property(c, "forward_speed", "At release [m/s].", [](auto& s) { return s.drop.forward_speed; });
  property(c, "pitch", "Angle of the first link at release [rad].", [](auto& s) { return s.drop.pitch; });
  property(c, "pitch_rate", "At release [rad/s].", [](auto& s) { return s.drop.pitch_rate; });
  bind_dropped(c, [](const BodyScene& s) { s.validate(); });
}

void bind_design_numbers(py::class_<BodyScene>& c) {
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
}

void bind_robot_scene(py::module_& m) {
  py::class_<BodyScene> c(m, "RobotScene", "A robot of links, its floor, its drop, and what a plan may be.");
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
  bind_drop_of_scene(c), bind_design_numbers(c);
  c.def(
       "held", [](const BodyScene& s) { return by_joint(s.robot, held_posture(s)); },
       "The posture that it holds without a plan: a Motion for each driven joint by its name.")
      .def("__repr__", [](const BodyScene& s) {
        return fmt::format("<ukemi.RobotScene '{}': {} links, {} joints, {:.4g} kg>", s.name, s.robot.links.size(),
                           s.robot.joints.size(), s.robot.mass());
      });
  bind_value(c);
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
  const std::pair<const char*, std::pair<double BodySample::*, const char*>> columns[] = {
      {"t", {&BodySample::t, "Times from release [s]; an event has two rows, its left and right limits."}},
      {"acc", {&BodySample::acc, "Acceleration of the point that counts [m/s^2]."}},
      {"acc_x", {&BodySample::acc_x, "Its forward component [m/s^2]."}},
      {"acc_y", {&BodySample::acc_y, "Its upward component [m/s^2]."}},
      {"energy", {&BodySample::energy, "Of the links [J]."}}};
  for (const auto& [name, what] : columns)
    row_property(c, name, what.second, [member = what.first](auto& s) { return &(s.*member); });
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
  py::class_<BodyPlayed> c(m, "RobotLanding", "One landing of a robot of links, from release to rest.");
  bind_checked(
      c, [](auto& p) { return tools::contact_name(p.checked.scene.robot); }, "contact");
  property(c, "motions", "What was played: a Motion of each driven joint by its name.",
           [](auto& p) { return by_joint(p.checked.scene.robot, p.checked.motion); });
  property(c, "loads",
           "The largest value of each load of the scene, by name: a dict of value, t [s], ratio (value / rating) and "
           "what RobotScene.loads has.",
           [](auto& p) { return loads_of_landing(p.checked.scene, p.checked.landing); });
  c.def("__repr__", [](const BodyPlayed& p) {
    return fmt::format("<ukemi.RobotLanding: peak {:.6g} m/s^2 at {:.4g} s>", p.checked.landing.peak,
                       p.checked.landing.t_peak);
  });
  bind_figure(c, body_figure, "The acceleration that counts [m/s^2] over time [s].");
  bind_trajectory(c);
  bind_value(c);
  bind_report(c, tools::kSimulateOutputs, kNoSeed,
              [](auto& p, tools::Run& run) { return report(p.checked, held_landing(p.checked, p.rate), {}, run); });
}

}  // namespace

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

void bind_body(py::module_& m) {
  bind_robot_scene(m), bind_files(m), bind_body_landing(m);
  m.def(
      "simulate",
      [](const BodyScene& scene, const JointMotions& motions, double rate, double accuracy) {
        SimulateOptions options{.accuracy = accuracy};
        options.validate();
        checked_rate(rate);
        const BodyMotion motion = motions_of(scene, motions);
        return long_call([&](const std::function<bool()>& stop) {
          options.over = &stop;
          return BodyPlayed{checked_body(scene, motion, options, rate), rate};
        });
      },
      py::arg("scene"), py::arg("motions") = JointMotions{}, py::arg("rate") = 1000.0, py::arg("accuracy") = 1e-9,
      "The same of a robot of links. motions: of its joints by name; one that is not named is held as its scene says.");
}

}  // namespace ukemi::python
