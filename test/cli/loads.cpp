// Loads of a robot of links as a user meets them: what is refused, told, planned, and kept.
#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <set>

#include "test/cli/refused.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

const std::string
    kAcceleration =
        "[[load]]\nname = \"slider\"\nkind = \"acceleration\"\nlink = \"slider\"\nat = [0, 0]\nrating = 1\n",
    kKnee = "[[load]]\nname = \"knee\"\nkind = \"torque\"\njoint = \"knee\"\nrating = 12\n",
    kFoot = "[[load]]\nname = \"foot\"\nkind = \"force\"\ncontact = \"foot\"\nrating = 150\n",
    kNoTouch = "[[load]]\nname = \"hull\"\nkind = \"touch\"\ncontact = \"slider\"\n";

/// hopper.toml with tables behind it, as scene.toml.
void write_scene(const Folder& f, const std::string& tables) {
  const std::string scene = read(dataset("scenes/hopper.toml"));
  f.write("scene.toml",
          replaced(scene, "\"../robots/hopper.toml", "\"" + dataset("robots/hopper.toml")) + "\n" + tables);
}

}  // namespace

TEST_CASE("a load that cannot be is refused where it stands") {
  const Folder f;
  const auto refused = [&](const std::string& tables, const std::vector<std::string>& texts) {
    write_scene(f, tables);
    check_refused(f, Arguments{"simulate", "scene.toml"} + kOut, texts);
  };
  refused("[load]\nname = \"x\"\n", {"scene.toml:", "tables [[load]] are needed"});
  refused(replaced(kKnee, "\"torque\"", "\"torqe\""), {"scene.toml:", "torqe", "torque"});
  refused(replaced(kKnee, "joint = \"knee\"", "joint = \"nee\""), {"scene.toml:", "nee", "knee"});
  refused(replaced(kKnee, "rating = 12", "rating = 0"), {"rating", "0: must be above 0"});
  refused(replaced(kKnee, "rating = 12\n", ""), {"rating", "missing"});
  refused(replaced(kKnee, "\"torque\"", "\"deflection\""), {"joint", "an elastic drive is needed"});
  refused(replaced(kKnee, "\"torque\"", "\"angle\""), {"phi_deg", "[low, high] is needed"});
  refused(replaced(kKnee, "joint", "contact = \"foot\"\njoint"), {"contact", "a load of the kind torque has none"});
  refused(kKnee + kKnee, {"name", "given twice"});
  refused(kNoTouch + "limit = false\n", {"limit", "true is needed"});
  refused(kNoTouch + "rating = 1\n", {"rating", "0 is needed"});
  refused(replaced(kKnee, "name = \"knee\"", "name = \"peak\""), {"name", "'peak'", "another name"});
  refused(kKnee + "unit = \"Nm\"\n", {"unknown key", "unit"});
  const std::string rate = replaced(kKnee, "\"torque\"", "\"reference_rate\"");
  refused(rate + "limit = false\n", {"limit", "a reference rate is no amount", "true is needed"});
  refused("[joint.knee]\nphi_deg = [-90, 0]\n" + replaced(kKnee, "\"knee\"\nkind", "\"knee.angle\"\nkind"),
          {"name", "given twice"});
  write_scene(f, kKnee);
  check_refused(f, Arguments{"optimize", "scene.toml", "--share", "0.9"} + kOut, {"--share", "--robust is needed"});
  check_refused(f, Arguments{"optimize", "scene.toml", "--robust", "mean", "--share", "2"} + kOut, {"--share: 2"});
}

TEST_CASE("loads of the paper's robot in the short form: its links, joint and contacts have their names") {
  const Folder f;
  const std::string thigh = "[[load]]\nname = \"thigh\"\nkind = \"acceleration\"\nlink = \"thigh\"\nrating = 1\n",
                    tables = "\n[release]\nphi_deg = -45\nfrom = 0.1\n\n[joint]\nphi_deg = [-100, 10]\n\n";
  f.write("plain.toml", read(kPaper) + tables), f.write("paper.toml", read(kPaper) + tables + thigh);
  f.write("parts.toml", read(kPaper) + "\n" + replaced(thigh, "rating = 1", "rating = 60") + kKnee + kFoot);
  const auto simulated = [&](const std::string& scene, const Arguments& more = {}) {
    done(f, Arguments{"simulate", scene, "--actuator", kTable2, "--no-report", "-o", "out"} + more);
    return summary(f);
  };
  SECTION("one acceleration, rated 1, is the peak of Eq. 6") {
    const Json with = simulated("paper.toml"), without = simulated("plain.toml", {"--hold", "-45"});
    CHECK(with["loads"][0]["value"] == with["peak_acceleration"]);
    CHECK(with["peak_acceleration"].get<double>() == Approx(without["peak_acceleration"].get<double>()).epsilon(1e-7));
    CHECK(with["peak_time"].get<double>() == Approx(without["peak_time"].get<double>()).epsilon(1e-7));
  }
  SECTION("every load and every goal") {
    CHECK(simulated("parts.toml", {"--hold", "-45"})["loads"].size() == 3);
    for (const Arguments& goal :
         std::vector<Arguments>{{"--evaluations", "150"},
                                {"--objective", "tolerant", "--evaluations", "100"},
                                {"--robust", "mean", "--samples", "16", "--evaluations", "600"},
                                {"--deadline", "0.2", "--bumps", "2"},
                                {"--evaluations", "200", "--release-phi", "-45", "--release-from", "0.1"}}) {
      done(f, Arguments{"optimize", "parts.toml", "--actuator", kTable2, "--no-report", "-o", "out"} + goal);
      const Json s = summary(f);
      CAPTURE(goal, s.dump());
      CHECK(s["loads"].size() == 3);
    }
    CHECK_THAT(read(f.at("out/motion.toml")), Contains("[reposition.knee]\nphi_deg = -45"));
  }
  SECTION("an atlas keeps them, and risk counts them") {
    done(f, {"atlas", "parts.toml", "--actuator", kTable2, "--height", "0.3:0.4:2", "--speed", "0:0.63:2",
             "--pitch-deg", "10:18:2", "--evaluations", "60", "--no-report", "-o", "atlas"});
    const Arguments ask = {"atlas", "--ask", "atlas", "--height", "0.35", "--speed", "0.3", "--pitch-deg", "15"};
    CHECK_THAT(done(f, ask + kOut).out, Contains("of the rating"));
    CHECK_THAT(
        done(f, {"risk", "parts.toml", "--actuator", kTable2, "--hold", "-45", "--samples", "100", "-o", "out"}).out,
        Contains("the load thigh is beyond 60 m/s^2"));
  }
  SECTION("trade and robot take it without loads too") {
    done(f, {"trade", kPaper, "--actuator", kTable2, "--vary", "drive.knee.k_sea=50:200:2", "--evaluations", "60",
             "--no-report", "-o", "out"});
    CHECK(summary(f)["points"].size() == 2);
    CHECK_THAT(done(f, {"robot", kPaper, "--actuator", kTable2, "-o", "out"}).out,
               Contains("shank") && Contains("foot"));
  }
  SECTION("what it does not know") {
    f.write("bad.toml", read(kPaper) + "\n" + replaced(kKnee, "\"knee\"\nkind", "\"hip\"\nkind") +
                            replaced(kFoot, "contact = \"foot\"", "contact = \"toe\""));
    check_refused(f, Arguments{"simulate", "bad.toml", "--actuator", kTable2} + kOut, {"bad.toml:", "toe", "foot"});
    check_refused(f, Arguments{"simulate", "parts.toml"} + kOut, {"[drive.knee]", "--actuator knee=FILE"});
  }
}

TEST_CASE("simulate tells every load, its time and which binds, and nothing without [[load]] is told") {
  const Folder f;
  write_scene(f, kAcceleration + kKnee + kFoot + kNoTouch);
  const Result r = done(f, {"simulate", "scene.toml", "-o", "out"});
  CHECK_THAT(r.out, Contains("value / rating") && Contains("binds") && Contains("limit, holds"));
  const Json s = summary(f);
  REQUIRE(s["loads"].size() == 4);
  CHECK(s["loads"][0]["value"] == s["peak_acceleration"]);
  CHECK(s["loads"][0]["time"] == s["peak_time"]);
  CHECK(s["loads"][0]["binds"] == true);
  CHECK(s["loads"][1]["of"] == "knee");
  CHECK(s["loads"][1]["value"].get<double>() > 0);
  CHECK(s["loads"][2]["ratio"].get<double>() == Approx(s["loads"][2]["value"].get<double>() / 150));
  CHECK(s["loads"][2]["ratio"].get<double>() > 1);
  CHECK(s["loads"][3]["value"] == 0);
  CHECK_THAT(read(f.at("out/report.html")), Contains("Loads"));
  done(f, {"simulate", dataset("scenes/hopper.toml"), "-o", "plain"});
  CHECK_FALSE(summary(f, "plain").contains("loads"));
  CHECK(summary(f, "plain")["peak_acceleration"] == s["peak_acceleration"]);
}

TEST_CASE("risk of a scene with loads is of the peak, and tells loads beyond their ratings") {
  const Folder f;
  write_scene(f, kAcceleration + replaced(kFoot, "rating = 150", "rating = 10"));
  const Result r = done(f, {"risk", "scene.toml", "--samples", "100", "-o", "out"});
  CHECK_THAT(r.out, Contains("peak |a| [m/s^2]") && !Contains("of the rating"));
  CHECK_THAT(read(f.at("out/report.html")), Contains("beyond 10 N in 100.0 %") && !Contains("largest load"));
}

TEST_CASE("a drive that is clamped at its rating keeps it") {
  const Folder f;
  const std::string robot = read(dataset("robots/hopper.toml"));
  f.write("hopper.toml",
          replaced(replaced(robot, "tau_max = 12", "tau_max = 12\nmotor_torque_max = 12"), "k_p = 50", "k_p = 1e7"));
  f.write("scene.toml", replaced(read(dataset("scenes/hopper.toml")), "\"../robots/hopper.toml", "\"hopper.toml"));
  CHECK_THAT(done(f, {"simulate", "scene.toml", "-o", "out", "--no-report"}).err, !Contains("rated 12 Nm"));
}

TEST_CASE("optimize plans for loads and keeps those that are limits, by a deadline and under scatter too") {
  const Folder f;
  write_scene(f, replaced(kAcceleration, "rating = 1", "rating = 40") + kFoot + kNoTouch);
  const Result r =
      done(f, {"optimize", "scene.toml", "--evaluations", "300", "--seed", "3", "-o", "out", "--no-report"});
  CHECK_THAT(r.err + r.out, Contains("largest value / rating"));
  const Json s = summary(f);
  REQUIRE(s["loads"].size() == 3);
  CHECK(s["value"].get<double>() ==
        Approx(std::max(s["loads"][0]["ratio"].get<double>(), s["loads"][1]["ratio"].get<double>())));
  CHECK(s["value"].get<double>() < s["hold"]["value"].get<double>());
  CHECK(s["loads"][2]["value"] == 0);
  CHECK(s["hold"]["loads"].size() == 3);
  done(f, {"optimize", "scene.toml", "--deadline", "0.5", "-o", "quick"});
  CHECK(summary(f, "quick")["value"].get<double>() <= s["hold"]["value"].get<double>());  // on a busy machine too
  done(f, {"optimize", "scene.toml", "--deadline", "2", "-o", "quick"});
  CHECK(summary(f, "quick")["value"].get<double>() < s["hold"]["value"].get<double>());
  const Result robust = done(f, {"optimize", "scene.toml", "--robust", "mean", "--share", "0.9", "--scatter",
                                 "height=0.02", "--samples", "16", "--evaluations", "2000", "-o", "robust"});
  CHECK_THAT(robust.out,
             Contains("limits hold in") && Contains("foot: is beyond 150 N in ") && Contains("hull: touches in "));
  CHECK(summary(f, "robust")["robust"]["share"] == 0.9);
  const double kept = summary(f, "robust")["robust"]["share_kept"];
  CHECK(kept == 1 - summary(f, "robust")["scatter"]["broken"].get<double>() / 2048);
  const std::string words = fmt::format("limits hold in {:.2f} % of 2048 fresh drops; asked 90 %", 100 * kept);
  CHECK_THAT(robust.out, Contains(words));
  CHECK_THAT(read(f.at("robust/report.html")), Contains(words) && Contains("keeps its limits under scatter"));
  CHECK(summary(f, "robust")["scatter"]["loads"].contains("hull"));
  done(f, {"risk", "scene.toml", "--motion", "out/motion.toml", "--samples", "128", "-o", "risk", "--no-report"});
  CHECK(summary(f, "risk")["ratings"].contains("load_foot"));
}

TEST_CASE("a share that is asked for by a deadline is judged on fresh drops in a part of it, or said not to be") {
  const Folder f;
  write_scene(f, kFoot + kNoTouch);
  const Arguments plan = {"optimize", "scene.toml", "--robust", "mean", "--share", "0.9", "--scatter", "height=0.02"};
  done(f, plan + Arguments{"--deadline", "4", "-o", "out"});
  const Json s = summary(f);
  REQUIRE(s["robust"]["share_kept"].is_number());
  CHECK(s["scatter"]["planned"]["samples"].get<int>() >= 128);
  CHECK_THAT(read(f.at("out/report.html")), Contains("limits hold in"));
  const std::string words = "not judged on fresh drops: the deadline left no time; asked 90 %";
  const Result quick = done(f, plan + Arguments{"--deadline", "0.02", "-o", "quick"});
  CHECK_THAT(quick.out, Contains(words));
  CHECK(summary(f, "quick")["robust"]["share_kept"].is_null());
  CHECK_THAT(read(f.at("quick/report.html")), Contains(words));
}

TEST_CASE("limits of the paper's scene are kept in a share of its drops too") {
  const Folder f;
  const Arguments plan = {"optimize",      dataset("scenes/paper.toml"),
                          "--actuator",    dataset("actuators/table2.toml"),
                          "--robust",      "mean",
                          "--forbid",      "hip",
                          "--scatter",     "height=0.02",
                          "--samples",     "16",
                          "--evaluations", "3000"};
  const Result r = done(f, plan + Arguments{"--share", "0.9", "-o", "out"});
  CHECK_THAT(r.out, Contains("limits hold in"));
  CHECK_THAT(read(f.at("out/report.html")), Contains("limits hold in") && Contains("asked 90 %"));
  const Json s = summary(f);
  CHECK(s["robust"]["share"] == 0.9);
  CHECK(s["value"].get<double>() < s["hold"]["value"].get<double>());
  done(f, {"simulate", dataset("scenes/paper.toml"), "--actuator", dataset("actuators/table2.toml"), "--motion",
           "out/motion.toml", "-o", "played", "--no-report"});
  CHECK(summary(f, "played")["peak_acceleration"].get<double>() ==
        Approx(s["peak_acceleration"].get<double>()).epsilon(1e-4));
  check_refused(f, plan + Arguments{"--share", "0.9", "--penalty", "500"} + kOut, {"--penalty", "--share"});
}

TEST_CASE("where no motion keeps the loads that are limits, the one that breaks them least is told") {
  const Folder f;
  write_scene(f, replaced(kKnee, "rating = 12", "rating = 0.5\nlimit = true"));
  const Arguments plan = {"optimize", "scene.toml", "--evaluations", "300", "-o", "out"};
  const Result r = run(plan, f.at(""));
  CHECK(r.code == 1);
  CHECK_THAT(r.err, Contains("breaks them least") && Contains("torque of knee is") && Contains("the 0.5 allowed"));
  const Json s = summary(f), least = s["least_breaking"];
  CHECK(s["motion"].is_null());
  CHECK(least["load"] == "knee");
  CHECK(least["limit"] == 0.5);
  CHECK(least["demand"].get<double>() > 0.5);
  CHECK(least["motion"].contains("hip"));
  // Contacts that must not touch cannot be broken by degrees.
  std::string touches;
  for (const std::string contact : {"foot", "knee", "slider"})
    touches += "[[load]]\nname = \"" + contact + "\"\nkind = \"touch\"\ncontact = \"" + contact + "\"\n";
  write_scene(f, touches);
  const Result touching = run(plan, f.at(""));
  CHECK(touching.code == 1);
  CHECK_FALSE(summary(f).contains("least_breaking"));
}

TEST_CASE("trade --pareto shows what one load costs in another") {
  const Folder f;
  write_scene(f, kKnee);
  const Result front =
      done(f, {"trade", "scene.toml", "--pareto", "peak,knee:3", "--evaluations", "1500", "-o", "front"});
  CHECK_THAT(front.out, Contains("m/s^2 with knee at most") && Contains("m/s^2 with at most"));
  const Json points = summary(f, "front")["points"];
  REQUIRE(points.size() == 3);
  CHECK(points[0]["planned"].get<double>() >= points[2]["planned"].get<double>());
  const Arguments base = {"trade", "scene.toml", "--pareto", "peak,knee:3", "--evaluations", "400"};
  for (const std::string k : {"1", "2"}) done(f, base + Arguments{"--shard", k + "/2", "-o", "s" + k});
  done(f, base + Arguments{"--merge", "s1", "s2", "-o", "all"});
  CHECK(summary(f, "all")["points"].size() == 3);
  CHECK(summary(f, "all")["plans"].get<int>() < summary(f, "s1")["plans"].get<int>());  // the ends are known
  const Interrupted early =
      interrupted_after(0.2, {"trade", "scene.toml", "--pareto", "peak,knee", "-o", "early"}, f.at(""));
  CHECK(early.code == 130);
  CHECK(summary(f, "early")["points"].empty());
  check_refused(f, {"trade", "scene.toml", "--pareto", "peak,nee"}, {"--pareto: 'nee'", "knee"});
  check_refused(f, {"trade", "scene.toml", "--pareto", "knee"}, {"--pareto: 'knee': A,B"});
}

TEST_CASE("an atlas of a scene with loads holds the largest as a part of its rating") {
  const Folder f;
  write_scene(f, kKnee);
  const Arguments atlas = {"atlas", "scene.toml", "--height", "0.2:0.4:3", "--evaluations", "400"};
  const Result r = done(f, atlas + Arguments{"-o", "out"});
  CHECK_THAT(r.out, Contains("of the rating"));
  CHECK_THAT(read(f.at("out/atlas.csv")), Contains("[of the rating]"));
  CHECK_THAT(done(f, {"atlas", "--ask", "out", "--height", "0.3", "-o", "asked"}).out, Contains("of the rating"));
  const Json asked = summary(f, "asked");
  CHECK(asked["goal"].get<double>() <= 1);
  done(f,
       {"simulate", "scene.toml", "--motion", "asked/motion.toml", "--height", "0.3", "-o", "played", "--no-report"});
  CHECK(summary(f, "played")["loads"][0]["ratio"].get<double>() == Approx(asked["goal"].get<double>()).epsilon(1e-4));
}

TEST_CASE("an atlas keeps forbidden contacts and ratings, of the paper's robot too, and its scene says them") {
  const Folder f;
  f.write("robot.toml", read(dataset("robots/hopper.toml")) + "speed_max = 2\nmotor_torque_max = 11\n");
  f.write("scene.toml", replaced(read(dataset("scenes/hopper.toml")), "\"../robots/hopper.toml", "\"robot.toml") +
                            "\n[joint.knee]\nphi_deg = [-150, -20]\n" + kKnee);
  const Arguments links = {"atlas", "scene.toml", "--height", "0.2:0.3:2", "--evaluations", "400"},
                  paper = {"atlas",         dataset("scenes/paper.toml"),
                           "--actuator",    dataset("actuators/table2.toml"),
                           "--height",      "0.2:0.3:2",
                           "--speed",       "0:0.2:2",
                           "--pitch-deg",   "16:18:2",
                           "--evaluations", "400"};
  for (const auto& [name, base, forbidden] : {std::tuple("links", links, "slider"), {"paper", paper, "hip"}}) {
    INFO(name);
    const std::string of = name;
    const Arguments limits = {"--forbid", forbidden, "--respect-ratings"};
    done(f, base + limits + Arguments{"--shard", "1/1", "-o", of + "1"});
    done(f, {"atlas", "--merge", of + "1", "-o", of});
    done(f, {"atlas", "--ask", of, "--height", "0.3", "-o", of + "_asked"});  // a drop of the grid
    CHECK(summary(f, of + "_asked")["found"] == true);
    done(f, {"simulate", of + "/scene.toml", "--height", "0.3", "--motion", of + "_asked/motion.toml", "-o", "played",
             "--no-report"});
    std::set<std::string> kept;
    const Json loads = summary(f, "played")["loads"];
    for (const Json& l : loads)
      if (l["limit"]) {
        INFO(l.dump());
        CHECK(l["value"] <= l["rating"]);
        kept.insert(l["load"].get<std::string>());
      }
    for (const std::string limit : {"knee.motor_speed", "knee.reference_rate", "knee.motor_torque"})
      CHECK(kept.count(limit) == 1);
    CHECK(kept.count(forbidden + std::string(".touch")) == 1);
  }
  // Without them the same table has a faster motion somewhere.
  done(f, links + Arguments{"-o", "free"});
  double fastest = 0;
  for (const std::string height : {"0.2", "0.3"}) {
    done(f, {"atlas", "--ask", "free", "--height", height, "-o", "free_asked"});
    done(f, {"simulate", "links/scene.toml", "--height", height, "--motion", "free_asked/motion.toml", "-o", "played",
             "--no-report"});
    const Json loads = summary(f, "played")["loads"];
    for (const Json& l : loads)
      if (l["load"] == "knee.motor_speed") fastest = std::max(fastest, l["value"].get<double>());
  }
  CHECK(fastest > 2);
  check_refused(f, {"atlas", "--ask", "links", "--forbid", "slider"}, {"--ask: ", "--forbid"});
  check_refused(f, {"atlas", "--merge", "links1", "--respect-ratings"}, {"--merge: --respect-ratings has no effect"});
  check_refused(f, links + Arguments{"--forbid", "sldier"}, {"--forbid: ", "slider"});
  f.write("named.toml", read(f.at("scene.toml")) + replaced(kKnee, "\"knee\"", "\"slider.touch\""));
  check_refused(f, {"atlas", "named.toml", "--height", "0.2:0.3:2", "--forbid", "slider"},
                {"--forbid", "'slider.touch': a load of the scene has this name"});
}

TEST_CASE("limits are loads, however they are said: of stops, ratings and contacts that must not touch") {
  const Folder f;
  const std::string robot = read(dataset("robots/hopper.toml")) + "speed_max = 6\nmotor_torque_max = 11\n";
  f.write("robot.toml", robot);
  f.write("scene.toml", replaced(read(dataset("scenes/hopper.toml")), "\"../robots/hopper.toml", "\"robot.toml") +
                            "\n[joint.knee]\nphi_deg = [-150, -20]\n" + kKnee);
  done(f, {"optimize", "scene.toml", "--respect-ratings", "--forbid", "slider", "--evaluations", "1000", "-o", "out"});
  const Json loads = summary(f)["loads"];
  std::vector<std::string> names;
  for (const Json& l : loads) {
    names.push_back(l["load"]);
    INFO(l.dump());
    if (l["limit"]) CHECK(l["value"] <= l["rating"]);
  }
  CHECK(names == std::vector<std::string>{"knee", "knee.angle", "slider.touch", "knee.motor_speed",
                                          "knee.reference_rate", "knee.motor_torque"});
  CHECK(loads[4]["rating"] == 6);
  CHECK(loads[4]["value"].get<double>() == Approx(summary(f)["joints"]["knee"]["peak_reference_rate"].get<double>()));
  // Without them the same scene has other plans; a limit that is broken is told by simulate.
  const Result r = done(f, {"simulate", "scene.toml", "--hold", "hip=35,knee=-15", "-o", "held"});
  CHECK_THAT(r.err, Contains("the load knee.angle is beyond its limit: ") && Contains("rad outside of its range"));
  write_scene(f, replaced(kNoTouch, "slider", "foot"));
  CHECK_THAT(done(f, {"simulate", "scene.toml", "-o", "touches"}).err,
             Contains("the load hull is beyond its limit: foot touches"));
}

TEST_CASE("map of a scene with loads shows the largest, and leaves out what breaks a limit") {
  const Folder f;
  write_scene(f, "[joint.knee]\nphi_deg = [-100, -10]\n" + kKnee + kFoot);
  const Result r = done(f, {"map", "scene.toml", "--vary", "phi_i_knee:9,phi_f_knee:7", "--polish", "2", "-o", "out"});
  const Json s = summary(f);
  CHECK(s["broken"] > 0);
  CHECK(s["failed"] == 0);
  CHECK_THAT(r.err, Contains("landings break a limit: they are left out"));
  CHECK_THAT(r.out, Contains("of the rating"));
  const Json& best = s["basins"][0];
  CHECK(best["largest_load"].get<double>() <= s["minima"][0]["largest_load"].get<double>() * (1 + 1e-4));
  std::string toml;
  for (const char* joint : {"hip", "knee"}) {
    const Json& m = best["motion"][joint];
    toml += std::string("[motion.") + joint + "]\nphi_i_deg = " + m["phi_i_deg"].dump() +
            "\nphi_f_deg = " + m["phi_f_deg"].dump() + "\nduration = " + m["duration"].dump() + "\n";
  }
  f.write("best.toml", toml);
  done(f, {"simulate", "scene.toml", "--motion", "best.toml", "--no-report", "-o", "one"});
  double largest = 0;
  const Json loads = summary(f, "one")["loads"];
  for (const Json& l : loads)
    if (l["limit"])
      CHECK(l["value"] <= l["rating"]);
    else
      largest = std::max(largest, l["ratio"].get<double>());
  CHECK(best["largest_load"].get<double>() == Approx(largest).epsilon(1e-6));
}

TEST_CASE("compare of a scene with loads plans for them with either set, and tells the largest with the other") {
  const Folder f;
  const std::string three = read(dataset("scenes/three_links.toml"));
  f.write("scene.toml",
          replaced(three, "\"../robots/three_links.toml", "\"" + dataset("robots/three_links.toml")) + "\n" + kKnee +
              replaced(kAcceleration, "link = \"slider\"\nat = [0, 0]\nrating = 1", "link = \"thigh\"\nrating = 100"));
  f.write("softer.toml", replaced(read(kTable2), "k_sea = 65", "k_sea = 120"));
  const Result r = done(f, {"compare", "--scene", "scene.toml", "--nominal", "hip=softer.toml", "--identified",
                            "hip=" + kTable2, "--evaluations", "300", "--robust", "mean", "-o", "out"});
  CHECK_THAT(r.out, Contains("Planned with the nominal constants, the robot with the identified ones has") &&
                        Contains("of the rating"));
  const Json s = summary(f);
  const Json m = s["motions"]["nominal"];
  std::string toml;
  for (const char* joint : {"hip", "knee"})
    toml += std::string("[motion.") + joint + "]\nphi_i_deg = " + m[joint]["phi_i_deg"].dump() +
            "\nphi_f_deg = " + m[joint]["phi_f_deg"].dump() + "\nduration = " + m[joint]["duration"].dump() + "\n";
  f.write("motion.toml", toml);
  done(f, {"simulate", "scene.toml", "--actuator", "hip=" + kTable2, "--motion", "motion.toml", "--no-report", "-o",
           "one"});
  double largest = 0;
  const Json loads = summary(f, "one")["loads"];
  for (const Json& l : loads) largest = std::max(largest, l["ratio"].get<double>());
  CHECK(s["peaks"]["nominal_motion"]["identified"].get<double>() == Approx(largest).epsilon(1e-9));
  CHECK(s["plans"].size() == 2);
}

TEST_CASE(
    "a report's first screen says in which share of the drops the limits hold, and has no tick where some break") {
  const Folder f;
  const auto screen = [&](const std::string& folder) {
    const std::string page = read(f.at(folder + "/report.html"));
    const std::size_t from = page.find("<section class=\"answer\">");
    REQUIRE(from != std::string::npos);
    return page.substr(from, page.find("</section>", from) - from);
  };
  const auto words = [](double kept, const std::string& drops) {
    return fmt::format("keeps its limits under scatter: {}</b> — limits hold in {:.2f} % of {}",
                       kept == 1 ? "yes" : "no", 100 * kept, drops);
  };
  const auto risk = [&](Arguments arguments) {
    done(f, Arguments{"risk"} + arguments + Arguments{"--samples", "256", "-o", "risk"});
    const Json s = summary(f, "risk");
    const double kept = s["share_kept"];
    CHECK_THAT(screen("risk"), Contains(words(kept, "256 drops")));
    return kept;
  };
  write_scene(f, replaced(kFoot, "150", "350\nlimit = true"));
  const Arguments falls = {"--scatter", "height=0.2"};
  const double some = risk(Arguments{"scene.toml"} + falls);
  CHECK((some > 0 && some < 1));
  CHECK(risk({"scene.toml", "--scatter", "height=0.001"}) == 1);
  done(f, Arguments{"optimize", "scene.toml", "--evaluations", "60", "-o", "plan"} + falls);
  const double broken = summary(f, "plan")["scatter"]["broken"];
  CHECK(broken > 0);
  CHECK_THAT(screen("plan"), Contains(words(1 - broken / 2048, "2048 fresh drops")) &&
                                 Contains("keeps its limits in its own drop: yes"));
  // The paper's robot: forbidden points, stops, ratings.
  f.write("motion.toml", "[motion]\nphi_i_deg = -24.4\nphi_f_deg = -85\nduration = 0.261\n");
  const Arguments motion = {"--actuator", kTable2, "--motion", "motion.toml"},
                  paper = Arguments{dataset("scenes/paper.toml")} + motion;
  CHECK(risk(paper + Arguments{"--forbid", "foot"}) == 0);
  const double hip = risk(paper + Arguments{"--forbid", "hip"});
  CHECK((hip > 0.9 && hip < 1));
  CHECK(hip == 1 - summary(f, "risk")["forbidden"]["hip"]["share"].get<double>());
  CHECK_THAT(screen("risk"), Contains("within ratings: no</b> — the motor turns faster than 3.14 rad/s in 100.0 %"));
  f.write("stops.toml", read(dataset("scenes/paper.toml")) + "\n[joint]\nphi_deg = [-103, 30]\n");
  const Arguments stops = Arguments{"stops.toml"} + motion;
  const double within = risk(stops);
  CHECK((within > 0 && within < 1));
  CHECK(within == 1 - summary(f, "risk")["ratings"]["joint"]["share"].get<double>());
  const double both = risk(stops + Arguments{"--forbid", "hip"});
  CHECK((both <= std::min(within, hip) && both >= within + hip - 1));
}

TEST_CASE(
    "optimize of a robot of links says how its plan does under the scatter that is assumed, as the paper's does") {
  const Folder f;
  const std::string says = "under scatter (pitch_deg=1,height=0.01,forward_speed=0.03; assumed; ";
  const Arguments few = {"--evaluations", "100", "--no-report", "-o", "out"};
  CHECK_THAT(done(f, Arguments{"optimize", dataset("scenes/paper.toml"), "--actuator", kTable2} + few).out,
             Contains(says + "4096 fresh drops): mean "));
  CHECK_THAT(done(f, Arguments{"optimize", dataset("scenes/three_links.toml")} + few).out,
             Contains(says + "2048 fresh drops): mean "));
  CHECK(summary(f)["scatter"]["assumed"] == true);
  CHECK_THAT(done(f, Arguments{"optimize", dataset("scenes/hopper.toml")} + few).out,
             Contains("under scatter (pitch_deg=1,height=0.01; assumed; "));
}

TEST_CASE("the tolerant peak has one name for both kinds of robot, and what else is minimised is `value`") {
  const Folder f;
  const Arguments few = {"--evaluations", "100", "--no-report", "-o", "out"};
  done(f, Arguments{"optimize", dataset("scenes/hopper.toml"), "--objective", "tolerant"} + few);
  const Json s = summary(f);
  CHECK(s["tolerant_peak"] == s["value"]);
  CHECK(s["hold"]["tolerant_peak"] == s["hold"]["value"]);
  CHECK(s["tolerant_peak"].get<double>() >= s["peak_acceleration"].get<double>());
  done(f, Arguments{"optimize", dataset("scenes/hopper.toml")} + few);
  CHECK_FALSE(summary(f).contains("value"));
}

TEST_CASE("a map of landings that break a limit does not say that they could not be followed") {
  const Folder f;
  write_scene(f, replaced(kNoTouch, "slider\"\n", "foot\"\n"));
  const Result all = run({"map", "scene.toml", "--vary", "phi_i_knee:4", "-o", "out"}, f.at(""));
  CHECK(all.code == 1);
  CHECK_THAT(all.err,
             Contains("4 of 4 landings break a limit") && Contains("no landing of the grid keeps every limit"));
  CHECK(all.err.find("followed") == std::string::npos);
  CHECK(summary(f)["failed"] == 0);
}

TEST_CASE("messages of ratings, --pareto and compare name the option that was given") {
  const Folder f;
  write_scene(f, kKnee + kNoTouch);
  const auto refused = [&](const Arguments& arguments, const std::vector<std::string>& words) {
    check_refused(f, arguments + kOut, words);
  };
  for (const char* range : {"3:1:3", "1:3:1", "a:1:3", "0:1:3", "1:3"}) {
    refused({"ratings", "scene.toml", "--motor-speed", range}, {"ukemi: --motor-speed: "});
    refused({"ratings", "scene.toml", "--motor-speed", "1:3:3", "--motor-torque", range}, {"ukemi: --motor-torque: "});
  }
  for (const char* front : {"x,knee", "peak,x", "peak,hull", "peak,peak", "peak,knee:1", "peak,knee:x", "peak"})
    refused({"trade", "scene.toml", "--pareto", front}, {"ukemi: --pareto: "});
  refused({"trade", "scene.toml", "--pareto", "peak,knee:x"}, {"N of designs from 2 to 1000"});
  for (const char* verb : {"trade", "atlas"}) {
    CHECK(run({verb, "--help"}, f.at("")).out.find("--drops") == std::string::npos);
    refused({verb, "scene.toml", "--drops", "x.csv"}, {"--drops"});
  }
  const Arguments same = {"--identified", kTable2};
  refused(Arguments{"compare", "--nominal", "knee=" + kTable2} + same, {"--nominal: knee=", "whose --scene is needed"});
  refused({"compare", "--nominal", kTable2, "--identified", "knee=" + kTable2}, {"--identified: knee=", "--scene"});
}
