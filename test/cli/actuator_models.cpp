// An actuator as lines of a simulator's model: --export mjcf,urdf.
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <regex>

#include "test/cli/refused.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

/// The attributes of the first element that begins with `start`.
std::map<std::string, std::string> attributes(const std::string& xml, const std::string& start) {
  const std::size_t begin = xml.find(start);
  INFO(start);
  REQUIRE(begin != xml.npos);
  const std::string element = xml.substr(begin, xml.find('>', begin) - begin);
  const std::regex attribute("([a-z]+)=\"([^\"]*)\"");
  std::map<std::string, std::string> out;
  for (std::sregex_iterator i(element.begin(), element.end(), attribute), end; i != end; ++i) out[(*i)[1]] = (*i)[2];
  return out;
}
double value(const std::string& xml, const std::string& start, const std::string& attribute) {
  return std::stod(attributes(xml, start).at(attribute));
}

/// Every element is closed, in order, and no comment holds "--": what an XML parser asks of these files.
void check_well_formed(std::string xml) {
  const std::regex comment("<!--((?!-->)[^])*-->");
  for (std::sregex_iterator i(xml.begin(), xml.end(), comment), end; i != end; ++i) {
    const std::string text = i->str();
    CHECK(text.substr(4, text.size() - 7).find("--") == text.npos);
  }
  xml = std::regex_replace(xml, comment, "");
  const std::regex tag("<(/?)([A-Za-z_]+)(?:\\s+[a-z]+=\"[^\"<&]*\")*\\s*(/?)>|<\\?[^?]*\\?>");
  std::vector<std::string> open;
  for (std::sregex_iterator i(xml.begin(), xml.end(), tag), end; i != end; ++i) {
    const std::smatch& m = *i;
    if (m[2].length() == 0 || m[3].length() > 0) continue;
    if (m[1].length() == 0) {
      open.push_back(m[2]);
    } else {
      REQUIRE(!open.empty());
      CHECK(open.back() == m[2]);
      open.pop_back();
    }
  }
  CHECK(open.empty());
  CHECK(std::regex_replace(xml, tag, "").find_first_of("<>&") == std::string::npos);
}

const Arguments kIdentify = {"identify", kTrial1, kTrial2, "--rig", kRig, "--no-report", "-o", "out"};
const Arguments kPredict = {"predict", kTrial1, "--rig", kRig, "--no-report", "-o", "out", "--actuator"};
const Arguments kBoth = {"--export", "mjcf,urdf"};

}  // namespace

TEST_CASE("export: each constant of a fit has its place in MJCF and URDF, with its error") {
  const Folder f;
  done(f, kIdentify + kBoth);
  const Json p = summary(f)["parameters"];
  const std::string mjcf = read(f.at("out/actuator.mjcf.xml")), urdf = read(f.at("out/actuator.urdf.xml"));
  check_well_formed(mjcf), check_well_formed(urdf);
  CHECK(value(mjcf, "<fixed name=\"knee_spring\"", "stiffness") == p["k_sea"]["value"].get<double>());
  CHECK(value(mjcf, "<fixed name=\"knee_spring\"", "damping") == p["c_sea"]["value"].get<double>());
  CHECK(value(mjcf, "<fixed name=\"knee_spring\"", "springlength") == 0);
  CHECK(value(mjcf, "<joint joint=\"knee_motor\"", "coef") == 1);  // the length is phi_m - phi_1
  CHECK(value(mjcf, "<joint joint=\"knee\"", "coef") == -1);
  CHECK(value(mjcf, "<joint name=\"knee_motor\"", "armature") == p["i_motor"]["value"].get<double>());
  CHECK(attributes(mjcf, "<motor name=\"knee\"").at("joint") == "knee_motor");  // the torque acts on the rotor
  CHECK(mjcf.find("<position") == mjcf.npos);
  CHECK_THAT(mjcf, Contains(", standard error ") && Contains("k_p = ") && Contains("phi_ref - knee) + ") &&
                       Contains("tau_max = 20 Nm, limit of the spring's torque: NOT IN THIS MODEL"));
  CHECK(value(urdf, "<inertia ixx", "izz") == p["i_motor"]["value"].get<double>());
  CHECK(value(urdf, "<dynamics damping=\"" + attributes(mjcf, "<fixed").at("damping"), "friction") == 0);
  CHECK_THAT(urdf, Contains("<springStiffness>" + attributes(mjcf, "<fixed").at("stiffness") + "</springStiffness>") &&
                       Contains("k_p = ") && Contains("NOT IN THIS MODEL") && Contains("<spring_stiffness>"));
}

TEST_CASE("export: an actuator that is given goes by its terms, its feedback and its name for the joint") {
  const Folder f;
  f.write(
      "a.toml",
      "[actuator]\nname = \"a -- b\"\nk_p = 50\nk_d = 2\nk_sea = 65\nc_sea = 1.6\ni_motor = 0.085\nfriction = 0.4\n"
      "viscous_friction = 0.3\noutput_friction = 0.1\noutput_viscous = 0.02\nk_sea_cubic = 9\nfeedback = \"motor\"\n"
      "tau_max = 25\nmotor_torque_max = 20\nspeed_max = 3\n");
  f.write("rig.toml", "[rig]\nlength = 0.3\ninertia_joint = 0.024225\n");  // says nothing of feedback
  done(f, Arguments{"predict", kTrial1, "--rig", "rig.toml", "--no-report", "-o", "out", "--actuator", "a.toml",
                    "--joint", "leg/knee"} +
              kBoth);
  const std::string mjcf = read(f.at("out/actuator.mjcf.xml")), urdf = read(f.at("out/actuator.urdf.xml"));
  check_well_formed(mjcf), check_well_formed(urdf);
  CHECK(value(mjcf, "<position", "kp") == 50);
  CHECK(value(mjcf, "<position", "kv") == 2);
  CHECK(value(mjcf, "<joint name=\"leg/knee_motor\"", "frictionloss") == 0.4);
  CHECK(value(mjcf, "<joint name=\"leg/knee_motor\"", "damping") == 0.3);
  CHECK(value(mjcf, "<joint name=\"leg/knee\"", "frictionloss") == 0.1);
  CHECK(value(mjcf, "<joint name=\"leg/knee\"", "damping") == 0.02);
  CHECK_THAT(mjcf, Contains("k_sea_cubic = 9 Nm/rad^3: NOT IN THIS MODEL") && Contains("phi_ref + k_d / k_p dphi_ref"));
  CHECK(value(urdf, "<dynamics damping=\"0.3\"", "friction") == 0.4);
  CHECK(value(urdf, "<limit", "effort") == 20);
  CHECK(value(urdf, "<limit", "velocity") == 3);
  CHECK_THAT(urdf, Contains("output_friction = 0.1 Nm: NOT IN THIS MODEL"));
}

TEST_CASE("export: a drive by its command is a motor with a gear") {
  const Folder f;
  f.write("a.toml", "[actuator]\nname = \"by command\"\nk_t = 1.25\nk_sea = 65\nc_sea = 1.6\ni_motor = 0.085\n");
  f.write("trial.csv", "t,phi,phi_ref,command\n0,0,0,0\n0.001,0,0,1\n0.002,0,0,1\n");
  done(f, {"predict", "trial.csv", "--drive", "command", "--rig", kRig, "--no-report", "-o", "out", "--actuator",
           "a.toml", "--export", "mjcf"});
  const std::string mjcf = read(f.at("out/actuator.mjcf.xml"));
  check_well_formed(mjcf);
  CHECK(value(mjcf, "<motor", "gear") == 1.25);
  CHECK(!fs::exists(f.at("out/actuator.urdf.xml")));
  check_refused(f, Arguments{"predict", kTrial1, "--rig", kRig, "--actuator", kTable2, "--export", "ros2"} + kOut,
                {"--export: 'ros2': mjcf or urdf"});
}
