// Logs as laboratories have them, through the program: HEBI's binary and CSV, forces on clocks of their own.
#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "test/cli/refused.hpp"
#include "test/unit/hebi_bytes.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

struct Row {
  double t, force, phi;
};
/// A shipped trial (simulated): its columns t, force, phi.
std::vector<Row> rows_of(const std::string& path) {
  std::istringstream in(read(path));
  std::vector<Row> out;
  char comma;
  for (std::string line; std::getline(in, line);) {
    if (line[0] == '#' || line[0] == 't') continue;
    std::istringstream cells(line);
    Row r{};
    cells >> r.t >> comma >> r.force >> comma >> r.phi;
    out.push_back(r);
  }
  return out;
}

/// The trial as a HEBI log, a module of which holds still.
std::string as_hebilog(const std::vector<Row>& rows) {
  std::string bytes = hebi_bytes::header(2);
  for (const Row& r : rows) {
    const auto stamp = std::int64_t(std::llround(1e6 * r.t));
    const hebi_bytes::Sample knee{stamp, float(r.phi), 0.0f, 500 * r.phi, 1}, hip{stamp, 0.25f, 0.25f, 0, 0};
    if (r.t == 0)
      bytes += hebi_bytes::info(knee, "Knee", "Leg") + hebi_bytes::info(hip, "Hip", "Leg");
    else
      bytes += hebi_bytes::feedback(hip) + hebi_bytes::feedback(knee);
  }
  return bytes;
}
std::string as_force_log(const std::vector<Row>& rows, double shift) {
  std::ostringstream out;
  out.precision(12);
  out << "Time_ms;Fy\n";
  for (const Row& r : rows) out << 1e3 * (r.t + shift) << ";" << -r.force << "\n";
  return out.str();
}

const Arguments kForceColumns = {"--force-columns", "t=Time_ms,force=-Fy"};

/// The eight shipped trials as HEBI logs with force logs of their own, the latter `shift` later on their clock.
struct Laboratory {
  Folder folder;
  Arguments logs, forces;
  explicit Laboratory(double shift) {
    for (int i = 1; i <= 8; ++i) {
      const std::vector<Row> rows = rows_of(dataset("impact/trial_" + std::to_string(i) + ".csv"));
      logs.push_back("hit_" + std::to_string(i) + ".hebilog");
      folder.write(logs.back(), as_hebilog(rows));
      forces = forces + Arguments{"--force-log", "force_" + std::to_string(i) + ".csv"};
      folder.write(forces.back(), as_force_log(rows, shift));
    }
  }
};

/// Bytes of a HEBI log of one module that follows its commands.
std::string moving(int samples) {
  std::string bytes = hebi_bytes::header(1);
  for (int i = 0; i < samples; ++i)
    bytes += hebi_bytes::feedback({10'000 * i, 0.001f * float(i), i < 3 ? hebi_bytes::kNaN : 0.1f});
  return bytes;
}

}  // namespace

TEST_CASE("identify reads HEBI logs and force logs on one clock as it reads the same trials in CSV") {
  const Laboratory lab(0);
  const Folder csv;
  done(csv, Arguments{"identify"} + impact_trials() + Arguments{"--rig", kRig, "--quiet", "-o", "out"});
  done(lab.folder, Arguments{"identify"} + lab.logs + Arguments{"--rig", kRig, "--module", "Knee"} + lab.forces +
                       kForceColumns + Arguments{"--force-clock", "shared", "--quiet", "-o", "out"});
  const Json a = summary(csv), b = summary(lab.folder);
  for (const auto& [name, p] : a["parameters"].items()) {
    INFO(name);
    CHECK(b["parameters"][name]["value"].get<double>() == Approx(p["value"].get<double>()).epsilon(1e-5));
  }
  CHECK(b["modules"].size() == 8);
  CHECK(b["modules"][0]["name"] == "Knee");
  CHECK(b["modules"][0]["spring_constant"] == 40);
  CHECK(b["modules"][0]["position_gains"]["kp"] == 0.5);
  CHECK(b["force_logs"][3] ==
        Json{{"trial", "hit_4.hebilog"}, {"file", "force_4.csv"}, {"clock", "shared"}, {"shift", 0}});
  CHECK(warned(b, "hit_1.hebilog: the motor's position is not used: the rig names no gear_ratio"));
  CHECK(b["provenance"].contains("checksum force_8.csv"));
}

TEST_CASE("force logs on clocks of their own are moved onto the trials' to a millisecond, the shift is told") {
  const Laboratory lab(71.25);
  const Result r = done(lab.folder, Arguments{"predict"} + lab.logs +
                                        Arguments{"--rig", kRig, "--actuator", kTable2, "--module", "2"} + lab.forces +
                                        kForceColumns + Arguments{"-o", "out"});
  CHECK_THAT(r.out, Contains("force_1.csv: moved by -71.2") && Contains("s onto the clock of hit_1.hebilog"));
  const Json s = summary(lab.folder);
  REQUIRE(s["force_logs"].size() == 8);
  for (const Json& f : s["force_logs"]) {
    CHECK(f["clock"] == "own");
    CHECK(f["shift"].get<double>() == Approx(-71.25).margin(1e-3));
  }
}

TEST_CASE("compare reads the logs that identify reads") {
  const Laboratory lab(0);
  done(lab.folder, Arguments{"compare", "--nominal", kNominal, "--identified", kTable2, "--rig", kRig, "--module",
                             "Knee", "--trials"} +
                       lab.logs + lab.forces + kForceColumns + Arguments{"--force-clock", "shared", "-o", "out"});
  const Json s = summary(lab.folder);
  CHECK(s["force_logs"].size() == 8);
  REQUIRE(s["residuals"].size() == 8);
  for (const Json& r : s["residuals"]) {
    CHECK(r["identified"].get<double>() < 6e-4);  // Table 2 made the trials; their noise is 5e-4
    CHECK(r["nominal"].get<double>() > 2 * r["identified"].get<double>());
  }
}

TEST_CASE("the motor's angle of a HEBI log is divided by the rig's gear_ratio") {
  const Folder f;
  f.write("hit.hebilog", as_hebilog(rows_of(kTrial2)));
  f.write("rig.toml", read(kRig) + "gear_ratio = 500\n");
  done(f, {"predict", "hit.hebilog", "--module", "Leg/Knee", "--rig", "rig.toml", "--actuator", kTable2, "-o", "out"});
  CHECK_THAT(read(f.at("out/fit.csv")), Contains("phi_motor_sim"));
  CHECK(warned(summary(f), "counts from where it was switched on: moved by "));
}

TEST_CASE("predict reads the vendor's CSV export, and says what it handled") {
  const Folder f;
  f.write("export.csv",
          "Time,Position_1,PositionCmd_1,Position_2,PositionCmd_2\n"
          "0,0,nan,5,5\n0.01,0.001,0.2,5,5\n0.01,0.001,0.2,5,5\n0.02,0.01,0.2,5,5\n0.06,0.1,0.2,5,5\n"
          "0.07,0.1,0.2,5,5\n");
  done(f, {"predict", "export.csv", "--module", "1", "--rig", kRig, "--actuator", kTable2, "-o", "out"});
  const Json s = summary(f);
  CHECK(s["trials"][0]["samples"] == 5);
  CHECK(warned(s, "export.csv: 1 duplicate stamp dropped"));
  CHECK(warned(s, "export.csv: 1 gap longer than 3 nominal intervals of 10 ms, the longest 40 ms"));
  CHECK(warned(s, "export.csv: 1 NaN command before the first command: held at the first position"));
  // The map makes it a plain trial, with a plain trial's rules.
  check_refused(f,
                Arguments{"predict", "export.csv", "--rig", kRig, "--actuator", kTable2, "--columns",
                          "t=Time,phi=Position_1,phi_ref=PositionCmd_1"} +
                    Arguments{"-o", "other"},
                {"export.csv:2:5: ", "'PositionCmd_1'", "'nan'"});
}

TEST_CASE("a HEBI log that is empty, cut or damaged is refused with its byte") {
  const Folder f;
  const std::string good = moving(20);
  const auto refused = [&](const std::string& bytes, const std::string& text) {
    f.write("a.hebilog", bytes);
    check_refused(f, Arguments{"identify", "a.hebilog", "--rig", kRig} + kOut, {"a.hebilog: byte ", text});
    check_refused(f, Arguments{"predict", "a.hebilog", "--rig", kRig, "--actuator", kTable2} + kOut,
                  {"a.hebilog: byte ", text});
  };
  refused("", "byte 0: the file is empty");
  refused(good.substr(0, 12), "byte 4: 1 modules: the file has room for 0");
  refused(good.substr(0, 60), "the file ends before its first whole feedback record");
  std::string flipped = good;
  flipped[16] ^= 1;
  refused(flipped, "byte 16: 0x72b1: a record of a .hebilog starts with 0x73b1");

  f.write("a.hebilog", good.substr(0, good.size() - 9));
  done(f, {"predict", "a.hebilog", "--rig", kRig, "--actuator", kTable2, "-o", "out"});
  const Json s = summary(f);
  CHECK(s["trials"][0]["samples"] == 19);
  CHECK(warned(s, "a.hebilog: the file ends inside its last record (byte "));
  CHECK(warned(s, "a.hebilog: 3 NaN commands before the first command"));
}

TEST_CASE("a module that is missing or not named is refused with those there are") {
  const Folder f;
  f.write("two.hebilog", as_hebilog(rows_of(kTrial1)));
  const Arguments identify = Arguments{"identify", "two.hebilog", "--rig", kRig} + kOut;
  const std::string list = "1 'Hip' of 'Leg' (10.0.0.1:100); 2 'Knee' of 'Leg' (10.0.0.1:101)";
  check_refused(f, identify, {"two.hebilog: 2 modules: --module NAME or number is needed", list});
  check_refused(f, identify + Arguments{"--module", "Ankle"}, {"--module: 'Ankle': no such module", list});
  check_refused(f, identify + Arguments{"--module", "Hip"},
                {"two.hebilog: no excitation: no force and a reference that stays"});
  check_refused(f, Arguments{"identify", kTrial1, "--rig", kRig, "--module", "Knee"} + kOut,
                {"--module: 'Knee': no trial is a HEBI log"});
}

TEST_CASE("a force log that does not fit its trial is refused") {
  const Folder f;
  const std::vector<Row> rows = rows_of(kTrial1);
  std::string text = "t,phi\n";
  for (const Row& r : rows) text += std::to_string(r.t) + "," + std::to_string(r.phi) + "\n";
  f.write("angle.csv", text);
  f.write("later.csv", as_force_log(rows, 10));
  f.write("zero.csv", "t,force\n0,0\n0.5,0\n1,0\n");
  const Arguments identify = Arguments{"identify", "angle.csv", "--rig", kRig} + kOut;
  check_refused(f, identify, {"angle.csv:1: ", "at least one excitation"});
  check_refused(f, identify + kForceColumns + Arguments{"--force-log", "later.csv", "--force-clock", "shared"},
                {"later.csv: the force runs from 10 to 11 s, the angle in angle.csv from 0 to 1 s: they do not overlap",
                 "--force-clock own"});
  check_refused(f, identify + Arguments{"--force-log", "zero.csv"},
                {"zero.csv: the force never leaves its rest", "cannot be aligned"});
  check_refused(f, identify + Arguments{"--force-log", "zero.csv", "--force-clock", "shared"},
                {"angle.csv: no excitation: a force of 0 throughout and no reference"});
  check_refused(f, identify + Arguments{"--force-log", "later.csv"}, {"later.csv:1: no column 't'"});
  check_refused(f, identify + Arguments{"--force-log", "none.csv"}, {"none.csv: no such file"});
  check_refused(f, identify + Arguments{"--force-log", "a.csv", "--force-log", "b.csv"},
                {"--force-log: 2 files for 1 trials: one for all or one for each is needed"});
  check_refused(f, identify + Arguments{"--force-columns", "t=Time"}, {"--force-columns: --force-log is needed"});
  check_refused(f, identify + Arguments{"--force-log", "zero.csv", "--force-clock", "shred"},
                {"--force-clock: 'shred': own or shared is needed", "did you mean \"shared\"?"});
  check_refused(
      f, Arguments{"identify", kTrial1, "--rig", kRig, "--force-log", "zero.csv", "--force-clock", "shared"} + kOut,
      {"trial_1.csv: a force in the trial beside the force log zero.csv"});
}

TEST_CASE("a trial without excitation is refused by identify, two with the same content are warned of") {
  const Folder f;
  f.write("still.csv", "t,phi,force,phi_ref\n0,0,0,0.1\n0.001,0,0,0.1\n0.002,0,0,0.1\n");
  check_refused(f, Arguments{"identify", kTrial1, "still.csv", "--rig", kRig} + kOut,
                {"still.csv: no excitation: a force of 0 throughout and a reference that stays: a force or a moving "
                 "reference is needed"});
  const std::string trial = read(dataset("impact_validation/trial_9.csv"));
  f.write("one.csv", trial);
  f.write("two.csv", "# another name\n" + trial);
  const Result r = done(f, {"predict", "one.csv", "two.csv", "--rig", kRig, "--actuator", kTable2, "-o", "out"});
  CHECK_THAT(r.err, Contains("trials 1 (one.csv) and 2 (two.csv) have the same content"));
  CHECK(warned(summary(f), "trials 1 (one.csv) and 2 (two.csv) have the same content"));
}

TEST_CASE("a real HEBI log is read by predict") {
  const auto path = lab_file("hebi/exampleLog.hebilog");
  if (!path) return;
  const Folder f;
  f.write("rig.toml", read(kRig) + "gear_ratio = 272.222\n");
  const Result r = run({"predict", *path, "--rig", "rig.toml", "--actuator", kTable2, "-o", "out"}, f.at(""));
  INFO(r.err);
  CHECK(r.code == 0);
  const Json s = summary(f);
  CHECK(s["modules"][0]["samples"] == 1050);
  CHECK(s["modules"][0]["spring_constant"] == 40);
  CHECK(warned(s, "1 NaN command before the first command: held at the first position"));
}

TEST_CASE("times of any origin: identify and predict answer as from 0, and say the origin") {
  const Folder f;
  const std::vector<double> origins = {0, -50, 1e7, 1.7e9};
  std::vector<Json> fits, predictions;
  for (const double origin : origins) {
    INFO(origin);
    Arguments paths;
    for (const char* number : {"3", "7"}) {
      std::ostringstream out;
      out.precision(17);
      out << "t,force,phi\n";
      for (const Row& r : rows_of(dataset(std::string("impact/trial_") + number + ".csv")))
        out << origin + r.t << "," << r.force << "," << r.phi << "\n";
      paths.push_back(f.write(std::string(number) + ".csv", out.str()));
    }
    done(f, Arguments{"identify"} + paths + Arguments{"--rig", kRig, "-o", "fit"});
    fits.push_back(summary(f, "fit"));
    CHECK(fits.back()["trials"][0]["t_origin"] == origin);
    CHECK((read(f.at("fit/fit.csv")).find("trial 2: t = 0 at ") == std::string::npos) == (origin == 0));
    done(f, {"predict", paths[0], "--rig", kRig, "--actuator", kTable2, "-o", "predicted"});
    predictions.push_back(summary(f, "predicted"));
  }
  for (std::size_t i = 1; i < origins.size(); ++i) {
    INFO(origins[i]);
    for (const char* name : {"k_p", "k_d", "k_sea", "c_sea", "i_motor"}) {
      const Json &a = fits[0]["parameters"][name], &b = fits[i]["parameters"][name];
      CHECK(std::abs(a["value"].get<double>() - b["value"].get<double>()) < 0.02 * a["std"].get<double>());
      CHECK(b["verdict"] == a["verdict"]);
    }
    CHECK(predictions[i]["rms"].get<double>() == Approx(predictions[0]["rms"].get<double>()).epsilon(1e-3));
  }
  f.write("gap.csv", "t,force,phi\n1700000000,0,0\n1700000000.01,1,0\n1800000000,0,0\n");
  check_refused(f, {"identify", "gap.csv", "--rig", kRig, "-o", "out"}, {"gap.csv:4:1: ", "less than 100000 s after"});
  f.write("case.csv", "t,force,PHI\n0,0,0\n0.01,1,0\n");
  check_refused(f, {"predict", "case.csv", "--rig", kRig, "--actuator", kTable2, "-o", "out"},
                {"case.csv:1:9: ", "'PHI'", "did you mean \"phi\"?"});
}
