// Robots of links over drops that scatter: what is drawn, what a plan promises, what risk tells. Of one elastic joint
// everything is also the paper's robot's, whose own path is another program.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/degrees.hpp"
#include "landing/judge/risk.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/plan/body_goal.hpp"
#include "landing/plan/body_plan.hpp"
#include "landing/plan/body_risk.hpp"
#include "landing/scatter/drop_model.hpp"
#include "landing/scatter/sampler.hpp"
#include "landing/search/tolerant_peak.hpp"
#include "test/folder.hpp"
#include "test/legs/robots.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using legs::long_paper, legs::shipped;

namespace {

Actuator fitted() {
  Actuator a = read_actuator(UKEMI_DATASETS "/actuators/table2.toml");
  a.uncertain = {"k_p", "k_sea"};
  a.covariance = Eigen::Matrix2d{{0.5, 0.3}, {0.3, 2}};
  return a;
}
const Scatter kAll{.pitch = 0.02,
                   .height = 0.01,
                   .forward_speed = 0.03,
                   .phi = 0.01,
                   .rate = 0.1,
                   .stiffness = 0.1,
                   .damping_normal = 0.1,
                   .damping_tangential = 0.2,
                   .delay = 1e-3};

}  // namespace

TEST_CASE("legs: a scatter reaches what it names, on bases that have it") {
  const BodyScene hopper = shipped("hopper");
  CHECK_THROWS_WITH(BodyDropModel(hopper, {.forward_speed = 0.1}), Catch::Matchers::Contains("forward_speed"));
  CHECK_THROWS_WITH(BodyDropModel(hopper, {.pitch_rate = 0.1}), Catch::Matchers::Contains("pitch_rate"));
  CHECK(assumed_scatter(hopper.robot).forward_speed == 0);
  CHECK_FALSE(BodyDropModel(hopper, {}).scatters());

  const BodyDropModel model(hopper, {.height = 0.2, .phi = 0.02, .rate = 0.1, .stiffness = 0.1});
  CHECK(model.sampler().dimension() == 6);  // height, stiffness, two joints twice
  const BodyMotion planned = held_posture(hopper);
  bool some_from_floor = false;
  for (const BodyDrop& d : model.even(64, 1)) {
    const double factor = d.scene.robot.contacts[0].law.stiffness / 20'000;
    for (const ContactPoint& c : d.scene.robot.contacts)
      CHECK(c.law.stiffness == Approx(20'000 * factor).epsilon(1e-12));
    CHECK(d.scene.drop.height >= 0);
    some_from_floor = some_from_floor || d.from_floor;
    const BodyMotion m = d.played(planned);
    CHECK(m[0].release_phi() == Approx(planned[0].phi_i + d.joints[0].phi));
    CHECK(m[1].release_rate() == Approx(d.joints[1].rate));
    CHECK(m[0].phi_f == planned[0].phi_f);
    CHECK(d.joints[0].phi != d.joints[1].phi);
    CHECK(simulate(d.scene, m).end == End::kRest);
  }
  CHECK(some_from_floor);
}

TEST_CASE("legs: what a fit knew of a robot scatters with its drops") {
  const test::Folder folder;
  std::string robot = test::read(UKEMI_DATASETS "/robots/hopper.toml");
  robot +=
      "\n[command.hip]\ntorque_gain = 0.8\n[identified]\norder = [\"drive.knee.k_p\", \"robot.link.shank.mass\", "
      "\"command.hip.torque_gain\", \"command.delay\", \"robot.contact.foot.stiffness\"]\ncovariance = [\n"
      "  [4, 0.016, 0, 0, 0],\n  [0.016, 1e-4, 0, 0, 0],\n  [0, 0, 0.0064, 0, 0],\n  [0, 0, 0, 1e-6, 0],\n"
      "  [0, 0, 0, 0, 1e6],\n]\n";
  (void)folder.write("hopper.toml", robot);
  const BodyScene scene = read_body_scene(
      folder.write("scene.toml", test::replaced(test::read(UKEMI_DATASETS "/scenes/hopper.toml"),
                                                "robot = \"../robots/hopper.toml\"", "robot = \"hopper.toml\"")));
  REQUIRE(scene.identified);
  CHECK(scene.identified->order.size() == 4);  // a delay of commands is none of a landing's
  const BodyDropModel model(scene, {});
  CHECK(model.sampler().dimension() == 4);
  CHECK_FALSE(BodyDropModel(scene, {}, {.inflate = 0}).scatters());
  constexpr long kDrops = 4096;
  double k_p = 0, mass = 0, both = 0, gain = 0, stiffness = 0;
  for (const BodyDrop& d : model.even(kDrops, 1)) {
    const Robot &is = d.scene.robot, &was = scene.robot;
    const double p = is.joints[1].sea.k_p - was.joints[1].sea.k_p, m = is.links[2].mass - was.links[2].mass,
                 g = is.joints[0].sea.k_p / was.joints[0].sea.k_p - 1;
    k_p += p * p, mass += m * m, both += p * m, gain += g * g;
    stiffness += std::pow(is.contacts[2].law.stiffness - was.contacts[2].law.stiffness, 2);
    CHECK(is.joints[0].sea.k_d / was.joints[0].sea.k_d == Approx(1 + g).epsilon(1e-12));
    CHECK(is.joints[0].sea.tau_max / was.joints[0].sea.tau_max == Approx(1 + g).epsilon(1e-12));
    CHECK(is.contacts[0].law.stiffness == was.contacts[0].law.stiffness);
  }
  const auto deviation = [](double square) { return std::sqrt(square / double(kDrops)); };
  CHECK(deviation(k_p) == Approx(2).epsilon(0.03));
  CHECK(deviation(mass) == Approx(0.01).epsilon(0.03));
  CHECK(both / std::sqrt(k_p * mass) == Approx(0.8).margin(0.03));
  CHECK(deviation(gain) == Approx(0.1).epsilon(0.03));  // 0.08 of 0.8
  CHECK(deviation(stiffness) == Approx(1000).epsilon(0.03));
  // The floor's own scatter comes on top.
  double ratio = 0;
  for (const BodyDrop& d : BodyDropModel(scene, {.stiffness = 0.1}).even(kDrops, 1))
    ratio += std::pow(d.scene.robot.contacts[2].law.stiffness / d.scene.robot.contacts[0].law.stiffness - 1, 2);
  CHECK(deviation(ratio) == Approx(0.05).epsilon(0.03));
  // Risk says how much of the spread is the robot's.
  const BodyRisk risk = body_risk(scene, held_posture(scene), {.samples = 256, .scatter = Scatter{.height = 0.01}});
  REQUIRE(risk.uncertainties.size() == 2);
  CHECK(std::ranges::count(risk.uncertainties, "the robot", &PeakRisk::Uncertainty::name) == 1);
}

TEST_CASE("legs: friction, slopes and pads scatter, where the robot has them") {
  BodyScene hopper = shipped("hopper");
  for (const Scatter& s : {Scatter{.dissipation = 0.1}, Scatter{.pad_thickness = 0.1}, Scatter{.pad_damping = 0.1}})
    CHECK_THROWS_WITH(BodyDropModel(hopper, s), Catch::Matchers::Contains("no contact of this robot has any"));
  const Scene paper = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  CHECK_THROWS_WITH(DropModel(paper, {.slope = 0.1}, fitted(), {}), Catch::Matchers::Contains("scatter: slope"));

  for (ContactPoint& c : hopper.robot.contacts) c.pad = Pad{0.01, 3000, 60};
  const Scatter scatter{.slope = 2 * kDegree,
                        .friction = 0.1,
                        .stiffness_tangential = 0.2,
                        .pad_thickness = 0.05,
                        .pad_stiffness = 0.15,
                        .pad_damping = 0.3};
  const BodyDropModel model(hopper, scatter);
  REQUIRE(model.sampler().dimension() == 6);
  constexpr long kDrops = 4096;
  // Root mean squares; a cut at three deviations takes 1.3 % of them.
  std::array<double, 6> sum{};
  for (const BodyDrop& d : model.even(kDrops, 1)) {
    const ContactPoint &c = d.scene.robot.contacts[1], &planned = hopper.robot.contacts[1];
    const auto moved = [](double x, double x0) { return std::log(x / x0); };
    const std::array<double, 6> z = {d.scene.slope,
                                     moved(c.law.friction, planned.law.friction),
                                     moved(c.law.stiffness_tangential, planned.law.stiffness_tangential),
                                     moved(c.pad->thickness, planned.pad->thickness),
                                     moved(c.pad->stiffness, planned.pad->stiffness),
                                     moved(c.pad->damping, planned.pad->damping)};
    for (std::size_t k = 0; k < z.size(); ++k) sum[k] += z[k] * z[k] / kDrops;
    CHECK(c.law.stiffness == planned.law.stiffness);
  }
  const std::array<double, 6> asked = {scatter.slope,         scatter.friction,      scatter.stiffness_tangential,
                                       scatter.pad_thickness, scatter.pad_stiffness, scatter.pad_damping};
  for (std::size_t k = 0; k < asked.size(); ++k) CHECK(std::sqrt(sum[k]) == Approx(0.987 * asked[k]).epsilon(0.01));
}

TEST_CASE("legs: with one joint, drops, tolerant peaks and risk are those of the paper's robot") {
  const Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  const Actuator a = fitted();
  const BodyScene body = long_paper(scene, a);
  const Motion motion{-20 * kDegree, -80 * kDegree, 0.3};
  const BodyMotion same = {motion};
  CHECK(simulate(body, same).peak == Approx(simulate(scene, a.sea, motion).peak).epsilon(1e-8));

  const std::vector<BodyDrop> box = execution_drops(body);
  CHECK(box.size() == std::size_t(kExecutionPoints));
  double worst = 0;
  for (const double p : peaks_over(box, same, 1e-9, 0).peaks) worst = std::max(worst, p);
  double two_link = 0;
  const ReferenceSpace space(scene, a.sea);
  for (int k = 0; k < kExecutionPoints; ++k) {
    const DrivenMotion p = space.execution_point({motion, a.sea}, scene.execution, k);
    two_link = std::max(two_link, peak_acceleration(scene, p.sea, p.motion).peak);
  }
  CHECK(worst == Approx(two_link).epsilon(1e-7));

  const BodyDropModel model(body, kAll, {});
  const DropModel paper(scene, kAll, a, {});
  CHECK(model.sampler().dimension() == paper.dimension());
  BodyRiskOptions of_body{.samples = 512};
  of_body.scatter = kAll;
  const BodyRisk r = body_risk(body, same, of_body);
  const Risk known = risk(paper, a, motion, {.samples = 512});
  // phi and rate come behind the floor's numbers here: other drops of one distribution.
  const double error = std::hypot(r.peaks.mean.standard_error, known.peaks.mean.standard_error);
  CHECK(std::abs(r.peaks.mean.value - known.peaks.mean.value) < 3 * error);
  CHECK(r.peaks.samples == 512);
  CHECK(r.failed == 0);
  CHECK(r.uncertainties.size() == paper.sampler().groups().size());
  CHECK(r.contacts.front().drops > 0);
}

TEST_CASE("legs: risk is what its drops are played to, the same on one thread, stopped where it is told") {
  const BodyScene scene = shipped("hopper");
  const BodyMotion m = held_posture(scene);
  const BodyRiskOptions options{.samples = 128};
  const BodyRisk r = body_risk(scene, m, options);
  const BodyDropModel model(scene, assumed_scatter(scene.robot));
  double mean = 0;
  for (const BodyDrop& d : model.even(128, 1)) mean += simulate(d.scene, d.played(m)).peak / 128;
  CHECK(r.peaks.mean.value == Approx(mean).epsilon(1e-4));
  CHECK(r.held.mean.value == Approx(mean).epsilon(1e-3));
  CHECK(r.assumed);
  CHECK(r.uncertainties.size() == 2);
  BodyRiskOptions one = options;
  one.threads = 1;
  CHECK(body_risk(scene, m, one).peaks.mean.value == r.peaks.mean.value);
  BodyRiskOptions stopped = options;
  stopped.monitor.stop = [] { return true; };
  CHECK(body_risk(scene, m, stopped).peaks.samples == 0);
  BodyScene rated = scene;
  rated.robot.joints[1].speed_max = 0.5, rated.robot.joints[1].motor_torque_max = 1e6;
  const BodyRisk of_rated = body_risk(rated, m, options);
  REQUIRE(of_rated.events.size() == 2);
  CHECK(of_rated.events[0].drops == 128);
  CHECK(of_rated.events[1].drops == 0);
}

TEST_CASE("legs: a plan is never worse than holding by its own goal, with every goal and a deadline") {
  const BodyScene scene = shipped("hopper");
  using Kind = Measure::Kind;
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant})
    for (const std::optional<Measure>& measure :
         {std::optional<Measure>(), std::optional(Measure{Kind::kMean}), std::optional(Measure{Kind::kCvar}),
          std::optional(Measure{Kind::kQuantile, 0.8}), std::optional(Measure{Kind::kWorst})})
      for (const std::optional<double>& deadline : {std::optional<double>(), std::optional(0.4)}) {
        BodyPlanOptions o;
        o.goal = goal, o.measure = measure, o.deadline = deadline;
        o.samples = 16, o.judging = 32, o.fresh = 64;
        if (!deadline) o.evaluations = measure ? 3'000 : 600;
        const BodyPlan p = plan(scene, o);
        INFO(int(goal) << " " << (measure ? measure->name() : "none") << " " << deadline.value_or(0));
        REQUIRE(p.found);
        CHECK(p.value <= p.held_value);  // by a deadline a busy machine gets no further
        if (!deadline) CHECK(p.value < p.held_value);
        CHECK(p.under.has_value() == !deadline);  // fresh drops, of the assumed scatter too
        if (!measure && goal == Goal::kTolerant) {
          const auto worst = [&](double accuracy) {
            return std::ranges::max(peaks_over(execution_drops(scene), p.motion, accuracy, 0).peaks);
          };
          const bool in_haste = deadline && p.value == worst(kSearchAccuracy);  // a slow machine judges as it searches
          CHECK((in_haste || p.value == Approx(worst(o.accuracy)).epsilon(1e-6)));
          CHECK(p.value >= p.landing.peak * (1 - 1e-9));
        }
      }
}

TEST_CASE("legs: a plan is never worse than the best posture to hold, with every goal, however short the search") {
  for (const char* const name : {"hopper", "three_links"}) {
    const BodyScene scene = shipped(name);
    for (const auto& [goal, measure] :
         {std::pair(Goal::kPeak, std::optional<Measure>()), std::pair(Goal::kTolerant, std::optional<Measure>()),
          std::pair(Goal::kPeak, std::optional(Measure{Measure::Kind::kCvar}))}) {
      BodyPlanOptions o;
      o.goal = goal, o.measure = measure, o.samples = 8, o.judging = 16, o.fresh = 0;
      o.evaluations = measure ? 1'500 : 150;
      const BodyPlan p = plan(scene, o);
      const BodyGoal by = plan_goals(scene, o, o.samples, o.judging).judge;
      double best = p.held_value;
      constexpr int kGrid = 9;
      BodyMotion m = p.hold;
      const auto held_at = [&](int joint, int k) {
        const auto& [low, high] = scene.search[std::size_t(joint)].phi;
        m[std::size_t(joint)].phi_i = m[std::size_t(joint)].phi_f = std::lerp(low, high, k / (kGrid - 1.0));
      };
      for (int i = 0; i < kGrid; ++i)
        for (int j = 0; j < kGrid; ++j) {
          held_at(0, i), held_at(1, j);
          best = std::min(best, judged(by, m, o).value);
        }
      INFO(name << " " << int(goal) << " " << (measure ? measure->name() : "none") << ": " << p.held_value);
      REQUIRE(p.found);
      CHECK(p.value <= 1.02 * best);
    }
  }
}

TEST_CASE("legs: a robot that begins on the floor stands on it, however its posture rounds") {
  for (const char* const name : {"hopper", "three_links"}) {
    BodyScene scene = shipped(name);
    scene.drop.height = 0;
    const BodyMotion held = held_posture(scene);
    for (int i = 0; i < 60; ++i) {
      scene.drop.pitch = 1e-3 * (i - 30);
      const BodyLanding l = peak_acceleration(scene, held, {.accuracy = kSearchAccuracy});
      INFO(name << " at " << scene.drop.pitch << " rad: " << l.peak << " m/s^2");
      CHECK(l.contacts.first() < 1e-5);
      CHECK(l.peak == Approx(simulate(scene, held).peak).epsilon(1e-3));
    }
  }
}

TEST_CASE("legs: plans of one seed are the same on one thread and two, what they promise is kept on fresh drops") {
  const BodyScene scene = shipped("hopper");
  BodyPlanOptions o;
  o.measure = Measure{Measure::Kind::kCvar}, o.evaluations = 8'000, o.samples = 32, o.threads = 2, o.fresh = 1024;
  const BodyPlan p = plan(scene, o);
  o.threads = 1;
  const BodyPlan one = plan(scene, o);
  CHECK(p.value == one.value);
  CHECK(p.motion[0].phi_i == one.motion[0].phi_i);
  REQUIRE(p.under);
  CHECK(std::abs(p.under->measured.value / p.value - 1) < 0.03);
  CHECK(p.under->measured.value < p.under->held.cvar90.value);
  BodyPlanOptions wrong = o;
  wrong.goal = Goal::kRobust;
  CHECK_THROWS_WITH(plan(scene, wrong), Catch::Matchers::Contains("a measure makes it robust"));
  wrong = o, wrong.samples = 0;
  CHECK_THROWS_WITH(plan(scene, wrong), Catch::Matchers::Contains("samples"));
}
