// ukemi calibrate: the contract for scripts, and what it refuses.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "test/cli/refused.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

const std::string kFolder = dataset("drops/"), kGuess = kFolder + "first_guess.toml", kHold = kFolder + "hold.toml",
                  kBend = kFolder + "bend.toml", kDrop1 = kFolder + "drop_1.csv";
const Arguments kOne = {"calibrate", kDrop1, "--scene", kGuess, "--actuator", kTable2, "--motion", kHold};
const Arguments kAll = {"calibrate",
                        kDrop1,
                        kFolder + "drop_2.csv",
                        kFolder + "drop_3.csv",
                        "--scene",
                        kGuess,
                        "--actuator",
                        kTable2,
                        "--motion",
                        kHold,
                        "--motion-of",
                        "drop_3=" + kBend,
                        "--motion-of",
                        "validation=" + kBend,
                        "--height-of",
                        "drop_2=0.25",
                        "--height-of",
                        "validation.csv=0.32",
                        "--validate",
                        kFolder + "validation.csv"};

void check_log(const std::string& bytes, const std::vector<std::string>& texts) {
  const Folder f;
  f.write("drop.csv", bytes);
  check_refused(
      f, Arguments{"calibrate", "drop.csv", "--scene", kGuess, "--actuator", kTable2, "--motion", kHold} + kOut, texts);
}
void check_options(const Arguments& options, const std::vector<std::string>& texts) {
  check_refused(Folder(), kOne + kOut + options, texts);
}

}  // namespace

TEST_CASE("calibrate writes its files and keys, and every verb reads the scene that it wrote") {
  const Folder f;
  const Result r = done(f, kAll + kOut + Arguments{"--strict", "--figures", "svg"});
  for (const char* figure : {"drop_1", "drop_3", "validation_1"}) {
    CHECK(fs::exists(f.at(std::string("out/") + figure + ".svg")));
    CHECK_THAT(read(f.at("out/report.html")), Contains(std::string("<figure id=\"figure-") + figure + "\""));
  }
  for (const char* name : {"scene.toml", "fit.csv", "validation.csv", "summary.json", "report.html"})
    CHECK(fs::exists(f.at(std::string("out/") + name)));
  const Json s = summary(f);
  const std::vector<std::pair<std::string, double>> truth = {
      {"stiffness", 6000}, {"damping_normal", 110}, {"damping_tangential", 40}, {"pitch", -8 * 0.017453292519943295}};
  for (const auto& [name, value] : truth) {
    INFO(name);
    CHECK_THAT(r.out, Contains(name));
    const Json& p = s["parameters"][name];
    CHECK(std::abs(p["value"].get<double>() - value) < 4 * p["std"].get<double>());
    CHECK(p["ci95"].size() == 2);
    CHECK(p["at_bound"] == false);
    CHECK(p["free"] == true);
    CHECK(p["verdict"] == "trusted");
  }
  CHECK(s["parameters"]["pitch"]["unit"] == "rad");
  CHECK(s["converged"] == true);
  CHECK(s["trusted"] == true);
  CHECK(s["correlation"].size() == 4);
  CHECK(s["warnings"].empty());
  CHECK(s["drops"].size() == 3);
  CHECK(s["diagnostics"]["model_rejected"] == false);
  CHECK(s["diagnostics"]["chow"].size() == 3);
  CHECK(s["outputs"]["acc"]["rms"].get<double>() == Approx(2).epsilon(0.03));
  CHECK(s["outputs"]["acc"]["noise"].get<double>() == Approx(2).epsilon(0.2));
  CHECK(s["outputs"]["phi_0"]["unit"] == "rad");
  const Json& v = s["validation"]["drops"][0];
  CHECK(v["rms"]["acc"].get<double>() == Approx(2).epsilon(0.06));
  CHECK(v["peak_simulated"].get<double>() == Approx(v["peak_measured"].get<double>()).margin(8));
  CHECK(v["peak_between_samples"].get<double>() > v["peak_simulated"].get<double>());

  std::istringstream csv(read(f.at("out/fit.csv")));
  std::string line;
  while (std::getline(csv, line) && line[0] == '#') continue;
  CHECK(line == "drop,t,output,measured,simulated,residual,used");
  long rows = 0;
  for (; std::getline(csv, line); ++rows)
    if (rows == 0) CHECK_THAT(line, Contains("1,0,acc,7.74,9.81,"));
  CHECK(rows == 3 * 4 * 1001);

  const std::string scene = read(f.at("out/scene.toml"));
  CHECK_THAT(scene, Contains("source = \"calibrated from drop logs by ukemi\"") && Contains("± ") &&
                        Contains("[verdict]\nstiffness = \"trusted\"\n"));
  const Result again =
      run({"simulate", "out/scene.toml", "--actuator", kTable2, "--motion", kHold, "-o", "sim"}, f.at(""));
  CHECK(again.code == 0);
  const Result search =
      run({"optimize", "out/scene.toml", "--actuator", kTable2, "--evaluations", "50", "-o", "opt"}, f.at(""));
  CHECK(search.code == 0);
}

TEST_CASE("calibrate --profile: where the errors are a parabola's, the profile has their interval") {
  const Folder f;
  const Result r = done(f, kAll + kOut + Arguments{"--profile", "stiffness,pitch", "--figures", "svg"});
  CHECK_THAT(r.out, Contains("stiffness by profile likelihood, 95 %: "));
  CHECK(fs::exists(f.at("out/profile_1.svg")));
  CHECK(fs::exists(f.at("out/profile_2.svg")));
  const Json s = summary(f);
  for (const char* name : {"stiffness", "pitch"}) {
    const Json &p = s["diagnostics"]["profile"][name], linear = p["linear"];
    const double width = linear[1].get<double>() - linear[0].get<double>();
    CHECK(linear == s["parameters"][name]["ci95"]);
    for (const int end : {0, 1})
      CHECK(p["ci95"][end].get<double>() == Approx(linear[end].get<double>()).margin(0.05 * width));
  }
  CHECK(read(f.at("out/profile.csv")).find("constant,value,rise,threshold\nstiffness,") != std::string::npos);
}

TEST_CASE("calibrate: the same bytes again, JSON on stdout, no report where none is asked for") {
  const Folder f;
  const Arguments quick = {"--json", "--no-report", "--quiet"};
  const Result a = run(kOne + quick + Arguments{"-o", "a"}, f.at("")),
               b = run(kOne + quick + Arguments{"-o", "b"}, f.at(""));
  REQUIRE(a.code == b.code);
  CHECK_FALSE(fs::exists(f.at("a/report.html")));
  Json x = Json::parse(a.out), y = Json::parse(b.out);
  for (Json* j : {&x, &y}) j->erase("provenance"), j->erase("time_s");
  CHECK(x == y);
}

TEST_CASE("calibrate --strict: exit 1 where a constant is not trusted, with every file written") {
  const Folder f;
  f.write("short.csv",
          "t_ms,acc_g\n284,1.0\n285,1.01\n286,26\n287,23\n288,20\n289,18\n290,16.5\n291,15\n292,14\n293,13\n");
  const Arguments command = {"calibrate", "short.csv", "--scene", kGuess, "--actuator", kTable2, "--motion", kHold};
  const Arguments lenient = {"--free", "stiffness", "-o", "lenient"};
  CHECK(run(command + lenient, f.at("")).code == 0);
  const Json s = summary(f, "lenient");
  CHECK(s["parameters"]["stiffness"]["free"] == true);
  CHECK(s["parameters"]["damping_normal"]["verdict"] == "fixed");
  const Result r = run(command + Arguments{"--strict", "-o", "strict"}, f.at(""));
  CHECK(r.code == 1);
  CHECK_THAT(r.err, Contains("warning"));
  CHECK(summary(f, "strict")["trusted"] == false);
}

TEST_CASE("calibrate refuses malformed logs with file, line and column") {
  SECTION("no time") { check_log("time,acc\n0,1\n1,2\n", {"drop.csv:1: ", "no column 't'"}); }
  SECTION("no output") { check_log("t,accel\n0,1\n1,2\n", {"drop.csv:1: ", "no measured output", "\"accel\""}); }
  SECTION("text") { check_log("t,acc\n0,1\n1,x\n", {"drop.csv:3:3: ", "'acc'", "a number is needed"}); }
  SECTION("time backwards") { check_log("t,acc\n0,1\n2,1\n1,1\n", {"drop.csv:4:1: ", "time must increase"}); }
  SECTION("empty time") { check_log("t,acc\n0,1\n,1\n1,1\n", {"drop.csv:3:1: ", "'t'", "empty"}); }
  SECTION("one unit twice") { check_log("t,acc,acc_g\n0,1,1\n1,1,1\n", {"drop.csv:1:7: ", "another unit"}); }
  SECTION("degrees") { check_log("t,phi_0\n0,-10\n1,1\n", {"drop.csv:2:3: ", "2 pi", "phi_0_deg"}); }
  SECTION("before the release") { check_log("t,acc\n-2,1\n-1,1\n0,1\n", {"drop.csv:4: ", "from the release"}); }
  SECTION("before the touchdown") {
    check_log("t,acc\n0,9.8\n0.1,9.8\n", {"drop.csv: ", "before the first touchdown"});
  }
  SECTION("nothing measured") { check_log("t,acc\n0,\n1,\n", {"drop.csv: ", "no measured value"}); }
}

TEST_CASE("calibrate refuses bad options") {
  check_options({"--free", "stifness"}, {"--free: 'stifness': ", "\"stiffness\""});
  check_options({"--free", "pitch,pitch"}, {"--free: 'pitch': ", "twice"});
  check_options({"--nuisance", "friction"}, {"--nuisance: 'friction': ", "time_shift"});
  check_options({"--nuisance", "pitch_offset"}, {"pitch and pitch_offset", "not both"});
  check_options({"--profile", "stifness"}, {"--profile: 'stifness': ", "\"stiffness\""});
  check_options({"--free", "stiffness", "--profile", "pitch"},
                {"--profile: pitch: it is not among the --free constants"});
  check_options({"--lower", "stiffness"}, {"--lower: 'stiffness': ", "NAME=VALUE"});
  check_options({"--lower", "stiffness=-1"}, {"lower bound of stiffness: -1: ", "at least 0"});
  check_options({"--lower", "stiffness_deg=1"}, {"--lower: 'stiffness_deg': "});
  check_options({"--upper", "pitch_deg=-190"}, {"bounds of pitch: ", "lower < upper"});
  check_options({"--prior", "pitch_deg=10"}, {"--prior: 'pitch_deg=10': ", "NAME=VALUE:STD"});
  check_options({"--prior", "pitch_deg=10:0"}, {"prior of pitch: 0: ", "above 0"});
  check_options({"--prior", "time_shift=0:1e-3"}, {"--prior: 'time_shift': ", "not fitted"});
  check_options({"--motion-of", "drop_9=x.toml"}, {"--motion-of: 'drop_9': ", "no such drop"});
  check_options({"--height-of", "drop_1=-1"}, {"--height-of: '-1': ", "at least 0"});
  check_options({"--height-of", "drop_1=0.2", "--height-of", "drop_1.csv=0.3"},
                {"--height-of: 'drop_1.csv': given twice"});
  check_options({"--speed-of", "drop_1=fast"}, {"--speed-of: 'fast': ", "a finite number"});
  check_options({"--accuracy", "1"}, {"accuracy: 1: "});
  check_options({"--validate", "nowhere.csv"}, {"nowhere.csv"});
  check_refused(Folder(), Arguments{"calibrate", kDrop1, "--scene", kGuess, "--actuator", kTable2} + kOut,
                {"no motion: give --motion"});
  const Folder f;
  f.write("scene.toml", read(kGuess).substr(0, read(kGuess).find("[floor]")) + "[drop]\nheight = 0.4\npitch_deg = 0\n");
  check_refused(
      f, Arguments{"calibrate", kDrop1, "--scene", "scene.toml", "--actuator", kTable2, "--motion", kHold} + kOut,
      {"no [floor]"});
}

TEST_CASE("every verb that plans on a floor says what its calibration did not trust") {
  const Folder f;
  f.write("scene.toml", read(kPaper) + "\n[verdict]\nstiffness = \"weak\"\npitch = \"trusted\"\n");
  const Arguments common = {"scene.toml", "--actuator", kTable2, "--no-report"};
  for (const Arguments& verb :
       {Arguments{"simulate"} + common + Arguments{"--hold", "-45"},
        Arguments{"risk"} + common + Arguments{"--hold", "-45", "--samples", "100"},
        Arguments{"optimize"} + common + Arguments{"--evaluations", "50"},
        Arguments{"compare", "--nominal", kTable2, "--identified", kTable2, "--scene", "scene.toml", "--no-report"}}) {
    const Result r = run(verb + kOut, f.at(""));
    INFO(verb[0] << r.err);
    CHECK_THAT(r.err, Contains("scene.toml: not trusted by the fit that wrote it: stiffness is weak"));
    CHECK_THAT(summary(f)["warnings"].dump(), Contains("stiffness is weak"));
  }
  f.write("wrong.toml", read(kPaper) + "\n[verdict]\nstiffness = \"sure\"\n");
  check_refused(f, Arguments{"simulate", "wrong.toml", "--actuator", kTable2, "--hold", "-45"} + kOut,
                {"wrong.toml:", "stiffness", "'sure'"});
}

namespace {

Arguments of_hopper(const std::vector<int>& drops, const std::string& scene) {
  const std::vector<std::string> height = {"0.3", "0.2", "0.15", "0.25"};
  Arguments out = {"calibrate", "--scene", scene};
  for (const int i : drops) {
    const std::string name = "hopper_" + std::to_string(i);
    out.insert(out.begin() + 1, kFolder + name + ".csv");
    out = out + Arguments{"--motion-of", name + "=" + kFolder + "hopper_hold_" + std::to_string(i) + ".toml",
                          "--height-of", name + "=" + height[std::size_t(i - 1)]};
  }
  return out;
}
const std::string kHopper = dataset("scenes/hopper.toml");

}  // namespace

TEST_CASE("calibrate of a robot of links: its floor, in a scene that every verb reads") {
  const Folder f;
  done(f, of_hopper({1, 2, 3}, kHopper) + Arguments{"--law", "only", "--strict"} + kOut);
  const Json s = summary(f);
  const std::vector<std::pair<std::string, double>> truth = {{"stiffness", 16000},
                                                             {"damping_normal", 150},
                                                             {"damping_tangential", 45},
                                                             {"stiffness_tangential", 14000},
                                                             {"friction", 0.45}};
  CHECK(s["parameters"].size() == truth.size());
  for (const auto& [name, value] : truth) {
    INFO(name);
    const Json& p = s["parameters"][name];
    CHECK(std::abs(p["value"].get<double>() - value) < 4 * p["std"].get<double>());
    CHECK(p["verdict"] == "trusted");
  }
  CHECK(s["outputs"]["phi_hip"]["unit"] == "rad");
  CHECK(s["outputs"]["acc"]["rms"].get<double>() == Approx(1).epsilon(0.05));
  CHECK(s["law"]["given"] == "linear, Coulomb's friction, without pads");
  CHECK(s["law"]["asked"] == s["law"]["given"]);
  CHECK(s["law_rejected"] == false);
  CHECK(s["laws"].size() == 1);
  CHECK_FALSE(fs::exists(f.at("out/robot.toml")));
  const std::string scene = read(f.at("out/scene.toml"));
  CHECK_THAT(scene, Contains("# A leg on an upright rail") && Contains("hold_deg = 35") && Contains("[uncertainty]") &&
                        Contains("[verdict]\nstiffness = \"trusted\"\n") &&
                        Contains("source = \"calibrated from drop logs by ukemi\""));
  done(f, {"simulate", "out/scene.toml", "--no-report", "-o", "sim"});
  CHECK(summary(f, "sim")["peak_acceleration"].get<double>() == Approx(126).epsilon(0.03));
  done(f, {"risk", "out/scene.toml", "--hold", "hip=35,knee=-70", "--samples", "100", "--no-report", "-o", "risk"});
  // Once more from there: nothing changes but what stands in front.
  done(f, of_hopper({1, 2, 3}, "out/scene.toml") + Arguments{"--law", "only", "-o", "again", "--no-report"});
  CHECK(summary(f, "again")["parameters"]["friction"]["value"].get<double>() ==
        Approx(s["parameters"]["friction"]["value"].get<double>()).epsilon(1e-4));
}

TEST_CASE("calibrate of a robot of links: a contact's own constants stand in the robot's file") {
  const Folder f;
  f.write("leg.toml", replaced(read(dataset("robots/hopper.toml")), "at = [0.2, 0]\n",
                               "at = [0.2, 0]\npad = { thickness = 0.005, stiffness = 3000 }\nfriction = 0.5\n") +
                          "\n[identified]\norder = [\"drive.hip.i_motor\"]\ncovariance = [[1e-8]]\n");
  f.write("scene.toml", replaced(read(kHopper), "\"../robots/hopper.toml\"", "\"leg.toml\""));
  const Arguments some = {"--law", "only", "--no-report", "--free", "stiffness,foot.friction,pad_stiffness"};
  (void)run(of_hopper({1}, "scene.toml") + some + kOut, f.at(""));
  const Json s = summary(f);
  CHECK(s["parameters"]["foot.friction"]["free"] == true);
  CHECK(s["parameters"]["friction"]["free"] == false);
  CHECK(s["parameters"]["pad_thickness"]["value"] == 0.005);
  CHECK_THAT(read(f.at("out/scene.toml")), Contains("robot = \"robot.toml\"") && Contains("friction = 0.8\n"));
  const std::string robot = read(f.at("out/robot.toml"));
  CHECK_THAT(robot, Contains("pad = { thickness = 0.005, stiffness = ") && !Contains("stiffness = 3000 }") &&
                        !Contains("\nfriction = 0.5\n") && !Contains("[identified]") &&
                        Contains("k_p = 50                              # Nm/rad"));
  done(f, {"simulate", "out/scene.toml", "--no-report", "-o", "sim"});
}

TEST_CASE("calibrate tells the columns of a log that it does not read and that look like others") {
  const Folder f;
  const std::string drop = read(dataset("drops/drop_1.csv"));
  f.write("odd.csv", replaced(drop, "t,acc,", "t,accl,"));
  const Arguments played = {"--actuator", kTable2, "--motion", dataset("drops/hold.toml"), "--no-report"};
  CHECK_THAT(run(Arguments{"calibrate", "odd.csv", "--scene", kPaper} + played + kOut, f.at("")).err,
             Contains("odd.csv: column 'accl' is not read (did you mean \"acc\"?)"));
  f.write("loads.toml",
          read(kPaper) + "\n[[load]]\nname = \"a\"\nkind = \"acceleration\"\nlink = \"thigh\"\nrating = 9\n");
  f.write("drop.csv", drop);
  CHECK_THAT(
      run(Arguments{"calibrate", "drop.csv", "--scene", "loads.toml", "--law", "only"} + played + kOut, f.at("")).err,
      Contains("drop.csv: column 'x_0' is not read: of a robot of links x_LINK, y_LINK"));
}

TEST_CASE("calibrate of a robot of links refuses what it cannot") {
  const Arguments one = of_hopper({1}, kHopper);
  const auto refused = [&](const Arguments& options, const std::vector<std::string>& texts) {
    check_refused(Folder(), one + kOut + options, texts);
  };
  refused({"--free", "frictions"}, {"--free: 'frictions': ", "\"friction\""});
  refused({"--free", "exponent"}, {"--free: 'exponent': "});  // of Hunt and Crossley
  refused({"--speed-of", "hopper_1=1"}, {"--speed-of: ", "no forward speed"});
  refused({"--law", "mine"}, {"--law"});
  refused({"--actuator", "ankle=x.toml"}, {"--actuator: 'ankle': "});
  check_refused(Folder(), kOne + kOut + Arguments{"--law", "only"}, {"--law: ", "robot of links"});
  const Folder f;
  f.write("drop.csv", "t,acc,remark\n0,9.8,1\n1,9.8,1\n");
  check_refused(f, Arguments{"calibrate", "drop.csv", "--scene", kHopper, "--height-of", "drop=6"} + kOut,
                {"drop.csv: ", "before the first touchdown"});
  f.write("none.csv", "t,acceleration\n0,9.8\n1,9.8\n");
  check_refused(f, Arguments{"calibrate", "none.csv", "--scene", kHopper} + kOut,
                {"none.csv:1: ", "acc, ax, ay, x_slider", "phi_knee"});
}

TEST_CASE("calibrate --errors takes what a nuisance term would be in each drop, and a log that ends early has no inf") {
  const Folder f;
  const auto std_of = [&](const Arguments& errors) {
    done(f, kAll + Arguments{"--free", "stiffness,damping_normal", "--no-report", "-o", "out"} + errors);
    return summary(f)["parameters"]["stiffness"]["std"].get<double>();
  };
  const double exact = std_of({}), one = std_of({"--errors", "height_offset=0.01"}),
               three = std_of({"--errors", "height_offset=0.03"});
  CHECK(one > 1.01 * exact);
  CHECK(three * three - exact * exact == Approx(9 * (one * one - exact * exact)).epsilon(1e-3));
  CHECK(summary(f)["error_budget"]["stiffness"].contains("height_offset"));
  check_refused(f, kAll + Arguments{"--nuisance", "height_offset", "--errors", "height_offset=0.01"} + kOut,
                {"--errors: height_offset: ", "is fitted"});
  f.write("cut.csv", "t,acc\n0,0\n0.05,0\n0.1,0\n");
  const Arguments hopper = {"calibrate", "cut.csv", "--scene", dataset("scenes/hopper.toml"), "-o", "out"};
  check_refused(f, hopper, {"cut.csv: the log ends at 0.1 s, before the first touchdown: is the drop's height right"});
}
