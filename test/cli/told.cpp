// What an answer must say of itself: a drive that lost the joint, drops that begin on the floor, what was not checked.
#include <catch2/catch.hpp>

#include "test/cli/program.hpp"

using namespace cli;

namespace {

/// A shipped file with one line in place of that which begins so.
std::string changed(const std::string& path, const std::string& begin, const std::string& line) {
  const std::string text = read(path);
  const std::size_t at = text.find("\n" + begin);
  REQUIRE(at != std::string::npos);
  return text.substr(0, at + 1) + line + text.substr(text.find('\n', at + 1));
}
std::string dropped_from(const Folder& f, const std::string& height) {
  return f.write("height_" + height + ".toml", changed(kPaper, "height", "height = " + height));
}

}  // namespace

TEST_CASE("told: a drive that loses the joint, by every verb that lands") {
  const Folder f;
  const std::string weak = f.write("weak.toml", changed(kTable2, "tau_max", "tau_max = 3"));
  const std::string scene = f.write("short.toml", read(kPaper) + "\n[run]\nt_end = 3\n");
  const Arguments hold{"--actuator", weak, "--hold", "-45", "--no-report", "-o", "out"};
  done(f, Arguments{"simulate", scene} + hold);
  CHECK(summary(f)["joint_lost"] == true);
  CHECK(warned(summary(f), "the drive has lost it"));
  done(f, Arguments{"risk", scene, "--samples", "200"} + hold);
  CHECK(summary(f)["joint_lost"].get<long>() > 100);
  CHECK(warned(summary(f), "drops the drive loses the joint"));
  done(f, {"map", scene, "--actuator", weak, "--grid", "2,2,2", "--polish", "1", "--no-report", "-o", "out"});
  CHECK(summary(f)["joint_lost"].get<long>() > 0);
  CHECK(warned(summary(f), "landings the drive loses the joint"));
  done(f, {"simulate", kPaper, "--actuator", kTable2, "--hold", "-45", "--no-report", "-o", "out"});
  CHECK(summary(f)["joint_lost"] == false);
  CHECK(summary(f)["sensitive"] == false);

  const std::string by_links = dataset("scenes/paper_friction.toml");
  const Arguments drive{"--actuator", weak, "--no-report", "-o", "out"};
  done(f, Arguments{"simulate", by_links, "--hold", "-45"} + drive);
  CHECK(summary(f)["joint_lost"] == true);
  CHECK(warned(summary(f), "the peak is that of a link that whirls"));
  done(f, Arguments{"risk", by_links, "--samples", "200", "--hold", "-45"} + drive);
  CHECK(summary(f)["joint_lost"].get<long>() > 100);
  done(f, Arguments{"map", by_links, "--vary", "phi_i_knee:4", "--polish", "1"} + drive);
  CHECK(summary(f)["joint_lost"].get<long>() > 0);
  CHECK(warned(summary(f), "landings the drive loses the joint"));
  done(f, {"simulate", by_links, "--hold", "-45", "--no-report", "-o", "out"});
  CHECK(summary(f)["joint_lost"] == false);
}

TEST_CASE("told: a robot that starts on the floor lands, and drops that would begin below it are counted") {
  const Folder f;
  const std::string floor = dropped_from(f, "0"), low = dropped_from(f, "0.01");
  done(f, {"optimize", floor, "--actuator", kTable2, "--evaluations", "300", "--no-report", "-o", "out"});
  CHECK(summary(f)["peak_acceleration"].get<double>() < summary(f)["hold"]["peak_acceleration"].get<double>());
  const Arguments risk{"--actuator", kTable2, "--hold", "-45", "--samples", "500", "--no-report", "-o", "out"};
  done(f, Arguments{"risk", low, "--scatter", "height=0.01"} + risk);
  CHECK(summary(f)["failed"] == 0);
  CHECK(summary(f)["peak"]["samples"] == 500);
  CHECK(summary(f)["from_floor"].get<double>() / 500 == Approx(0.158).margin(0.01));  // of a normal number below -1
  CHECK(warned(summary(f), "would begin below the floor"));
  done(f, Arguments{"risk", kPaper} + risk);
  CHECK(summary(f)["from_floor"] == 0);
  CHECK_FALSE(warned(summary(f), "floor"));
  done(f, {"atlas", floor, "--actuator", kTable2, "--height", "0:0.1:2", "--speed", "0:0.5:2", "--pitch-deg", "10:20:2",
           "--evaluations", "60", "--no-report", "-o", "out"});
  CHECK(summary(f)["planned"] == 8);
}
