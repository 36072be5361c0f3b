// The motions of a robot of links on a grid.
#include <catch2/catch.hpp>
#include <cmath>

#include "landing/body/body_run.hpp"
#include "landing/plan/body_map.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {

BodyScene hopper() { return read_body_scene(UKEMI_DATASETS "/scenes/hopper.toml"); }

}  // namespace

TEST_CASE("legs: a grid of a robot of links has the peaks of its motions, whatever the number of threads") {
  const BodyScene scene = hopper();
  const BodySpace space(scene);
  SurveyOptions options;
  options.map.cells = {4, 1, 1, 3, 1}, options.map.polished = 2, options.map.threads = 2;
  options.map.slice = held_slice(space, scene);
  const BodySurvey s = survey(scene, options);
  REQUIRE(s.map.grid.size() == 12);
  CHECK(s.failed + s.missing == 0);
  for (std::size_t i = 0; i < s.map.grid.size(); ++i) {
    const Coordinates x = s.map.values(s.map.place(i));
    BodyMotion m = held_posture(scene);
    m[0].phi_i = x[0], m[1].phi_f = x[3];
    for (Motion& joint : m) joint.duration = 0.55;
    CHECK(s.map.grid[i].peak == Approx(simulate(scene, m).peak).epsilon(1e-4));
  }
  REQUIRE(s.minima.size() == 2);
  CHECK(s.minima[0].peak <= s.minima[1].peak);
  REQUIRE(!s.basins.empty());
  CHECK(s.basins[0].peak <= s.minima[0].peak * (1 + 1e-4));
  CHECK(s.basins[0].peak == simulate(scene, s.basins[0].motion).peak);
  CHECK(s.basins[0].tolerant >= s.basins[0].peak * (1 - 1e-4));
  options.map.threads = 1;
  const BodySurvey one = survey(scene, options);
  for (std::size_t i = 0; i < s.map.grid.size(); ++i) CHECK(one.map.grid[i].peak == s.map.grid[i].peak);
  CHECK(one.basins[0].peak == s.basins[0].peak);
}

TEST_CASE("legs: a slice is a motion that is mapped, or is refused by its number") {
  BodyScene scene = hopper();
  const auto refused = [&](auto&& change, const std::string& words) {
    BodyMotion m = held_posture(scene);
    change(m);
    CHECK_THROWS_WITH(slice_of(BodySpace(scene), scene, m, {"m.toml"}), Catch::Matchers::Contains(words));
  };
  refused([](BodyMotion& m) { m[1].bumps[0] = 0.2; }, "m.toml: b0_knee = 0.2: 0 is the nearest that is mapped");
  refused([](BodyMotion& m) { m[1].duration = 0.3; }, "duration_knee = 0.3: 1 is the nearest that is mapped");
  refused([](BodyMotion& m) { m[0].gain_p = 2; }, "gain_p_hip = 2: 1 is the nearest");
  refused([](BodyMotion& m) { m[0].reposition = Reposition{1, 0, 0, 1}; }, "joint 'hip' moves in the air");
  scene.freedom.bumps = 1;
  BodyMotion m = held_posture(scene);
  m[1].bumps[0] = 0.2;
  const BodySpace space(scene);
  const Coordinates x = slice_of(space, scene, m, {"m.toml"});
  CHECK(space.variables()[6].name == "b0_knee");
  CHECK(x[6] == Approx(0.2));
}

TEST_CASE("legs: a map that is stopped tells what was not played") {
  const BodyScene scene = hopper();
  SurveyOptions options;
  options.map.cells = {4, 1, 1, 3, 1}, options.map.threads = 1;
  long rows = 0;
  options.map.monitor = {[&](long done, long) { rows = done; }, [&] { return rows >= 2; }};
  options.basins = options.map.monitor;
  const BodySurvey s = survey(scene, options);
  CHECK(s.missing == 6);  // two rows of three were played
  CHECK(s.basins.empty());
}
