// One landing of each kernel, with its report: what a sanitizer build can play in seconds (see test_sanitized).
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "common/actuator.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/run/simulate.hpp"

using namespace ukemi;
using namespace ukemi::landing;

TEST_CASE("every kernel follows a landing to its end, and its energy balance closes") {
  const std::string data = UKEMI_DATASETS;
  const SeaParameters<double> table2 = read_actuator(data + "/actuators/table2.toml").sea;
  SeaParameters<double> unlimited = table2, extended = table2;
  unlimited.tau_max = std::numeric_limits<double>::infinity();
  extended.friction = 0.1, extended.viscous = 0.05, extended.k_sea_cubic = 20;
  const Motion motion{-0.5, -1.4, 0.2};
  const Scene paper = read_scene(data + "/scenes/paper.toml");
  for (const SeaParameters<double>& sea : {table2, unlimited, extended}) {
    const Landing l = simulate(paper, sea, motion, {}, 200);
    CHECK(l.end == End::kRest);
    CHECK(std::isfinite(l.peak));
    CHECK(l.peak > 100);
    CHECK(l.energy_residual < 1e-6);
    CHECK(l.touches.size() > 1);
    CHECK(l.trajectory.size() > 100);
  }
  Scene spinning = paper, nowhere = paper;
  spinning.drop.pitch_rate = 1;  // the flight is integrated
  CHECK(simulate(spinning, table2, motion, {}, 200).energy_residual < 1e-6);
  nowhere.floor.reset();
  CHECK(simulate(nowhere, table2, motion, {}, 200).end == End::kNoContact);
}
