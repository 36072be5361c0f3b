// A folder of results is of one run: what fails, is killed or finds the disk full leaves the earlier run's or its own.
#include <fcntl.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <functional>
#include <random>
#include <set>

#include "common/files.hpp"
#include "test/cli/refused.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

const Arguments kOptimize = {"optimize", kPaper, "--actuator", kTable2, "--evaluations", "50", "-o", "out"};
const Arguments kHold = {"simulate", kPaper, "--actuator", kTable2, "--hold", "-45", "-o", "out"};
const Arguments kDesign = {"design", kTrial1,   kTrial2, "--rig",   kRig,   "--actuator", kTable2, "--check",
                           "0",      "--width", "0.02",  "--noise", "5e-4", "-o",         "out"};

std::set<std::string> names_in(const std::string& folder) {
  std::set<std::string> out;
  for (const auto& entry : fs::directory_iterator(folder)) out.insert(entry.path().filename());
  return out;
}

/// Every file in the folder is named by its summary, and carries the summary's command and time.
void check_one_run(const Folder& f, const std::string& folder = "out") {
  const Json s = summary(f, folder);
  CHECK(s["files"].get<std::set<std::string>>() == names_in(f.at(folder)));
  const Json& p = s["provenance"];
  std::string command = p["command"].get<std::string>(), time = p["time"].get<std::string>();
  for (const auto& [name, text] : f.content(folder)) {
    INFO(name);
    CHECK(text.find(command) != std::string::npos);
    CHECK(text.find(time) != std::string::npos);
  }
}

/// The program, killed once `moment` has come (20 s at most); true where it was still running.
bool killed(const Arguments& arguments, const Folder& f, const std::function<bool()>& moment) {
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    const int nowhere = ::open("/dev/null", O_RDWR);
    for (const int stream : {0, 1, 2}) ::dup2(nowhere, stream);
    std::vector<char*> argv = {const_cast<char*>(UKEMI_PROGRAM)};
    for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
    argv.push_back(nullptr);
    if (::chdir(f.at("").c_str()) == 0) ::execv(UKEMI_PROGRAM, argv.data());
    ::_exit(127);
  }
  for (double t = 0; t < std::stod(patience()) && !moment(); t += 1e-3) ::usleep(1000);
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFSIGNALED(status);
}
/// The same, after `delay` [us].
bool killed(const Arguments& arguments, const Folder& f, long delay) {
  return killed(arguments, f, [delay] { return ::usleep(useconds_t(delay)) == 0; });
}

int kills() {
  const char* given = std::getenv("UKEMI_KILLS");
  return given ? std::stoi(given) : 6;
}

}  // namespace

TEST_CASE("a run leaves nothing of the earlier one, whatever it writes itself") {
  const Folder f;
  SECTION("a search that fails leaves no earlier motion") {
    done(f, kOptimize);
    check_one_run(f);
    CHECK(run(kOptimize + Arguments{"--forbid", "hip,knee,foot"}, f.at("")).code == 1);
    CHECK(names_in(f.at("out")) == std::set<std::string>{"summary.json"});
  }
  SECTION("fewer hits") {
    run(kDesign + Arguments{"--hits", "2"}, f.at(""));
    CHECK(names_in(f.at("out")).count("hit_2.csv") == 1);
    run(kDesign + Arguments{"--hits", "1"}, f.at(""));
    CHECK(names_in(f.at("out")).count("hit_1.csv") == 1);
    CHECK(names_in(f.at("out")).count("hit_2.csv") == 0);
  }
  SECTION("no report") {
    done(f, kHold);
    done(f, kHold + Arguments{"--no-report"});
    CHECK(names_in(f.at("out")) == std::set<std::string>{"contacts.csv", "summary.json", "trajectory.csv"});
  }
  SECTION("no profile, no validation") {
    const Arguments identify = {"identify",    kTrial1,   kTrial2, "--rig", kRig, "--free",
                                "k_sea,c_sea", "--start", kTable2, "-o",    "out"};
    run(identify + Arguments{"--profile", "k_sea"}, f.at(""));
    CHECK(names_in(f.at("out")).count("profile.csv") == 1);
    run(identify, f.at(""));
    CHECK(names_in(f.at("out")).count("profile.csv") == 0);
  }
  check_one_run(f);
}

TEST_CASE("an earlier run of another verb leaves nothing, but what was changed since or is read") {
  const Folder f;
  SECTION("all of it goes") {
    done(f, kOptimize);
    done(f, kHold);
    check_one_run(f);
  }
  SECTION("what this run reads stays") {
    done(f, kOptimize);
    const std::string motion = read(f.at("out/motion.toml"));
    done(f, {"simulate", kPaper, "--actuator", kTable2, "--motion", "out/motion.toml", "-o", "out"});
    CHECK(read(f.at("out/motion.toml")) == motion);
    CHECK_FALSE(fs::exists(f.at("out/motion.csv")));
  }
  SECTION("what was changed since stays") {
    done(f, kOptimize);
    f.write("out/motion.toml", read(f.at("out/motion.toml")) + "# mine\n");
    f.write("out/progress.csv", "mine");
    done(f, kHold);
    CHECK_THAT(read(f.at("out/motion.toml")), Contains("# mine"));
    CHECK(read(f.at("out/progress.csv")) == "mine");
    CHECK_FALSE(fs::exists(f.at("out/motion.csv")));
  }
  SECTION("demo, which is of several runs, killed in its second") {
    done(f, kOptimize);
    CHECK(killed({"demo", "-o", "out"}, f, [&] { return fs::exists(f.at("out/identify/summary.json")); }));
    CHECK(names_in(f.at("out")).count("motion.csv") == 0);
  }
  SECTION("a summary that is none, or names files elsewhere") {
    f.write("mine.csv", "mine");
    f.write("out/summary.json", "{\"provenance\": {\"wrote ../mine.csv\": \"fnv1a-64 " + ukemi::checksum("mine") +
                                    "\", \"wrote gone\": 1}}");
    done(f, kHold);
    CHECK(read(f.at("mine.csv")) == "mine");
    f.write("out/summary.json", "mine");
    done(f, kHold);
  }
}

TEST_CASE("files that are not results stay") {
  const Folder f;
  done(f, kHold);
  f.write("out/notes.txt", "mine");
  fs::create_directory(f.at("out/deeper"));
  f.write("out/deeper/trajectory.csv", "mine");
  f.write("out/hit_1_mine.csv", "mine");
  done(f, kOptimize);
  CHECK(read(f.at("out/notes.txt")) == "mine");
  CHECK(read(f.at("out/deeper/trajectory.csv")) == "mine");
  CHECK(read(f.at("out/hit_1_mine.csv")) == "mine");
  CHECK_FALSE(fs::exists(f.at("out/trajectory.csv")));  // of simulate
  CHECK(names_in(f.at("out")).count(".ukemi-commit") == 0);
  CHECK(names_in(f.at("")) == std::set<std::string>{"out"});
  const Json listed = summary(f)["files"];
  for (const Json& name : listed) CHECK(fs::exists(f.at("out/" + name.get<std::string>())));
}

TEST_CASE("a run that fails on its input leaves the earlier results as they were") {
  const Folder f;
  done(f, kHold);
  f.write("bad.toml", "[robot]\n");
  check_refused(f, {"simulate", "bad.toml", "--actuator", kTable2, "--hold", "-45", "-o", "out"}, {"bad.toml"});
  check_refused(f, kHold + Arguments{"--rate", "0"}, {"--rate"});
}

TEST_CASE("the results of the folder in which the program was started are exchanged too") {
  const Folder f;
  fs::create_directory(f.at("out"));
  for (int i = 0; i < 2; ++i)
    REQUIRE(run({"simulate", kPaper, "--actuator", kTable2, "--hold", "-45", "-o", "."}, f.at("out")).code == 0);
  check_one_run(f);
}

TEST_CASE("demo's parts and its summary are of one run") {
  const Folder f;
  fs::create_directory(f.at("out"));
  f.write("out/summary.json", "an earlier run's");
  // Killed in its second part: the first is new, and no earlier summary speaks for it.
  const bool running = killed({"demo", "-o", "out"}, f, [&] { return fs::exists(f.at("out/identify/summary.json")); });
  CHECK(running);
  CHECK(!fs::exists(f.at("out/summary.json")));
  check_one_run(f, "out/identify");
}

TEST_CASE("a run that would write over one of its inputs is refused before any work") {
  const Folder f;
  done(f, {"identify", kTrial1, "--rig", kRig, "-o", "out"});
  const std::vector<std::string> rule = {": this run would write over it, as ", "another output folder is needed"};
  const Arguments identify = {"identify", kTrial1, "--rig", kRig, "-o", "out"};
  fs::create_symlink("out/actuator.toml", f.at("soft.toml"));
  fs::create_hard_link(f.at("out/actuator.toml"), f.at("hard.toml"));
  fs::create_symlink("out", f.at("link"));
  for (const char* start : {"out/actuator.toml", "soft.toml", "hard.toml", "link/actuator.toml"})
    check_refused(f, identify + Arguments{"--start", start}, rule);
  check_refused(f, {"identify", kTrial1, "--rig", kRig, "-o", "link", "--start", "out/actuator.toml"}, rule);
  fs::copy_file(kTrial1, f.at("fit.csv"));
  fs::copy_file(kPaper, f.at("scene.toml"));
  check_refused(f, {"identify", "fit.csv", "--rig", kRig, "-o", "."}, rule);
  check_refused(f, {"predict", "fit.csv", "--rig", kRig, "--actuator", kTable2, "-o", "."}, rule);
  const std::string drop = dataset("drops/drop_1.csv");
  check_refused(f,
                {"calibrate", drop, "--scene", "scene.toml", "--actuator", kTable2, "--motion",
                 dataset("drops/hold.toml"), "-o", "."},
                rule);
  // One that it leaves alone may stand there.
  done(f, {"optimize", kPaper, "--actuator", "out/actuator.toml", "--evaluations", "20", "-o", "out"});
  done(f, {"predict", kTrial1, "--rig", kRig, "--actuator", "out/actuator.toml", "-o", "out"});
}

TEST_CASE("the checksum is of the bytes that were read, also where the file has changed since") {
  const Folder f;
  fs::copy_file(kPaper, f.at("scene.toml"));
  const Arguments optimize = {"optimize", "scene.toml", "--actuator", kTable2, "--deadline", "0.5", "-o"};
  done(f, optimize + Arguments{"first"});
  // The file is exchanged while the search runs.
  const std::string later = "{ (sleep 0.25; echo '# later' >>scene.toml) & }";
  REQUIRE(run(optimize + Arguments{"second"}, f.at(""), {.limits = later}).code == 0);
  CHECK_THAT(read(f.at("scene.toml")), Contains("# later"));
  CHECK(summary(f, "second")["provenance"]["checksum scene.toml"] ==
        summary(f, "first")["provenance"]["checksum scene.toml"]);
}

TEST_CASE("a full disk leaves the earlier results, and says what happened") {
  const Folder f;
  const auto check = [&](const Surroundings& around, const std::string& folder, const std::string& reason) {
    const auto before = f.content(folder);
    const Result r = run({"simulate", kPaper, "--actuator", kTable2, "--hold", "-50", "-o", folder}, f.at(""), around);
    INFO(r.err);
    CHECK(r.code == 2);
    CHECK_THAT(r.err, Contains(folder + "/") && Contains("cannot be written: " + reason));
    const bool untouched = f.content(folder) == before;
    CHECK(untouched);
  };
  done(f, kHold);
  SECTION("a limit on the length of a file") { check({.limits = "ulimit -f 100"}, "out", "File too large"); }
  SECTION("the same beside other files") {
    f.write("out/notes.txt", "mine");
    check({.limits = "ulimit -f 100"}, "out", "File too large");
  }
  SECTION("a small file system") {
    fs::create_directory(f.at("small"));
    if (::mount("none", f.at("small").c_str(), "tmpfs", 0, "size=2m") != 0) {
      WARN("skipped: no file system can be mounted here");
      return;
    }
    const Folder capture;  // the streams of `run` go elsewhere
    run({"simulate", kPaper, "--actuator", kTable2, "--hold", "-45", "-o", "small/out"}, f.at(""));
    const std::uintmax_t left = fs::space(f.at("small")).available;
    f.write("small/filler", std::string(std::size_t(left > 65536 ? left - 65536 : 0), 'x'));
    check({}, "small/out", "No space left on device");
    CHECK(names_in(f.at("small")) == std::set<std::string>{"filler", "out"});
    ::umount(f.at("small").c_str());
  }
}

TEST_CASE("a kill at any moment leaves the folder of one run") {
  const Folder f;
  // Two commands a verb, so that each can tell the other's files.
  const std::vector<std::array<Arguments, 2>> verbs = {
      {kHold, kHold + Arguments{"--no-report", "--rate", "500"}},
      {kOptimize, kOptimize + Arguments{"--forbid", "hip,knee,foot"}},
      {Arguments{"predict", kTrial1, "--rig", kRig, "--actuator", kTable2, "-o", "out"},
       Arguments{"predict", kTrial2, "--rig", kRig, "--actuator", kTable2, "-o", "out"}},
      {Arguments{"compare", "--nominal", kNominal, "--identified", kTable2, "-o", "out"},
       Arguments{"compare", "--nominal", kTable2, "--identified", kTable2, "-o", "out"}},
      {kDesign + Arguments{"--hits", "2"}, kDesign + Arguments{"--hits", "1"}},
      {Arguments{"identify", kTrial1, "--rig", kRig, "-o", "out"},
       Arguments{"identify", kTrial2, "--rig", kRig, "--no-report", "-o", "out"}},
      {Arguments{"map", kPaper, "--actuator", kTable2, "--grid", "4,4,4", "--polish", "2", "-o", "out"},
       Arguments{"map", kPaper, "--actuator", kTable2, "--grid", "5,4,4", "--polish", "2", "--no-report", "-o",
                 "out"}}};
  std::mt19937 random(12);
  int alive = 0, runs = 0;
  for (const auto& commands : verbs) {
    fs::remove_all(f.at("out"));
    const auto start = std::chrono::steady_clock::now();
    run(commands[0], f.at(""));
    const auto taken = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start);
    for (int k = 0; k < kills(); ++k) {
      // Half of them near the end, where files are written.
      const double part = double(random() % 1000) / 1000;
      alive +=
          killed(commands[std::size_t(k + 1) % 2], f, long(double(taken.count()) * (k % 2 ? part : 0.8 + part / 4)));
      ++runs;
      INFO(commands[0][0] << ", kill " << k);
      check_one_run(f);
    }
    run(commands[1], f.at(""));
    check_one_run(f);
    CHECK(names_in(f.at("")) == std::set<std::string>{"out"});
  }
  WARN(alive << " of " << runs << " runs were killed before their end");
}

TEST_CASE("messages have colours on a terminal only, and none with NO_COLOR") {
  if (std::system("command -v script >/dev/null 2>&1") != 0) {
    WARN("no script(1) here: skipped");
    return;
  }
  const Folder f;
  const auto told = [&](const std::string& environment, const std::string& arguments, bool terminal) {
    const std::string command = environment + " " UKEMI_PROGRAM " " + arguments;
    const std::string log = f.at("log");
    const std::string whole = terminal ? "script -qec '" + command + "' /dev/null </dev/null >" + log + " 2>&1"
                                       : command + " >" + log + " 2>&1";
    (void)std::system(whole.c_str());
    return read(log);
  };
  const std::string refused = "simulate nowhere.toml";
  CHECK_THAT(told("TERM=xterm", refused, true), Contains("\033[1;31mukemi"));
  CHECK_THAT(told("TERM=xterm NO_COLOR=", refused, true), Contains("\033[1;31m"));  // empty: as if not set
  for (const auto& [environment, terminal] :
       {std::pair("TERM=xterm NO_COLOR=1", true), {"TERM=dumb", true}, {"TERM=xterm", false}}) {
    const std::string text = told(environment, refused, terminal);
    CHECK_THAT(text, Contains("ukemi"));
    CHECK(text.find('\033') == std::string::npos);
  }
}
