// Robots of links that are falling already: moves in the air, limits, the planner of a control program.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "common/degrees.hpp"
#include "landing/body/load.hpp"
#include "landing/model/motion_space.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/plan/body_drops.hpp"
#include "landing/plan/body_planner.hpp"
#include "landing/plan/body_space.hpp"
#include "landing/run/simulate.hpp"
#include "test/legs/robots.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using Catch::Matchers::Contains;
using legs::long_paper, legs::shipped;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Let go in the held posture; the references may move from 0.05 s on.
BodyScene in_air(BodyScene scene) {
  const BodyMotion held = held_posture(scene);
  BodyRelease release{.from = 0.05};
  for (const Motion& m : held) release.joints.push_back({m.phi_i, 0.2});
  scene.release = release;
  return scene;
}

}  // namespace

TEST_CASE("legs: in the air the paper's robot in the long form is the paper's robot") {
  Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  const Actuator a = read_actuator(UKEMI_DATASETS "/actuators/table2.toml");
  scene.release = Release{-45 * kDegree, 0.3, 0.1};
  BodyScene body = long_paper(scene, a);
  body.release = BodyRelease{{{-45 * kDegree, 0.3}}, 0.1};
  for (const double to : {0.2, 0.28, 0.5}) {  // the last is cut short by the floor
    const Motion m{.phi_i = -20 * kDegree,
                   .phi_f = -80 * kDegree,
                   .duration = 0.3,
                   .reposition = Reposition{-45 * kDegree, 0.3, 0.1, to}};
    CHECK(simulate(body, {m}).peak == Approx(simulate(scene, a.sea, m).peak).epsilon(1e-7));
  }
  BodyScene thrown = body;
  scene.drop.vertical_speed = thrown.drop.vertical_speed = -1.3;
  const Motion m{-0.4, -1.4, 0.3};
  CHECK(simulate(thrown, {m}).peak == Approx(simulate(scene, a.sea, m).peak).epsilon(1e-7));

  const BodySpace space(body);
  const ReferenceSpace two_link(scene, a.sea);
  REQUIRE(space.dimension() == two_link.dimension());
  CHECK(space.variables().back().name == "to");
  const BodyMotion middle = space.motion(Coordinates::Constant(space.dimension(), 0.5));
  REQUIRE(middle[0].reposition);
  CHECK(middle[0].reposition->from == 0.1);
  CHECK(middle[0].reposition->to > 0.1);
  CHECK((space.unit(middle) - Coordinates::Constant(space.dimension(), 0.5)).norm() < 1e-12);
}

TEST_CASE("legs: a plan in the air is never worse than standing still, with every goal, deadline and bump count") {
  for (const char* name : {"hopper", "three_links"})
    for (const int bumps : {0, 2})
      for (const bool robust : {false, true})
        for (const Goal goal : {Goal::kPeak, Goal::kTolerant})
          for (const std::optional<double>& deadline : {std::optional<double>(), std::optional(0.3)}) {
            if (robust && goal == Goal::kTolerant) continue;
            BodyScene scene = in_air(shipped(name));
            scene.freedom.bumps = bumps;
            BodyPlanOptions o{.goal = goal, .deadline = deadline};
            if (robust) o.measure = Measure{Measure::Kind::kCvar};
            o.samples = 8, o.judging = 16, o.fresh = 32;
            if (!deadline) o.evaluations = robust ? 1'000 : 300;
            const BodyPlan p = plan(scene, o);
            INFO(name << " " << bumps << " " << robust << " " << int(goal) << " " << deadline.value_or(0));
            REQUIRE(p.found);
            CHECK(p.value <= p.held_value);
            const Motion& m = p.motion.front();
            REQUIRE(m.reposition);
            CHECK(m.reposition->phi == scene.release->joints[0].phi);
            CHECK(m.reposition->rate == 0.2);
            if (!deadline) CHECK(p.value < 0.9 * p.held_value);
          }
}

TEST_CASE("legs: a plan keeps the stops, the ratings and the contacts that must not touch, or says that none does") {
  const BodyScene free = shipped("hopper");
  BodyPlanOptions o{.evaluations = 600};
  const BodyPlan open = plan(free, o);
  REQUIRE(open.found);

  BodyScene stops = free;  // narrower than the best motion needs
  const double least = open.landing.demands[2 - 1].phi_min;
  set_limit(stops, limit(free.robot, Load::Kind::kAngle, 1, 0, {0.9 * least, 0}));
  const BrokenLimit broken = simulate(stops, open.motion).broken;
  REQUIRE(broken);
  CHECK(stops.loads[std::size_t(broken.load)].name == "knee.angle");
  CHECK(simulate(stops, open.motion).peak == open.landing.peak);  // told, and followed to its end
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant}) {
    o.goal = goal;
    const BodyPlan kept = plan(stops, o);
    REQUIRE(kept.found);
    CHECK(kept.landing.demands[1].phi_min >= 0.9 * least);
    for (const BodyDrop& d : execution_drops(stops)) CHECK_FALSE(simulate(d.scene, d.played(kept.motion)).broken);
  }
  o.goal = Goal::kPeak;

  BodyScene rated = free;
  const JointDemands& most = open.landing.demands[0];
  rated.robot.joints[0].speed_max = 0.8 * most.motor_speed;
  rated.robot.joints[0].motor_torque_max = 0.9 * most.motor_torque;
  CHECK(respect_ratings(rated) == std::vector<std::string>{"knee"});
  const BodyPlan slower = plan(rated, o);
  REQUIRE(slower.found);
  CHECK(slower.landing.demands[0].motor_speed <= 0.8 * most.motor_speed);
  CHECK(slower.landing.demands[0].motor_torque <= 0.9 * most.motor_torque);

  REQUIRE(free.robot.contacts[2].name == "foot");
  BodyScene no_foot = free;  // it lands on its knee
  forbid(no_foot, {"foot"});
  const BodyPlan on_knee = plan(no_foot, o);
  REQUIRE(on_knee.found);
  CHECK_FALSE(on_knee.held_keeps_limits);
  for (const Touch& t : on_knee.landing.touches) CHECK(t.point != 2);
  forbid(no_foot, {"slider", "knee", "foot"});
  const BodyPlan none = plan(no_foot, o);
  CHECK_FALSE(none.found);
  CHECK_FALSE(none.held_keeps_limits);
  CHECK_THAT(none.message, Contains("no motion was found that keeps the limits") && Contains(" s: foot.touch"));
}

TEST_CASE("legs: under scatter the limits are kept in the share of the drops that the measure asks for") {
  BodyScene scene = shipped("hopper");
  BodyPlanOptions o;
  o.evaluations = 8'000, o.samples = 32, o.judging = 64, o.fresh = 1'000;
  o.measure = Measure{Measure::Kind::kQuantile, 0.95};
  o.scatter = Scatter{.pitch = 0.02, .height = 0.02};
  const BodyPlan open = plan(scene, o);
  REQUIRE(open.found);
  CHECK(open.under->broken == 0);
  set_limit(scene, limit(scene.robot, Load::Kind::kAngle, 1, 0, {0.85 * open.landing.demands[1].phi_min, 4}));
  const BodyPlan kept = plan(scene, o);
  REQUIRE(kept.found);
  CHECK(kept.under->broken <= 100);
}

TEST_CASE("legs: a planner answers in the air, by the clock, whatever was measured") {
  for (const char* name : {"hopper", "three_links"}) {
    const BodyScene scene = shipped(name);
    BodyPlanner planner(scene);
    const BodyMotion held = held_posture(scene);
    BodyFallState now{.height = 0.25, .pitch = scene.drop.pitch, .elapsed = 0.05};
    for (const Motion& m : held) now.joints.push_back({m.phi_i, 0});
    for (int n = 0; n < 4; ++n) {
      now.elapsed = 0.05 + 0.02 * n, now.height = 0.3 - 0.5 * 9.81 * now.elapsed * now.elapsed;
      const BodyAnswer a = planner.plan(now, 0.05, std::uint64_t(n));
      INFO(name << " " << n << " " << a.wrong << " " << a.plan.message);
      REQUIRE(a.found());
      CHECK(a.plan.value <= a.plan.held_value);
    }
    using Status = Plan::Status;
    const auto status = [&](auto change, double deadline = 0.05) {
      BodyFallState s = now;
      change(s);
      return planner.plan(s, deadline).status;
    };
    CHECK(status([](auto& s) { s.height = 1e-4; }) == Status::kFloorFirst);
    CHECK(status([](auto& s) { s.height = kNaN; }) == Status::kBadInput);
    CHECK(status([](auto& s) { s.height = -1; }) == Status::kBadInput);
    CHECK(status([](auto& s) { s.pitch = 17; }) == Status::kBadInput);
    CHECK(status([](auto& s) { s.joints[0].phi = 45; }) == Status::kBadInput);
    CHECK(status([](auto& s) { s.joints[0].rate = kNaN; }) == Status::kBadInput);
    CHECK(status([](auto& s) { s.joints.clear(); }) == Status::kBadInput);
    CHECK(status([](auto& s) { s.elapsed = -1; }) == Status::kBadInput);
    CHECK(status([](auto& s) { s.vertical_speed = 1e9; }) == Status::kBadInput);
    CHECK(status([](auto&) {}, std::numeric_limits<double>::infinity()) == Status::kBadInput);
    CHECK(status([](auto&) {}, 0) == Status::kBadInput);
    CHECK(planner.plan(scene.drop, 0.1).found());
  }
}

TEST_CASE("legs: a planner that is asked again, in less time, answers no worse, and 400 motions find one") {
  const Goal goal = GENERATE(Goal::kPeak, Goal::kTolerant);
  const BodyScene scene = shipped("hopper");
  BodyPlanner planner(scene, {.goal = goal});
  const BodyAnswer first = planner.plan(scene.drop, 1);
  REQUIRE(first.found());
  for (const double deadline : {0.1, 0.05}) {
    const BodyAnswer again = planner.plan(scene.drop, deadline, 2);
    REQUIRE(again.found());
    CHECK(again.plan.value <= first.plan.value * (1 + 1e-5));
  }
  // Found and judged without what is known, in motions rather than by the clock.
  const BodyPlan small = plan(scene, {.goal = goal, .evaluations = 400});
  CHECK(small.value < 0.7 * small.held_value);
}
