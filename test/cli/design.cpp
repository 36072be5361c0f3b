// ukemi design: the contract for scripts, and what it refuses.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "test/cli/refused.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

const Arguments kTwo = {"design", kTrial1, kTrial2, "--rig", kRig, "--actuator", kTable2};
const Arguments kNone = {"design", "--rig", kRig, "--noise", "5e-4"};
const Arguments kSmall = {"--hits", "1", "--check", "4", "--width", "0.02"};

void check_options(const Arguments& options, const std::vector<std::string>& texts) {
  check_refused(Folder(), kTwo + kOut + options, texts);
}

}  // namespace

TEST_CASE("design writes the hits, the bars before and after, the margins and the check") {
  const Folder f;
  const Result r = done(f, kTwo + kOut);
  for (const char* name : {"hits.csv", "hit_1.csv", "hit_2.csv", "summary.json", "report.html"})
    CHECK(fs::exists(f.at(std::string("out/") + name)));
  const Json s = summary(f);
  for (const char* name : {"k_p", "k_d", "k_sea", "c_sea", "i_motor"}) {
    INFO(name);
    const Json& c = s["constants"][name];
    CHECK(c["half_width_after"].get<double>() < c["half_width_before"].get<double>());
    const Json& q = s["check"]["constants"][name];
    CHECK(q["scatter"].get<double>() == Approx(q["std_predicted"].get<double>()).epsilon(0.4));
    CHECK(q["covered"].get<int>() >= 42);
    CHECK_THAT(r.out, Contains(name));
  }
  CHECK(s["criterion"]["name"] == "worst");
  CHECK(s["criterion"]["after"].get<double>() < s["criterion"]["before"].get<double>());
  CHECK(s["noise"].get<double>() == Approx(5e-4).epsilon(0.1));
  CHECK(s["check"]["repeats"] == 50);
  CHECK(s["check"]["failed"] == 0);
  CHECK(s["check"]["agrees"] == true);
  CHECK(s["runners_up"].size() > 0);
  CHECK(s["candidates"]["beyond_the_angle"].get<int>() > 0);
  REQUIRE(s["hits"].size() == 2);
  for (const Json& h : s["hits"]) {
    CHECK(std::abs(h["peak"].get<double>()) <= 300);
    CHECK(h["width"].get<double>() >= 0.010);
    CHECK(h["width"].get<double>() <= 0.020);
    CHECK(h["angle"].get<double>() <= h["angle_within_uncertainty"].get<double>());
    CHECK(h["margin"].get<double>() >= 0);
    CHECK(h["margin"].get<double>() == Approx(0.6 - h["angle_within_uncertainty"].get<double>()));
  }

  // What a script plays is the hit that is named.
  std::istringstream csv(read(f.at("out/hit_1.csv")));
  std::string line;
  while (std::getline(csv, line) && line[0] == '#') continue;
  CHECK(line == "t,force");
  double impulse = 0;
  long rows = 0;
  for (; std::getline(csv, line); ++rows) impulse += 1e-3 * std::stod(line.substr(line.find(',') + 1));
  CHECK(rows == 1001);
  const Json& first = s["hits"][0];
  CHECK(impulse == Approx(first["peak"].get<double>() * first["width"].get<double>() * 2 / 3.14159265).epsilon(0.01));
}

TEST_CASE("design: an actuator's covariance stands for the trials, the same bytes again, with any number of threads") {
  const Folder f;
  const Result fit = run({"identify", kTrial1, kTrial2, "--rig", kRig, "-o", "fit"}, f.at(""));
  REQUIRE(fit.code == 0);
  const Arguments from = {"--actuator", "fit/actuator.toml", "--json", "--quiet", "--no-report"};
  const Result a = run(kNone + kSmall + from + Arguments{"-o", "a"}, f.at("")),
               b = run(kNone + kSmall + from + Arguments{"-o", "b", "--threads", "1"}, f.at("")),
               c = run(Arguments{"design", kTrial1, kTrial2, "--rig", kRig, "--noise", "5e-4"} + kSmall + from +
                           Arguments{"-o", "c"},
                       f.at(""));
  REQUIRE(a.code == 0);
  CHECK_FALSE(fs::exists(f.at("a/report.html")));
  Json x = Json::parse(a.out), y = Json::parse(b.out);
  for (Json* j : {&x, &y}) j->erase("provenance"), j->erase("time_s");
  CHECK(x == y);
  const Json z = Json::parse(c.out);
  CHECK(x["in_hand"] == "the actuator's covariance");
  CHECK(z["in_hand"] == "2 trials");
  for (const char* when : {"half_width_before", "half_width_after"})
    CHECK(x["constants"]["i_motor"][when].get<double>() ==
          Approx(z["constants"]["i_motor"][when].get<double>()).epsilon(0.05));
}

TEST_CASE("design: exit 1 with the reason where no hit is safe") {
  const Folder f;
  const Result r = run(kTwo + kOut + Arguments{"--angle", "0.001"}, f.at(""));
  CHECK(r.code == 1);
  CHECK_THAT(r.err, Contains("no hit of this budget is safe"));
  const Json s = summary(f);
  CHECK(s["hits"].empty());
  CHECK(s["check"].is_null());
  CHECK(s["constants"]["k_p"]["half_width_after"].is_null());
  CHECK_FALSE(fs::exists(f.at("out/hits.csv")));
}

TEST_CASE("design warns where the actuator is not that of the trials") {
  const Folder f;
  f.write("other.toml", replaced(read(kTable2), "k_p = 50", "k_p = 55"));
  const Result r =
      run(Arguments{"design", kTrial2, "--rig", kRig, "--actuator", "other.toml"} + kSmall + kOut, f.at(""));
  CHECK_THAT(r.err, Contains("misses these trials") && Contains("fit them first"));
}

TEST_CASE("design refuses bad options and files") {
  check_options({"--peak", "-1"}, {"peak: -1: must be above 0 N"});
  check_options({"--peak", "strong"}, {"--peak", "strong"});
  check_options({"--width", "0.02", "0.01"}, {"width: 0.01: the longest pulse must be at least the shortest, 0.02 s"});
  check_options({"--width", "0"}, {"width: 0: must be above 0 s"});
  check_options({"--angle", "3.5"}, {"angle: 3.5: must lie between 0 and pi rad"});
  check_options({"--angle", "nan"}, {"--angle: 'nan': a finite number is needed"});
  check_options({"--hits", "0"}, {"hits: 0: must lie between 1 and 20"});
  check_options({"--criterion", "wurst"}, {"--criterion: 'wurst': ", "worst, d or e", "\"worst\""});
  check_options({"--directions", "bith"}, {"--directions: 'bith': ", "both or positive", "\"both\""});
  check_options({"--rate", "500"}, {"rate: 500: a pulse of 0.01 s needs at least 8 samples"});
  check_options({"--rate", "1e9"}, {"rate: 1000000000: at most a million samples"});
  check_options({"--duration", "0.05"}, {"duration: 0.05: the log must go on after the hit"});
  check_options({"--noise", "0"}, {"noise: 0: must be above 0 rad"});
  check_options({"--tau-max", "-1"}, {"--tau-max"});
  check_options({"--check", "-1"}, {"--check"});
  check_options({"--columns", "fie=phi"}, {"--columns", "fie"});
  check_refused(Folder(), Arguments{"design", "--rig", kRig, "--actuator", kTable2} + kOut,
                {"--noise: without trials the noise of the angle [rad] is needed"});
  check_refused(Folder(), kNone + kOut + Arguments{"--actuator", kTable2}, {"table2.toml: no covariance"});
  check_refused(Folder(), {"design", kTrial1, "--rig", kRig, "-o", "out"}, {"--actuator is required"});
  check_refused(Folder(), {"design", "nowhere.csv", "--rig", kRig, "--actuator", kTable2, "-o", "out"},
                {"nowhere.csv"});
  const Folder f;
  f.write("still.csv", "t,phi,force\n0,0,0\n0.1,0,0\n0.2,0,0\n");
  check_refused(f, {"design", "still.csv", "--rig", kRig, "--actuator", kTable2, "-o", "out"},
                {"still.csv: no excitation"});
  f.write("silent.csv", "t,phi,force\n0,0,0\n0.1,0,1\n0.2,0,0\n");
  check_refused(f, {"design", "silent.csv", "--rig", kRig, "--actuator", kTable2, "-o", "out"},
                {"--noise: the trials show none"});
}

TEST_CASE("design of a robot of links: of commands, those to log next, and what it cannot do is refused") {
  const Folder f;
  const std::string robot = dataset("scenes/hopper.toml");
  const auto commands = [&](const std::string& file, double size) {
    std::string text = "t,phi_ref_hip,phi_ref_knee\n";
    for (int k = 0; k < 200; ++k) {
      const double bend = 0.6 + size * std::sin(0.05 * k);
      text += fmt::format("{},{},{}\n", 0.002 * k, bend, -2 * bend);
    }
    f.write(file, text);
  };
  commands("still.csv", 0), commands("swing.csv", 0.3);
  const Arguments design = {"design",    "--robot",   robot,    "--next",
                            "still.csv", "swing.csv", "--free", "drive.hip.i_motor,link.thigh.mass"};
  done(f, design + Arguments{"--noise", "phi=0.001", "--hits", "1", "-o", "out"});
  const Json s = summary(f);
  CHECK(s["candidates"][0]["file"] == "swing.csv");
  CHECK(s["candidates"][0]["rank"] == 1);
  CHECK(s["candidates"][1]["rank"].is_null());
  CHECK(s["constants"]["robot.link.thigh.mass"]["half_width_before"].is_null());
  CHECK(s["constants"]["robot.link.thigh.mass"]["half_width_after"].get<double>() < 1);
  CHECK(s["noise"].size() == 2);
  CHECK_THAT(read(f.at("out/next.csv")), Contains("rank,file,together,alone"));
  CHECK_THAT(read(f.at("out/report.html")), Contains("What to log next"));
  done(f, design + Arguments{"--noise", "phi=0.001", "--heights", "0,0.2", "--no-report", "-o", "high"});
  std::vector<std::string> files;
  const Json high = summary(f, "high");
  for (const Json& c : high["candidates"]) files.push_back(c["file"]);
  std::sort(files.begin(), files.end());
  CHECK(files == std::vector<std::string>{"still.csv from 0 m", "still.csv from 0.2 m", "swing.csv from 0 m",
                                          "swing.csv from 0.2 m"});
  check_refused(f, design + Arguments{"--noise", "phi=0.001", "--heights", "-1"} + kOut,
                {"--heights: -1 m", "at least 0"});
  check_refused(f, design + kOut, {"--noise is needed"});
  check_refused(f, design + Arguments{"--noise", "phi=0.001", "--peak", "100"} + kOut,
                {"--peak", "no effect with --robot"});
  check_refused(f, Arguments{"design", "--robot", robot, "--free", "drive.hip.i_motor"} + kOut, {"--next"});
  check_refused(f, Arguments{"design", "--robot", robot, "--next", "swing.csv"} + kOut, {"--free"});
  check_refused(f, Arguments{"design", "--next", "swing.csv", "--rig", kRig, "--actuator", kTable2} + kOut,
                {"--next: --robot is needed"});
  check_refused(f, kNone + Arguments{"--actuator", kTable2, "--tie", "2"} + kOut, {"--tie: --pieces is needed"});
  check_refused(f, Arguments{"design", "--actuator", kTable2} + kOut, {"--rig is required, or --robot"});
}
