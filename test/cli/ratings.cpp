// The motor's ratings: carried from rig or option to the plan, and said where they are unknown.
#include <catch2/catch.hpp>

#include "test/cli/refused.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

/// A shipped file without the motor's ratings; tau_max stays.
std::string unrated(const std::string& path) {
  std::string out;
  std::istringstream lines(read(path));
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with("speed_max") && !line.starts_with("motor_torque_max")) out += line + "\n";
  return out;
}
const Arguments kTwo = {"identify", dataset("impact/trial_3.csv"), dataset("impact/trial_7.csv"), "--rig"};

}  // namespace

TEST_CASE("ratings: identify takes them from the rig, an option goes before it") {
  const Folder f;
  done(f, kTwo + Arguments{kRig, "-o", "rig"});
  CHECK_THAT(read(f.at("rig/actuator.toml")), Contains("\nspeed_max = 3.14 ") && Contains("\nmotor_torque_max = 20 "));
  done(f, kTwo + Arguments{kRig, "--speed-max", "5", "--motor-torque-max", "12.5", "-o", "given"});
  CHECK_THAT(read(f.at("given/actuator.toml")),
             Contains("\nspeed_max = 5 ") && Contains("\nmotor_torque_max = 12.5 ") && Contains("\ntau_max = 20 "));
  for (const char* bad : {"0", "-3", "nan", "inf", "0x10", "fast"})
    check_refused(f, kTwo + Arguments{kRig, "--speed-max", bad, "-o", "new"}, {"--speed-max", bad});
}

TEST_CASE("ratings: what plans on an actuator without them says so first, in the report and in the summary") {
  const Folder f;
  f.write("rig.toml", unrated(kRig));
  CHECK_THAT(done(f, kTwo + Arguments{"rig.toml", "-o", "fit"}).out,
             Contains("the motor's ratings are unknown (speed_max, motor_torque_max): --speed-max"));
  CHECK(read(f.at("fit/actuator.toml")).find("motor_torque_max") == std::string::npos);
  const std::string said =
      "actuator.toml: the motor's ratings of speed and torque are unknown (speed_max, motor_torque_max)";
  const Arguments on = {kPaper, "--actuator", "fit/actuator.toml", "-o", "out"};
  for (const Arguments& verb : {Arguments{"optimize", "--evaluations", "200"}, Arguments{"simulate", "--hold", "-45"},
                                Arguments{"risk", "--motion", dataset("drops/bend.toml"), "--samples", "200"},
                                Arguments{"ratings", "--motor-speed", "2:3:2", "--evaluations", "100"}}) {
    INFO(verb[0]);
    done(f, verb + on);
    CHECK(warned(summary(f), said));
    CHECK(summary(f)["warnings"][0].get<std::string>().find(said) != std::string::npos);
    const std::string page = read(f.at("out/report.html"));
    CHECK_THAT(page, Contains("ratings of speed and torque are unknown") && !Contains("found a fault"));
    if (verb[0] == "simulate" || verb[0] == "optimize")
      CHECK(summary(f)["ratings"]["unknown"] == Json({"speed_max", "motor_torque_max"}));
  }
  done(f, {"compare", "--nominal", kNominal, "--identified", "fit/actuator.toml", "-o", "constants"});
  CHECK(!warned(summary(f, "constants"), "unknown"));  // no motion is asked of it
  f.write("half.toml", unrated(kTable2) + "speed_max = 3.14\n");
  done(f, {"simulate", kPaper, "--actuator", "half.toml", "--hold", "-45", "-o", "half"});
  CHECK(warned(summary(f, "half"), "half.toml: the motor's torque rating is unknown (motor_torque_max)"));
}

TEST_CASE("ratings: tau_max limits the spring and rates no motor") {
  const Folder f;
  f.write("weak.toml", replaced(read(kTable2), "motor_torque_max = 20", "motor_torque_max = 1"));
  done(f, {"simulate", kPaper, "--actuator", "weak.toml", "--hold", "-45", "-o", "out"});
  CHECK(warned(summary(f), "the robot could not follow: motor torque"));
  f.write("soft.toml", replaced(replaced(read(kTable2), "motor_torque_max = 20", "motor_torque_max = 1000"),
                                "tau_max = 20", "tau_max = 1"));
  done(f, {"simulate", kPaper, "--actuator", "soft.toml", "--hold", "-45", "-o", "out"});
  CHECK(!warned(summary(f), "motor torque"));
}
