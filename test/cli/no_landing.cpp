// A result over nothing is no result, and a drive that is unstable is said to be.
#include <catch2/catch.hpp>

#include "test/cli/refused.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

/// The paper's scene with one line another.
void write_scene(const Folder& f, const std::string& from, const std::string& to) {
  f.write("scene.toml", replaced(read(kPaper), from, to));
}

}  // namespace

TEST_CASE("gravity is needed, and may be 0") {
  const Folder f;
  write_scene(f, "gravity", "# gravity");
  check_refused(f, {"simulate", "scene.toml", "--actuator", kTable2, "--hold", "-45", "-o", "out"},
                {"scene.toml:", "'gravity' is missing"});
}

TEST_CASE("a fall that never meets the floor: simulate says so, optimize has no answer") {
  const Folder f;
  const auto [from, to] = GENERATE(std::pair{"gravity = 9.81", "gravity = 0"},
                                   std::pair{"contacts = [\"hip\", \"knee\", \"foot\"]", "contacts = []"});
  write_scene(f, from, to);
  const Result flight = done(f, {"simulate", "scene.toml", "--actuator", kTable2, "--hold", "-45", "-o", "out"});
  CHECK_THAT(flight.err, Contains("no point touches the floor"));
  CHECK(summary(f)["end"] == "no contact");
  const Result r =
      run({"optimize", "scene.toml", "--actuator", kTable2, "--evaluations", "100", "-o", "best"}, f.at(""));
  CHECK(r.code == 1);
  CHECK_THAT(r.err, Contains("no point of the robot touches the floor"));
  CHECK_THAT(r.out, !Contains("nan"));
  CHECK(summary(f, "best")["motion"].is_null());
}

TEST_CASE("a drive without damping in its spring is called unstable") {
  const Folder f;
  f.write("actuator.toml", replaced(read(kTable2), "c_sea = 1.6", "c_sea = 0"));
  const Result r = run({"simulate", kPaper, "--actuator", "actuator.toml", "--hold", "-45", "-o", "out"}, f.at(""));
  CHECK(r.code == 1);  // it whirls at 1e7 rad/s, where the energy balance does not close
  CHECK_THAT(r.err, Contains("the drive is unstable on this robot") && Contains("the joint turns from"));
  const Result sound = done(f, {"simulate", kPaper, "--actuator", kTable2, "--hold", "-45", "-o", "sound"});
  CHECK_THAT(sound.err, !Contains("unstable"));
}

TEST_CASE("best known values: a scene given twice, or none, is refused") {
  const Folder f;
  fs::copy(fs::path(kPaper).parent_path().parent_path(), f.at("data"), fs::copy_options::recursive);
  const std::string known = read(f.at("data/best_known.csv"));
  ::setenv("UKEMI_DATASETS", f.at("data").c_str(), 1);
  const auto bench = [&](const std::string& from, const std::string& to) {
    f.write("data/best_known.csv", replaced(known, from, to));
    return run({"bench", "optimizers", "--times", "0.005", "--solvers", "random", "-o", "out"}, f.at(""));
  };
  const Result twice = bench("\nlow,", "\npaper,"), empty = bench("paper,171.679,", "paper,,");
  ::unsetenv("UKEMI_DATASETS");
  CHECK(twice.code == 2);
  CHECK_THAT(twice.err, Contains("best_known.csv:8:1: 'paper': the scene is given twice"));
  CHECK(empty.code == 2);
  CHECK_THAT(empty.err, Contains("best_known.csv:4:7"));
}
