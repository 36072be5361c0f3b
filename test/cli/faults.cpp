// What goes wrong around the program: files that are none, names that no terminal should see, streams that take
// nothing, no memory, no threads. Always one line and an exit code, never a signal.
#include <fcntl.h>
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <functional>
#include <set>

#include "test/cli/refused.hpp"

using namespace cli;
using Catch::Matchers::Contains;
using Catch::Matchers::Equals;

namespace {

const Arguments kHold = {"simulate", kPaper, "--actuator", kTable2, "--hold", "-45", "-o", "out"};

/// A sanitizer needs more room than any limit leaves.
#ifdef __SANITIZE_ADDRESS__
constexpr bool kLimitsMemory = false;
#else
constexpr bool kLimitsMemory = true;
#endif

std::string repeated(const std::string& text, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += text;
  return out;
}

double seconds_of(const std::function<void()>& act) {
  const auto start = std::chrono::steady_clock::now();
  act();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void refused_rig(const std::string& bytes, const std::vector<std::string>& texts) {
  const Folder f;
  f.write("rig.toml", bytes);
  check_refused(f, Arguments{"identify", kTrial1, "--rig", "rig.toml"} + kOut, texts);
}

}  // namespace

// ---- input

TEST_CASE("a TOML file that nests without end is refused where it goes too deep") {
  const std::string dots = "a" + repeated(".a", 100'000), deep = "rig.toml:2:66: more than 32 dots in a key";
  refused_rig("[rig]\n" + dots + " = 1\n", {deep});
  refused_rig("[rig]\n[" + dots + "]\n", {"rig.toml:2:67: more than 32 dots in a key"});
  refused_rig("[rig]\nx = {" + dots + " = 1}\n", {"rig.toml:2:71: more than 32 dots in a key"});
  refused_rig("[rig]\nx = " + repeated("[", 100'000), {"rig.toml:2:37: more than 32 brackets within brackets"});
  refused_rig("[rig]\nx = " + repeated("{a=", 100'000), {"rig.toml:2:101: more than 32 brackets within brackets"});
  // Neither strings nor comments hide what stands behind them on the line.
  refused_rig("[rig]\nx = [\"\"\"a\"\"\"\", {" + dots + " = 1}]\n", {"more than 32 dots in a key"});
  refused_rig("[rig]\nx = ['\\', {" + dots + " = 1}]\n", {"more than 32 dots in a key"});
  refused_rig("[rig]\nx = [\"\\\\\", {" + dots + " = 1}]\n", {"more than 32 dots in a key"});
}

TEST_CASE("dots and brackets in strings, comments and long lists are no nesting") {
  const Folder f;
  const std::string many = repeated(".", 100) + repeated("[{", 100);
  f.write("rig.toml", read(kRig) + "\n# " + many + "\n");
  f.write("table2.toml", read(kTable2) + "\n[provenance]\na = \"" + many + "\\\" \" # \"\nb = '" + many +
                             "'\nc = \"\"\"\n\"" + many + "\n\"\"\"\nd = [" + repeated("[0.5, 1.5], ", 200) + "]\n");
  done(f, {"predict", kTrial1, "--rig", "rig.toml", "--actuator", "table2.toml", "-o", "out"});
}

TEST_CASE("devices, pipes and files beyond every measure are no input, and no time is lost on them") {
  const Folder f;
  ::mkfifo(f.at("pipe").c_str(), 0600);
  const int huge = ::open(f.at("huge.csv").c_str(), O_CREAT | O_WRONLY, 0600);
  REQUIRE(::ftruncate(huge, off_t(5) << 30) == 0);
  ::close(huge);
  const std::string what = "is a pipe or a device: a regular file is needed";
  const double seconds = seconds_of([&] {
    for (const std::string& path : {std::string("/dev/zero"), std::string("/dev/stdin"), f.at("pipe")}) {
      INFO(path);
      const Result trial = run({"identify", path, "--rig", kRig, "-o", "out"}, f.at(""));
      CHECK(trial.code == 2);
      CHECK_THAT(trial.err, Equals("ukemi: " + path + ": " + what + "\n"));
      CHECK(run({"identify", kTrial1, "--rig", path, "-o", "out"}, f.at("")).code == 2);
    }
    const Result r = run({"identify", "huge.csv", "--rig", kRig, "-o", "out"}, f.at(""));
    CHECK(r.code == 2);
    CHECK_THAT(r.err, Contains("huge.csv: 5368709120 bytes: a file of at most 4294967296 is read"));
    f.write("zeros.csv", "");
    fs::resize_file(f.at("zeros.csv"), std::uintmax_t(3) << 30);  // sparse
    const Result zeros = run({"identify", "zeros.csv", "--rig", kRig, "-o", "out"}, f.at(""));
    CHECK(zeros.code == 2);
    CHECK_THAT(zeros.err, Contains("zeros.csv:1:1: byte 0x00: not a text file"));
    f.write("wide.toml", "[rig]\n" + repeated("# " + std::string(1000, 'x') + "\n", 17'000));
    CHECK_THAT(run({"identify", kTrial1, "--rig", "wide.toml", "-o", "out"}, f.at("")).err,
               Contains("wide.toml: a TOML file of at most 16777216 bytes is read"));
  });
  CHECK(seconds < 20);
}

TEST_CASE(
    "a seed of more than 64 bits, below 0 or no whole number is refused, one of 64 bits is kept to its last digit") {
  const Folder f;
  for (const char* seed : {"18446744073709551616", "99999999999999999999", "-1", "1.5", "1e3", "0x10", " 1"}) {
    INFO(seed);
    check_refused(f, kHold + Arguments{std::string("--seed=") + seed},
                  {"--seed", "a whole number from 0 to 18446744073709551615 is needed"});
  }
  done(f, {"optimize", kPaper, "--actuator", kTable2, "--evaluations", "20", "--seed", "18446744073709551615", "-o",
           "out"});
  CHECK(summary(f)["seed"] == 18446744073709551615u);
  CHECK(summary(f)["provenance"]["seed"] == "18446744073709551615");
  const Arguments bench = {"bench", "optimizers", "--times", "0.005", "--solvers", "random", "--no-report"};
  done(f, bench + Arguments{"--seed", "18446744073709551615", "-o", "one"});
  const Result again =
      done(f, bench + Arguments{"--seed", "18446744073709551615", "--with", "one/optimizers.csv", "-o", "two"});
  CHECK_THAT(again.err, Contains("20 searches, 20 from earlier runs"));
}

// ---- names

TEST_CASE("a name is shown escaped, and every file that names it reads back") {
  const Folder f;
  const std::string name =
      GENERATE(std::string("two\nlines.csv"), std::string("bell\x07 \x1b[31mred.csv"), std::string("return\r.csv"),
               std::string("turned \xE2\x80\xAE.csv"), std::string("no utf-8 \xFC.csv"),
               std::string("\xC2\x9B"
                           "31m.csv"));
  const auto printable = [](const std::string& text, const std::string& lines) {
    return std::all_of(text.begin(), text.end(), [&](char c) {
      return static_cast<unsigned char>(c) >= 32 ? c != 127 : lines.find(c) != std::string::npos;
    });
  };
  const auto clean = [&](const std::string& text) {
    return printable(text, "\n") && text.find("\xE2\x80\xAE") == std::string::npos &&
           text.find("\xC2\x9B") == std::string::npos && text.find('\xFC') == std::string::npos;
  };
  INFO(name);
  check_refused(f, Arguments{"identify", name, "--rig", kRig} + kOut, {"no such file"});
  CHECK(clean(run({"identify", name, "--rig", kRig, "-o", "out"}, f.at("")).err));
  CHECK(clean(run({"identify", kTrial1, "--rig", kRig, "--free", name, "-o", "out"}, f.at("")).err));
  CHECK(clean(run({name}, f.at("")).err));
  CHECK(clean(run({"identify", "--" + name}, f.at("")).err));

  fs::copy_file(kTrial1, f.at(name));
  const std::string folder = "out of " + name;
  const Result r = done(f, {"identify", name, name, "--rig", kRig, "-o", folder});
  CHECK(clean(r.err));
  CHECK(clean(r.out));
  CHECK_THAT(r.err, Contains("count twice"));
  for (const auto& [file, text] : f.content(folder)) {
    INFO(file);
    CHECK(printable(text, "\n"));
    if (file != "summary.json") CHECK(clean(text));
  }
  const Json s = summary(f, folder);
  CHECK(s["trials"].size() == 2);
  if (name.find('\xFC') == std::string::npos) CHECK(s["trials"][0]["file"] == name);
  const std::string actuator = folder + "/actuator.toml", motion = folder + "/motion.toml";
  done(f, {"optimize", kPaper, "--actuator", actuator, "--evaluations", "20", "-o", folder});
  done(f, {"simulate", kPaper, "--actuator", actuator, "--motion", motion, "-o", "landing"});
}

TEST_CASE("an actuator's name comes back as it was, whatever it holds") {
  const Folder f;
  f.write("rig.toml", read(kRig));
  const std::string name = "Gr\xC3\xBC\xC3\x9F\" \\ e\n\x1b";
  f.write("named.toml", replaced(read(kTable2), "name = \"", "name = \"Gr\xC3\xBC\xC3\x9F\\\" \\\\ e\\n\\u001B"));
  const Result r = done(f, {"compare", "--nominal", "named.toml", "--identified", kTable2, "-o", "out"});
  CHECK(read(f.at("out/report.html")).find('\x1b') == std::string::npos);
}

TEST_CASE("the command line in the provenance is one that a shell takes back") {
  const Folder f;
  fs::copy_file(kPaper, f.at("it's a scene.toml"));
  done(f, {"simulate", "it's a scene.toml", "--actuator", kTable2, "--hold", "-45", "-o", "o\nut"});
  CHECK(summary(f, "o\nut")["provenance"]["command"] ==
        "ukemi simulate 'it'\\''s a scene.toml' --actuator " + kTable2 + " --hold -45 -o $'o\\nut'");
}

// ---- streams

TEST_CASE("messages go on where stderr takes none") {
  const Folder f;
  for (const char* err : {">/dev/full", ">&-"}) {
    INFO(err);
    CHECK(run(kHold, f.at(""), {.err = err}).code == 0);
    CHECK(run({"optimize", kPaper, "--actuator", kTable2, "--evaluations", "20", "-o", "opt"}, f.at(""), {.err = err})
              .code == 0);
    CHECK(run({"identify", "none.csv", "--rig", kRig, "-o", "none"}, f.at(""), {.err = err}).code == 2);
    CHECK(run({"identfy"}, f.at(""), {.err = err}).code == 2);
    CHECK(Json::accept(read(f.at("out/summary.json"))));
  }
}

TEST_CASE("results that stdout did not take are an error, told on stderr, the files are there") {
  const Folder f;
  const Arguments json = kHold + Arguments{"--json"};
  const auto check = [&](const Arguments& arguments, const std::string& out, const std::string& reason) {
    INFO(arguments[0] << " " << out);
    const Result r = run(arguments, f.at(""), {.out = out});
    CHECK(r.code == 1);
    CHECK_THAT(r.err, Contains("ukemi: stdout cannot be written: " + reason));
  };
  for (const Arguments& arguments : {kHold, json, Arguments{"--help"}, Arguments{"--version"}}) {
    check(arguments, ">/dev/full", "No space left on device");
    check(arguments, ">&-", "Bad file descriptor");
  }
  // A reader that goes at once.
  const Result broken = run(json, f.at(""), {.limits = "{ mkfifo pipe; (: <pipe) & }", .out = ">pipe"});
  CHECK(broken.code == 1);
  CHECK_THAT(broken.err, Contains("ukemi: stdout cannot be written: Broken pipe"));
  CHECK(summary(f)["end"] == "rest");
}

// ---- memory and threads

TEST_CASE("without the memory or the threads that it asks for the program goes on or says so") {
  if (!kLimitsMemory) {
    WARN("skipped: a sanitizer needs more memory than a limit leaves");
    return;
  }
  const Folder f;
  const auto within = [&](long kibibytes, const Arguments& arguments) {
    return run(arguments, f.at(""), {.limits = "ulimit -v " + std::to_string(kibibytes)});
  };
  long least = 16'000;  // [KiB] the libraries alone
  while (within(least, {"--version"}).code != 0) least += 400;
  const Arguments map = {"map", kPaper, "--actuator", kTable2, "--grid", "4,4,4", "--polish", "2"};
  const Arguments fit = {"identify", kTrial1, kTrial2, "--rig", kRig};
  const Arguments search = {"optimize", kPaper, "--actuator", kTable2, "--evaluations", "300"};
  int done_some = 0, without_memory = 0;
  for (const Arguments& arguments : {map, fit, search})
    for (const long more : {0, 400, 1000, 2000, 4000, 10'000, 18'000, 40'000, 200'000}) {  // a stack takes 8192
      const Result r = within(least + more, arguments + Arguments{"--threads", "64"} + kOut);
      INFO(arguments[0] << " within " << least + more << " KiB: " << r.code << " " << r.err);
      CHECK((r.code == 0 || r.code == 1));
      if (r.code == 1) CHECK_THAT(r.err, Contains("ukemi: not enough memory\n"));
      done_some += r.code == 0, without_memory += r.code == 1;
    }
  CHECK(done_some > 9);
  CHECK(without_memory > 0);
}
