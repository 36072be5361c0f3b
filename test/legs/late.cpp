// Robots of links whose drives are late: the paper's robot by its links beside its own kernel, derivatives beside
// differences, a plan.
#include <catch2/catch.hpp>
#include <cmath>

#include "landing/body/load.hpp"
#include "landing/derivatives/body_gradient.hpp"
#include "landing/lanes/body_batch.hpp"
#include "landing/plan/body_plan.hpp"
#include "landing/run/simulate.hpp"
#include "test/legs/robots.hpp"
#include "test/paper.hpp"
#include "test/quotient.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {

SeaParameters<double> late(double delay, double filter, Feedback feedback = Feedback::kOutput) {
  SeaParameters<double> sea = test::table2_sea();
  sea.control_delay = delay, sea.velocity_filter = filter, sea.feedback = feedback;
  return sea;
}

/// The robot with a torso, its hip late.
BodyScene late_hip() {
  BodyScene out = legs::shipped("three_links");
  out.robot.joints[0].sea.control_delay = 2e-3, out.robot.joints[0].sea.velocity_filter = 1e-3;
  return out;
}
const BodyMotion kMoving = {{0.2, 0.9, 0.2}, {-0.5, -1.2, 0.3}};

}  // namespace

TEST_CASE("legs: a drive that is late: reports and peaks of the paper's robot, by its scene and by links") {
  const Scene scene = test::paper();
  for (const SeaParameters<double>& sea : {late(1e-3, 0), late(0, 2e-3), late(3e-3, 1e-3, Feedback::kMotor)})
    for (const Motion& m : {Motion{-0.785398, -0.785398, 1}, Motion{-0.3, -1.2, 0.25, {}, 0.6, 1.5}}) {
      const BodyScene links = legs::long_paper(scene, {.sea = sea});
      const Landing own = simulate(scene, sea, m, {.accuracy = 1e-11});
      const BodyLanding by_links = simulate(links, {m}, {.accuracy = 1e-11});
      INFO(sea.control_delay << " s, " << sea.velocity_filter << " s, " << m.phi_f);
      REQUIRE(!no_landing(by_links.end));
      CHECK(by_links.peak == Approx(own.peak).epsilon(1e-7));
      CHECK(by_links.demands[0].motor_torque == Approx(own.demands.motor_torque).epsilon(1e-4));
      CHECK(peak_acceleration(links, {m}, {.accuracy = 1e-6}).peak == Approx(own.peak).epsilon(1e-4));
      // The drive counts: at once the peak is another.
      const SeaParameters<double> prompt = late(0, 0, sea.feedback);
      CHECK(std::abs(simulate(legs::long_paper(scene, {.sea = prompt}), {m}).peak - own.peak) > 1e-4 * own.peak);
    }
}

TEST_CASE("legs: one joint that is late leaves the others as they are") {
  BodyScene scene = late_hip();
  const double with = simulate(scene, kMoving, {.accuracy = 1e-10}).peak;
  scene.robot.joints[0].sea.control_delay = 1e-9, scene.robot.joints[0].sea.velocity_filter = 0;
  const double hardly = simulate(scene, kMoving, {.accuracy = 1e-10}).peak;
  scene.robot.joints[0].sea.control_delay = 0;
  const double prompt = simulate(scene, kMoving, {.accuracy = 1e-10}).peak;
  CHECK(hardly == Approx(prompt).epsilon(1e-5));
  CHECK(std::abs(with - prompt) > 1e-4 * prompt);
}

TEST_CASE("legs: derivatives of a landing whose drive is late, those by its delay and filter too") {
  const BodyScene scene = late_hip();
  std::vector<BodyParameter> of_interest;
  for (const BodyParameter& p : parameters_of(scene, kMoving))
    if (p.of == BodyParameter::Of::kMotion || (p.of == BodyParameter::Of::kDrive && p.index == 0))
      of_interest.push_back(p);
  constexpr SimulateOptions kTight{.accuracy = 1e-13, .rest = SimulateOptions::Rest::kIgnore};
  const BodyGradients g = gradients(scene, kMoving, of_interest, kTight, 3);
  REQUIRE(!g.peaks.empty());
  CHECK(g.peaks[0].value == Approx(peak_acceleration(scene, kMoving, kTight).peak).epsilon(1e-8));
  int right = 0;
  bool delay = false, filter = false;
  double size = 0;
  for (std::size_t k = 0; k < of_interest.size(); ++k) {
    BodyScene moved = scene;
    BodyMotion motion = kMoving;
    double& x = number(moved, motion, of_interest[k]);
    const double x0 = x, unit = of_interest[k].of == BodyParameter::Of::kDrive ? std::abs(x0) : 1;
    if (unit == 0) continue;
    const Quotient q = central(unit, 1e-7, [&](double by) {
      x = x0 + by;
      return peak_acceleration(moved, motion, kTight).peak;
    });
    const std::string what = name(of_interest[k], scene.robot);
    INFO(what << ": " << g.peaks[0].d[Eigen::Index(k)] << ", " << q.value << " +- " << q.error);
    size = std::max(size, std::abs(q.value * unit));
    if (q.error * unit > 1e-6 * size) continue;
    CHECK(std::abs(g.peaks[0].d[Eigen::Index(k)] - q.value) * unit < 1e-5 * size);
    ++right;
    delay = delay || what.find("control_delay") != std::string::npos;
    filter = filter || what.find("velocity_filter") != std::string::npos;
  }
  CHECK(right > 8);
  CHECK(delay);
  CHECK(filter);
}

TEST_CASE("legs: drives that are late land in lanes as one by one") {
  const BodyScene scene = late_hip();
  std::vector<BodyMotion> motions;
  for (int i = 0; i < 24; ++i) {
    const double x = i / 24.0;
    motions.push_back({{-1.2 + 2 * x, 0.8 - 1.5 * x, 0.15 + 0.3 * x}, {-0.2 - x, -1.3 + x, 0.4 - 0.2 * x}});
  }
  for (const InstructionSet set : {InstructionSet::kBaseline, InstructionSet::kAvx2, InstructionSet::kAvx512}) {
    std::vector<BodyBatchCase> cases;
    for (const BodyMotion& m : motions) cases.push_back({&scene, &m});
    std::vector<BodyLanding> lanes(motions.size());
    body_batch_peaks(cases, lanes, {.accuracy = 1e-7}, 1, set);
    int off = 0;
    for (std::size_t k = 0; k < motions.size(); ++k) {
      const double one = peak_acceleration(scene, motions[k], {.accuracy = 1e-9}).peak;
      off += !(std::abs(lanes[k].peak - one) < 1e-4 * one);
      CHECK(lanes[k].work.steps > 0);
    }
    CHECK(off <= 1);  // one that stands beside a cliff
  }
}

TEST_CASE("legs: a plan for drives that are late, with every goal, under scatter, and for loads") {
  BodyScene scene = late_hip();
  scene.robot.joints[1].sea.control_delay = 1e-3;
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant}) {
    const BodyPlan p = plan(scene, {.goal = goal, .evaluations = 200});
    REQUIRE(p.found);
    CHECK(p.value < 0.5 * p.held_value);
    CHECK(simulate(scene, p.motion).peak == Approx(p.landing.peak).epsilon(1e-6));
  }
  BodyPlanOptions o{.evaluations = 100};
  o.measure = Measure{Measure::Kind::kMean}, o.samples = 8, o.judging = 16, o.fresh = 64;
  CHECK(plan(scene, o).found);
  set_limit(scene, limit(scene.robot, Load::Kind::kMotorTorque, 0, 15));
  const BodyPlan kept = plan(scene, {.evaluations = 200});
  REQUIRE(kept.found);
  CHECK(kept.landing.loads[0].value <= 15);
}

TEST_CASE("legs: a robot that is too large for drives that are late is refused") {
  Robot robot = late_hip().robot;
  for (int i = 0; i < 6; ++i) robot.contacts.push_back(robot.contacts[0]);
  CHECK_THROWS_WITH(robot.validate(), Catch::Matchers::Contains("at most 5 links, 4 joints, 7 contacts"));
  robot.joints[0].sea.control_delay = robot.joints[0].sea.velocity_filter = 0;
  CHECK_NOTHROW(robot.validate());
}
