// What the program says of words that are not quite right, and one word for one thing.
#include <algorithm>
#include <catch2/catch.hpp>

#include "test/cli/refused.hpp"

using namespace cli;
using Catch::Matchers::Contains;

TEST_CASE("words: --help has each option under a heading, in one order") {
  const Folder f;
  const std::string help = done(f, {"optimize", "--help"}).out;
  std::size_t last = 0;
  for (const char* heading :
       {"What to plan for:", "The robot and its drop:", "The motion:", "The search:", "The files:"}) {
    const std::size_t at = help.find(std::string("\n") + heading);
    INFO(heading);
    REQUIRE(at != std::string::npos);
    CHECK(at > last);
    last = at;
  }
  for (const char* verb : {"identify", "predict", "compare", "calibrate", "design", "simulate", "optimize", "risk",
                           "map", "atlas", "trade", "ratings", "robot", "demo"}) {
    const std::string text = done(f, {verb, "--help"}).out;
    const std::size_t begin = text.find("\nOptions:\n"), end = text.find("\n\n", begin + 1);
    INFO(verb);
    REQUIRE(begin != std::string::npos);
    const std::string loose = text.substr(begin, end - begin);
    CHECK_THAT(loose, Contains("--help"));
    CHECK(std::count(loose.begin(), loose.end(), '\n') == 2);  // nothing else
  }
}

TEST_CASE("words: help VERB is VERB --help, and help alone is --help") {
  const Folder f;
  CHECK(done(f, {"help", "optimize"}).out == done(f, {"optimize", "--help"}).out);
  CHECK(done(f, {"help", "bench", "scenes"}).out == done(f, {"bench", "scenes", "--help"}).out);
  CHECK(done(f, {"help"}).out == done(f, {"--help"}).out);
  check_refused(f, {"help", "optimise"}, {"'optimise'", "no such verb", "\"optimize\""});
}

TEST_CASE("words: a number that is none is refused with option, value and rule, and numbers are decimal") {
  const Arguments base = {"optimize", kPaper, "--actuator", kTable2, "-o", "out"};
  for (const char* bad : {"50ms", "0x10", "nan", "1e999", "1 2"})
    check_refused(Folder(), base + Arguments{"--deadline", bad}, {"--deadline: ", "a finite number is needed"});
  check_refused(Folder(), base + Arguments{"--evaluations", "1.5"}, {"--evaluations: '1.5': a whole number is needed"});
  check_refused(Folder(), base + Arguments{"--evaluations", "0x10"}, {"--evaluations: '0x10'"});
}

TEST_CASE("words: an option that there is not is told with the nearest one") {
  const Folder f;
  check_refused(f, {"optimize", kPaper, "--actuator", kTable2, "--deadlin", "5"},
                {"'--deadlin'", "no such option of optimize", "\"--deadline\""});
  check_refused(f, {"optimize", kPaper, "--actuator", kTable2, "--dead-line=5"}, {"'--dead-line'", "\"--deadline\""});
  check_refused(f, {"bench", "scenes", "--repetition", "5"}, {"'--repetition'", "no such option of scenes"});
}

TEST_CASE("words: an option's value that is not quite right is told with the nearest one") {
  const Arguments base = {"optimize", kPaper, "--actuator", kTable2, "-o", "out"};
  check_refused(Folder(), base + Arguments{"--solver", "aut"}, {"'aut'", "\"auto\""});
  check_refused(Folder(), base + Arguments{"--objective", "tolernt"}, {"--objective: 'tolernt'", "\"tolerant\""});
  check_refused(Folder(), base + Arguments{"--robust", "cvr"}, {"--robust: 'cvr'", "\"cvar\""});
  check_refused(Folder(), base + Arguments{"--forbid", "knee,feet"}, {"--forbid: 'feet'", "\"foot\""});
  check_refused(Folder(), base + Arguments{"--figures", "sgv"}, {"--figures: 'sgv'", "\"svg\""});
}

TEST_CASE("words: --hold is in degrees, and an angle like one in radians is warned of") {
  const Folder f;
  const Arguments hold = {"simulate", kPaper, "--actuator", kTable2, "-o", "out", "--hold"};
  done(f, hold + Arguments{"-0.78"});
  CHECK(warned(summary(f), "--hold: -0.78: degrees, not radians (-0.78 rad would be -44.69)"));
  for (const char* meant : {"0", "-2", "-45"}) {
    done(f, hold + Arguments{meant});
    CHECK(!warned(summary(f), "--hold"));
  }
}

TEST_CASE("words: with --robust landings are counted and called so, else motions") {
  const Folder f;
  const Arguments base = {"optimize", kPaper, "--actuator",    kTable2, "--no-report",
                          "-o",       "out",  "--evaluations", "3000"};
  const Result robust = done(f, base + Arguments{"--robust", "cvar", "--samples", "16", "--details"});
  CHECK_THAT(robust.err, Contains("3000 landings") && !Contains("3000 motions"));
  CHECK(summary(f)["landings"].get<long>() >= summary(f)["evaluations"].get<long>());
  CHECK_THAT(robust.out, Contains("motions evaluated") && Contains("landings played"));
  CHECK_THAT(done(f, base).err, Contains("3000 motions"));
}

TEST_CASE("words: optimize says its answer in ten lines, every number with --details") {
  const Folder f;
  const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n'); };
  for (const Arguments& scene : {Arguments{kPaper, "--actuator", kTable2}, {UKEMI_DATASETS "/scenes/hopper.toml"}})
    for (const Arguments& goal : {Arguments{}, {"--robust", "mean", "--samples", "16"}, {"--objective", "tolerant"}}) {
      const Arguments base = Arguments{"optimize", "--no-report", "-o", "out", "--evaluations", "300"} + scene + goal;
      const std::string few = done(f, base).out, all = done(f, base + Arguments{"--details"}).out;
      INFO(few);
      CHECK(lines(few) <= 10);
      CHECK(lines(all) > lines(few));
      CHECK_THAT(few, Contains("Lands with ") && Contains("motion: ") && Contains("contacts: "));
    }
}

TEST_CASE("words: a CSV file says how it is read, and is") {
  const Folder f;
  done(f, {"simulate", kPaper, "--actuator", kTable2, "--hold", "-45", "-o", "out"});
  CHECK_THAT(read(f.at("out/trajectory.csv")), Contains("# Read with pandas.read_csv(file, comment=\"#\")"));
}
