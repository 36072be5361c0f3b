#include "tools/report/actuator_models.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "common/actuator_constants.hpp"
#include "common/csv.hpp"
#include "common/text.hpp"

namespace ukemi::tools {

namespace {

/// Lines as an XML comment, in which "--" may not stand.
std::string comment(std::string text) {
  for (std::size_t i; (i = text.find("--")) != std::string::npos;) text.replace(i, 2, "- -");
  return "<!--\n" + text + "-->\n";
}

/// Model element that holds each constant of an actuator file, by its key; a constant without one is left out.
using Elements = std::map<std::string, std::string>;

/// A line for each constant of the actuator: value, standard error, model element.
std::string listing(const Actuator& a, const Elements& elements) {
  std::string text;
  const auto line = [&](const std::string& name, double value, const std::string& unit) {
    const auto error = a.standard_error(name);
    const auto element = elements.find(name);
    text += fmt::format("  {} = {} {}{}: {}\n", name, shortest(value), unit,
                        error ? fmt::format(", standard error {:.2g}", *error) : "",
                        element == elements.end() ? "NOT IN THIS MODEL" : element->second);
  };
  const auto u = constants(a.sea);
  for (int i = known_command(a.sea) ? 2 : 0; i < kConstants; ++i) line(kConstantNames[i], u[i], kConstantUnits[i]);
  for (const ActuatorConstant& c : optional_constants())
    if (a.sea.*c.at != c.absent) line(c.key, a.sea.*c.at, c.unit);
  if (std::isfinite(a.sea.tau_max)) line("tau_max", a.sea.tau_max, "Nm, limit of the spring's torque");
  if (a.speed_max) line("speed_max", *a.speed_max, "rad/s, the motor's rating");
  if (a.motor_torque_max) line("motor_torque_max", *a.motor_torque_max, "Nm, the motor's rating");
  for (const auto& [name, verdict] : doubted(a.verdicts)) text += fmt::format("  Beware: {} is {}.\n", name, verdict);
  return text;
}

bool feeds_back_motor(const Actuator& a) { return a.sea.feedback == Feedback::kMotor; }

std::string mjcf_words(const Actuator& a, const std::string& j) {
  const bool motor = feeds_back_motor(a), command = known_command(a.sea);
  Elements elements = {{"k_p", motor ? "kp of the position actuator" : "your controller, see below"},
                       {"k_d", motor ? "kv of the position actuator" : "your controller, see below"},
                       {"k_sea", "stiffness of the tendon " + j + "_spring"},
                       {"c_sea", "damping of the same tendon"},
                       {"i_motor", "armature of " + j + "_motor, the rotor's at the gear's output"},
                       {"friction", "frictionloss of " + j + "_motor"},
                       {"viscous_friction", "damping of " + j + "_motor"},
                       {"output_friction", "frictionloss of " + j},
                       {"output_viscous", "damping of " + j}};
  if (command) elements["k_t"] = "gear of the motor actuator, of which ctrl is the command";
  const std::string text =
      fmt::format("Series elastic actuator: {}\nWhere its constants went:\n", shown(a.name)) + listing(a, elements) +
      fmt::format(
          "{0} is phi_1, the angle of the link; {0}_motor is phi_m, the angle of the rotor at the gear's output.\n"
          "The tendon's length is phi_m - phi_1: K_SEA (phi_m - phi_1) + C_SEA (dphi_m - dphi_1) drives the link "
          "and brakes the rotor, Eq. 2 without its limit. An armature counts the rotor's turning against its base "
          "alone, as Eq. 4 does.\n",
          j);
  if (command) return text;
  if (motor)
    return text +
           "The drive feeds back the motor's angle. A position actuator knows no reference rate: with\n  ctrl = "
           "phi_ref + k_d / k_p dphi_ref\nit is Eq. 3.\n";
  return text + fmt::format(
                    "The drive feeds back the angle of the link, while its torque acts on the rotor. No position "
                    "actuator can: it acts where it measures. Set the ctrl of the motor actuator at every step:\n"
                    "  ctrl = {} (phi_ref - {}) + {} (dphi_ref - rate of {})\n",
                    shortest(a.sea.k_p), j, shortest(a.sea.k_d), j);
}

std::string drive_element(const Actuator& a, const std::string& j) {
  if (known_command(a.sea))
    return fmt::format("<motor name=\"{0}\" joint=\"{0}_motor\" gear=\"{1}\"/>", j, shortest(a.sea.k_t));
  if (feeds_back_motor(a))
    return fmt::format("<position name=\"{0}\" joint=\"{0}_motor\" kp=\"{1}\" kv=\"{2}\"/>", j, shortest(a.sea.k_p),
                       shortest(a.sea.k_d));
  return fmt::format("<motor name=\"{0}\" joint=\"{0}_motor\"/>", j);
}

/// The law of the drive's controller, for a format that has none.
std::string controller_words(const Actuator& a) {
  if (known_command(a.sea)) return fmt::format("k_t = {} times its command", shortest(a.sea.k_t));
  return fmt::format("Eq. 3: k_p (phi_ref - {0}) + k_d (dphi_ref - rate of {0})",
                     feeds_back_motor(a) ? "phi_m" : "phi_1");
}

bool has_ratings(const Actuator& a) { return a.motor_torque_max && a.speed_max; }

std::string urdf_words(const Actuator& a, const std::string& j) {
  Elements elements = {{"k_sea", "springStiffness of " + j + "_spring, which Gazebo alone reads"},
                       {"c_sea", "damping of " + j + "_spring"},
                       {"i_motor", "inertia of the link " + j + "_rotor, the rotor's at the gear's output"},
                       {"friction", "friction of " + j + "_motor"},
                       {"viscous_friction", "damping of " + j + "_motor"}};
  if (has_ratings(a)) {
    elements["motor_torque_max"] = "effort of " + j + "_motor";
    elements["speed_max"] = "velocity of " + j + "_motor";
  }
  return fmt::format("Series elastic actuator: {}\nWhere its constants went:\n", shown(a.name)) + listing(a, elements) +
         fmt::format(
             "Two joints in a row: {0}_motor is phi_m, {0}_spring is phi_1 - phi_m, so that phi_1 is their sum.\n"
             "What URDF cannot hold: the spring (without Gazebo's line the joint is free); the controller, whose "
             "torque acts on {0}_motor ({1}); the limit of the spring's torque; friction between link and base.\n"
             "The link world is the rig: put your robot's link in its place. The rotor is a body here, of 1 g, since "
             "Gazebo leaves\n"
             "out lighter ones: on a base that turns it carries i_motor along, which Eq. 4 does not.\n"
             "The same in SDF: <dynamics><damping>{2}</damping><friction>0</friction><spring_reference>0"
             "</spring_reference><spring_stiffness>{3}</spring_stiffness></dynamics>\n",
             j, controller_words(a), shortest(a.sea.c_sea), shortest(a.sea.k_sea));
}

}  // namespace

std::string mjcf(const Actuator& a, const RigLink& link, const std::string& j, const std::string& comments) {
  const SeaParameters<double>& s = a.sea;
  return comment(comments + mjcf_words(a, j) +
                 "The link here is without gravity, whatever the rig was; in your robot put the rotor's body beside "
                 "the link's, both in the body that carries the actuator, with one pos and one axis.\n") +
         fmt::format(
             R"(<mujoco model="ukemi_actuator">
  <compiler angle="radian"/>
  <option gravity="0 0 0" timestep="0.0005" integrator="implicitfast"/>
  <worldbody>
    <body name="{j}_rotor">
      <inertial pos="0 0 0" mass="1e-6" diaginertia="1e-12 1e-12 1e-12"/>
      <joint name="{j}_motor" type="hinge" axis="0 0 1" armature="{i_motor}" damping="{viscous}" frictionloss="{friction}"/>
    </body>
    <body name="{j}_link">
      <inertial pos="0 0 0" mass="1" diaginertia="{inertia} {inertia} {inertia}"/>
      <joint name="{j}" type="hinge" axis="0 0 1" damping="{output_viscous}" frictionloss="{output_friction}"/>
      <site name="{j}_tip" pos="{length} 0 0"/>
    </body>
  </worldbody>
  <tendon>
    <fixed name="{j}_spring" stiffness="{k_sea}" damping="{c_sea}" springlength="0">
      <joint joint="{j}_motor" coef="1"/>
      <joint joint="{j}" coef="-1"/>
    </fixed>
  </tendon>
  <actuator>
    {drive}
  </actuator>
</mujoco>
)",
             fmt::arg("j", j), fmt::arg("i_motor", shortest(s.i_motor)), fmt::arg("viscous", shortest(s.viscous)),
             fmt::arg("friction", shortest(s.friction)), fmt::arg("inertia", shortest(link.inertia)),
             fmt::arg("output_viscous", shortest(s.output_viscous)),
             fmt::arg("output_friction", shortest(s.output_friction)), fmt::arg("length", shortest(link.length)),
             fmt::arg("k_sea", shortest(s.k_sea)), fmt::arg("c_sea", shortest(s.c_sea)),
             fmt::arg("drive", drive_element(a, j)));
}

std::string urdf(const Actuator& a, const RigLink& link, const std::string& j, const std::string& comments) {
  const SeaParameters<double>& s = a.sea;
  const std::string limit = has_ratings(a) ? fmt::format("\n    <limit effort=\"{}\" velocity=\"{}\"/>",
                                                         shortest(*a.motor_torque_max), shortest(*a.speed_max))
                                           : "";
  return "<?xml version=\"1.0\"?>\n" + comment(comments + urdf_words(a, j)) +
         fmt::format(
             R"(<robot name="ukemi_actuator">
  <link name="world"/>
  <link name="{j}_rotor">
    <inertial>
      <mass value="0.001"/>
      <inertia ixx="{i_motor}" ixy="0" ixz="0" iyy="{i_motor}" iyz="0" izz="{i_motor}"/>
    </inertial>
  </link>
  <link name="{j}_link">
    <inertial>
      <mass value="1"/>
      <inertia ixx="{inertia}" ixy="0" ixz="0" iyy="{inertia}" iyz="0" izz="{inertia}"/>
    </inertial>
  </link>
  <joint name="{j}_motor" type="continuous">
    <parent link="world"/>
    <child link="{j}_rotor"/>
    <axis xyz="0 0 1"/>{limit}
    <dynamics damping="{viscous}" friction="{friction}"/>
  </joint>
  <joint name="{j}_spring" type="continuous">
    <parent link="{j}_rotor"/>
    <child link="{j}_link"/>
    <axis xyz="0 0 1"/>
    <dynamics damping="{c_sea}" friction="0"/>
  </joint>
  <gazebo reference="{j}_spring">
    <implicitSpringDamper>true</implicitSpringDamper>
    <springReference>0</springReference>
    <springStiffness>{k_sea}</springStiffness>
  </gazebo>
</robot>
)",
             fmt::arg("j", j), fmt::arg("i_motor", shortest(s.i_motor)), fmt::arg("inertia", shortest(link.inertia)),
             fmt::arg("limit", limit), fmt::arg("viscous", shortest(s.viscous)),
             fmt::arg("friction", shortest(s.friction)), fmt::arg("c_sea", shortest(s.c_sea)),
             fmt::arg("k_sea", shortest(s.k_sea)));
}

}  // namespace ukemi::tools
