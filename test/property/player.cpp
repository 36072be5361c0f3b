// What a Player sends is what the simulation plays.
#include "landing/model/player.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "common/actuator.hpp"
#include "landing/body/body_run.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/run/simulate.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity(), kNaN = std::numeric_limits<double>::quiet_NaN();
}

TEST_CASE("player: sends what a landing of the paper's robot played, by any clock") {
  const Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  Motion bumps{-0.3, -1.4, 0.3, {0.2, -0.1, 0.05, 0.02}};
  bumps.gain_p = 0.5, bumps.gain_d = 2;
  Motion air = bumps, cut = bumps;
  air.reposition = Reposition{-0.8, 0, 0.05, 0.2};
  cut.reposition = Reposition{-0.8, 0, 0.05, 0.6};  // the floor comes first
  for (const Motion& m : {bumps, air, cut}) {
    const Landing l = simulate(scene, sea, m, {}, 1000);
    const double touchdown = l.touches.front().t_touchdown;
    constexpr double kClock = 1234.5;
    Player player({m});
    REQUIRE(player.released(kClock));
    double worst = 0;
    for (const Sample& s : l.trajectory)
      if (s.t < touchdown) worst = std::max(worst, std::abs(player.at(0, kClock + s.t).phi - s.phi_ref));
    REQUIRE(player.touchdown(kClock + touchdown));
    for (const Sample& s : l.trajectory) {
      const DriveCommand c = player.at(0, kClock + s.t);
      worst = std::max(worst, std::abs(c.phi - s.phi_ref));
      if (s.t > touchdown) CHECK((c.gain_p == 0.5 && c.gain_d == 2));
    }
    CHECK(worst < 1e-9);
    CHECK(player.end() == kClock + touchdown + m.duration);
    CHECK(player.at(0, 1e9).phi == m.phi_f);
    CHECK(player.at(0, 1e9).dphi == 0);
  }
}

TEST_CASE("player: every joint of a robot of links") {
  const BodyScene scene = read_body_scene(UKEMI_DATASETS "/scenes/hopper.toml");
  BodyMotion m = held_posture(scene);
  m[0].phi_f = 1.2, m[0].duration = 0.2, m[1].phi_f = -0.4, m[1].duration = 0.5;
  m[1].reposition = Reposition{-1.0, 0, 0, 0.1};
  const BodyLanding l = simulate(scene, m, {}, 1000);
  Player player(m);
  CHECK(player.joints() == 2);
  player.released(0), player.touchdown(l.contacts.first());
  for (const BodySample& s : l.trajectory)
    for (int k = 0; k < 2; ++k) REQUIRE(std::abs(player.at(k, s.t).phi - s.phi_ref[std::size_t(k)]) < 1e-9);
  CHECK(player.end() == l.contacts.first() + 0.5);
}

TEST_CASE("player: whatever it is told, it holds a posture and throws nothing") {
  CHECK_THROWS(Player({}));
  CHECK_THROWS(Player({{0, 0, -1}}));
  Motion m{-0.5, -1, 0.3};
  m.reposition = Reposition{-0.8, 0, 0.1, 0.2};
  Player p({m});
  CHECK(p.at(0, 5).phi == -0.8);  // before it is told of a release
  CHECK(p.end() == kInfinity);
  CHECK_FALSE(p.released(kNaN));
  CHECK_FALSE(p.touchdown(kInfinity));
  CHECK_FALSE(p.touchdown(1));  // held in a hand, the foot bumps
  CHECK(p.at(0, 1.2).phi == -0.8);
  REQUIRE(p.released(10));
  CHECK_FALSE(p.touchdown(9.9));
  for (const double t : {-1e300, 9.0, 10.0, 10.1, -kInfinity, kNaN}) CHECK(p.at(0, t).phi == -0.8);
  CHECK(p.at(0, 10.3).phi == -0.5);
  CHECK(p.at(0, kInfinity).phi == -0.5);
  REQUIRE(p.touchdown(10.3));
  CHECK_FALSE(p.touchdown(10.4));
  CHECK(p.at(0, 10.3).phi == -0.5);
  CHECK(p.at(0, kInfinity).phi == -1);
  CHECK(p.at(7, 20).phi == -1);
  REQUIRE(p.released(20));  // the next drop
  CHECK_FALSE(p.landing());
  CHECK(p.at(0, 20).phi == -0.8);
}
