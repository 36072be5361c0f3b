// Drop logs in, scenes out and in again.
#include <catch2/catch.hpp>
#include <cmath>

#include "common/files.hpp"
#include "landing/drops/drop_log.hpp"
#include "landing/model/scene_file.hpp"
#include "test/folder.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace test;

TEST_CASE("drop log: columns in any order and unit, gaps, rows before the release") {
  const File f("drop.csv",
               "# made up\nphi_0_deg; note; t_ms; acc_g; y_0_mm\n9;x;-1;0;0\n10;a;0;1;700\n;b;1;;699\n-20;c;2.5;2;\n");
  const DropLog log = read_drop(f.path);
  CHECK(log.file == f.path);
  CHECK(log.before_release == 1);
  CHECK(log.t == std::vector<double>{0, 0.001, 0.0025});
  CHECK(log.output[kAcc][0] == 9.80665);
  CHECK(std::isnan(log.output[kAcc][1]));
  CHECK(log.output[kAcc][2] == 2 * 9.80665);
  CHECK(log.count(kAcc) == 2);
  CHECK(log.output[kThighY][1] == Approx(0.699));
  CHECK(log.count(kThighY) == 2);
  CHECK(log.output[kThighAngle][2] == Approx(-20 * 0.017453292519943295));
  CHECK(log.output[kAccX].empty());
  CHECK(log.count(kAccX) == 0);
}

TEST_CASE("drop log: what is shipped says that it is simulated") {
  for (const char* name : {"drop_1", "drop_2", "drop_3", "validation"}) {
    const std::string path = std::string(UKEMI_DATASETS "/drops/") + name + ".csv";
    CHECK(read_text_file(path).rfind("# SIMULATED by ukemi, not measured.", 0) == 0);
    const DropLog log = read_drop(path);
    CHECK(log.t.size() == 1001);
    for (const auto o : {kAcc, kThighX, kThighY, kThighAngle}) CHECK(log.count(o) == 1001);
  }
}

TEST_CASE("a scene that is written reads back") {
  for (const char* name : {"paper", "fast", "straight", "paper_soft"}) {
    Scene s = read_scene(std::string(UKEMI_DATASETS "/scenes/") + name + ".toml");
    s.verdicts = {{"stiffness", "weak"}, {"pitch", "fixed"}};
    s.t_end = 1.25, s.drop.pitch_rate = -0.5, s.floor_source = "a \"quoted\" \\ source";
    const File f("scene.toml", to_toml(s, "two\nlines"));
    const Scene r = read_scene(f.path);
    CHECK(r.robot.gravity == s.robot.gravity);
    CHECK(r.robot.link_length == s.robot.link_length);
    CHECK(r.robot.mass == s.robot.mass);
    CHECK(r.robot.inertia_com == s.robot.inertia_com);
    CHECK(r.contacts == s.contacts);
    REQUIRE(r.floor.has_value());
    CHECK(r.floor->stiffness == s.floor->stiffness);
    CHECK(r.floor->damping_normal == s.floor->damping_normal);
    CHECK(r.floor->damping_tangential == s.floor->damping_tangential);
    CHECK(r.floor_source == s.floor_source);
    CHECK(r.drop.height == s.drop.height);
    CHECK(r.drop.forward_speed == s.drop.forward_speed);
    CHECK(r.drop.pitch == Approx(s.drop.pitch).epsilon(1e-15).margin(1e-300));
    CHECK(r.drop.pitch_rate == s.drop.pitch_rate);
    CHECK(r.search.phi[0] == Approx(s.search.phi[0]).epsilon(1e-15));
    CHECK(r.search.duration == s.search.duration);
    CHECK(r.execution.phi == Approx(s.execution.phi).epsilon(1e-15));
    CHECK(r.execution.duration == s.execution.duration);
    CHECK(r.t_end == s.t_end);
    CHECK(r.verdicts == s.verdicts);
    Scene bare = s;
    bare.floor.reset(), bare.contacts = {}, bare.t_end.reset(), bare.verdicts.clear();
    const Scene b = read_scene(File("scene.toml", to_toml(bare, "")).path);
    CHECK_FALSE(b.floor.has_value());
    CHECK_FALSE(b.touches());
    CHECK_FALSE(b.t_end.has_value());
    CHECK(b.verdicts.empty());
  }
}
