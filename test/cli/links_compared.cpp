// Robots of links under two sets of constants, and on a grid: compare and map.
#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "test/cli/refused.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

const std::string kHopper = dataset("scenes/hopper.toml"), kThree = dataset("scenes/three_links.toml");

/// An actuator with another spring and gain than Table 2, in the folder.
std::string softer(const Folder& f) {
  return f.write("softer.toml",
                 "[actuator]\nname = \"softer\"\nk_p = 40\nk_d = 1\nk_sea = 120\nc_sea = 1.6\n"
                 "i_motor = 0.085\n");
}

}  // namespace

TEST_CASE("compare plays the best motions of a robot of links under both sets of a drive's constants") {
  const Folder f;
  softer(f);
  const Arguments compare = {"compare",
                             "--scene",
                             kThree,
                             "--nominal",
                             "hip=softer.toml",
                             "--identified",
                             "hip=" + kTable2,
                             "--evaluations",
                             "300",
                             "--seed",
                             "2",
                             "-o",
                             "out"};
  const Result r = done(f, compare);
  const Json s = summary(f);
  CHECK(s["parameters"]["k_p_hip"]["nominal"] == 40);
  CHECK(s["parameters"]["k_p_hip"]["identified"] == 50);
  CHECK(s["parameters"]["k_sea_hip"]["difference_percent"].get<double>() == Approx(100 * (65.0 / 120 - 1)));
  CHECK(!s["parameters"].contains("k_p_knee"));  // the same drive in both
  CHECK_THAT(r.out, Contains("Planned with the nominal constants, the robot with the identified ones hits with"));
  // Each cell of the table is the peak that simulate finds.
  for (const char* of : {"nominal", "identified"}) {
    const Json m = s["motions"][of];
    std::string toml;
    for (const char* joint : {"hip", "knee"})
      toml += std::string("[motion.") + joint + "]\nphi_i_deg = " + m[joint]["phi_i_deg"].dump() +
              "\nphi_f_deg = " + m[joint]["phi_f_deg"].dump() + "\nduration = " + m[joint]["duration"].dump() + "\n";
    f.write("motion.toml", toml);
    for (const auto& [set, drive] :
         {std::pair{"nominal", std::string("hip=softer.toml")}, {"identified", "hip=" + kTable2}}) {
      done(f, {"simulate", kThree, "--actuator", drive, "--motion", "motion.toml", "--no-report", "-o", "one"});
      CHECK(s["peaks"][std::string(of) + "_motion"][set].get<double>() ==
            Approx(summary(f, "one")["peak_acceleration"].get<double>()).epsilon(1e-9));
    }
    // A set's own best is the plan that optimize finds with these drives.
    done(f, {"optimize", kThree, "--actuator", of == std::string("nominal") ? "hip=softer.toml" : "hip=" + kTable2,
             "--evaluations", "300", "--seed", "2", "--no-report", "-o", "best"});
    CHECK(summary(f, "best")["peak_acceleration"] == s["peaks"][std::string(of) + "_motion"][of]);
  }
  const std::string rows = read(f.at("out/trajectories.csv")), page = read(f.at("out/report.html"));
  CHECK_THAT(rows, Contains("set,t,acc,phi_hip,phi_ref_hip,phi_knee,phi_ref_knee") && Contains("\nidentified,0,"));
  CHECK_THAT(page, Contains("Peak |a| on three_links") && Contains("planned with the nominal constants"));
}

TEST_CASE("compare plans for scatter with both sets of a robot of links, judged with the identified one") {
  const Folder f;
  softer(f);
  f.write("fit.toml",
          replaced(read(kTable2), "[actuator]",
                   "[uncertainty]\norder = [\"k_p\", \"k_sea\"]\ncovariance = [[4, 0], [0, 9]]\n[actuator]"));
  done(f, {"compare", "--scene", kHopper, "--nominal", "hip=softer.toml", "--identified", "hip=fit.toml", "--robust",
           "mean", "--evaluations", "800", "--no-report", "-o", "out"});
  const Json plans = summary(f)["plans"], k_p = summary(f)["parameters"]["k_p_hip"];
  CHECK(k_p["z"].get<double>() == Approx((50.0 - 40.0) / 2));
  CHECK(k_p["inside_ci95"] == false);
  REQUIRE(plans.size() == 3);
  CHECK(plans[2]["set"] == "identified, with its covariance");
  CHECK(plans[0]["set"] == "nominal");
  CHECK(plans[1]["truth"]["samples"] == 2048);
  CHECK(plans[1]["truth"]["mean"].get<double>() == Approx(plans[1]["promised"].get<double>()).epsilon(0.05));

  f.write("drops.csv", "height\n0.3\n0.33\n0.28\n");
  done(f, {"compare", "--scene", kHopper, "--nominal", "hip=softer.toml", "--identified", "hip=fit.toml", "--robust",
           "mean", "--drops", "drops.csv", "--evaluations", "800", "--no-report", "-o", "measured"});
  const Json of_measured = summary(f, "measured")["plans"];
  REQUIRE(of_measured.size() == 2);  // no covariance scatters them
  CHECK(of_measured[1]["truth"]["samples"] == 3);
  CHECK(of_measured[1]["truth"]["mean"].get<double>() ==
        Approx(of_measured[1]["promised"].get<double>()).epsilon(1e-6));
}

TEST_CASE("compare of a robot of links refuses what is no drive of it, in one line") {
  const Folder f;
  softer(f);
  const auto refused = [&](const Arguments& more, const std::vector<std::string>& words) {
    check_refused(f, Arguments{"compare", "--scene", kHopper} + more, words);
  };
  const Arguments both = {"--nominal", "hip=softer.toml", "--identified", "hip=" + kTable2};
  refused({"--nominal", "hop=softer.toml", "--identified", "hip=" + kTable2}, {"--nominal: 'hop'", "\"hip\""});
  refused({"--nominal", "hip=softer.toml", "--identified", kTable2}, {"--identified: ", "JOINT=FILE is needed"});
  refused({"--nominal", "hip=none.toml", "--identified", "hip=" + kTable2}, {"none.toml"});
  refused(both + Arguments{"--trials", "a.csv", "--rig", "b.toml"}, {"--trials, --rig: ", "leave --scene out"});
  refused(both + Arguments{"--robust", "mean", "--drops", "a.csv"}, {"a.csv"});
  f.write("drops.csv", "height\n0.3\n");
  refused(both + Arguments{"--robust", "mean", "--drops", "drops.csv", "--scatter", "height=0.1"},
          {"--scatter", "--drops"});
  refused(both + Arguments{"--evaluations", "0"}, {"evaluations: 0: 1 to"});
  check_refused(f, {"compare", "--nominal", "softer.toml", "--nominal", "softer.toml", "--identified", kTable2},
                {"--nominal: ", "one file is needed"});
}

TEST_CASE("compare shows every constant that differs, and doubts landings that a simulation would doubt") {
  const Folder f;
  const std::string drive =
      "[actuator]\nname = \"knee\"\nk_p = 50\nk_d = 1\nk_sea = 65\nc_sea = 1.6\n"
      "i_motor = 0.085\ntau_max = 20\n";
  f.write("plain.toml", drive), f.write("late.toml", drive + "control_delay = 0.02\n");
  const auto compared = [&](const std::string& identified, const char* evaluations) {
    done(f, {"compare", "--scene", kThree, "--nominal", "knee=plain.toml", "--identified", "knee=" + identified,
             "--evaluations", evaluations, "--no-report", "-o", "out"});
    return summary(f);
  };
  const Json s = compared("late.toml", "200");
  CHECK(s["parameters"]["control_delay_knee"]["identified"] == 0.02);
  CHECK(s["parameters"]["control_delay_knee"]["difference_percent"].is_null());
  CHECK_FALSE(s["parameters"].contains("k_p_hip"));
  CHECK(warned(s, "best for nominal, with identified: knee: the drive is unstable"));
  CHECK(warned(s, "best for nominal, with identified: joint hip turns from"));
  // Of so short a search the motion of the nominal set is the better one for both.
  f.write("rubs.toml", drive + "friction = 0.3\n");
  const Json rubs = compared("rubs.toml", "250");
  const double own = rubs["peaks"]["identified_motion"]["identified"],
               other = rubs["peaks"]["nominal_motion"]["identified"];
  REQUIRE(other < 0.99 * own);
  CHECK(warned(rubs, "the motion planned with the nominal constants is better with the identified ones"));
}

TEST_CASE("map plays a robot of links over a grid of some variables, the others as a motion has them") {
  const Folder f;
  f.write("slice.toml",
          "[motion.hip]\nphi_i_deg = 40\nphi_f_deg = 60\nduration = 0.3\n"
          "[motion.knee]\nphi_i_deg = -80\nphi_f_deg = -60\nduration = 0.3\n");
  const Arguments map = {"map",     kHopper,      "--vary",   "phi_i_hip:7,phi_f_knee:5",
                         "--slice", "slice.toml", "--polish", "2"};
  const Result r = done(f, map + Arguments{"-o", "out"});
  const Json s = summary(f);
  CHECK(s["grid"] == Json({7, 1, 1, 5, 1}));
  CHECK(s["landings"] == 35);
  const double lowest = s["minima"][0]["peak_acceleration"], best = s["basins"][0]["peak_acceleration"];
  CHECK(best <= lowest * (1 + 1e-4));
  CHECK_THAT(r.out, Contains("35 landings") && Contains("lowest of the grid"));
  std::istringstream rows(read(f.at("out/map.csv")));
  std::string line;
  while (std::getline(rows, line) && line[0] == '#') {
  }
  CHECK(line == "phi_i_hip_deg,phi_f_hip_deg,phi_i_knee_deg,phi_f_knee_deg,duration,peak,peak_contact,contacts");
  double least = 1e9;
  int count = 0;
  for (; std::getline(rows, line); ++count) {
    std::istringstream cells(line);
    std::vector<double> values;
    std::string cell;
    while (values.size() < 7 && std::getline(cells, cell, ',')) values.push_back(std::stod(cell));
    REQUIRE(values.size() == 7);
    CHECK(values[6] >= 1);  // a touchdown before the peak
    std::getline(cells, cell);
    CHECK(cell.starts_with("foot"));
    CHECK(values[1] == Approx(60));
    CHECK(values[2] == Approx(-80));
    CHECK(values[4] == Approx(0.3));
    least = std::min(least, values[5]);
  }
  CHECK(count == 35);
  CHECK(least == Approx(lowest));
  CHECK_THAT(read(f.at("out/report.html")), Contains("phi_F of knee") && Contains("Smallest peak"));
  CHECK_THAT(read(f.at("out/basins.csv")), Contains("phi_i_hip_deg") && Contains("tolerant_peak"));
  done(f, map + Arguments{"--threads", "1", "-o", "one"});
  CHECK(summary(f, "one")["basins"] == s["basins"]);
  const std::string released = replaced(read(kHopper), "\"../robots", "\"" + dataset("robots")) +
                               "\n[release]\nfrom = 0.02\n[release.hip]\nphi_deg = 30\n[release.knee]\nphi_deg = -60\n";
  f.write("released.toml", released);
  done(f, {"optimize", "released.toml", "--evaluations", "300", "--no-report", "-o", "moved"});
  done(f, {"map", "released.toml", "--vary", "to:5", "--slice", "moved/motion.toml", "--polish", "1", "-o", "moves"});
  CHECK_THAT(read(f.at("moves/map.csv")), Contains(",peak_contact,contacts"));
  check_refused(f, {"map", kHopper, "--vary", "phi_i_hip:9", "--slice", "moved/motion.toml", "-o", "none"},
                {"moved/motion.toml: joint 'hip' moves in the air"});
  done(f, {"map", kHopper, "--vary", "phi_i_hip:9", "--polish", "1", "-o", "line"});
  CHECK_THAT(read(f.at("line/report.html")), Contains("id=\"figure-map\""));
}

TEST_CASE("map of a robot of links refuses what it has no grid for, in one line") {
  const Folder f;
  const auto refused = [&](const Arguments& more, const std::vector<std::string>& words) {
    check_refused(f, Arguments{"map", kHopper} + more, words);
  };
  refused({}, {"--vary: 0 variables: one to three of phi_i_hip, phi_f_hip, phi_i_knee, phi_f_knee, duration"});
  refused({"--vary", "phi_i_hop"}, {"--vary: 'phi_i_hop': ", "did you mean \"phi_i_hip\"?"});
  refused({"--vary", "phi_i_hip:1"}, {"--vary: 'phi_i_hip': 1: ", "2 to 4096"});
  refused({"--vary", "phi_i_hip:2.5"}, {"--vary: 'phi_i_hip': 2.5: ", "2 to 4096"});
  refused({"--vary", "phi_i_hip,phi_i_hip"}, {"given twice"});
  refused({"--vary", "phi_i_hip,phi_f_hip,phi_i_knee,phi_f_knee"}, {"--vary: 4 variables: one to three"});
  refused({"--vary", "duration", "--grid", "4,4,4"}, {"--grid: ", "--vary"});
  refused({"--vary", "duration", "--release-phi", "3"}, {"--release-phi", "[release.JOINT]"});
  f.write("far.toml",
          "[motion.hip]\nphi_i_deg = 100\nphi_f_deg = 60\nduration = 0.3\n"
          "[motion.knee]\nphi_i_deg = -80\nphi_f_deg = -60\nduration = 0.3\n");
  refused({"--vary", "duration", "--slice", "far.toml"}, {"far.toml: phi_i_hip = 1.74533: 1.5708 is the nearest"});
  check_refused(f, {"map", kPaper, "--actuator", kTable2, "--vary", "phi_i"}, {"--vary: ", "--grid"});
}
