// The shipped robots of links: what is held, the fast path, rest, plans, files.
#include <catch2/catch.hpp>
#include <cmath>

#include "common/degrees.hpp"
#include "common/random.hpp"
#include "landing/body/load.hpp"
#include "landing/judge/checked.hpp"
#include "landing/model/motion_space.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/plan/body_least_breaking.hpp"
#include "landing/plan/body_space.hpp"
#include "landing/plan/checked_body.hpp"
#include "landing/plan/scene_doubts.hpp"
#include "landing/search/solvers.hpp"
#include "test/folder.hpp"
#include "test/legs/robots.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using legs::shipped;

namespace {

BodyMotion random_motion(const BodyScene& scene, std::uint64_t index) {
  Random r(20261124, index);
  const BodySpace space(scene);
  Coordinates u(space.dimension());
  for (double& x : u) x = r.uniform();
  return space.motion(u);
}
bool same(const BodyMotion& a, const BodyMotion& b, double within) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::abs(a[i].phi_i - b[i].phi_i) > within || std::abs(a[i].phi_f - b[i].phi_f) > within ||
        std::abs(a[i].duration - b[i].duration) > within)
      return false;
  return true;
}

}  // namespace

// 1097 and 98.5: computed independently, by plain differential evolution's simulator.
TEST_CASE("legs: the shipped robots held, their energy balanced and their peaks checked") {
  const std::pair<const char*, double> known[] = {{"three_links", 1097}, {"hopper", 98.5}};
  for (const auto& [name, peak] : known) {
    const BodyScene scene = shipped(name);
    const CheckedBody c = checked_body(scene, held_posture(scene));
    INFO(name << ": " << c.landing.peak);
    CHECK(c.landing.end == End::kRest);
    CHECK(std::abs(c.landing.peak / peak - 1) < 5e-4);
    CHECK(c.landing.energy_residual < 1e-8);
    CHECK(c.sensitivity.right);
    CHECK_FALSE(c.sensitivity.sensitive);
  }
}

TEST_CASE("legs: the paper's robot in the long form lands as it does in the short one") {
  const Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  const BodyScene body = legs::long_paper(scene, read_actuator(UKEMI_DATASETS "/actuators/table2.toml"));
  const Motion held{-45 * kDegree, -45 * kDegree, 0.5};
  CHECK(std::abs(simulate(body, {held}, {.accuracy = 1e-12}).peak - 466.171207916) <
        1e-6);  // as test/regression/reference.cpp
}

TEST_CASE("legs: a flight in which nothing strains is closed-form, and any other is followed") {
  // Against the same landing with a spring that is next to nothing beside a joint.
  const auto spared = [](const BodyScene& scene) {
    const BodyMotion held = held_posture(scene);
    BodyScene strained = scene;
    strained.robot.joints[1].parallel_stiffness += 1e-6;
    const SimulateOptions fine{.accuracy = 1e-11};
    const BodyLanding l = peak_acceleration(scene, held, fine), followed = peak_acceleration(strained, held, fine);
    CHECK(l.peak == Approx(followed.peak).epsilon(1e-6));
    CHECK(l.contacts.first() == Approx(followed.contacts.first()).epsilon(1e-6));
    return followed.work.steps - l.work.steps >= 3;
  };
  BodyScene scene = shipped("three_links");
  CHECK(spared(scene));
  scene.drop.vertical_speed = 0.5;
  CHECK(spared(scene));
  scene.drop.pitch_rate = 0.5;
  CHECK_FALSE(spared(scene));
  const BodyScene hopper = shipped("hopper");
  CHECK(spared(hopper));
  scene = hopper, scene.robot.joints[1].parallel_stiffness = 1;
  CHECK_FALSE(spared(scene));
  scene = hopper, scene.robot.rail_viscous = 2;
  CHECK_FALSE(spared(scene));
  scene = hopper, scene.robot.rail_direction = 1.2;
  CHECK_FALSE(spared(scene));
}

TEST_CASE("legs: the fast path has the peaks of the accurate one, and what rests has had its peak") {
  for (const char* name : {"three_links", "hopper", "foot"}) {
    const BodyScene scene = shipped(name);
    for (std::uint64_t n = 0; n < 12; ++n) {
      const BodyMotion m = random_motion(scene, n);
      const BodyLanding l = simulate(scene, m);
      INFO(name << ", motion " << n << ": " << l.peak);
      CHECK(l.end == End::kRest);
      CHECK(l.energy_residual < 1e-8);
      CHECK(l.contacts.first_point() == l.touches.at(0).point);
      CHECK(simulate(scene, m, {.rest = SimulateOptions::Rest::kIgnore}).peak == l.peak);
      CHECK(peak_acceleration(scene, m, {.accuracy = 1e-7}).peak == Approx(l.peak).epsilon(1e-4));
    }
  }
}

// On its knee the robot lands with 71.3 at the best, in a basin that is wide; on its foot with 58.7, in one that is
// narrow.
TEST_CASE("legs: every solver plans, keeps its budget, and is no worse than holding, with every goal") {
  const BodyScene scene = shipped("hopper");
  for (const std::string& solver : solver_names())
    for (const auto& [goal, measure] :
         {std::pair(Goal::kPeak, std::optional<Measure>()), std::pair(Goal::kTolerant, std::optional<Measure>()),
          std::pair(Goal::kPeak, std::optional(Measure{Measure::Kind::kCvar}))}) {
      BodyPlanOptions o{.solver = solver, .goal = goal, .measure = measure, .samples = 8, .judging = 16, .fresh = 0};
      o.evaluations = measure ? 1'500 : 200;
      INFO(solver << " " << int(goal) << " " << measure.has_value());
      if (solver == "sqp" && measure) {
        CHECK_THROWS_WITH(plan(scene, o), Catch::Matchers::StartsWith("solver: sqp: "));
        continue;
      }
      const BodyPlan p = plan(scene, o);
      CHECK(p.found);
      CHECK(p.value <= p.held_value);
      CHECK(p.evaluations <= *o.evaluations);
    }
}

TEST_CASE("legs: a plan finds the narrow basin of another first contact") {
  const BodyScene scene = shipped("three_links");
  int on_foot = 0;
  for (const std::uint64_t seed : {4, 5, 6}) {
    const BodyPlan p = plan(scene, {.evaluations = 20'000, .seed = seed});
    CAPTURE(seed, p.value);
    CHECK(p.value < 72);
    on_foot += p.value < 60.2 && scene.robot.contacts[std::size_t(p.landing.contacts.first_point())].name == "foot";
  }
  CHECK(on_foot >= 2);
}

TEST_CASE("legs: what abandons a landing is a bound of its peak") {
  const BodyScene scene = shipped("hopper");
  const BodyLanding l = peak_acceleration(scene, held_posture(scene), {.accuracy = 1e-6, .abandon_above = 50});
  CHECK(l.end == End::kAbandoned);
  CHECK(l.peak > 50);
}

TEST_CASE("legs: a landing that is noticed late starts its motion late") {
  BodyScene scene = shipped("hopper");
  const BodyMotion m = random_motion(scene, 3);
  const BodyLanding at_once = simulate(scene, m, {}, 1000);
  scene.detection_delay = 0.02;
  const BodyLanding late = simulate(scene, m, {}, 1000);
  CHECK(late.contacts.first() == at_once.contacts.first());
  for (const BodySample& s : late.trajectory)
    if (s.t < late.contacts.first() + 0.02) REQUIRE(s.phi_ref[0] == m[0].phi_i);
  CHECK(late.peak != at_once.peak);
}

TEST_CASE("legs: a robot that is released turning keeps its momentum, with the forward speed at its first link") {
  BodyScene scene = shipped("three_links");
  scene.drop.pitch_rate = 2, scene.drop.height = 5;
  const BodyLanding l = simulate(scene, held_posture(scene), {}, 1000);
  const BodySample &a = l.trajectory[0], &b = l.trajectory[1];
  CHECK((b.x[0] - a.x[0]) / (b.t - a.t) == Approx(0.63).epsilon(0.02));
  CHECK((b.theta[0] - a.theta[0]) / (b.t - a.t) == Approx(2).epsilon(0.02));
}

TEST_CASE("legs: plans are better than holding, the same on one thread, and come back from their files") {
  const BodyScene scene = shipped("hopper");
  const BodyPlan p = plan(scene, {.evaluations = 600, .seed = 2, .threads = 2}),
                 one = plan(scene, {.evaluations = 600, .seed = 2, .threads = 1});
  REQUIRE(p.found);
  CHECK(p.evaluations == 600);
  CHECK(p.landing.peak < 0.7 * p.held.peak);
  CHECK(p.landing.peak == one.landing.peak);
  CHECK(same(p.motion, one.motion, 0));
  CHECK(p.variables[0].name == "phi_i_hip");
  CHECK(p.variables.size() == 5);
  const test::Folder f;
  const std::string toml = f.write("m.toml", body_motion_toml(p.motion, scene.robot, "a plan")),
                    csv = f.write("m.csv", body_motion_csv(p.motion, scene.robot, 1000, "a plan"));
  CHECK(same(read_body_motion(toml, scene.robot), p.motion, 1e-14));
  CHECK(same(read_body_motion(csv, scene.robot), p.motion, 1e-14));
  CHECK(simulate(scene, read_body_motion(csv, scene.robot)).peak == Approx(p.landing.peak).epsilon(1e-9));
}

TEST_CASE("legs: shape terms, gains and durations of each joint are planned, played and kept in files") {
  BodyScene scene = shipped("hopper");
  scene.freedom.bumps = 1, scene.freedom.gains = std::array{0.5, 2.0}, scene.own_durations = true;
  const BodySpace space(scene);
  CHECK(space.dimension() == 12);
  const char* names[] = {"phi_i_hip",  "phi_f_hip",  "phi_i_knee",    "phi_f_knee", "duration_hip", "b0_hip",
                         "gain_p_hip", "gain_d_hip", "duration_knee", "b0_knee",    "gain_p_knee",  "gain_d_knee"};
  for (int k = 0; k < 12; ++k) CHECK(space.variables()[std::size_t(k)].name == names[k]);
  const BodyMotion m = random_motion(scene, 5);
  CHECK(m[0].duration != m[1].duration);
  CHECK(m[0].bumps[0] != 0);
  CHECK(m[1].gain_p != 1);
  CHECK(m[1].bumps[1] == 0);
  CHECK((space.motion(space.unit(m))[1].bumps[0] == Approx(m[1].bumps[0])));
  const BodyLanding l = simulate(scene, m);
  CHECK(l.energy_residual < 1e-8);
  int differ = 0;
  for (std::uint64_t n = 0; n < 10; ++n) {
    const BodyMotion shaped = random_motion(scene, n);
    BodyMotion plain = shaped;
    plain[0].bumps = {}, plain[1].bumps = {};
    differ += std::abs(simulate(scene, plain).peak / simulate(scene, shaped).peak - 1) > 1e-3;
  }
  CHECK(differ >= 5);

  const BodyPlan p = plan(scene, {.evaluations = 1'500, .seed = 2});
  REQUIRE(p.found);
  CHECK(p.landing.peak < 0.7 * p.held.peak);
  const test::Folder f;
  for (const auto& [file, text] : {std::pair{"m.toml", body_motion_toml(p.motion, scene.robot, "a plan")},
                                   {"m.csv", body_motion_csv(p.motion, scene.robot, 1000, "a plan")}}) {
    const BodyMotion read = read_body_motion(f.write(file, text), scene.robot);
    INFO(file);
    CHECK(simulate(scene, read).peak == Approx(p.landing.peak).epsilon(1e-6));
    CHECK(read[1].gain_d == Approx(p.motion[1].gain_d));
    CHECK(read[0].bumps[0] == Approx(p.motion[0].bumps[0]).margin(1e-6));
  }
  BodyMotion still = held_posture(scene);  // a reference that leaves and comes back
  still[1].bumps[0] = 0.3, still[1].duration = 0.15;
  CHECK(simulate(scene, still, {.accuracy = 1e-7}).peak == Approx(simulate(scene, still).peak).epsilon(1e-5));
}

TEST_CASE("legs: moves in the air of several joints come back from their rows") {
  for (const char* name : {"three_links", "hopper", "foot"}) {
    const BodyScene scene = shipped(name);
    for (std::uint64_t n = 0; n < 6; ++n) {
      BodyMotion m = random_motion(scene, n);
      std::vector<std::size_t> driven;
      for (std::size_t i = 0; i < m.size(); ++i)
        if (scene.robot.joints[i].driven()) driven.push_back(i);
      REQUIRE(driven.size() == 2);
      // The first joint's move begins later than the other's, or not at all; the other's is cut by the floor, or is
      // not.
      if (n % 3 != 0)
        m[driven[0]].reposition = Reposition{m[driven[0]].phi_i + 0.3, n % 3 == 2 ? 2.0 : 0.0, 0.0837, 0.2};
      m[driven[1]].reposition = Reposition{m[driven[1]].phi_i - 0.4, 0, 0.05, n % 2 ? 0.15 : 0.4};
      m[driven[1]].gain_p = 1.5, m[driven[0]].bumps[0] = 0.1;
      const BodyLanding l = simulate(scene, m);
      const test::Folder f;
      const std::string csv =
          f.write("m.csv", body_motion_csv(m, scene.robot, 1000, "a plan", l.contacts.first() + scene.detection_delay));
      const BodyMotion back = read_body_motion(csv, scene.robot);
      INFO(name << ", motion " << n);
      CHECK(back[driven[0]].reposition.has_value() == m[driven[0]].reposition.has_value());
      CHECK(back[driven[1]].reposition->from == Approx(0.05).epsilon(1e-9));
      CHECK(back[driven[1]].gain_p == 1.5);
      CHECK(simulate(scene, back).peak == Approx(l.peak).epsilon(1e-6));
    }
  }
}

TEST_CASE("legs: rows of moves in the air that are none are refused with their place") {
  const BodyScene scene = shipped("hopper");
  BodyMotion m = held_posture(scene);
  m[0].reposition = Reposition{m[0].phi_i + 0.3, 0, 0.05, 0.2};
  const std::string good = body_motion_csv(m, scene.robot, 1000, "rows", 0.25);
  const test::Folder f;
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& words) {
    std::string text = good;
    REQUIRE(text.find(from) != text.npos);
    text.replace(text.find(from), from.size(), to);
    CHECK_THROWS_WITH(read_body_motion(f.write("m.csv", text), scene.robot),
                      Catch::Matchers::Contains("m.csv:") && Catch::Matchers::Contains(words));
  };
  refused("t,t_from_release,", "t,other,", "a move in the air needs the column 't_from_release' too");
  refused("phi_ref_knee", "phi_ref_ankle", "phi_ref_knee");
  refused("\n-0.1,", "\n-0.1005,", "as in the first row, is needed");
}

TEST_CASE("legs: a plan of one motion is to hold, and a robot that touches nothing has none") {
  BodyScene scene = shipped("three_links");
  const BodyPlan held = plan(scene, {.evaluations = 1});
  CHECK(held.landing.peak == held.held.peak);
  scene.floor = false, scene.t_end = 1;
  const BodyPlan none = plan(scene, {.evaluations = 10});
  CHECK(none.found);  // in the air all motions have the peak of a flight
  CHECK(none.landing.peak == Approx(9.81));
  scene.robot.joints[0].kind = scene.robot.joints[1].kind = DriveKind::kLocked;
  CHECK_THROWS_WITH(plan(scene), Catch::Matchers::Contains("no joint is driven"));
}

TEST_CASE("legs: what looks wrong with a robot is said") {
  const Robot good = shipped("foot").robot;
  CHECK(doubts(good).empty());
  const auto said = [&](auto&& change, const std::string& words) {
    Robot r = good;
    change(r);
    const std::vector<std::string> all = doubts(r);
    INFO(words);
    REQUIRE(all.size() == 1);
    CHECK_THAT(all[0], Catch::Matchers::Contains(words));
  };
  said([](Robot& r) { r.links[1].mass = 300, r.links[1].inertia_com = 2; }, "a cube of steel");
  said([](Robot& r) { r.links[1].mass = 1e-4, r.links[1].inertia_com = 5e-7; }, "a carbon tube");
  said([](Robot& r) { r.links[1].com = {0.4, 0}; }, "centre of mass lies");
  said([](Robot& r) { r.links[1].inertia_com = 0.1; }, "all its mass at both ends");
  said([](Robot& r) { r.links[1].inertia_com = 1e-6; }, "a rod of its length");
  said([](Robot& r) { r.contacts.push_back(r.contacts[2]); }, "another contact");
  said([](Robot& r) { r.contacts.clear(); }, "never touches the floor");
  Robot pinned = good;
  pinned.base = Base::kPinned, pinned.pin_height = 0.7;
  CHECK(doubts(pinned).size() == 3);  // only heel and toe are lower
}

TEST_CASE("legs: what looks wrong with how a robot is let go is said, and nothing of shipped scenes") {
  for (const char* name : {"foot", "hopper", "three_links"}) CHECK(doubts(shipped(name)).empty());
  const auto said = [&](const char* name, auto&& change, const std::string& words) {
    BodyScene s = shipped(name);
    change(s);
    const std::vector<std::string> all = doubts(s);
    INFO(words);
    REQUIRE(all.size() == 1);
    CHECK_THAT(all[0], Catch::Matchers::Contains(words));
  };
  const auto stop = [](BodyScene& s, double low, double high) {
    s.robot.stops.push_back({1, {low * kDegree, high * kDegree}, 100, 1});
  };
  said(
      "hopper", [&](BodyScene& s) { stop(s, -60, 0); }, "let go at -70 deg, 10 deg beyond its stop");
  said(
      "hopper", [](BodyScene& s) { s.search[1].hold = -1.22 * kDegree; }, "(-1.22 rad would be -69.9)");
  said(
      "hopper", [](BodyScene& s) { s.search[1].hold = 20 * kDegree; }, "no plan holds it there");
  said(
      "hopper",
      [](BodyScene& s) {
        s.search[0].phi = {-0.35 * kDegree, 1.2 * kDegree};
      },
      "degrees, not radians");
  said(
      "hopper",
      [](BodyScene& s) {
        set_limit(s, limit(s.robot, Load::Kind::kAngle, 1, 0, {-2.6 * kDegree, -0.1 * kDegree}));
      },
      "knee.angle: phi_deg: [-2.6, -0.1]: degrees, not radians");
  said(
      "hopper", [](BodyScene& s) { s.robot.rail_direction = 1.5708 * kDegree; },
      "robot.rail.direction_deg: 1.5708: degrees, not radians");
  said(
      "foot", [](BodyScene& s) { s.robot.contacts[3].pad->thickness = 10; }, "thickness is in metres");
  said(
      "three_links",
      [](BodyScene& s) {
        s.release = BodyRelease{.joints = {{0, 0}, {-45 * kDegree, 0}}, .from = 0.5};
      },
      "no joint moves in the air");
  // An arm on a pin.
  BodyScene arm;
  arm.robot.base = Base::kPinned, arm.robot.pin_height = 0.5;
  arm.robot.links = {{"arm", -1, {}, 1, 0.01, {0.2, 0}}};
  arm.robot.contacts = {{"tip", 0, {0.4, 0}, {.stiffness = 1000, .damping_normal = 10}, {}}};
  arm.robot.joints = {{.name = "pin", .child = 0, .kind = DriveKind::kPassive, .phi = 0.5}};
  arm.search.resize(1), arm.floor = true, arm.drop.pitch = 0.5;
  CHECK(doubts(arm).size() == 1);  // its contact never touches
  arm.robot.pin_height = 0.2;
  REQUIRE(doubts(arm).size() == 1);
  CHECK_THAT(doubts(arm)[0], Catch::Matchers::Contains("m below the floor"));
  arm.robot.pin_height = 0.39, arm.robot.joints[0].phi = 0.3;
  REQUIRE(doubts(arm).size() == 1);
  CHECK_THAT(doubts(arm)[0], Catch::Matchers::Contains("are one angle: the drop's counts"));
}

TEST_CASE("legs: drives that do not come to rest are told, as the paper's robot's are, of each joint") {
  BodyScene scene = shipped("three_links");
  const BodyMotion held = held_posture(scene);
  CHECK_FALSE(instability(scene, held));
  // The paper's robot: the same rate as of its own form.
  const Actuator a = read_actuator(UKEMI_DATASETS "/actuators/table2.toml");
  Actuator loose = a;
  loose.sea.c_sea = 0.001;
  const Scene paper = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  const Motion posture{-0.6, -0.6, 1};
  const auto two = instability(paper, loose.sea, posture);
  const auto links = instability(legs::long_paper(paper, loose), {posture});
  REQUIRE((two && links));
  CHECK(links->rate == Approx(two->rate).epsilon(1e-9));
  // A small disturbance in flight grows at that rate.
  for (Joint& j : scene.robot.joints) j.sea.c_sea = 0.001;
  const auto grows = instability(scene, held);
  REQUIRE(grows);
  const auto joint = std::size_t(grows->joint);
  scene.floor = false, scene.robot.gravity = 0, scene.drop = {};
  for (Joint& j : scene.robot.joints) j.sea.tau_max = std::numeric_limits<double>::infinity();
  scene.release = BodyRelease{.joints = {{held[0].phi_i, 0}, {held[1].phi_i, 0}}};
  scene.release->joints[joint].rate = 1e-6;
  const double from = 8 / grows->rate, to = 16 / grows->rate;
  scene.t_end = to;
  BodyMotion still = held_posture(scene);
  const BodyLanding l = simulate(scene, still, {.accuracy = 1e-11}, 4000);
  double early = 0, late = 0;
  for (const BodySample& x : l.trajectory) {
    if (x.t < from) early = std::max(early, std::abs(x.dphi[joint]));
    late = std::max(late, std::abs(x.dphi[joint]));
  }
  CHECK(std::log(late / early) / (to - from) == Approx(grows->rate).epsilon(0.1));
}

TEST_CASE("legs: where no motion keeps the ratings, the one that breaks them least is told") {
  BodyScene scene = legs::shipped("hopper");
  for (Joint& j : scene.robot.joints) j.speed_max = 0.5, j.motor_torque_max = 100;
  CHECK(respect_ratings(scene).empty());
  const BodyPlan p = plan(scene, {.evaluations = 1000});
  REQUIRE_FALSE(p.found);
  const std::optional<BodyLeastBreaking> least = least_breaking(scene, {});
  REQUIRE(least);
  const BodyLeastBreaking& l = *least;
  CHECK(l.limit.kind == Load::Kind::kMotorSpeed);
  CHECK(l.limit.rating == 0.5);
  CHECK(l.excess() > 1);
  // In its own drop it demands no more than that, and less than holding does.
  BodyScene told = scene;
  told.loads.clear();
  for (const int j : {0, 1})
    told.loads.push_back({.name = "speed", .kind = Load::Kind::kMotorSpeed, .index = j, .rating = 0.5});
  const double own = worth(told, peak_acceleration(told, l.motion));
  CHECK(own <= l.excess() * (1 + 1e-6));
  CHECK(own < worth(told, peak_acceleration(told, held_posture(told))));
  for (Joint& j : scene.robot.joints) j.speed_max = 1000;
  CHECK(respect_ratings(scene).empty());
  CHECK_FALSE(least_breaking(scene, {}));
}
