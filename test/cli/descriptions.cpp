// URDF and MJCF on a plane: `ukemi robot leg.urdf --normal y`, and what it makes of robots that others wrote.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "test/cli/refused.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

const std::string kUrdf = dataset("robots/hopper.urdf"), kMjcf = dataset("robots/hopper.xml");
const Arguments kRail = {"--normal", "y", "--base", "rail", "--contacts", "slider,knee,foot", "--no-report"};

/// Whether the program was built with the parser; a warning where it was not.
bool reads(const std::string& description, const std::string& package) {
  const Folder f;
  const Result r = run({"robot", description, "--normal", "y", "-o", "out", "--no-report"}, f.at(""));
  if (r.err.find(package) == std::string::npos) return true;
  WARN("skipped: the program was built without " << package);
  return false;
}
bool reads_urdf() { return reads(kUrdf, "liburdfdom-dev"); }
bool reads_mjcf() { return reads(kMjcf, "libmujoco-dev"); }

/// robot.toml of a description with the drives of hopper.toml in place of what it cannot know.
std::string with_hoppers_drives(const std::string& robot) {
  const std::string hopper = read(dataset("robots/hopper.toml"));
  return robot.substr(0, robot.find("\n# limits;")) + "\n" + hopper.substr(hopper.find("[drive.hip]"));
}
double hopper_peak(const Folder& f, const std::string& robot, const std::string& name) {
  f.write(name + ".toml", robot);
  f.write(name + "_scene.toml",
          replaced(read(dataset("scenes/hopper.toml")), "= \"../robots/hopper.toml\"", "= \"" + name + ".toml\""));
  done(f, {"simulate", name + "_scene.toml", "-o", name + "_out", "--no-report"});
  return Json::parse(read(f.at(name + "_out/summary.json")))["peak_acceleration"];
}

/// A leg of which every number is a round one: a base, a thigh with a bent bracket fixed on it, a shank.
const std::string kLeg = R"(<robot name="leg">
  <link name="base"><inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="hip" type="revolute">
    <parent link="base"/><child link="thigh"/><origin xyz="0.1 0.3 -0.2"/><axis xyz="0 1 0"/>
    <limit lower="-0.5" upper="1" effort="10" velocity="7"/>
  </joint>
  <link name="thigh"><inertial><origin xyz="0 0 -0.2"/><mass value="3"/>
    <inertia ixx="0.5" ixy="0" ixz="0" iyy="0.4" iyz="0" izz="0.3"/></inertial></link>
  <joint name="bolt" type="fixed"><parent link="thigh"/><child link="box"/><origin xyz="0.2 0.5 -0.4" rpy="0 0 1.5707963267948966"/></joint>
  <link name="box"><inertial><origin xyz="0 0.1 0"/><mass value="1"/>
    <inertia ixx="0.06" ixy="0.01" ixz="0" iyy="0.05" iyz="0" izz="0.04"/></inertial></link>
  <joint name="knee" type="continuous">
    <parent link="thigh"/><child link="shank"/><origin xyz="0 0 -0.4"/><axis xyz="0 -1 0"/><dynamics damping="0.25"/>
  </joint>
  <link name="shank"><inertial><origin xyz="0 0 -0.1"/><mass value="1"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.001"/></inertial></link>
  <joint name="tip" type="fixed"><parent link="shank"/><child link="toe-1"/><origin xyz="0.05 0 -0.3"/></joint>
  <link name="toe-1"/>
</robot>
)";

Json summary_of(const Folder& f, const std::string& description, const Arguments& options) {
  done(f, Arguments{"robot", f.write("leg.urdf", description), "-o", "out", "--no-report"} + options);
  return Json::parse(read(f.at("out/summary.json")));
}
/// The text of the projection's note of that kind and name.
std::string told(const Json& summary, const std::string& what, const std::string& name) {
  for (const Json& n : summary["projection"])
    if (n["what"] == what && n["name"] == name) return n["text"];
  return "";
}
/// All of two lists of links, numbers to rounding.
void check_same(const Json& a, const Json& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    CHECK(a[i]["name"] == b[i]["name"]);
    for (const char* key : {"mass", "inertia_com", "length"})
      CHECK(a[i][key].get<double>() == Approx(b[i][key].get<double>()).epsilon(1e-12).margin(1e-14));
    for (int k : {0, 1}) CHECK(a[i]["com"][k].get<double>() == Approx(b[i]["com"][k].get<double>()).margin(1e-12));
  }
}

void refused(const std::string& from, const std::string& to, const std::vector<std::string>& texts,
             const Arguments& options = {"--normal", "y"}) {
  const Folder f;
  f.write("leg.urdf", from.empty() ? to : replaced(kLeg, from, to));
  INFO(from << " -> " << to);
  check_refused(f, Arguments{"robot", "leg.urdf", "-o", "out"} + options, texts);
}

}  // namespace

TEST_CASE("a description's robot falls as the robot of links that it is, in URDF and in MJCF") {
  if (!reads_urdf()) return;
  const Folder f;
  const double peak = hopper_peak(f, read(dataset("robots/hopper.toml")), "own");
  CHECK(peak == Approx(98.476).epsilon(1e-4));
  const Result r = done(f, Arguments{"robot", kUrdf, "-o", "urdf"} + kRail);
  CHECK_THAT(r.out, Contains("locked     roll") && Contains("[1, 0, 0] is 90 deg off the normal") &&
                        Contains("merged     motor          fixed on thigh: 0.215 kg") &&
                        Contains("3 links, 2.273 kg") && Contains("offsets along y up to 0.07 m"));
  CHECK(hopper_peak(f, with_hoppers_drives(read(f.at("urdf/robot.toml"))), "a") == Approx(peak).epsilon(1e-9));
  if (!reads_mjcf()) return;
  done(f, Arguments{"robot", kMjcf, "-o", "mjcf"} + kRail);
  const std::string mjcf = read(f.at("mjcf/robot.toml"));
  CHECK(hopper_peak(f, with_hoppers_drives(mjcf), "b") == Approx(peak).epsilon(1e-9));
  CHECK_THAT(mjcf,
             Contains("# i_motor = 0.006 ") && Contains("# tau_max = 12 ") && Contains("gravity = 9.81   # m/s^2\n"));
}

TEST_CASE("what is fixed on a link is merged with it, masses and whole tensors") {
  if (!reads_urdf()) return;
  const Folder f;
  const Json s = summary_of(f, kLeg, {"--normal", "y", "--contacts", "toe-1"});
  REQUIRE(s["links"].size() == 3);
  const Json& thigh = s["links"][1];
  CHECK(thigh["name"] == "thigh");
  CHECK(thigh["mass"].get<double>() == 4);
  // The box's centre of mass: the bolt at (0.2, 0.5, -0.4), then 0.1 along its y, which is -x: (0.1, 0.5, -0.4); with 3
  // kg at (0, 0, -0.2): x = 0.025, z = -0.25. About y: the thigh's 0.4, the box's own ixx, which is across the plane.
  CHECK(thigh["com"][0].get<double>() == Approx(0.25).epsilon(1e-12));
  CHECK(thigh["com"][1].get<double>() == Approx(0.025).epsilon(1e-12));
  const double steiner = 3 * (0.025 * 0.025 + 0.05 * 0.05) + 0.075 * 0.075 + 0.15 * 0.15;
  CHECK(thigh["inertia_com"].get<double>() == Approx(0.4 + 0.06 + steiner).epsilon(1e-12));
  CHECK(s["projection"].size() > 5);
  CHECK_THAT(told(s, "stays", "hip"), Contains("revolute about +y: phi = -q"));
  CHECK_THAT(told(s, "stays", "knee"), Contains("continuous about -y: phi = q"));
  CHECK_THAT(told(s, "to fill in", "drive.hip"),
             Contains("limits -57.3 to 28.65 deg, effort 10 Nm, speed 7 rad/s"));  // turned with phi = -q
  CHECK_THAT(told(s, "renamed", "toe-1"), Contains("toe_1"));
  CHECK_THAT(read(f.at("out/robot.toml")),
             Contains("joint = \"hip\"\nq = { name = \"hip\", sign = -1, zero_deg = 0 }") &&
                 Contains("joint = \"knee\"\nq = { name = \"knee\", sign = 1, "));
  const std::string toml = read(f.at("out/robot.toml"));
  CHECK_THAT(toml, Contains("at = [0.2, 0.1]   # m: along, across\njoint = \"hip\"") &&
                       Contains("name = \"toe_1\"\nlink = \"shank\"\nat = [0.3") && Contains("damping = 0.25") &&
                       Contains("TO FILL IN: URDF knows no drive"));
}

TEST_CASE("robot.toml reads back as the robot that was shown") {
  if (!reads_urdf()) return;
  const Folder f;
  for (const Arguments& base :
       {Arguments{"--base", "free"}, {"--base", "rail"}, {"--base", "pinned", "--pin-height", "1"}}) {
    Json s = summary_of(f, kLeg, Arguments{"--normal", "y", "--contacts", "toe-1,thigh", "--contacts", "base"} + base);
    done(f, {"robot", "out/robot.toml", "-o", "back", "--no-report"});
    Json back = Json::parse(read(f.at("back/summary.json")));
    for (const char* key : {"links", "joints", "contacts", "mass", "reach", "base", "locked", "doubts"})
      CHECK(s[key] == back[key]);
    CHECK(s["contacts"].size() == 3);
  }
}

TEST_CASE("the same robot along other axes, or with its joints turned about, is the same") {
  if (!reads_urdf()) return;
  const Folder f;
  const Arguments y = {"--normal", "y"};
  std::string plain = replaced(kLeg, " rpy=\"0 0 1.5707963267948966\"", "");  // its tensor would turn otherwise
  plain = replaced(plain, "ixy=\"0.01\"", "ixy=\"0\"");
  const Json links = summary_of(f, plain, y)["links"];
  const auto along = [&](std::string order, std::string moments, const std::string& normal) {
    std::string out = plain;
    for (std::size_t i = out.find("xyz=\""); i != std::string::npos; i = out.find("xyz=\"", i + 1)) {
      const std::size_t begin = i + 5, end = out.find('"', begin);
      std::istringstream in(out.substr(begin, end - begin));
      std::string v[3];
      in >> v[0] >> v[1] >> v[2];
      out.replace(begin, end - begin, v[order[0] - 'x'] + " " + v[order[1] - 'x'] + " " + v[order[2] - 'x']);
    }
    for (const char axis : {'x', 'y', 'z'})  // ixx of the new frame is that of the old axis which stands there
      for (std::size_t i = out.find(fmt::format("i{0}{0}=", axis)); i != std::string::npos;
           i = out.find(fmt::format("i{0}{0}=", axis), i + 1))
        out.replace(i, 4, fmt::format("I{0}{0}=", moments[std::size_t(axis - 'x')]));
    for (std::size_t i = out.find("I"); i != std::string::npos; i = out.find("I", i + 1))
      if (out[i + 3] == '=') out[i] = 'i';
    Json s = summary_of(f, out, {"--normal", normal});
    return std::pair(s["links"], told(s, "stays", "hip"));
  };
  // Forward, normal and up of the old robot are x, y, z; new vectors list the old axes that stand at x, y, z.
  const auto [x_links, x_hip] = along("yxz", "yxz", "x");  // forward y, up z
  const auto [z_links, z_hip] = along("xzy", "xzy", "z");  // forward x, up y
  check_same(x_links, links);
  check_same(z_links, links);
  CHECK_THAT(x_hip, Contains("about +x: phi = q"));
  CHECK_THAT(z_hip, Contains("about +z: phi = q"));
  Json s = summary_of(f, replaced(plain, "<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 -2 0\"/>"), y);
  CHECK(s["links"] == links);
  CHECK_THAT(told(s, "stays", "hip"), Contains("about -y: phi = q"));
  CHECK_THAT(told(s, "to fill in", "drive.hip"), Contains("limits -28.65 to 57.3 deg"));
}

TEST_CASE("a drive of a description's joint comes from --actuator, by a path from robot.toml") {
  if (!reads_urdf()) return;
  const Folder f;
  f.write("hip.toml", read(kTable2));
  const Json s = summary_of(f, kLeg, {"--normal", "y", "--actuator", "hip=hip.toml"});
  CHECK(s["joints"][0]["kind"] == "elastic");
  CHECK(s["joints"][1]["kind"] == "passive");
  CHECK_THAT(read(f.at("out/robot.toml")), Contains("[drive.hip]\nfile = \"../hip.toml\"\n"));
  done(f, {"robot", "out/robot.toml", "-o", "back", "--no-report"});
  CHECK(Json::parse(read(f.at("back/summary.json")))["joints"] == s["joints"]);
  refused("", kLeg, {"--actuator: 'hop'", "did you mean \"hip\"?"}, {"--normal", "y", "--actuator", "hop=" + kTable2});
  refused("", kLeg, {"--actuator: ", "JOINT=FILE is needed"}, {"--normal", "y", "--actuator", kTable2});
}

TEST_CASE("a root without mass is no link: its joint says how the base moves") {
  if (!reads_urdf()) return;
  const Folder f;
  const std::string world =
      "<link name=\"world\"/><joint name=\"lift\" type=\"prismatic\"><parent link=\"world\"/><child "
      "link=\"base\"/><axis xyz=\"0 0 1\"/><limit lower=\"0\" upper=\"1\" effort=\"0\" "
      "velocity=\"0\"/></joint>";
  const std::string head = "<robot name=\"leg\">";
  Json s = summary_of(f, replaced(kLeg, head, head + world), {"--normal", "y"});
  CHECK(s["links"].size() == 3);
  CHECK(s["links"][0]["name"] == "base");
  CHECK_THAT(told(s, "base", "base"), Contains("joint lift (prismatic) on world, which has no mass, is the base's") &&
                                          Contains("its limits, 0 to 1 m, are left out: ") && Contains("[stop.rail]"));
  std::string pin = replaced(world, "prismatic", "continuous");
  pin = replaced(pin, "0 0 1", "0 1 0");
  s = summary_of(f, replaced(kLeg, head, head + pin), {"--normal", "y"});
  CHECK(s["joints"].size() == 2);
  s = summary_of(f, replaced(kLeg, head, head + pin), {"--normal", "y", "--base", "pinned"});
  CHECK(s["joints"].size() == 3);
  CHECK(s["joints"][0]["name"] == "lift");
  s = summary_of(f, kLeg, {"--normal", "y", "--lock", "knee"});
  CHECK(s["links"].size() == 2);
  CHECK_THAT(told(s, "locked", "knee"), Contains("--lock names it; 1 kg merged"));
}

TEST_CASE("a description that is no robot of links is refused with the rule") {
  if (!reads_urdf()) return;
  const std::string y = "leg.urdf: ";
  refused("", kLeg, {"--normal: x, y or z is needed"}, {});
  refused("", kLeg, {"--normal: 'w': x, y or z is needed"}, {"--normal", "w"});
  refused("", kLeg, {y, "--normal x: no joint that stays turns about it", "hip [0, 1, 0], knee [0, -1, 0]"},
          {"--normal", "x"});
  refused("", kLeg, {y, "--contacts: 'toe': one of", "toe-1"}, {"--normal", "y", "--contacts", "toe"});
  refused("", kLeg, {y, "--lock: 'kne': one of hip, knee is needed (did you mean \"knee\"?)"},
          {"--normal", "y", "--lock", "kne"});
  refused("", kLeg, {"--pin-height: --base pinned is needed"}, {"--normal", "y", "--pin-height", "1"});
  refused("", kLeg, {"with contacts --pin-height"}, {"--normal", "y", "--base", "pinned", "--contacts", "toe-1"});
  refused("", kLeg, {"--base", "'fixed'"}, {"--normal", "y", "--base", "fixed"});
  refused("mass value=\"3\"", "mass value=\"-3\"", {y, "link 'thigh': mass -3 kg: at least 0 is needed"});
  refused("iyy=\"0.4\"", "iyy=\"0.9\"", {y, "link 'thigh': principal moments", "0.9 kg m^2", "triangle rule"});
  refused("mass value=\"3\"", "mass value=\"0\"", {y, "link 'thigh': mass 0 with an inertia"});
  refused("mass value=\"3\"", "mass value=\"three\"", {y, "liburdfdom: "});
  refused("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 0\"/>", {y, "joint 'hip': its axis has no direction"});
  refused("lower=\"-0.5\"", "lower=\"5\"", {y, "joint 'hip': limits from 5 to 1: lower <= upper is needed"});
  refused("damping=\"0.25\"", "damping=\"-1\"", {y, "joint 'knee': damping -1: at least 0 is needed"});
  refused("<dynamics damping=\"0.25\"/>", "<mimic joint=\"hip\"/>",
          {y, "joint 'knee': it follows 'hip' (mimic)", "--lock knee"});
  const std::size_t shank = kLeg.find("<inertial><origin xyz=\"0 0 -0.1\"/>"), end = kLeg.find("</inertial>", shank);
  refused("", kLeg.substr(0, shank) + kLeg.substr(end + 11),
          {y, "link 'shank' on joint 'knee': mass 0, with all that is fixed on it"});
  refused("iyy=\"0.01\" iyz=\"0\" izz=\"0.001\"", "iyy=\"0\" iyz=\"0\" izz=\"0.01\"",
          {y, "link 'shank' on joint 'knee': no inertia about the normal"});
  refused("child link=\"toe-1\"", "child link=\"thigh\"",
          {y, "liburdfdom: Failed to find root link: Two root links found: [base] and [toe-1]"});
  refused("child link=\"toe-1\"", "child link=\"nobody\"", {y, "liburdfdom: "});
  refused("</robot>", "", {y, "liburdfdom"});
  refused("", "mass = 1", {y, "neither <robot> nor <mujoco>"});
  refused("",
          "<robot name=\"a\">" + std::string(3000, '\n') +
              [] {
                std::string deep;
                for (int i = 0; i < 5000; ++i) deep += "<a>";
                return deep;
              }(),
          {"leg.urdf:3001: elements nest deeper than 256"});
  std::string many, contacts;
  for (int i = 0; i < 8; ++i)
    many += fmt::format(
        "<joint name=\"j{0}\" type=\"continuous\"><parent link=\"base\"/><child link=\"l{0}\"/><axis xyz=\"0 1 "
        "0\"/></joint>"
        "<link name=\"l{0}\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
        "izz=\"1\"/></inertial></link>",
        i);
  refused("</robot>", many + "</robot>",
          {y, "11 links and 10 joints in this plane: at most 8 and 7 are possible; --lock"});
  for (int i = 0; i < 13; ++i) contacts += i ? ",toe-1" : "toe-1";
  refused("", kLeg, {y, "--contacts: 13 names: at most 12"}, {"--normal", "y", "--contacts", contacts});
  const Folder f;
  check_refused(f, {"robot", "no.urdf", "--normal", "y", "-o", "out"}, {"no.urdf: no such file"});
  f.write("leg.xacro", kLeg);
  check_refused(f, {"robot", "leg.xacro", "--normal", "y", "-o", "out"}, {"leg.xacro: a file of macros", "xacro FILE"});
  check_refused(f, {"robot", dataset("robots/hopper.toml"), "--normal", "y", "-o", "out"}, {"of URDF and MJCF alone"});
}

TEST_CASE("a description in MJCF that is no robot of links is refused with the rule") {
  if (!reads_mjcf()) return;
  const std::string good = read(kMjcf);
  const auto refused_mjcf = [&](const std::string& from, const std::string& to, const std::vector<std::string>& texts) {
    const Folder f;
    f.write("leg.xml", replaced(good, from, to));
    check_refused(f, {"robot", "leg.xml", "--normal", "y", "-o", "out"}, texts);
  };
  refused_mjcf("frictionloss", "friktion", {"leg.xml:11: ", "MuJoCo: ", "friktion"});
  refused_mjcf("mass=\"0.143\"", "mass=\"-1\"", {"leg.xml", "MuJoCo: "});
  refused_mjcf("</mujoco>", "", {"leg.xml", "MuJoCo: "});
  refused_mjcf("<actuator>", "<equality><joint joint1=\"knee\" joint2=\"hip\"/></equality><actuator>",
               {"leg.xml: ", "joint 'knee': it follows 'hip' (mimic)"});
  refused_mjcf("<actuator>", "<equality><connect body1=\"shank\" anchor=\"0 0 0\"/></equality><actuator>",
               {"leg.xml: ", "it holds 'shank' and 'world' together: a tree is needed"});
  refused_mjcf("</worldbody>", "<body name=\"ball\"><freejoint/><geom size=\"0.1\"/></body></worldbody>",
               {"leg.xml: ", "2 bodies hang on 'world'", "one robot is needed"});
}

TEST_CASE("MJCF: joints in one body, springs, free bases") {
  if (!reads_mjcf()) return;
  const Folder f;
  f.write("leg.xml", R"(<mujoco><compiler angle="radian"/><worldbody><body name="trunk" pos="0 0 1"><freejoint/>
    <inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/>
    <body name="leg" pos="0 0 -0.5">
      <joint name="yaw" axis="0 0 1"/><joint name="hip" axis="0 1 0" pos="0.1 0 0.2" ref="0.3" stiffness="5" springref="0.5"/>
      <inertial pos="0 0 -0.1" mass="1" diaginertia="0.1 0.1 0.1"/></body></body></worldbody></mujoco>)");
  done(f, {"robot", "leg.xml", "--normal", "y", "--contacts", "leg", "-o", "out", "--no-report"});
  const Json s = Json::parse(read(f.at("out/summary.json")));
  CHECK(s["links"].size() == 2);
  CHECK_THAT(told(s, "base", "trunk"), Contains("(free) on world"));
  CHECK_THAT(told(s, "locked", "yaw"), Contains("hinge at 0"));
  const std::string toml = read(f.at("out/robot.toml"));
  CHECK_THAT(toml, Contains("at = [0.3, 0.1]") || Contains("at = [0.30000000000000004, 0.1]"));
  CHECK_THAT(toml, Contains("stiffness = 5 ") && Contains("rest_deg = -11.459"));  // springref - ref, phi = -q
  CHECK(s["links"][1]["com"][0].get<double>() == Approx(0.3));
  CHECK(s["links"][1]["com"][1].get<double>() == Approx(-0.1));
}

TEST_CASE("Atlas, as dart-doc of Debian ships it, is a planar robot of seven joints") {
  const std::string atlas = "/usr/share/doc/dart/data/sdf/atlas/atlas_v3_no_head.urdf";
  if (!fs::exists(atlas)) {
    WARN("skipped: dart-doc is not installed, its Atlas is not there");
    return;
  }
  if (!reads_urdf()) return;
  const Folder f;
  done(f, {"robot", atlas, "--normal", "y", "--lock", "l_arm_ely,l_arm_wry,r_arm_ely,r_arm_wry", "--contacts",
           "l_foot,r_foot", "-o", "out"});
  const Json s = Json::parse(read(f.at("out/summary.json")));
  CHECK(s["links"].size() == 8);
  CHECK(s["joints"].size() == 7);
  CHECK(s["mass"].get<double>() == Approx(146.554));
  done(f, {"robot", "out/robot.toml", "-o", "back", "--no-report"});
  CHECK(Json::parse(read(f.at("back/summary.json")))["links"] == s["links"]);
}
