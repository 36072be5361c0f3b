// motion.csv as the robot plays it, given back to the program.
#include <catch2/catch.hpp>

#include "test/cli/program.hpp"

using namespace cli;

TEST_CASE("motion.csv gives the peak of motion.toml, with shape terms, gains and a move in the air") {
  const Folder f;
  const Arguments optimize = {"optimize", kPaper, "--actuator", kTable2, "--evaluations", "200", "-o", "best"};
  const auto check = [&](const Arguments& more) {
    done(f, optimize + more);
    double peak[2];
    for (int i : {0, 1}) {
      done(f, {"simulate", kPaper, "--actuator", kTable2, "--motion", i ? "best/motion.csv" : "best/motion.toml", "-o",
               "out", "--no-report"});
      peak[i] = summary(f)["peak_acceleration"];
    }
    CHECK(peak[1] == Approx(peak[0]).epsilon(1e-6));
  };
  check({});
  check({"--bumps", "4", "--landing-gains", "0.5:2"});
  check({"--bumps", "2", "--release-phi", "-45", "--release-from", "0.1"});
  check({"--release-phi", "-45", "--release-from", "0.2", "--release-rate", "20", "--rate", "2000"});
}
