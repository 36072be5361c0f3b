// What identify says of logs that are not as they should be, and what it leaves behind.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <sstream>

#include "test/cli/refused.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

/// The shipped trial without its comments.
std::vector<std::string> lines_of(const std::string& path) {
  std::istringstream in(read(path));
  std::vector<std::string> out;
  for (std::string line; std::getline(in, line);)
    if (line[0] != '#') out.push_back(line);
  return out;
}
std::string joined(const std::vector<std::string>& lines) {
  std::string out;
  for (const std::string& l : lines) out += l + "\n";
  return out;
}

const std::string kLeg = "[actuator]\nname = \"leg\"\nk_p = 50\nk_d = 1\nk_sea = 65\nc_sea = 1.6\ni_motor = 0.085\n";

}  // namespace

TEST_CASE("the verdicts stand in actuator.toml, and the verbs that read it warn of what is not trusted") {
  const Folder f;
  done(f, Arguments{"identify"} + impact_trials() + Arguments{"--rig", kRig} + kOut);
  CHECK_THAT(read(f.at("out/actuator.toml")), Contains("[verdict]\nk_p = \"trusted\"\nk_d = \"trusted\"\n"));
  const std::string trial = dataset("impact_validation/trial_9.csv");
  const Arguments drop = {kPaper, "--hold", "-45"};
  const auto warns = [&](const Arguments& command) {
    const Result r = done(f, command + Arguments{"-o", "other"});
    return r.err.find("not trusted by the fit that wrote it") != std::string::npos;
  };
  CHECK_FALSE(warns(Arguments{"simulate"} + drop + Arguments{"--actuator", "out/actuator.toml"}));
  CHECK_FALSE(warns(Arguments{"simulate"} + drop + Arguments{"--actuator", kTable2}));  // says nothing of verdicts

  f.write("weak.toml", kLeg + "[verdict]\nk_p = \"trusted\"\nk_d = \"fixed\"\ni_motor = \"weak\"\n");
  const Arguments weak = {"--actuator", "weak.toml"};
  CHECK(warns(Arguments{"simulate"} + drop + weak));
  CHECK(warns(Arguments{"optimize", kPaper, "--evaluations", "200"} + weak));
  CHECK(warns(Arguments{"map", kPaper, "--grid", "4,4,4"} + weak));
  CHECK(warns({"compare", "--nominal", kTable2, "--identified", "weak.toml"}));
  CHECK(warns(Arguments{"predict", trial, "--rig", kRig} + weak));
  CHECK_THAT(done(f, Arguments{"predict", trial, "--rig", kRig, "-o", "other"} + weak).err,
             Contains("weak.toml: not trusted by the fit that wrote it: i_motor is weak;"));
  f.write("bad.toml", kLeg + "[verdict]\nk_p = \"trustee\"\n");
  check_refused(f, Arguments{"simulate"} + drop + Arguments{"--actuator", "bad.toml", "-o", "new"},
                {"bad.toml:9:", "'trustee'", "trusted"});
}

TEST_CASE("identify carries the rig's speed_max, and what it fitted beside the constants reads back") {
  const Folder f;
  f.write("rig.toml", replaced(read(kRig), "speed_max = 3.14", "speed_max = 3.5"));
  const Arguments two = {"identify", dataset("impact/trial_3.csv"), dataset("impact/trial_7.csv"), "--rig", "rig.toml"};
  done(f, two + kOut + Arguments{"--nuisance", "stiffening,force_gain"});
  CHECK_THAT(read(f.at("out/actuator.toml")),
             Contains("speed_max = 3.5") && Contains("motor_torque_max = 20  #") && Contains("\"k_sea_cubic\""));
  done(f, {"simulate", kPaper, "--hold", "-45", "--actuator", "out/actuator.toml", "-o", "other"});
  f.write("rig.toml", replaced(read(kRig), "speed_max = 3.14", "speed_max = 0"));
  check_refused(f, two + Arguments{"-o", "new"}, {"rig.toml:", "speed_max"});
}

TEST_CASE("a gap is warned of with its place, and in a hit it costs the verdict") {
  const Folder f;
  std::vector<std::string> rows = lines_of(kTrial1);
  rows.erase(rows.begin() + 401, rows.begin() + 406);  // 0.4 s on
  f.write("later.csv", joined(rows));
  std::vector<std::string> hit = lines_of(kTrial1);
  hit.erase(hit.begin() + 61);  // 0.06 s, one row
  f.write("hit.csv", joined(hit));
  const std::string trial = dataset("impact/trial_8.csv");
  done(f, Arguments{"identify", "later.csv", trial, "--rig", kRig} + kOut);
  CHECK(warned(summary(f), "later.csv: a gap in the log, the longest of 6 ms at 0.399 s"));
  CHECK(summary(f)["trusted"] == true);
  done(f, Arguments{"identify", "hit.csv", trial, "--rig", kRig} + kOut);
  CHECK(warned(summary(f), "hit.csv: a gap of 2 ms at 0.059 s, in a hit"));
  CHECK(summary(f)["trusted"] == false);
}

TEST_CASE("a force of the wrong sign is recognised: in every trial, and in one") {
  const Folder f;
  const Arguments eight = impact_trials(), rig = {"--rig", kRig};
  run(Arguments{"identify"} + eight + rig + kOut + Arguments{"--columns", "force=-force"}, f.at(""));
  CHECK(warned(summary(f), "the link moves against the force in every trial: its sign is flipped? try -F: force=-..."));
  CHECK(summary(f)["trusted"] == false);

  std::vector<std::string> rows = lines_of(eight[2]);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const std::size_t comma = rows[i].find(',');
    if (rows[i][comma + 1] != '0' || rows[i][comma + 2] != ',') rows[i].insert(comma + 1, "-");
  }
  f.write("flipped.csv", joined(rows));
  Arguments mixed = eight;
  mixed[2] = "flipped.csv";
  run(Arguments{"identify"} + mixed + rig + kOut, f.at(""));
  CHECK(warned(summary(f), "flipped.csv: the link moves against the force, unlike in 7 of 8 trials"));
  CHECK(summary(f)["trusted"] == false);
}

TEST_CASE("12,000 samples with 0.02 N of load-cell noise fit, the noise estimated or given") {
  const Folder f;
  const std::vector<std::string> rows = lines_of(dataset("impact/trial_5.csv"));  // 1 kHz: twelve samples from each
  std::vector<std::array<double, 3>> log;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    std::array<double, 3> row{};
    std::sscanf(rows[i].c_str(), "%lf,%lf,%lf", &row[0], &row[1], &row[2]);
    log.push_back(row);
  }
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::string text = "# SIMULATED\nt,force,phi\n";
  for (std::size_t k = 0; k + 1 < log.size(); ++k)
    for (int part = 0; part < 12; ++part) {
      const auto at = [&](std::size_t c) { return log[k][c] + (log[k + 1][c] - log[k][c]) * part / 12; };
      char row[80];
      std::snprintf(row, sizeof row, "%.7f,%.6f,%.8f\n", at(0), at(1) + 0.02 * normal(random), at(2));
      text += row;
    }
  f.write("fast.csv", text);
  const Arguments command = {"identify", "fast.csv", "--rig", kRig, "--start", kTable2};
  run(command + kOut, f.at(""));
  CHECK(summary(f)["converged"] == true);
  CHECK(summary(f)["parameters"]["k_p"]["value"] == Approx(50).epsilon(0.01));
  CHECK(summary(f)["force_noise"][0] == Approx(0.02).epsilon(0.15));
  run(command + kOut + Arguments{"--force-noise", "0.02"}, f.at(""));
  CHECK(summary(f)["force_noise"][0] == 0.02);
  check_refused(f, command + Arguments{"-o", "new", "--force-noise", "-1"}, {"--force-noise: -1: at least 0 N"});
}

TEST_CASE("a fit that found nothing writes no actuator.toml") {
  const Folder f;
  const Arguments escapes = {"identify", dataset("impact/trial_8.csv"), "--rig", kRig, "--columns", "force=1e4*force"};
  const Result r = run(escapes + kOut, f.at(""));
  CHECK(r.code == 1);
  CHECK_THAT(r.err, Contains("no start could be followed through the trials"));
  CHECK_FALSE(fs::exists(f.at("out/actuator.toml")));
  CHECK(summary(f)["rms"].is_null());  // 0 would be a perfect fit
  CHECK_THAT(r.out, !Contains("residual rms 0"));
}

TEST_CASE("logs that no actuator explains end within seconds, and say so") {
  // A reference that steps at uneven times, and an angle that has nothing to do with it.
  const Folder f;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform;
  std::string text = "# SIMULATED\nt,phi,phi_ref\n";
  double t = 0;
  for (int i = 0; i < 1050; ++i) {
    char row[80];
    std::snprintf(row, sizeof row, "%.6f,%.6f,%.6f\n", t, 0.3 * std::sin(11 * t) + 0.01 * uniform(random),
                  0.2 * std::round(2 * std::sin(3 * t)));
    text += row, t += 0.01 * (0.7 + 0.6 * uniform(random));
  }
  f.write("odd.csv", text);
  const Result r = run(Arguments{"identify", "odd.csv", "--rig", kRig} + kOut, f.at(""));
  INFO(r.err);
  CHECK(r.code != -1);
  CHECK(r.code != 124);  // `run` gives it a minute
  const Json s = summary(f);
  CHECK(s["trusted"] == false);
  CHECK(s["time_s"].get<double>() < 20);
}

TEST_CASE("a real HEBI log is fitted, or given up, within seconds") {
  const auto path = lab_file("hebi/exampleLog.hebilog");
  if (!path) return;
  const Folder f;
  const Result r = run({"identify", *path, "--rig", kRig, "-o", "out"}, f.at(""));
  INFO(r.err);
  CHECK((r.code == 0 || r.code == 1));
  CHECK(summary(f)["trusted"] == false);
  CHECK(summary(f)["time_s"].get<double>() < 20);
}

TEST_CASE("a measured arm with one row missing is fitted within seconds") {
  const auto path = lab_file("rotary_arm/step_up.csv");
  if (!path) return;
  const Folder f;
  f.write("arm.toml", "[rig]\nlength = 0.45\ninertia_joint = 0.01418\nfeedback = \"motor\"\n");
  std::vector<std::string> rows = lines_of(*path);
  rows.erase(rows.begin() + 600);
  f.write("arm.csv", joined(rows));
  const Result r =
      run({"identify", "arm.csv", "--rig", "arm.toml", "--nuisance", "initial_angle", "-o", "out"}, f.at(""));
  INFO(r.err);
  CHECK(r.code == 0);
  CHECK(summary(f)["time_s"].get<double>() < 10);
}
