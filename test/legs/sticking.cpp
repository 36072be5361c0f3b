// Dry friction in landings: it sticks, on both sides of every drive and on the rail, in the scalar run, in lanes and
// with derivatives.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/degrees.hpp"
#include "common/integrate/hybrid.hpp"
#include "common/integrate/tableaus.hpp"
#include "common/random.hpp"
#include "landing/body/body_run.hpp"
#include "landing/body/body_system.hpp"
#include "landing/lanes/batch.hpp"
#include "landing/lanes/body_batch.hpp"
#include "landing/run/landing.hpp"
#include "test/legs/robots.hpp"
#include "test/legs/trees.hpp"
#include "test/paper.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using legs::rub, legs::random_state, legs::random_tree, legs::State, legs::System;

namespace {

constexpr double kGravity = 9.81;

/// A link that turns about a pin at the origin, geared and without gains, in gravity g.
BodyScene pinned_link(double g, double friction) {
  BodyScene out;
  out.robot.base = Base::kPinned, out.robot.gravity = g;
  out.robot.links = {{"link", -1, {}, 1.2, 0.01, {0.2, 0}}};
  out.robot.joints = {{.name = "pin", .child = 0, .kind = DriveKind::kGeared, .sea = {0, 0, 0, 0, 0.05}}};
  out.robot.joints[0].sea.friction = friction;
  out.robot.peak = {0.2, 0};
  return out;
}
constexpr double kPinInertia = 0.01 + 1.2 * 0.2 * 0.2 + 0.05;

/// Of a system alone, from event to event.
State follow(System& s, State y, double until, std::vector<double>* events = nullptr) {
  s.settle(0.0, y);
  integrate::Integrator<integrate::DormandPrince853, System> driver(s, 0, y, {.accuracy = 1e-12});
  while (true) {
    const integrate::Outcome o = driver.step(until);
    REQUIRE(o.status <= integrate::Status::kEvent);
    if (o.status == integrate::Status::kReached) return driver.state();
    if (o.event < 0) continue;
    if (events) events->push_back(driver.time());
    y = driver.state();
    (void)s.cross(o.event, y);
    s.hold_or_slip(driver.time(), y);
    driver.refresh(y);
  }
}

}  // namespace

TEST_CASE("sticking: a link that rubs slows down evenly, stops when it must, and stays", "[legs]") {
  const BodyScene scene = pinned_link(0, 0.8);
  System s(scene.robot, 0);
  State y = State::Zero();
  y[System::kOmega] = -4;
  std::vector<double> events;
  const double stops = 4 * kPinInertia / 0.8;
  const State end = follow(s, y, 2 * stops, &events);
  REQUIRE(events.size() == 1);
  CHECK(events[0] == Approx(stops).epsilon(1e-10));
  CHECK(end[System::kTheta] == Approx(-0.5 * 4 * stops).epsilon(1e-10));
  CHECK(end[System::kOmega] == 0);
}

TEST_CASE("sticking: a link stays at rest where its weight turns it less than friction holds, and only there",
          "[legs]") {
  const double moment = 1.2 * kGravity * 0.2;
  for (const double angle : {10.0, 20.0, 30.0, 40.0, 60.0, 90.0}) {
    const BodyScene scene = pinned_link(kGravity, 1.2);
    System s(scene.robot, 0);
    State y = State::Zero();
    y[System::kTheta] = angle * kDegree;  // 0 hangs down
    const State end = follow(s, y, 0.05);
    const double beyond = moment * std::sin(angle * kDegree) - 1.2;
    CAPTURE(angle, beyond);
    if (beyond < 0)
      CHECK(end == y);
    else
      CHECK(end[System::kOmega] == Approx(-beyond / kPinInertia * 0.05).epsilon(2e-2));
  }
}

TEST_CASE("sticking: joints that friction holds still move as those that are locked", "[legs]") {
  for (const std::string name : {"hopper", "three_links", "foot"}) {
    const BodyScene open = legs::shipped(name);
    const BodyMotion held = held_posture(open);
    for (std::size_t which = 0; which < open.robot.joints.size(); ++which) {
      if (!open.robot.joints[which].driven()) continue;
      BodyScene stuck = open, locked = open;
      SeaParameters<double>& sea = stuck.robot.joints[which].sea;
      (stuck.robot.joints[which].kind == DriveKind::kElastic ? sea.output_friction : sea.friction) = 1e6;
      locked.robot.joints[which].kind = DriveKind::kLocked, locked.robot.joints[which].phi = held[which].phi_i;
      const double a = peak_acceleration(stuck, held, {.accuracy = 1e-11}).peak,
                   b = peak_acceleration(locked, held, {.accuracy = 1e-11}).peak;
      INFO(name << ", " << open.robot.joints[which].name);
      CHECK(a == Approx(b).epsilon(1e-8));
    }
  }
}

TEST_CASE("sticking: what is held needs the torques that would hold it: random trees", "[legs]") {
  for (std::uint64_t i = 0; i < 300; ++i) {
    Random r(20261128, i);
    const Base base = std::array{Base::kFree, Base::kRail, Base::kPinned}[i % 3];
    Robot robot = random_tree(r, 6, base);
    for (Joint& j : robot.joints) {
      j.kind = r.uniform() < 0.5 ? DriveKind::kGeared : DriveKind::kElastic;
      j.sea = {r.uniform(0, 50), r.uniform(0, 2), r.uniform(20, 100), r.uniform(0, 2), r.uniform(0.01, 0.2)};
      j.sea.friction = j.sea.output_friction = 1;
    }
    robot.rail_friction = base == Base::kRail ? 1 : 0;
    System s(robot, 0);
    State y = random_state(r, robot);
    for (int k = 0; k < System::kPlaces; ++k) {
      s.slip_of(k) = 1;
      if (s.has_friction_at(k) && r.uniform() < 0.6) s.cross_friction(System::kGuardsPerPlace * k, y);
    }
    INFO("draw " << i);
    const auto hold = s.holds(0.0, y);
    const State held = s.derivative(0, y);
    State dy;
    // As torques of the joints, and a force along the rail, of a robot on which nothing rubs.
    System free = s;
    free.has_friction = false;
    for (int k = 0; k < System::kPlaces; ++k)
      if (s.has_friction_at(k) && s.slip_of(k) == 0) CHECK(s.rate_of(k, held) == 0);
    const auto torque_of = [&](int j, double* motor) {
      const double tau = s.torque(j, 0.0, y, motor);
      return tau - (s.slip_of(kSides * j) == 0 ? hold[std::size_t(kSides * j)].torque : 0);
    };
    const bool on_rail = base == Base::kRail && s.slip_of(System::kRailPlace) == 0;
    free.derivative_under(y, dy, torque_of, [&](auto& load, const auto&) {
      if (!on_rail) return;
      load.x -= hold[System::kRailPlace].torque * s.body.rail[0],
          load.y -= hold[System::kRailPlace].torque * s.body.rail[1];
    });
    for (int k = System::kVx; k < System::kSlip; ++k) CHECK(held[k] == Approx(dy[k]).epsilon(1e-8).margin(1e-8));
  }
}

TEST_CASE("sticking: a carriage on its rail stays below the angle of friction, and slides beyond it", "[legs]") {
  for (const double degrees : {10.0, 30.0, 35.0, 60.0}) {
    BodyScene scene;
    scene.robot.base = Base::kRail, scene.robot.gravity = kGravity;
    scene.robot.rail_direction = degrees * kDegree, scene.robot.rail_load_friction = 0.6;
    scene.robot.links = {{"carriage", -1, {}, 2.0, 0.1, {}}};
    System s(scene.robot, 0);
    const State end = follow(s, State::Zero(), 0.3);
    const double along = std::sin(degrees * kDegree) - 0.6 * std::cos(degrees * kDegree);
    CAPTURE(degrees);
    if (along < 0)
      CHECK(end == State::Zero());
    else
      CHECK(end[System::kVx] == Approx(-kGravity * along * 0.3).epsilon(1e-9));
  }
}

TEST_CASE("sticking: the paper's robot alone and in lanes, by its scene and by links", "[legs]") {
  Random r(20261129);
  int stuck = 0, off = 0;
  constexpr int kDraws = 60;
  for (int n = 0; n < kDraws; ++n) {
    const Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
    Actuator actuator;
    actuator.sea = test::table2_sea();
    BodyScene by_links = legs::long_paper(scene, actuator);
    rub(by_links, r);
    const SeaParameters<double>& sea = by_links.robot.joints[0].sea;
    const Motion motion{r.uniform(-1.5, 0), r.uniform(-1.5, 0), r.uniform(0.1, 0.6)};
    const LandingPeak two = peak_acceleration(scene, sea, motion, {.accuracy = 1e-11});
    const BodyLanding tree = peak_acceleration(by_links, {motion}, {.accuracy = 1e-11});
    INFO("draw " << n);
    CHECK(tree.peak == Approx(two.peak).epsilon(1e-6));
    CHECK(tree.t_peak == Approx(two.t_peak).epsilon(1e-6));
    LandingPeak lane;
    const BatchCase c{&scene, &sea, motion};
    batch_peaks({&c, 1}, {&lane, 1}, {.accuracy = 1e-7});
    BodyLanding tree_lane;
    const BodyMotion played{motion};
    const BodyBatchCase b{&by_links, &played};
    body_batch_peaks({&b, 1}, {&tree_lane, 1}, {.accuracy = 1e-7});
    off += std::abs(lane.peak / two.peak - 1) > 1e-4, off += std::abs(tree_lane.peak / two.peak - 1) > 1e-4;
    stuck += std::abs(peak_acceleration(scene, test::table2_sea(), motion).peak / two.peak - 1) > 1e-3;
  }
  CHECK(stuck > kDraws / 2);  // friction counts
  CHECK(off <= 2);
}

TEST_CASE("sticking: a passive joint that rubs hangs where it was let go, and a robot that is stuck rests", "[legs]") {
  BodyScene scene = legs::shipped("three_links");
  for (Joint& j : scene.robot.joints) j.kind = DriveKind::kPassive, j.stiffness = j.damping = 0, j.sea.friction = 5000;
  const BodyLanding l = simulate(scene, held_posture(scene), {}, 1000);
  CHECK(l.end == End::kRest);
  for (std::size_t j = 0; j < scene.robot.joints.size(); ++j) {
    double most = 0;
    for (const BodySample& s : l.trajectory) most = std::max(most, std::abs(s.phi[j] - scene.robot.joints[j].phi));
    CAPTURE(j, most);
    CHECK(most < 1e-9);
  }
}

TEST_CASE("sticking: an accuracy of 1e-7 is one, and the energy closes", "[legs]") {
  Random r(20261130);
  int off = 0;
  for (const std::string name : {"hopper", "three_links", "foot"})
    for (int n = 0; n < 12; ++n) {
      BodyScene scene = legs::shipped(name);
      rub(scene, r);
      BodyMotion m = held_posture(scene);
      for (std::size_t i = 0; i < m.size(); ++i)
        if (scene.robot.joints[i].driven())
          m[i].phi_f = r.uniform(scene.search[i].phi[0], scene.search[i].phi[1]), m[i].duration = r.uniform(0.1, 0.4);
      const BodyLanding l = simulate(scene, m, {.accuracy = 1e-10});
      const double rough = peak_acceleration(scene, m, {.accuracy = 1e-7}).peak;
      INFO(name << ", draw " << n << ": " << l.peak << ", " << rough);
      CHECK_FALSE(no_landing(l.end));
      CHECK(l.energy_residual < 1e-7);
      off += std::abs(rough / l.peak - 1) > 1e-4;
    }
  CHECK(off <= 2);
}
