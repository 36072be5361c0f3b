// Drives whose command is known: a rig of its own for a trial, a logged command; a measured one where UKEMI_LAB_DATA is
// set.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/random.hpp"
#include "test/cli/refused.hpp"

using namespace cli;

namespace {

const std::string kHead = "[errors]\nexact = true\n[rig]\nlength = 1\ninertia_joint = 1\n";

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
  CHECK(s["parameters"]["k_sea"]["std"].get<double>() > 20);  // widened: the model does not explain the logs
  CHECK_FALSE(s["diagnostics"]["missing_terms"].empty());
}

TEST_CASE("known drives: a controller that is fed the logged angle answers late, within its limit and its rate") {
  // Ours and simulated: 1 kHz, a proportional controller that reads the encoder, acts 5 ms later, and is limited.
  const Folder f;
  const double gain = 40, limit = 3, rate = 200, k_t = 1.5, k_sea = 60, c_sea = 1.2, i_motor = 0.08, inertia = 1;
  const int late = 5, n = 3000, steps = 20;
  std::vector<double> command;
  double phi = 0, phi_m = 0, dphi = 0, dphi_m = 0;
  std::string log = "t,phi,phi_motor,phi_ref\n";
  ukemi::Random random(5);
  const auto logged = [&](double angle) { return angle + 1e-5 * random.normal(); };
  for (int i = 0; i < n; ++i) {
    const double t = i * 1e-3, ref = t < 0.1 ? 0 : 0.3 * std::sin(3 * (t - 0.1)) + 0.1 * std::sin(17 * (t - 0.1));
    const double encoder = logged(phi);
    log += fmt::format("{},{},{},{}\n", t, encoder, logged(phi_m), ref);
    double c = std::clamp(gain * (ref - encoder), -limit, limit);
    if (i > 0) c = std::clamp(c, command.back() - rate * 1e-3, command.back() + rate * 1e-3);
    command.push_back(c);
    const double acts = i < late ? command.front() : command[std::size_t(i - late)], h = 1e-3 / steps;
    for (int k = 0; k < steps; ++k) {  // the midpoint rule
      const auto acceleration = [&](double p, double m, double v, double w) {
        const double tau = k_sea * (m - p) + c_sea * (w - v);
        return std::pair(tau / inertia, (k_t * acts - tau) / i_motor);
      };
      const auto [a, b] = acceleration(phi, phi_m, dphi, dphi_m);
      const double v = dphi + h / 2 * a, w = dphi_m + h / 2 * b;
      const auto [c1, d1] = acceleration(phi + h / 2 * dphi, phi_m + h / 2 * dphi_m, v, w);
      phi += h * v, phi_m += h * w, dphi += h * c1, dphi_m += h * d1;
    }
  }
  f.write("a.csv", log);
  f.write("rig.toml", kHead + fmt::format("[drive]\ncommand_gain = {}\ncommand_limit = {}\ncommand_rate = {}\n"
                                          "angle = \"logged\"\n",
                                          gain, limit, rate));
  const Result r =
      run(Arguments{"identify", "a.csv", "--rig", "rig.toml", "--nuisance", "control_delay"} + kOut, f.at(""));
  INFO(r.err);
  const Json s = summary(f)["parameters"];
  INFO(summary(f)["nuisance"].dump());
  const Json delay = summary(f)["nuisance"]["control_delay"];
  CHECK(delay["value"].get<double>() == Approx(5e-3).margin(2e-5));
  CHECK(s["k_sea"]["value"].get<double>() == Approx(k_sea).epsilon(2e-3));
  CHECK(s["c_sea"]["value"].get<double>() == Approx(c_sea).epsilon(5e-3));
  CHECK(s["i_motor"]["value"].get<double>() == Approx(i_motor).epsilon(5e-3));
  CHECK(summary(f)["nuisance"]["k_t"]["value"].get<double>() == Approx(k_t).epsilon(2e-3));
  f.write("bad.toml", kHead + "[drive]\ncommand_gain = 40\ncommand_rate = 200\n");
  check_refused(f, Arguments{"identify", "a.csv", "--rig", "bad.toml"} + kOut, {"bad.toml", "command_rate", "logged"});
  f.write("bad.toml", kHead + "[drive]\nangle = \"logged\"\n");
  check_refused(f, Arguments{"identify", "a.csv", "--rig", "bad.toml"} + kOut, {"bad.toml", "angle", "command_gain"});
  f.write("bad.toml", kHead + "[drive]\ncommand_limit = 3\n");
  check_refused(f, Arguments{"identify", "a.csv", "--rig", "bad.toml"} + kOut, {"a.csv", "no column 'command'"});
  f.write("bad.toml", kHead + "[drive]\ncommand_gain = 40\nangle = \"logged\"\nfeedback = \"motor\"\n");
  f.write("b.csv", "t,phi,phi_ref\n0,0,0\n0.1,0,0.1\n0.2,0.02,0.1\n0.3,0.03,0.1\n");
  check_refused(f, Arguments{"identify", "b.csv", "--rig", "bad.toml"} + kOut, {"b.csv", "no column 'phi_motor'"});
}

TEST_CASE("known drives: design plans no hits for a drive whose command is a log's, and compare heeds --drive") {
  const Folder f;
  f.write("rig.toml", kHead + "[drive]\ncommand_gain = 40\nangle = \"logged\"\n");
  const Arguments design = {"design", "--actuator", kTable2, "--noise", "1e-3", "--rig"};
  check_refused(f, design + Arguments{"rig.toml"} + kOut, {"rig.toml", "a command that is logged", "predicted"});
  check_refused(f, design + Arguments{kRig, "--drive", "command"} + kOut, {"a command that is logged"});
  check_refused(f,
                Arguments{"compare", "--nominal", kTable2, "--identified", kTable2, "--trials", kTrial1, "--rig", kRig,
                          "--drive", "command"} +
                    kOut,
                {"no column 'command'"});
}
