// Drives whose command is known: a rig of its own for a trial, a logged command; a measured one where UKEMI_LAB_DATA is
// set.
#include <catch2/catch.hpp>

#include "test/cli/refused.hpp"

using namespace cli;

namespace {

const std::string kHead = "[rig]\nlength = 1\ninertia_joint = 1\n";

std::string controller(int gain, const std::string& feedback) {
  return kHead + "[drive]\ncommand_gain = " + std::to_string(gain) + "\ncommand_limit = 8\nfeedback = \"" + feedback +
         "\"\n";
}

}  // namespace

TEST_CASE("known drives: what does not fit together is one line, and nothing is written") {
  const Folder f;
  f.write("output.toml", controller(50, "output"));
  f.write("plain.toml", kHead);
  f.write("a.csv", "t,phi,phi_ref\n0,0,0\n0.1,0,0.1\n0.2,0.01,0.1\n0.3,0.02,0.1\n");
  f.write("b.csv", "t,phi,phi_ref\n0,0,0\n0.1,0,0.1\n0.2,0.02,0.1\n0.3,0.03,0.1\n");
  const auto refused = [&](const Arguments& more, const std::string& words) {
    check_refused(f, Arguments{"identify", "a.csv", "b.csv", "--rig", "plain.toml"} + more + kOut, {words});
  };
  refused({"--trial-rig", "c.csv=output.toml"}, "no such trial");
  refused({"--trial-rig", "a.csv=output.toml", "--trial-rig", "a.csv=output.toml"}, "given twice");
  refused({"--trial-rig", "a.csv=output.toml"}, "cannot be told apart");
  refused({"--drive", "command"}, "no column 'command'");
}

TEST_CASE("known drives: a landing asks for a controller, and has friction on both sides") {
  const Folder f;
  const std::string spring = "[actuator]\nname = \"leg\"\nk_sea = 65\nc_sea = 1.6\ni_motor = 0.085\n";
  f.write("drive.toml", spring + "k_t = 1.5\n");
  for (const Arguments& verb : {Arguments{"simulate", kPaper, "--hold", "-45"}, Arguments{"optimize", kPaper},
                                Arguments{"risk", kPaper, "--hold", "-45"}, Arguments{"map", kPaper}})
    check_refused(f, verb + Arguments{"--actuator", "drive.toml"} + kOut, {"drive.toml", "k_p", "k_t"});
  // What rubs turns less: the joint's range shrinks with each.
  double before = 1e9;
  for (const char* friction :
       {"", "output_friction = 2\n", "output_friction = 2\noutput_friction_asymmetry = 0.5\nbreakaway = 1\n",
        "output_friction = 2\noutput_viscous = 3\noutput_friction_asymmetry = 0.5\nbreakaway = 1\n"}) {
    f.write("rubs.toml", spring + "k_p = 50\nk_d = 1\n" + friction);
    const Result r = run(Arguments{"simulate", kPaper, "--hold", "-45", "--actuator", "rubs.toml"} + kOut, f.at(""));
    INFO(friction);
    CHECK(r.code == 0);
    const auto angles = summary(f)["ratings"]["phi_1_deg"];
    const double range = angles[1].get<double>() - angles[0].get<double>();
    CHECK(range < before);
    before = range;
  }
}

TEST_CASE("a measured drive with friction that sticks on both sides is explained, by two controllers at once") {
  const auto output = lab_file("flexible_drive/p_output_050.csv"), motor = lab_file("flexible_drive/p_motor_270.csv");
  if (!output || !motor) return;
  const Folder f;
  f.write("output.toml", controller(50, "output"));
  f.write("motor.toml", controller(270, "motor"));
  const Result r =
      run({"identify", *output, *motor, "--rig", "output.toml", "--trial-rig", "p_motor_270.csv=motor.toml",
           "--columns", "t=t_s,phi=0.001*x2_mm,phi_motor=0.001*x1_mm,phi_ref=0.001*xr_mm", "--nuisance",
           "friction,output_friction,viscous,output_viscous", "-o", "out"},
          f.at(""));
  INFO(r.err);
  CHECK(r.code == 0);
  const Json s = summary(f);
  CHECK(s["rms"].get<double>() < 1.25e-3);                                             // of 50e-3
  CHECK(s["parameters"]["k_sea"]["value"].get<double>() == Approx(240).epsilon(0.1));  // a sister's antiresonance
}
