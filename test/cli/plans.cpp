// What `optimize` answers is worth playing, or it says that there is no answer.
#include <catch2/catch.hpp>

#include "test/cli/program.hpp"

using namespace cli;
using Catch::Matchers::Contains;

TEST_CASE("a robot that is already falling gets a better answer than to hold, as README asks for it") {
  const Folder f;
  done(f, {"optimize", kPaper, "--actuator", kTable2, "--objective", "tolerant", "--evaluations", "2000", "--bumps",
           "2", "--release-phi", "-45", "--release-from", "0.1", "-o", "out"});
  const Json s = summary(f);
  CHECK(s["hold"]["phi_deg"].get<double>() == Approx(-45));
  CHECK(s["hold"]["peak"].get<double>() == Approx(466.17).epsilon(1e-4));
  CHECK(s["hold"]["tolerant_peak"].get<double>() == Approx(468.0).epsilon(1e-3));
  CHECK(s["hold"]["within_limits"] == true);
  CHECK(s["tolerant_peak"] < 200);
  CHECK(s["reduction"] > 0.5);
}

TEST_CASE("the best posture to hold is what simulate plays") {
  const Folder f;
  done(f, {"optimize", kPaper, "--actuator", kTable2, "--evaluations", "2000", "-o", "out"});
  const Json hold = summary(f)["hold"];
  CHECK(hold["peak"] == hold["peak_acceleration"]);
  CHECK(hold["peak"] < 466);
  CHECK(hold["tolerant_peak"] >= hold["peak"]);
  done(f, {"simulate", kPaper, "--actuator", kTable2, "--hold", hold["phi_deg"].dump(), "-o", "held"});
  CHECK(summary(f, "held")["peak_acceleration"].get<double>() == Approx(hold["peak"].get<double>()).epsilon(1e-6));
}

TEST_CASE("where nothing keeps the ratings, there is no plan but the motion that breaks them least") {
  const Folder f;
  // At 0.01 rad/s every motion is refused before a landing of it is played.
  const std::string speed = GENERATE("0.05", "0.01");
  f.write("slow.toml", replaced(read(kTable2), "speed_max = 3.14", "speed_max = " + speed));
  const Arguments asked = {"optimize",          kPaper,        "--actuator", "slow.toml", "--evaluations", "3000",
                           "--respect-ratings", "--no-report", "-o",         "out"};
  for (const Arguments& robust : {Arguments{}, Arguments{"--robust", "cvar", "--samples", "32"}}) {
    const Result r = run(asked + robust, f.at(""));
    CHECK(r.code == 1);
    CHECK_THAT(r.err, Contains("keeps the limits") && Contains("breaks them least") &&
                          Contains("times the " + speed + " allowed"));
    CHECK_THAT(r.out + r.err, !Contains("promised") && !Contains("--robust"));
    if (!robust.empty()) CHECK_THAT(r.err, Contains("in 90 % of the drops"));
    CHECK(!fs::exists(f.at("out/motion.csv")));
    const Json s = summary(f), least = s["least_breaking"];
    CHECK(s["motion"].is_null());
    CHECK(least["limit"] == std::stod(speed));
    CHECK(least["demand"] > std::stod(speed));
    CHECK(least["motion"]["duration"] > 0);
  }
}

TEST_CASE("all solvers side by side keep one deadline") {
  const Folder f;
  const auto start = std::chrono::steady_clock::now();
  done(f, {"optimize", kPaper, "--actuator", kTable2, "--solver", "compare", "--deadline", "1", "-o", "out"});
  const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  CHECK(took < 3);  // 16 s before; a busy machine may take a moment
  CHECK(summary(f)["solvers"].size() > 10);
}

TEST_CASE("an answer on the edge of its search box is said") {
  const Folder f;
  f.write("scene.toml", replaced(read(kPaper), "duration = [0.1, 1.0]", "duration = [0.9, 1.0]"));
  done(f, {"optimize", "scene.toml", "--actuator", kTable2, "--evaluations", "4000", "-o", "out"});
  const Json s = summary(f);
  const double at = s["motion"]["duration"];
  CHECK(warned(s, "duration lies on the lower edge of its search range, 0.9 s") == (at < 0.9001));
  CHECK(warned(s, "duration lies on the upper edge of its search range, 1 s") == (at > 0.9999));
}

TEST_CASE("a robot that starts on the floor has an answer, one that starts beyond the sky is refused") {
  const Folder f;
  f.write("floor.toml", replaced(read(kPaper), "height = 0.4 ", "height = 0 "));
  done(f, {"optimize", "floor.toml", "--actuator", kTable2, "--evaluations", "1000", "-o", "out"});
  CHECK(summary(f)["peak_acceleration"] < 200);
  f.write("sky.toml", replaced(read(kPaper), "height = 0.4 ", "height = 1e20 "));
  const Result r = run({"simulate", "sky.toml", "--actuator", kTable2, "--hold", "-45", "-o", "sky"}, f.at(""));
  CHECK(r.code == 2);
  CHECK_THAT(r.err, Contains("height") && Contains("1e+20") && Contains("at most 1e4"));
}
