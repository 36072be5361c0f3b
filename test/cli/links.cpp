// Robots of links as a user meets them: simulate, optimize, robot, and what refuses them.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <regex>
#include <sstream>

#include "test/cli/refused.hpp"
#include "test/cli/robot_log.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

const std::string kHopper = dataset("scenes/hopper.toml"), kThree = dataset("scenes/three_links.toml"),
                  kFoot = dataset("scenes/foot.toml");

std::string header_of(const std::string& csv) {
  for (std::size_t at = 0; at < csv.size(); at = csv.find('\n', at) + 1)
    if (csv[at] != '#') return csv.substr(at, csv.find('\n', at) - at);
  return "";
}

}  // namespace

TEST_CASE("simulate lets a robot of links fall, held as its scene says or as the command does") {
  const Folder f;
  const Result r = done(f, {"simulate", kHopper, "-o", "out"});
  CHECK_THAT(r.out, Contains("98.476") && Contains("foot"));
  const Json s = Json::parse(read(f.at("out/summary.json")));
  CHECK(s["peak_acceleration"].get<double>() == Approx(98.5).epsilon(5e-4));
  CHECK(s["energy_residual"].get<double>() < 1e-8);
  CHECK(s["motion"]["hip"]["phi_i_deg"].get<double>() == Approx(35));
  CHECK(s["contacts"][0]["point"] == "foot");
  CHECK(s["end"] == "rest");
  CHECK(s["joints"]["knee"]["kind"] == "geared");
  const std::string header = header_of(read(f.at("out/trajectory.csv")));
  for (const char* column : {"x_slider", "theta_shank", "phi_hip", "phi_ref_knee", "tau_knee", "f_foot_y", "acc"})
    CHECK_THAT(header, Contains(column));
  const std::string page = read(f.at("out/report.html"));
  CHECK_THAT(page, Contains("\"links\"") && Contains("id=\"figure-postures\"") && Contains("plans within"));
  done(f, {"simulate", kHopper, "--hold", "hip=35,knee=-70", "-o", "same", "--no-report"});
  CHECK(Json::parse(read(f.at("same/summary.json")))["peak_acceleration"] == s["peak_acceleration"]);
}

TEST_CASE("optimize plans for every driven joint, and simulate plays its rows to the same peak") {
  const Folder f;
  done(f, {"optimize", kHopper, "--evaluations", "400", "--seed", "3", "-o", "best"});
  const Json s = Json::parse(read(f.at("best/summary.json")));
  const double peak = s["peak_acceleration"];
  CHECK(peak < s["hold"]["peak_acceleration"].get<double>());
  CHECK(s["hold"]["phi_deg"]["knee"].get<double>() == Approx(-70));
  CHECK(s["evaluations"] == 400);
  CHECK(header_of(read(f.at("best/motion.csv"))) == "t,phi_ref_hip,dphi_ref_hip,phi_ref_knee,dphi_ref_knee");
  for (const char* motion : {"best/motion.csv", "best/motion.toml"}) {
    done(f, {"simulate", kHopper, "--motion", motion, "-o", "played", "--no-report"});
    CHECK(Json::parse(read(f.at("played/summary.json")))["peak_acceleration"].get<double>() ==
          Approx(peak).epsilon(1e-9));
  }
  done(f, {"optimize", kHopper, "--evaluations", "400", "--seed", "3", "--threads", "1", "-o", "one"});
  CHECK(Json::parse(read(f.at("one/summary.json")))["motion"] == s["motion"]);
}

TEST_CASE("a deadline is kept for a robot of links too") {
  const Folder f;
  done(f, {"optimize", kThree, "--deadline", "0.5", "-o", "out"});
  const Json s = Json::parse(read(f.at("out/summary.json")));
  CHECK(s["peak_acceleration"].get<double>() < 0.5 * s["hold"]["peak_acceleration"].get<double>());
  CHECK(s["time_s"].get<double>() < 2);  // whatever else the machine does
}

TEST_CASE("a deadline that leaves no time says nothing of what it does not know") {
  const Folder f;
  for (const Arguments& scene : {Arguments{kPaper, "--actuator", kTable2}, Arguments{kHopper}}) {
    const Result r = run(Arguments{"optimize"} + scene + Arguments{"--deadline", "0.001", "-o", "out"}, f.at(""));
    CHECK_THAT(r.out, !Contains("nan"));
  }
}

TEST_CASE("robot shows a robot before anything falls, and says what looks wrong") {
  const Folder f;
  const Result r = done(f, {"robot", kFoot, "-o", "out"});
  CHECK_THAT(r.out, Contains("4 links, 3.05 kg") && Contains("ankle") && Contains("passive") && Contains("heel"));
  const Json s = Json::parse(read(f.at("out/summary.json")));
  CHECK(s["doubts"].empty());
  CHECK(s["links"].size() == 4);
  CHECK_THAT(read(f.at("out/report.html")), Contains("id=\"figure-robot\""));
  done(f, {"robot", dataset("robots/foot.toml"), "-o", "alone"});  // without a scene
  f.write("heavy.toml", replaced(read(dataset("robots/hopper.toml")), "mass = 1.215", "mass = 121.5"));
  const Result heavy = done(f, {"robot", "heavy.toml", "-o", "heavy"});
  CHECK_THAT(heavy.err, Contains("link 'thigh': 121.5 kg in 0.205 m: a cube of steel"));
  check_refused(f, {"robot", kPaper, "-o", "none"}, {"[drive.knee]"});
}

TEST_CASE("a drive of a robot of links comes from its file, or from --actuator JOINT=FILE") {
  const Folder f;
  const std::string robot = read(dataset("robots/three_links.toml")),
                    from = "[drive.hip]\nfile = \"../actuators/table2.toml\"\n",
                    knee = "[drive.knee]\nfile = \"../actuators/table2.toml\"\n";
  f.write("leg.toml", replaced(replaced(robot, from, ""), knee, ""));
  f.write("scene.toml", replaced(read(kThree), "\"../robots/three_links.toml\"", "\"leg.toml\""));
  const Arguments simulate = {"simulate", "scene.toml", "-o", "out", "--no-report"};
  check_refused(f, simulate, {"leg.toml:", "a table [drive.hip], or --actuator hip=FILE"});
  check_refused(f, simulate + Arguments{"--actuator", kTable2}, {"--actuator: ", "JOINT=FILE is needed"});
  check_refused(f, simulate + Arguments{"--actuator", "hop=" + kTable2},
                {"--actuator: 'hop'", "did you mean \"hip\"?"});
  done(f, simulate + Arguments{"--actuator", "hip=" + kTable2, "--actuator", "knee=" + kTable2});
  CHECK(Json::parse(read(f.at("out/summary.json")))["peak_acceleration"].get<double>() == Approx(1097).epsilon(5e-4));
}

TEST_CASE("optimize plans for drops that scatter, risk plays the plan over them, of a robot of links") {
  const Folder f;
  const Result best =
      done(f, {"optimize", kHopper, "--robust", "cvar", "--evaluations", "6000", "--samples", "16", "-o", "best"});
  CHECK_THAT(best.err, Contains("pitch_deg=1,height=0.01 is assumed"));  // what its base has
  const Json s = Json::parse(read(f.at("best/summary.json")));
  CHECK(s["robust"]["measure"] == "cvar");
  const double promised = s["robust"]["promised"], fresh = s["scatter"]["measured"];
  CHECK(std::abs(fresh / promised - 1) < 0.05);
  CHECK(fresh < 0.7 * s["scatter"]["held"]["cvar90"].get<double>());
  CHECK(s["scatter"]["deviations"] == "pitch_deg=1,height=0.01");
  const Result r = done(f, {"risk", kHopper, "--motion", "best/motion.toml", "--samples", "1000", "-o", "risk"});
  CHECK_THAT(r.err, Contains("pitch_deg=1,height=0.01 is assumed"));
  const Json told = Json::parse(read(f.at("risk/summary.json")));
  CHECK(told["peak"]["cvar90"].get<double>() == Approx(fresh).epsilon(0.03));
  CHECK(told["sobol"]["pitch"]["total"].get<double>() > 0.5);
  CHECK(told["contacts"][0]["point"] == "foot");
  CHECK(told["motion"]["hip"]["phi_i_deg"] == s["motion"]["hip"]["phi_i_deg"]);
  CHECK_THAT(read(f.at("risk/histogram.csv")), Contains("lower,upper,count,count_held"));
  CHECK_THAT(read(f.at("risk/report.html")), Contains("figure-sobol") && Contains("The constants of the drives"));
  for (const char* goal : {"peak", "tolerant"}) {
    done(f, {"optimize", kHopper, "--objective", goal, "--deadline", "0.4", "--robust", "mean", "-o", goal});
    const Json quick = Json::parse(read(f.at(std::string(goal) + "/summary.json")));
    CHECK(quick["objective"] == goal);
    CHECK(quick["value"].get<double>() <= quick["hold"]["value"].get<double>());  // a busy machine gets no further
  }
}

TEST_CASE("optimize --log stands beside what the robot did in its logs") {
  const Folder f;
  done(f, {"simulate", kHopper, "--rate", "500", "-o", "held"});
  const Json held = Json::parse(read(f.at("held/summary.json")));
  (void)f.write("log.csv", as_log(read(f.at("held/trajectory.csv")), 0));
  const Result r = done(f, {"optimize", kHopper, "--log", "log.csv", "--evaluations", "200", "-o", "best"});
  CHECK_THAT(r.out, Contains("In its log the model took"));
  const Json s = Json::parse(read(f.at("best/summary.json")));
  CHECK(s["logged"]["median"].get<double>() == Approx(held["peak_acceleration"].get<double>()).epsilon(0.02));
  CHECK_THAT(run({"optimize", kHopper, "--log", "log.csv", "--deadline", "1"}, f.at("")).err,
             Contains("--log: not with --deadline"));
  CHECK_THAT(run({"optimize", kHopper, "--log", "none.csv"}, f.at("")).err, Contains("none.csv"));
}

TEST_CASE("a plan of a robot of links has shape terms and gains, in its files and its tables") {
  const Folder f;
  for (const char* goal : {"peak", "tolerant"}) {
    done(f, Arguments{"optimize", kHopper, "--bumps", "1", "--landing-gains", "0.5:2", "--objective", goal,
                      "--evaluations", "300"} +
                kOut);
    const Json s = summary(f);
    CHECK(s["motion"]["hip"]["bumps_deg"].size() == 4);
    CHECK(s["motion"]["knee"]["gain_p"].get<double>() >= 0.5);
    const std::string motion = f.at("out/motion.toml");
    CHECK_THAT(read(motion), Contains("bumps_deg") && Contains("gain_d"));
    done(f, {"simulate", kHopper, "--motion", motion, "-o", "played"});
    CHECK(Json::parse(read(f.at("played/summary.json")))["peak_acceleration"].get<double>() ==
          Approx(s["peak_acceleration"].get<double>()).epsilon(1e-6));
  }
}

/// The hopper's scene with a release at other angles than its held ones; its path.
static std::string released_hopper(const Folder& f) {
  std::string text = read(kHopper);
  text = std::regex_replace(text, std::regex("robot = \"[^\"]*\""), "robot = \"leg.toml\"");
  f.write("leg.toml", read(dataset("robots/hopper.toml")));
  return f.write("released.toml",
                 text + "[release]\nfrom = 0.02\n[release.hip]\nphi_deg = 20\n[release.knee]\nphi_deg = -40\n");
}

TEST_CASE("a joint that --hold names stays there, though its scene lets it move in the air") {
  const Folder f;
  const std::string released = released_hopper(f);
  done(f, {"simulate", released, "--hold", "hip=35,knee=-70", "-o", "held"});
  done(f, {"simulate", kHopper, "--hold", "hip=35,knee=-70", "-o", "plain"});
  const auto peak = [&](const char* folder) { return summary(f, folder)["peak_acceleration"].get<double>(); };
  CHECK(peak("held") == Approx(peak("plain")).epsilon(1e-9));
}

TEST_CASE("limits of a robot of links: kept by plans, counted by risk, and said where nothing keeps them") {
  const Folder f;
  const std::string leg = f.write("leg.toml",
                                  read(dataset("robots/hopper.toml")) + "speed_max = 6\nmotor_torque_max = 12\n"),
                    scene = f.write("scene.toml",
                                    std::regex_replace(read(kHopper), std::regex("../robots/hopper.toml"), "leg.toml") +
                                        "[joint.knee]\nphi_deg = [-120, 0]\n");
  done(f, {"optimize", scene, "--respect-ratings", "--forbid", "knee", "--evaluations", "800", "-o", "kept"});
  const Json s = Json::parse(read(f.at("kept/summary.json")));
  CHECK(s["joints"]["knee"]["motor_speed"].get<double>() <= 6);
  CHECK(s["joints"]["knee"]["phi_deg"][0].get<double>() >= -120);
  CHECK(s["peak_acceleration"].get<double>() < s["hold"]["peak_acceleration"].get<double>());
  done(f, {"risk", scene, "--motion", "kept/motion.toml", "--forbid", "foot,knee", "--samples", "200", "-o", "risk"});
  const Json told = Json::parse(read(f.at("risk/summary.json")));
  CHECK(told["forbidden"]["foot"]["share"] == 1);
  CHECK(told["ratings"].contains("joint_knee"));
  const Result none =
      run({"optimize", scene, "--forbid", "slider,knee,foot", "--evaluations", "200", "-o", "none"}, f.at(""));
  CHECK(none.code == 1);
  CHECK_THAT(none.err, Contains("no motion was found that keeps the limits; holding breaks them after") &&
                           Contains(" s: foot.touch"));
}

TEST_CASE("trade shows what a number of a design buys") {
  const Folder f;
  const Result r =
      done(f, {"trade", kHopper, "--vary", "drive.knee.k_p=20:100:3", "--evaluations", "800", "-o", "out"});
  CHECK_THAT(r.out, Contains("Lowest: "));
  const Json s = summary(f);
  REQUIRE(s["points"].size() == 3);
  CHECK(s["middle"] == Json({60}));
  for (const Json& p : s["points"]) CHECK(p["planned"].get<double>() < p["held"].get<double>());
  CHECK_THAT(read(f.at("out/trade.csv")), Contains("drive.knee.k_p,held,unchanged,planned,peak,phi_i_hip_deg"));
  CHECK_THAT(read(f.at("out/report.html")), Contains("id=\"figure-trade\""));
  done(f, {"trade", kFoot, "--vary", "robot.contact.heel.pad.thickness=0:0.02:2", "--vary", "drop.height=0.2:0.3:2",
           "--evaluations", "200", "--respect-ratings", "-o", "two"});
  CHECK(summary(f, "two")["points"].size() == 4);
  const auto refused = [&](const Arguments& more, const Arguments& what) {
    check_refused(f, Arguments{"trade", kHopper} + more, what);
  };
  refused({"--vary", "drive.knee.k_q=1:2"}, {"--vary: 'drive.knee.k_q'", "drive.knee.k_p"});
  refused({"--vary", "drive.knee.k_p=-1:2"}, {"--vary: drive.knee.k_p = -1", "k_p"});
  refused({"--vary", "robot.contact.foot.pad.thickness=0.01:0.02"}, {"foot.pad.thickness: there is no pad"});
  refused({"--vary", "drop.height=0.2"}, {"--vary: ", "LO:HI"});
  refused({"--vary", "drop.height=0.2:0.3", "--vary", "drop.height=0.2:0.3", "--vary", "drop.height=0.2:0.3"},
          {"--vary: 3 times", "once or twice"});
  check_refused(f, {"trade", kPaper, "--vary", "drop.height=0.2:0.3"}, {"paper.toml", "[drive.knee]"});
}

TEST_CASE("trade: shards are put together, Ctrl-C is gone on from") {
  const Folder f;
  const Arguments base = {"trade", kHopper, "--vary", "drive.knee.k_p=20:100:4", "--evaluations", "2000", "--quiet"};
  const auto rows = [&](const std::string& folder) {
    const std::string text = read(f.at(folder + "/trade.csv"));
    return text.substr(text.find("drive.knee.k_p,"));
  };
  for (const std::string k : {"1", "2"}) {
    done(f, base + Arguments{"--shard", k + "/2", "-o", "s" + k});
    CHECK(summary(f, "s" + k)["points"].size() == 2);
    CHECK(fs::exists(f.at("s" + k + "/trade.part")));
  }
  done(f, base + Arguments{"--merge", "s2", "s1", "-o", "all"});
  CHECK(summary(f, "all")["points"].size() == 4);
  CHECK_FALSE(fs::exists(f.at("all/trade.part")));
  const auto refused = [&](const Arguments& more, const Arguments& what) { check_refused(f, base + more, what); };
  refused({"--merge", "s1", "-o", "bad"}, {"--merge: 2 of 4 designs are in none of the folders"});
  refused({"--merge", "s1", "none", "-o", "bad"}, {"none/trade.part: there is none"});
  refused({"--merge", "s1", "s2", "--seed", "2", "-o", "bad"}, {"s1/trade.part: begun for another trade"});
  const Arguments in_air = {"trade", released_hopper(f), "--vary", "drive.knee.k_p=20:100:2", "--evaluations", "200"};
  done(f, in_air + Arguments{"--release-from", "0.03", "--shard", "1/2", "-o", "r1"});
  check_refused(f, in_air + Arguments{"--release-from", "0.04", "--merge", "r1", "-o", "bad"},
                {"r1/trade.part: begun for another trade"});
  refused({"--shard", "5/5", "-o", "bad"}, {"--shard: '5/5'", "N up to 4"});
  refused({"--pareto", "peak,knee"}, {"--vary or --pareto"});

  const Interrupted r = interrupted_after(0.15, base + Arguments{"--threads", "1", "-o", "out"}, f.at(""));
  CHECK(r.code == 130);
  CHECK(summary(f)["interrupted"] == true);
  CHECK(fs::exists(f.at("out/trade.part")));
  done(f, base + Arguments{"-o", "out"});
  done(f, base + Arguments{"-o", "whole"});
  CHECK(rows("out") == rows("whole"));
  CHECK_FALSE(fs::exists(f.at("out/trade.part")));
}

TEST_CASE("optimize --respect-ratings of a robot of links tells what breaks the ratings least where none keeps them") {
  const Folder f;
  std::string robot = read(dataset("robots/hopper.toml"));
  for (std::size_t at = 0; (at = robot.find("tau_max = 12", at)) != std::string::npos; at += 20)
    robot.insert(at, "speed_max = 0.5\n");
  f.write("hopper.toml", robot);
  f.write("scene.toml", replaced(read(kHopper), "\"../robots/hopper.toml", "\"hopper.toml"));
  const Result r = run({"optimize", "scene.toml", "--respect-ratings", "--evaluations", "500", "-o", "out"}, f.at(""));
  CHECK(r.code == 1);
  CHECK_THAT(r.err, Contains("breaks them least") && Contains("motor speed of") && Contains("times the 0.5 allowed"));
  const Json l = summary(f)["least_breaking"];
  CHECK(l["rating"] == "motor_speed");
  CHECK(l["demand"].get<double>() > 0.5);
  CHECK(l["motion"].contains("knee"));
}

TEST_CASE("ratings of a robot of links is a trade of what its drives are rated") {
  const Folder f;
  done(f, {"ratings", kHopper, "--motor-speed", "2:20:3", "--evaluations", "1500", "-o", "out"});
  const Json points = summary(f)["points"];
  REQUIRE(points.size() == 3);
  CHECK(points[0]["drive.*.speed_max"] == 2);
  CHECK(points[2]["planned"].get<double>() <= points[0]["planned"].get<double>());
}

TEST_CASE("a landing from another height, of a robot alone, with the drives behind its commands") {
  const Folder f;
  const auto peak = [&](const Arguments& arguments) {
    done(f, Arguments{"simulate"} + arguments + Arguments{"-o", "out", "--no-report"});
    return summary(f)["peak_acceleration"].get<double>();
  };
  f.write("low.toml", replaced(replaced(read(kHopper), "\"../robots/hopper.toml", "\"" + dataset("robots/hopper.toml")),
                               "height = 0.3 ", "height = 0.2 "));
  CHECK(peak({kHopper, "--height", "0.2"}) == peak({"low.toml"}));
  CHECK(peak({kPaper, "--actuator", kTable2, "--hold", "-45", "--height", "0.2"}) <
        peak({kPaper, "--actuator", kTable2, "--hold", "-45"}));

  const std::string hopper = dataset("robots/hopper.toml"), robot = read(hopper);
  check_refused(f, {"optimize", hopper, "--height", "0.2"}, {"hopper.toml: contact slider has no stiffness"});
  check_refused(f, {"optimize", kHopper, "--height", "-1"}, {"--height: -1"});
  std::string alone = robot;
  for (std::size_t at = 0; (at = alone.find("[[robot.contact]]", at)) != std::string::npos; at += 20)
    alone.insert(at + 17, "\nstiffness = 20000\ndamping_normal = 120");
  f.write("alone.toml", alone);
  f.write("commanded.toml", alone + "\n[command.knee]\ntorque_gain = 0.5\ntorque_low = -9\ntorque_high = 11\n");
  f.write("by_hand.toml", alone.substr(0, alone.find("[drive.knee]")) +
                              "[drive.knee]\nkind = \"geared\"\nk_p = 25\n"
                              "k_d = 1\ni_motor = 0.006\ntau_max = 4.5\n");
  const Arguments hold = {"--hold", "hip=35,knee=-70", "--height", "0.2"};
  CHECK(peak(Arguments{"commanded.toml"} + hold) == Approx(peak(Arguments{"by_hand.toml"} + hold)).epsilon(1e-12));
  CHECK(std::abs(peak(Arguments{"commanded.toml"} + hold) - peak(Arguments{"alone.toml"} + hold)) > 0.1);
  done(f, {"optimize", "commanded.toml", "--height", "0.2", "--evaluations", "300", "-o", "plan", "--no-report"});
  CHECK(summary(f, "plan")["peak_acceleration"].get<double>() > 0);
}

TEST_CASE("a scene that does not say which robot falls, and tables in the wrong one of its two files") {
  const Folder f;
  f.write("leg.toml", read(dataset("robots/hopper.toml")));
  const std::string scene = replaced(read(kHopper), "\"../robots/hopper.toml", "\"leg.toml");
  const auto refused = [&](const std::string& text, const std::vector<std::string>& words) {
    f.write("scene.toml", text);
    for (const char* verb : {"simulate", "optimize", "risk"}) check_refused(f, {verb, "scene.toml"}, words);
  };
  const std::string says = "robot = \"FILE\" above all tables";
  refused(replaced(scene, "robot =", "robt ="), {"scene.toml: ", "[robot] is missing (there is [robt])", says});
  refused(replaced(scene, "robot = \"leg.toml\"", "") + "robot = \"leg.toml\"\n", {"[robot] is missing", says});
  f.write("scene.toml", replaced(scene, "robot = \"leg.toml\"", "[robot]\nfile = \"leg.toml\""));
  check_refused(f, {"simulate", "scene.toml"}, {"--actuator is required", says});
  for (const char* table : {"stop.knee", "command.knee", "sensor", "identified"})
    refused(scene + "\n[" + table + "]\nx = 1\n", {"scene.toml:", "it belongs into the robot's file", "leg.toml"});
  for (const char* table : {"joint.knee", "drop", "floor", "release", "execution", "search.knee"}) {
    f.write("leg.toml", read(dataset("robots/hopper.toml")) + "\n[" + table + "]\nx = 1\n");
    refused(scene, {"leg.toml:", "it belongs into the scene's file", "scene.toml"});
  }
}

TEST_CASE("drops as they were measured are played and planned for, of a robot of links") {
  const Folder f;
  const Arguments drops = {"--drops", "drops.csv"};
  done(f, {"risk", kHopper, "--samples", "400", "-o", "drawn"});
  f.write("drops.csv", read(f.at("drawn/risk.csv")));  // the worst of them, as if they had been measured
  const Json drawn = Json::parse(read(f.at("drawn/summary.json")));
  const Result r = done(f, Arguments{"risk", kHopper, "-o", "risk"} + drops);
  CHECK_THAT(r.err, !Contains("assumed"));
  const Json told = Json::parse(read(f.at("risk/summary.json")));
  CHECK(told["peak"]["max"].get<double>() == Approx(drawn["peak"]["max"].get<double>()).epsilon(1e-9));
  CHECK(told["scatter"].is_null());

  done(f, Arguments{"optimize", kHopper, "--robust", "worst", "--evaluations", "4000", "-o", "best"} + drops);
  const Json best = Json::parse(read(f.at("best/summary.json")));
  CHECK(best["scatter"]["deviations"].is_null());
  CHECK(best["scatter"]["planned"]["samples"] == told["peak"]["samples"]);
  CHECK(best["robust"]["promised"].get<double>() == Approx(best["scatter"]["measured"].get<double>()).epsilon(1e-4));
  CHECK(best["scatter"]["planned"]["max"] < 0.7 * told["peak"]["max"].get<double>());
  const Result alone = done(f, Arguments{"optimize", kHopper, "--evaluations", "500", "-o", "alone"} + drops);
  CHECK_THAT(alone.out, Contains("measured drops"));

  for (const Arguments& more : {Arguments{"--scatter", "height=0.1"}, Arguments{"--inflate", "2"}}) {
    check_refused(f, Arguments{"risk", kHopper} + drops + more, {more[0], "--drops"});
    check_refused(f, Arguments{"optimize", kHopper} + drops + more, {more[0], "--drops"});
  }
  check_refused(f, Arguments{"risk", kHopper, "--samples", "100"} + drops, {"--samples", "--drops"});
  check_refused(f, {"optimize", kHopper, "--columns", "t=Time", "-o", "none"}, {"--columns: --log is needed"});
  f.write("drops.csv", "height,colour\n0.3,1\n-0.3,1\n");
  check_refused(f, Arguments{"risk", kHopper} + drops, {"drops.csv:3:1: 'height': -0.3: "});
  f.write("drops.csv", "height,forward_speed\n0.3,0\n0.3,1\n");
  check_refused(f, Arguments{"risk", kHopper} + drops, {"drops.csv:3:5: 'forward_speed': 1: ", "rail"});
}

TEST_CASE("what a verb cannot do for a robot of links is refused in a line that says what it can") {
  const Folder f;
  check_refused(f, {"optimize", kHopper, "--solver", "compare"},
                {"--solver compare: of the paper's robot alone; robots of links are planned without it"});
  check_refused(f, {"optimize", kHopper, "--solver", "sqp", "--forbid", "knee"},
                {"solver: sqp: a scene without limits", "a largest peak"});
  check_refused(f, {"optimize", kHopper, "--robust", "median"}, {"--robust: 'median': ", "cvar"});
  check_refused(f, {"optimize", kHopper, "--robust", "mean", "--scatter", "forward_speed=0.1"},
                {"scatter: forward_speed", "this base"});
  check_refused(f, {"optimize", kHopper, "--release-phi", "2"}, {"--release-phi", "[release.JOINT]"});
  check_refused(f, {"optimize", kHopper, "--release-from", "0.1"}, {"--release-from: ", "[release]"});
  const std::string slips = replaced(read(kHopper), "\"../robots/hopper.toml", "\"" + dataset("robots/hopper.toml")) +
                            "\n[release]\nhip.phi_deg = 35\nknee.phi_deg = -70\nfrom = ";
  f.write("slips.toml", slips + "0.1\n"), f.write("late.toml", slips + "0.3\n");
  for (const Arguments& plan : {Arguments{"optimize"},
                                {"trade", "--vary", "drop.height=0.2:0.3"},
                                {"map", "--vary", "phi_i_knee"},
                                {"simulate"}}) {
    check_refused(f, plan + Arguments{"late.toml"},
                  {"late.toml: release.from: 0.3 s: ", "before the first touchdown, at 0.24"});
    if (plan[0] != "simulate")
      check_refused(f, plan + Arguments{"slips.toml", "--release-from", "0.25"},
                    {"--release-from: 0.25 s: ", "before the first touchdown, at 0.24"});
  }
  f.write("turns.toml", slips + "0.1\nhip.rate_deg = 40\n");  // the fall is integrated
  check_refused(f, {"optimize", "turns.toml", "--release-from", "0.28"},
                {"--release-from: 0.28 s: ", "before the first touchdown, at 0.2"});
  check_refused(f, {"risk", kHopper, "--inflate", "101"}, {"--inflate: 101: 0 to 100 is needed"});
  check_refused(f, {"optimize", kHopper, "--evaluations", "100", "--evaluations", "200"},
                {"--evaluations: given more than once"});
  const std::string foot = read(dataset("robots/foot.toml"));  // here with a third drive
  f.write("leg.toml", foot.substr(0, foot.find("[drive.hip]")) +
                          "[drive.hip]\nfile = \"table2.toml\"\n[drive.knee]\nfile = \"table2.toml\"\n"
                          "[drive.ankle]\nfile = \"table2.toml\"\n");
  f.write("table2.toml", read(kTable2));
  f.write("scene.toml", replaced(read(kFoot), "\"../robots/foot.toml\"", "\"leg.toml\"") +
                            "ankle = { phi_deg = [-30, 30], hold_deg = 0 }\n");
  check_refused(f, {"optimize", "scene.toml", "--bumps", "4", "--landing-gains", "0.5:2"},
                {"25 variables for 3 driven joints", "at most 20"});
  check_refused(f, {"simulate", kHopper, "--drop-from", "x.csv"}, {"--drop-from: 'x.csv': FILE:ROW is needed"});
  check_refused(f, {"risk", kHopper, "--forbid", "kne"}, {"--forbid: 'kne'", "did you mean"});
  check_refused(f, {"risk", kHopper, "--hold", "-45"}, {"--hold: '-45': ", "NAME=VALUE"});
  check_refused(f, {"risk", kPaper, "--hold", "-45"}, {"--actuator is required"});
  check_refused(f, {"simulate", kHopper, "--hold", "35"}, {"--hold: '35': ", "NAME=VALUE"});
  check_refused(f, {"simulate", kHopper, "--hold", "hop=35"}, {"--hold: 'hop': ", "hip or knee"});
  check_refused(f, {"simulate", kHopper, "--hold", "hip=400"}, {"--hold: 400: ", "-360 to 360"});
  check_refused(f, {"simulate", kPaper, "--hold", "-45", "--actuator", kTable2, "--actuator", kTable2},
                {"one file is needed"});
}

TEST_CASE("contacts that touch at one instant are all told, in their order") {
  const Folder f;
  CHECK_THAT(done(f, {"simulate", kFoot, "--no-report", "-o", "out"}).out, Contains(" heel, toe, heel, head, "));
}

TEST_CASE("what was perhaps meant otherwise is told of a robot of links: units, drives, what a number cannot change") {
  const Folder f;
  const std::string hopper = dataset("scenes/hopper.toml"), paper = dataset("scenes/paper.toml");
  const auto refused = [&](const Arguments& call, const std::string& words) {
    check_refused(f, call + Arguments{"-o", "bad"}, {words});
  };
  refused({"optimize", hopper, "--robust", "cvar", "--penalty", "10"}, "--penalty: of the paper's robot");
  refused({"optimize", hopper, "--robust", "cvar", "--share", "0.99"}, "--share: the scene has no limit to keep");
  refused({"optimize", hopper, "--robust", "cvar", "--samples", "1"}, "--samples: 1: 16 to 4096");
  refused({"optimize", paper, "--actuator", kTable2, "--penalty", "10"}, "--penalty: of drops that scatter");
  refused({"trade", hopper, "--vary", "drive.knee.k_sea=1:10:3"}, "drive.knee.k_sea");
  refused({"trade", hopper, "--vary", "drive.knee.speed_max=1:10:3"}, "--respect-ratings is needed");
  refused({"ratings", hopper, "--motor-speed", "0:4:2"}, "--motor-speed: 0: above 0 is needed");
  refused({"trade", hopper, "--vary", "drive.knee.k_p=1:10:2", "--vary", "drive.knee.k_p=1:10:2"}, "named twice");
  refused(
      {"simulate", dataset("scenes/three_links.toml"), "--actuator", "hip=" + kTable2, "--actuator", "hip=" + kTable2},
      "--actuator: 'hip': given twice");
  const auto warned = [&](const Arguments& call, const std::string& words) {
    CHECK_THAT(done(f, call + Arguments{"--no-report", "-o", "out"}).err, Contains(words));
  };
  warned({"simulate", hopper, "--hold", "knee=-1.2"}, "--hold: -1.2: degrees, not radians (-1.2 rad would be -68.75)");
  warned({"optimize", paper, "--actuator", kTable2, "--evaluations", "50", "--release-phi", "-0.78"},
         "--release-phi: -0.78: degrees");
  warned({"optimize", hopper, "--robust", "mean", "--deadline", "0.5"}, "the scene has no [scatter]: ");
  f.write("unrated.toml", replaced(read(kTable2), "speed_max", "# "));
  f.write("robot.toml", replaced(replaced(read(dataset("robots/three_links.toml")), "../actuators/table2", "unrated"),
                                 "../actuators/table2", dataset("actuators/table2")));
  f.write("rated.toml", replaced(read(dataset("scenes/three_links.toml")), "\"../robots/three_links", "\"robot"));
  warned({"simulate", "rated.toml"}, "unrated.toml: the motor's speed rating is unknown (speed_max)");
  CHECK_THAT(done(f, {"optimize", hopper, "--robust", "mean", "--deadline", "0.5", "-o", "out"}).out,
             Contains("Over the drops that it is planned for "));
  f.write("loose.toml", replaced(read(kTable2), "c_sea", "c_sea = 0.001 #"));
  warned(
      {"simulate", dataset("scenes/three_links.toml"), "--actuator", "hip=loose.toml", "--actuator", "knee=loose.toml"},
      ": the drive is unstable on this robot: in flight");
  f.write("motor.toml", read(kTable2) + "feedback = \"motor\"\n");
  const std::string sets = "the sets differ in what the drive feeds back too: nominal output, identified motor";
  warned({"compare", "--nominal", kTable2, "--identified", "motor.toml"}, sets);
  refused({"simulate", paper, "--actuator", kTable2, "--hold", "-45", "--joint", "knee"}, "--joint requires --export");
  refused({"identify", kTrial1, "--rig", kRig, "--force-clock", "own"}, "--force-clock requires --force-log");
  refused({"identify", kTrial1, "--rig", kRig, "--free", ""}, "--free: a value is needed, not ''");
  warned({"calibrate", dataset("drops/drop_1.csv"), "--scene", paper, "--actuator", kTable2, "--motion",
          dataset("drops/hold.toml"), "--free", "stiffness", "--validate", dataset("drops/drop_1.csv")},
         "is fitted too: what it shows is no validation");
}

TEST_CASE("risk of a robot of links writes its worst drops, and simulate replays a row to its peak") {
  const Folder f;
  const auto rows = [&](const std::string& path) {
    std::istringstream in(read(f.at(path)));
    std::vector<std::string> out;
    for (std::string line; std::getline(in, line);)
      if (!line.empty() && line[0] != '#') out.push_back(line);
    return out;
  };
  const auto replayed = [&](const std::string& scene, const Arguments& more, const std::string& header) {
    const Arguments all = Arguments{scene} + more;
    done(f, Arguments{"risk"} + all +
                Arguments{"--samples", "200", "--no-report", "-o", "risk", "--inexact", "--scatter",
                          "pitch_deg=2,height=0.02,friction=10%,stiffness=5%,phi_deg=1,rate_deg=5,delay=0.001"});
    const std::vector<std::string> table = rows("risk/risk.csv");
    REQUIRE(table.size() == 101);
    CHECK_THAT(table[0], Contains("row,peak,") && Contains(header) && !Contains("*") && !Contains("length"));
    double last = summary(f, "risk")["peak"]["max"];
    for (const int row : {1, 20, 100}) {
      const double peak = std::stod(table[std::size_t(row)].substr(table[std::size_t(row)].find(',') + 1));
      CHECK(peak <= last);
      last = peak;
      done(f, Arguments{"simulate"} + all +
                  Arguments{"--drop-from", "risk/risk.csv:" + std::to_string(row), "--no-report", "-o", "row"});
      CHECK(summary(f, "row")["peak_acceleration"].get<double>() == Approx(peak).epsilon(1e-3));
    }
  };
  replayed(kFoot, {}, "robot.contact.heel.friction");
  f.write("far.csv", "height,robot.contact.heel.friction\n0.2,0.5\n-1,0.5\n");
  check_refused(f, {"simulate", kFoot, "--drop-from", "far.csv:3", "-o", "out"},
                {"far.csv:3:1: 'height': -1: ", "at least 0"});
  f.write("far.csv", "height,robot.contact.heel.fricton\n0.2,0.5\n");
  check_refused(f, {"simulate", kFoot, "--drop-from", "far.csv:1", "-o", "out"}, {"far.csv:1:8: ", "friction"});
  f.write("far.csv", "height\n0.2\n");
  check_refused(f, {"simulate", kFoot, "--drop-from", "far.csv:2", "-o", "out"}, {"the file has 1 row(s)"});
  done(f, {"simulate", kFoot, "--drop-from", "far.csv:1", "--no-report", "-o", "row"});
  done(f, {"simulate", kFoot, "--height", "0.2", "--no-report", "-o", "height"});
  CHECK(summary(f, "row")["peak_acceleration"] == summary(f, "height")["peak_acceleration"]);
}
