// Bad usage and bad input: exit code 2, one line on stderr that says where, what and the rule, and nothing written.
#include <catch2/catch.hpp>

#include "test/cli/refused.hpp"

using namespace cli;

namespace {

/// `identify` of one shipped trial, with these options.
void check_identify(const Arguments& options, const std::vector<std::string>& texts) {
  check_refused(Folder(), Arguments{"identify", kTrial1, "--rig", kRig} + kOut + options, texts);
}
void check_optimize(const Arguments& options, const std::vector<std::string>& texts) {
  check_refused(Folder(), Arguments{"optimize", kPaper, "--actuator", kTable2} + kOut + options, texts);
}
void check_simulate(const Arguments& options, const std::vector<std::string>& texts) {
  check_refused(Folder(), Arguments{"simulate", kPaper, "--actuator", kTable2} + kOut + options, texts);
}

/// `identify`, `predict` and `compare` with a trial file of these bytes; all three read trials and must refuse alike.
void check_trial(const std::string& bytes, const std::vector<std::string>& texts) {
  const Folder f;
  f.write("trial.csv", bytes);
  check_refused(f, Arguments{"identify", "trial.csv", "--rig", kRig} + kOut, texts);
  check_refused(f, Arguments{"predict", "trial.csv", "--rig", kRig, "--actuator", kTable2} + kOut, texts);
  check_refused(
      f,
      Arguments{"compare", "--nominal", kNominal, "--identified", kTable2, "--trials", "trial.csv", "--rig", kRig} +
          kOut,
      texts);
}

/// `simulate` and `optimize` with a scene of these bytes.
void check_scene(const std::string& bytes, const std::vector<std::string>& texts) {
  const Folder f;
  f.write("scene.toml", bytes);
  check_refused(f, Arguments{"simulate", "scene.toml", "--actuator", kTable2, "--hold", "-45"} + kOut, texts);
  check_refused(f, Arguments{"optimize", "scene.toml", "--actuator", kTable2, "--evaluations", "10"} + kOut, texts);
}
void check_rig(const std::string& bytes, const std::vector<std::string>& texts) {
  const Folder f;
  f.write("rig.toml", bytes);
  check_refused(f, Arguments{"identify", kTrial1, "--rig", "rig.toml"} + kOut, texts);
}
void check_actuator(const std::string& bytes, const std::vector<std::string>& texts) {
  const Folder f;
  f.write("actuator.toml", bytes);
  check_refused(f, Arguments{"simulate", kPaper, "--actuator", "actuator.toml", "--hold", "-45"} + kOut, texts);
  check_refused(f, Arguments{"identify", kTrial1, "--rig", kRig, "--start", "actuator.toml"} + kOut, texts);
}

}  // namespace

TEST_CASE("a malformed trial is refused with file, line and column") {
  SECTION("missing column") {
    const Folder f;
    f.write("trial.csv", "t,phii,force\n0,0,0\n1,0,0\n");  // predict can do without phi
    check_refused(f, Arguments{"identify", "trial.csv", "--rig", kRig} + kOut,
                  {"trial.csv:1: no column 'phi'", "\"phii\""});
    check_trial("time,phi,force\n0,0,0\n1,0,0\n", {"trial.csv:1: ", "no column 't'"});
  }
  SECTION("no excitation") {
    check_trial("t,phi,forse\n0,0,0\n1,0,0\n", {"trial.csv:1: ", "force", "at least one excitation", "\"forse\""});
  }
  SECTION("text in a number") {
    check_trial("t,phi,force\n0,0,0\n1,abc,0\n", {"trial.csv:3:3: ", "'phi'", "'abc'", "a number is needed"});
  }
  SECTION("NaN") {
    check_trial("t,phi,force\n0,0,0\n1,0,NaN\n", {"trial.csv:3:5: ", "'force'", "'NaN'", "a finite number is needed"});
  }
  SECTION("infinity") {
    check_trial("t,phi,force\n0,0,0\n1,-inf,0\n", {"trial.csv:3:3: ", "'-inf'", "a finite number is needed"});
  }
  SECTION("empty cell") {
    check_trial("t,phi,force\n0,0,0\n1,,0\n", {"trial.csv:3:3: ", "'phi'", "a number is needed"});
  }
  SECTION("more cells") { check_trial("t,phi,force\n0,0,0\n1,0,0,9\n", {"trial.csv:3:7: ", "'9'", "3 columns"}); }
  SECTION("fewer cells") { check_trial("t,phi,force\n0,0,0\n1,0\n", {"trial.csv:3:1: ", "2 cells", "3 columns"}); }
  SECTION("a column twice") { check_trial("t,phi,t,force\n0,0,0,0\n1,0,1,0\n", {"trial.csv:1:7: ", "'t'", "twice"}); }
  SECTION("time going backwards") {
    check_trial("# made up\nt,phi,force\n0,0,0\n2,0,0\n1,0,0\n",
                {"trial.csv:5:1: ", "'t'", " 1: time must increase; 2 "});
  }
  SECTION("repeated time") {
    check_trial("t,phi,force\n0,0,0\n1,0,0\n1,0,0\n", {"trial.csv:4:1: ", "time must increase"});
  }
  SECTION("empty file") { check_trial("", {"trial.csv: ", "empty", "a header line with column names is needed"}); }
  SECTION("header only") { check_trial("t,phi,force\n", {"trial.csv:1: ", "at least one row"}); }
  SECTION("one row") { check_trial("t,phi,force\n0,0,0\n", {"trial.csv:2: ", "at least two samples are needed"}); }
  SECTION("a line of 10 MB") {
    check_trial("t,phi,force\n" + std::string(10 << 20, '1') + "\n",
                {"trial.csv:2:1048577: ", "longer than 1048576 bytes"});
  }
  SECTION("a binary file") {
    std::string bytes = "t,phi\n";
    for (int i = 0; i < 4096; ++i) bytes += char(i * 37 % 256);
    check_trial(bytes, {"trial.csv:2:1: ", "byte 0x00", "not a text file"});
  }
  SECTION("degrees where radians are meant") {
    check_trial("t,phi,force\n0,0,0\n1,20,0\n",
                {"trial.csv:3:3: ", "'phi': 20: ", "2 pi", "are these degrees?", "phi_deg", "--multi-turn"});
  }
  SECTION("a folder") { check_identify({"."}, {".: is a folder: a file is needed"}); }
  SECTION("one bad trial among good ones") {
    const Folder f;
    f.write("bad.csv", "t,phi,force\n0,0,0\n1,x,0\n");
    check_refused(f, Arguments{"identify", kTrial1, "bad.csv", kTrial1, "--rig", kRig} + kOut, {"bad.csv:3:3: "});
  }
}

TEST_CASE("an angle beyond 2 pi is accepted where it is meant, or said to be in degrees") {
  const Folder f;
  f.write("turns.csv", "t,phi,force\n0,0,0\n0.001,20,0\n0.002,0,0\n");
  f.write("degrees.csv", "t,phi_deg,force\n0,0,0\n0.001,20,0\n0.002,0,0\n");
  const auto predict = [&](const Arguments& more) {
    return run(Arguments{"predict", "--rig", kRig, "--actuator", kTable2, "--quiet"} + kOut + more, f.at(""));
  };
  CHECK(predict({"turns.csv", "--multi-turn"}).code == 0);
  CHECK(predict({"degrees.csv"}).code == 0);
  CHECK(predict({"turns.csv", "--columns", "phi=phi"}).code == 2);
}

TEST_CASE("option --columns is refused where it names what is not there") {
  check_identify({"--columns", "phi=defl"}, {"trial_1.csv:5", "'defl'"});
  check_identify({"--columns", "phy=phi"}, {"--columns: ", "'phy'", "one of t, phi, force", "did you mean \"phi\"?"});
  check_identify({"--columns", "phi"}, {"--columns: ", "'phi'", "NAME=COLUMN is needed"});
}

TEST_CASE("a malformed TOML file is refused with file, line and column") {
  const std::string rig = read(kRig), scene = read(kPaper), actuator = read(kTable2);
  SECTION("broken syntax") {
    check_rig("[rig]\nlength = = 0.3\n", {"rig.toml:2:10: "});
    check_scene("[robot\n", {"scene.toml:1:"});
    check_actuator("[actuator]\nname = \"a\nk_p = 1\n", {"actuator.toml:2:"});
  }
  SECTION("unknown key") {
    check_rig("[rig]\nlength = 0.3\ninertia_joint = 0.024\ntau_mx = 20\n",
              {"rig.toml:4:1: unknown key 'tau_mx' in [rig]", "did you mean \"tau_max\"?"});
    check_scene(replaced(scene, "contacts", "contcts"),
                {"scene.toml:5:1: unknown key 'contcts' in [robot]", "did you mean \"contacts\"?"});
    check_scene(replaced(scene, "gravity", "gravty"), {"[robot] the key 'gravity' is missing (there is 'gravty')"});
    check_actuator(replaced(actuator, "tau_max =", "taumax ="),
                   {"actuator.toml:9:1: unknown key 'taumax'", "did you mean \"tau_max\"?"});
  }
  SECTION("unknown table") {
    check_scene(replaced(scene, "[search]", "[serch]"), {"scene.toml:21:2: unknown table 'serch'", "\"search\""});
  }
  SECTION("misspelled key that is needed") {
    check_scene(replaced(scene, "damping_normal", "dampng_normal"),
                {"scene.toml:10:1: ", "'damping_normal' is missing", "'dampng_normal'"});
  }
  SECTION("negative mass") {
    check_scene(replaced(scene, "mass = [0.806, 0.806]", "mass = [0.806, -0.806]"),
                {"scene.toml:7:", "mass: -0.806: must be above 0"});
  }
  SECTION("negative constant") {
    check_actuator(replaced(actuator, "k_p = 50", "k_p = -50"),
                   {"actuator.toml:4:7: ", "k_p: -50: must be at least 0"});
  }
  SECTION("text for a number") {
    check_actuator(replaced(actuator, "k_p = 50", "k_p = \"50\""), {"actuator.toml:4:7: ", "a number is needed"});
  }
  SECTION("degrees for radians") {
    check_scene(replaced(scene, "pitch_deg", "pitch"), {"scene.toml:19:9: ", "pitch: 18: ", "2 pi", "'pitch_deg'"});
  }
  SECTION("both units") {
    check_scene(replaced(scene, "pitch_deg = 18.0", "pitch = 0.3\npitch_deg = 18.0"),
                {"scene.toml:20:13: ", "beside 'pitch'"});
  }
  SECTION("missing table") {
    check_scene(scene.substr(0, scene.find("[drop]")), {"scene.toml: ", "[drop] is missing"});
  }
  SECTION("a stop") {
    check_rig(rig + "\n[stop]\nphi_deg = [-10, 10]\nstiffness = 100\n",
              {"rig.toml:", "[stop]: a rig has none", "--robot"});
    check_rig(rig + "\n[stop.arm]\nphi_deg = [-10, 10]\nstiffness = 100\n",
              {"rig.toml:", "describe it as a robot of one link, base = \"pinned\", with [stop.JOINT]"});
  }
  SECTION("empty file") { check_rig("", {"rig.toml: ", "the table [rig] is missing"}); }
  SECTION("a trial for a rig") { check_rig(read(kTrial1), {"rig.toml:"}); }
  SECTION("a scene for an actuator") { check_actuator(scene, {"actuator.toml: ", "the table [actuator] is missing"}); }
  SECTION("a binary file") { check_rig(std::string("[rig]\n\0\0", 8), {"rig.toml:2:1: ", "not a text file"}); }
  SECTION("a motion in radians beyond 2 pi") {
    const Folder f;
    f.write("motion.toml", "[motion]\nphi_i = -27.2\nphi_f = -82.4\nduration = 0.169\n");
    check_refused(f, Arguments{"simulate", kPaper, "--actuator", kTable2, "--motion", "motion.toml"} + kOut,
                  {"motion.toml:2:9: ", "phi_i: -27.2: ", "'phi_i_deg'"});
    f.write("motion.toml", "[motion]\nphi_i_deg = -27.2\nphi_f_deg = 1e9\nduration = 0.169\n");
    check_refused(f, Arguments{"simulate", kPaper, "--actuator", kTable2, "--motion", "motion.toml"} + kOut,
                  {"motion.toml:3:13: ", "phi_f_deg: 1000000000: ", "-360 to 360"});
  }
}

TEST_CASE("a file that is not there is named") {
  const Folder f;
  check_refused(f, Arguments{"identify", "none.csv", "--rig", kRig} + kOut, {"none.csv: no such file"});
  check_refused(f, Arguments{"identify", kTrial1, "--rig", "none.toml"} + kOut, {"none.toml: no such file"});
  check_refused(f, Arguments{"identify", kTrial1, "--rig", kRig, "--start", "none.toml"} + kOut,
                {"none.toml: no such file"});
  check_refused(f, Arguments{"predict", kTrial1, "--rig", kRig, "--actuator", "none.toml"} + kOut,
                {"none.toml: no such file"});
  check_refused(f, Arguments{"simulate", "none.toml", "--actuator", kTable2, "--hold", "0"} + kOut,
                {"none.toml: no such file"});
  check_refused(f, Arguments{"simulate", kPaper, "--actuator", kTable2, "--motion", "none.toml"} + kOut,
                {"none.toml: no such file"});
  check_refused(f, Arguments{"optimize", kPaper, "--actuator", "none.toml"} + kOut, {"none.toml: no such file"});
  check_refused(f, Arguments{"compare", "--nominal", "none.toml", "--identified", kTable2} + kOut,
                {"none.toml: no such file"});
  check_refused(f, Arguments{"compare", "--nominal", kNominal, "--identified", kTable2, "--scene", "none.toml"} + kOut,
                {"none.toml: no such file"});
}

TEST_CASE("an output folder that cannot be made is refused before any work") {
  const Folder f;
  f.write("file", "kept");
  const Arguments out = {"-o", "file/out"};
  check_refused(f, Arguments{"identify", kTrial1, "--rig", kRig} + out, {"file/out: ", "not a folder"});
  check_refused(f, Arguments{"predict", kTrial1, "--rig", kRig, "--actuator", kTable2} + out,
                {"file/out: ", "not a folder"});
  check_refused(f, Arguments{"simulate", kPaper, "--actuator", kTable2, "--hold", "-45"} + out,
                {"file/out: ", "not a folder"});
  check_refused(f, Arguments{"optimize", kPaper, "--actuator", kTable2} + out, {"file/out: ", "not a folder"});
  check_refused(f, Arguments{"compare", "--nominal", kNominal, "--identified", kTable2} + out,
                {"file/out: ", "not a folder"});
  check_refused(f, Arguments{"demo"} + out, {"file/out: ", "not a folder"});
  check_refused(f, {"identify", kTrial1, "--rig", kRig, "-o", "file"}, {"file: ", "not a folder"});
}

TEST_CASE("bad usage of the program is refused") {
  const Folder f;
  SECTION("no verb") { check_refused(f, {}, {"subcommand"}); }
  SECTION("unknown verb") { check_refused(f, {"identfy", kTrial1}, {"identfy", "identify"}); }
  SECTION("unknown option") {
    check_identify({"--bogus"}, {"--bogus"});
    check_optimize({"--evaluation", "10"}, {"--evaluation"});
  }
  SECTION("missing required option") {
    check_refused(f, Arguments{"identify", kTrial1} + kOut, {"--rig", "required"});
    check_refused(f, Arguments{"identify", "--rig", kRig} + kOut, {"TRIAL", "required"});
    check_refused(f, Arguments{"predict", kTrial1, "--rig", kRig} + kOut, {"--actuator", "required"});
    check_refused(f, Arguments{"simulate", kPaper, "--hold", "0"} + kOut, {"--actuator", "required"});
    check_refused(f, Arguments{"optimize", "--actuator", kTable2} + kOut, {"SCENE", "required"});
    check_refused(f, Arguments{"compare", "--nominal", kNominal} + kOut, {"--identified", "required"});
  }
  SECTION("an option without its value") { check_refused(f, {"identify", kTrial1, "--rig"}, {"--rig"}); }
  SECTION("--hold and --motion") {
    f.write("motion.toml", "[motion]\nphi_i = 0\nphi_f = 0\nduration = 1\n");
    const Arguments simulate = Arguments{"simulate", kPaper, "--actuator", kTable2} + kOut;
    check_refused(f, simulate, {"--motion", "--hold", "is needed"});
    check_refused(f, simulate + Arguments{"--hold", "0", "--motion", "motion.toml"},
                  {"--motion", "--hold", "is needed"});
  }
  SECTION("--trials and --rig belong together") {
    const Arguments compare = Arguments{"compare", "--nominal", kNominal, "--identified", kTable2} + kOut;
    check_refused(f, compare + Arguments{"--trials", kTrial1}, {"--trials", "--rig", "together"});
    check_refused(f, compare + Arguments{"--rig", kRig}, {"--trials", "--rig", "together"});
  }
  SECTION("a constant that is fixed without a value") {
    check_identify({"--free", "k_p"}, {"--free: ", "k_d", "--start"});
  }
}

TEST_CASE("a bad name in an option is refused with what was meant") {
  check_identify({"--free", "k_p,k_dd"},
                 {"--free: 'k_dd': ", "one of k_p, k_d, k_sea, c_sea, i_motor", "did you mean \"k_d\"?"});
  check_identify({"--nuisance", "initial_angel"}, {"--nuisance: 'initial_angel': ", "did you mean \"initial_angle\"?"});
  check_identify({"--lower", "ksea=1"}, {"--lower: 'ksea': ", "did you mean \"k_sea\"?"});
  check_identify({"--upper", "imotor=1"}, {"--upper: 'imotor': ", "did you mean \"i_motor\"?"});
  check_identify({"--loss", "hubr:1"}, {"--loss: 'hubr:1': ", "none or huber:DELTA"});
  check_identify({"--weights", "trail"}, {"--weights: 'trail': ", "equal or trial"});
  check_optimize({"--solver", "sbplex"}, {"solver: 'sbplex': ", "one of auto, ", "did you mean \"sbplx\"?"});
  check_optimize({"--objective", "peek"}, {"--objective", "peek", "\"peak\""});
}

TEST_CASE("a bad number in an option is refused with its rule") {
  check_identify({"--lower", "k_p=-1"}, {"k_p", "-1", "must be at least 0"});
  check_identify({"--lower", "k_p=5x"}, {"--lower: '5x': ", "a finite number is needed"});
  check_identify({"--lower", "k_p"}, {"--lower: 'k_p': ", "NAME=VALUE is needed"});
  check_identify({"--lower", "k_p=9", "--upper", "k_p=8"}, {"k_p", "9 to 8", "lower < upper"});
  check_identify({"--loss", "huber:0"}, {"--loss: 'huber:0': ", "above 0"});
  check_identify({"--loss", "huber:nan"}, {"--loss: 'nan': ", "a finite number is needed"});
  check_identify({"--accuracy", "1"}, {"accuracy: 1: ", "from 1e-13 to 1e-3"});
  check_identify({"--threads", "0"}, {"--threads", "0", "1 to 4096"});
  check_identify({"--seed", "-1"}, {"--seed", "-1"});
  check_identify({"--seed", "one"}, {"--seed", "one"});
  check_simulate({"--hold", "down"}, {"--hold", "down"});
  check_simulate({"--hold", "400"}, {"--hold: 400: ", "-360 to 360"});
  check_simulate({"--hold", "nan"}, {"--hold: 'nan': ", "a finite number"});
  check_simulate({"--hold", "0", "--rate", "0"}, {"--rate: 0: ", "above 0"});
  check_simulate({"--hold", "0", "--accuracy", "1e-20"}, {"accuracy: 1e-20: ", "from 1e-14 to 1e-2"});
  check_optimize({"--rate", "-1"}, {"--rate: -1: ", "above 0"});
  check_optimize({"--evaluations", "0"}, {"evaluations: 0: ", "at least 1"});
  check_optimize({"--evaluations", "many"}, {"--evaluations", "many"});
  check_optimize({"--tolerance", "-1"}, {"tolerance: -1: ", "at least 0"});
  check_optimize({"--deadline", "0"}, {"deadline: 0 s: ", "above 0"});
  check_optimize({"--deadline", "-1"}, {"deadline: -1 s: ", "above 0"});
  check_optimize({"--objective", "tolerent"}, {"--objective: 'tolerent': ", "peak or tolerant", "tolerant"});
  check_optimize({"--forbid", "hip,elbow"}, {"--forbid: 'elbow': ", "hip, knee or foot"});
  check_optimize({"--solver", "compair"}, {"solver: 'compair': ", "auto"});
}

TEST_CASE("what a motion may have beside the paper's numbers is refused where it is none") {
  check_optimize({"--bumps", "5"}, {"--bumps: 5: ", "from 0 to 4"});
  check_optimize({"--bumps", "two"}, {"--bumps", "two"});
  check_optimize({"--landing-gains", "-1:2"}, {"--landing-gains: -1: ", "at least 0"});
  check_optimize({"--landing-gains", "2:1"}, {"--landing-gains: '2:1': ", "LO:HI"});
  check_optimize({"--release-from", "0.1"}, {"--release-from", "--release-phi is needed"});
  check_optimize({"--release-phi", "-45", "--release-from", "0.4"},
                 {"--release-from: 0.4 s: ", "before the first touchdown, at 0.28"});
  check_optimize({"--release-phi", "-45", "--release-from", "-1"}, {"--release-from: -1: ", "at least 0"});
  check_optimize({"--release-phi", "nan"}, {"--release-phi: 'nan': a finite number is needed"});
  const Folder f;
  const auto scene = [&](const std::string& more) { return f.write("s.toml", read(kPaper) + "\n" + more); };
  const auto refused = [&](const std::string& more, const std::vector<std::string>& words) {
    check_refused(f, {"optimize", scene(more), "--actuator", kTable2, "-o", "out"}, words);
  };
  refused("[motion]\nbumps = 5\n", {"s.toml:", "bumps", "5: ", "0 to 4"});
  refused("[motion]\nbumps = 1.5\n", {"s.toml:", "bumps", "1.5: ", "whole number"});
  refused("[motion]\nlanding_gains = [-1, 2]\n", {"s.toml:", "landing_gains", "-1", "at least 0"});
  refused("[release]\nphi_deg = -45\nfrom = 0.5\n", {"s.toml:", "from", "0.5 s: ", "before the first touchdown"});
  refused("[joint]\nphi_deg = [-40, 0]\n[release]\nphi_deg = -45\n", {"s.toml:", "-45 deg: ", "stops, -40 to 0 deg"});
  refused("[detection]\ndelay = 1\n", {"s.toml:", "delay", "1 s: ", "at most 0.1"});
  refused("[release]\nrate_deg = 3\n", {"s.toml:", "phi_deg", "missing"});
  const std::string motion = f.write("m.toml",
                                     "[motion]\nphi_i_deg = 0\nphi_f_deg = 0\nduration = 1\n"
                                     "[reposition]\nphi_deg = 0\nfrom = 0.2\nto = 0.1\n");
  check_refused(f, {"simulate", kPaper, "--actuator", kTable2, "--motion", motion, "-o", "out"},
                {"m.toml:8", "to", "0.1 s: ", "later than `from`"});
  check_refused(f, {"ratings", kPaper, "--actuator", kTable2, "--motor-speed", "2:1:3", "-o", "out"},
                {"--motor-speed: '2:1:3': ", "LO:HI:N"});
  check_refused(f, {"ratings", kPaper, "--actuator", kTable2, "--motor-speed", "0:1:3", "-o", "out"},
                {"--motor-speed: 0: ", "above 0"});
}

TEST_CASE("a robust plan that is none is refused") {
  check_optimize({"--robust", "median"}, {"--robust: 'median'", "cvar"});
  check_optimize({"--robust", "quantile:2"}, {"--robust: 'quantile:2': ", "between 0 and 1"});
  check_optimize({"--robust", "mean", "--samples", "3"}, {"--samples: 3: ", "16 to 4096"});
  check_optimize({"--samples", "64"}, {"--samples: ", "--robust is needed"});
  check_optimize({"--robust", "mean", "--penalty", "0"}, {"--penalty: 0: ", "above 0"});
  check_optimize({"--robust", "mean", "--inflate", "-1"}, {"--inflate: -1: ", "0 to 100"});
  check_optimize({"--scatter", "pitch=1"}, {"--scatter: 'pitch'", "pitch_deg"});
  const Folder f;
  const auto refused = [&](const std::string& more, const std::vector<std::string>& words) {
    const std::string scene = f.write("s.toml", read(kPaper) + "\n" + more);
    check_refused(f, {"optimize", scene, "--actuator", kTable2, "-o", "out"}, words);
  };
  refused("[uncertainty]\norder = [\"mass\"]\ncovariance = [[1]]\n", {"s.toml:", "'mass'", "not a constant"});
  const std::string actuator = f.write(
      "a.toml", read(kTable2) + "\n[uncertainty]\norder = [\"k_p\", \"k_d\"]\n" + "covariance = [[1, 5], [5, 1]]\n");
  check_refused(f, {"optimize", kPaper, "--actuator", actuator, "--robust", "mean", "-o", "out"},
                {"covariance", "positive semidefinite"});
}

TEST_CASE("a scatter, a risk and a row of drops that are none are refused") {
  const Folder f;
  const Arguments risk = {"risk", kPaper, "--actuator", kTable2, "--hold", "-45", "-o", "out"};
  const auto scatter = [&](const std::string& text, const std::vector<std::string>& words) {
    check_refused(f, risk + Arguments{"--scatter", text}, words);
  };
  scatter("pich_deg=1", {"--scatter: 'pich_deg': ", "did you mean \"pitch_deg\"?"});
  scatter("height=-0.01", {"--scatter: 'height=-0.01': ", "at least 0"});
  scatter("stiffness=0.1", {"--scatter: 'stiffness=0.1': ", "10%"});
  scatter("stiffness=-5%", {"--scatter: 'stiffness=-5%': ", "at least 0%"});
  scatter("height=0.01,height=0.02", {"--scatter: 'height'", "twice"});
  scatter("height", {"--scatter: 'height': ", "NAME=VALUE"});
  scatter("", {"--scatter: ", "a value is needed"});
  const auto scene = [&](const std::string& lines) {
    return f.write("s.toml", read(kPaper) + "\n[scatter]\n" + lines);
  };
  const auto in_scene = [&](const std::string& lines, const std::vector<std::string>& words) {
    check_refused(f, {"risk", scene(lines), "--actuator", kTable2, "--hold", "-45", "-o", "out"}, words);
  };
  in_scene("height = -1\n", {"s.toml:30:10: ", "at least 0"});
  in_scene("stiffness = 0.1\n", {"s.toml:30:", "stiffness"});
  in_scene("stiffness = \"ten\"\n", {"s.toml:30:", "'ten': ", "10%"});
  in_scene("hight = 1\n", {"s.toml:30:1: unknown key 'hight'", "did you mean \"height\"?"});

  check_refused(f, risk + Arguments{"--samples", "99"}, {"--samples: 99: ", "100 to 10000000"});
  check_refused(f, risk + Arguments{"--inflate", "-2"}, {"--inflate: -2: ", "0 to 100"});
  check_refused(f, risk + Arguments{"--forbid", "elbow"}, {"--forbid: 'elbow': "});
  check_refused(f, risk + Arguments{"--motion", "m.toml"}, {"--motion", "--hold", "is needed"});
  f.write("drops.csv", "row,peak,height\n1,200,0.4\n2,190,-0.4\n");
  check_refused(f, risk + Arguments{"--drops", "drops.csv"}, {"drops.csv:3:7: 'height': -0.4: ", "at least 0"});
  f.write("drops.csv", "height,stiffness\n0.4,0\n");
  check_refused(f, risk + Arguments{"--drops", "drops.csv"}, {"drops.csv:2:5: 'stiffness': 0: ", "above 0"});
  f.write("drops.csv", "height\n0.4\n");
  for (const Arguments& more : {Arguments{"--samples", "1000"}, {"--scatter", "height=0.1"}, {"--inexact"}})
    check_refused(f, risk + Arguments{"--drops", "drops.csv"} + more, {more[0], "--drops"});
  check_simulate({"--hold", "0", "--drop-from", f.at("drops.csv")}, {"--drop-from: ", "FILE:ROW"});
  check_simulate({"--hold", "0", "--drop-from", f.at("drops.csv:0")}, {"--drop-from: ", "FILE:ROW"});
  check_simulate({"--hold", "0", "--drop-from", f.at("drops.csv:2")}, {"--drop-from: ", "1 row(s)"});
}

TEST_CASE("a benchmark that is none is refused") {
  const Folder f;
  check_refused(f, {"bench", "-o", "out"}, {"subcommand"});
  check_refused(f, {"bench", "optimizers", "--solvers", "none", "-o", "out"}, {"solver: 'none'"});
  check_refused(f, {"bench", "scenes", "--only", "nonsense", "-o", "out"}, {"--only", "no such omission"});
}

TEST_CASE("an error is on stderr with --json and --quiet too") {
  check_identify({"--json", "--free", "k_dd"}, {"--free: 'k_dd': "});
  check_identify({"--quiet", "--free", "k_dd"}, {"--free: 'k_dd': "});
}
