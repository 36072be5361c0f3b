// Robots of links on floors and with drives that explicit steps cannot follow: the run goes implicit, as that of the
// paper's robot does.
#include <ceres/jet.h>
#include <catch2/catch.hpp>

#include "common/jet.hpp"
#include "landing/body/body_course.hpp"
#include "landing/body/body_run.hpp"
#include "landing/lanes/body_batch.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/plan/body_space.hpp"
#include "test/legs/robots.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using Catch::Detail::Approx;

namespace {

constexpr std::uint64_t kSeed = 20261128;

void damp(BodyScene& scene, double factor) {
  for (ContactPoint& c : scene.robot.contacts) c.law.damping_normal *= factor, c.law.damping_tangential *= factor;
}

}  // namespace

TEST_CASE("stiff: a floor whose damping is 100 to a million times that of the shipped robots", "[legs]") {
  for (const std::string name : {"three_links", "hopper"})
    for (const double factor : {1e2, 1e4, 1e6}) {
      CAPTURE(name, factor);
      BodyScene scene = legs::shipped(name);
      damp(scene, factor);
      const BodyMotion held = held_posture(scene);
      const BodyLanding l = simulate(scene, held), fine = peak_acceleration(scene, held, {.accuracy = 1e-11});
      CHECK((l.end == End::kRest || l.end == End::kTimeLimit));
      CHECK(l.peak == Approx(fine.peak).epsilon(1e-6));
      CHECK(l.work.implicit > 0);
      CHECK(l.work.steps < 10'000);
      const BodyBatchCase batch{&scene, &held};
      BodyLanding lane;
      body_batch_peaks({&batch, 1}, {&lane, 1}, {});
      CHECK(lane.peak == Approx(fine.peak).epsilon(1e-4));
    }
}

TEST_CASE("stiff: the paper's robot, damping and motor inertia drawn: peaks of runs ten thousand times tighter",
          "[legs]") {
  const Scene paper = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  const Actuator table2 = read_actuator(UKEMI_DATASETS "/actuators/table2.toml");
  INFO("seed " << kSeed);
  int implicit = 0;
  for (std::uint64_t i = 0; i < 24; ++i) {
    Random r(kSeed, i);
    CAPTURE(i);
    Scene scene = paper;
    Actuator actuator = table2;
    scene.floor->damping_normal *= std::pow(10, r.uniform(0, 4));
    actuator.sea.i_motor *= std::pow(10, r.uniform(-5, 0));
    const Motion motion{-r.uniform(), -r.uniform(), 0.1 + 0.5 * r.uniform()};
    const LandingPeak fine = peak_acceleration(scene, actuator.sea, motion, {.accuracy = 1e-12}),
                      usual = peak_acceleration(scene, actuator.sea, motion, {.accuracy = 1e-8});
    REQUIRE(!no_landing(fine.end));
    REQUIRE(!no_landing(usual.end));
    CHECK(usual.peak == Approx(fine.peak).epsilon(1e-6));
    implicit += usual.work.implicit > 0;
  }
  CHECK(implicit > 6);
}

TEST_CASE("stiff: the Jacobian of an implicit step is that by automatic differentiation", "[legs]") {
  using System = BodySystem<kTriple, true>;
  constexpr int n = System::kStates;
  using Dual = ceres::Jet<double, n + 1>;
  INFO("seed " << kSeed);
  for (const std::string name : {"three_links", "hopper"}) {
    const BodyScene scene = legs::shipped(name);
    const BodySpace space(scene);
    for (std::uint64_t i = 0; i < 40; ++i) {
      Random r(kSeed, i);
      CAPTURE(name, i);
      Coordinates u(space.dimension());
      for (double& x : u) x = r.uniform();
      const BodyMotion motion = space.motion(u);
      BodyCourse<kTriple, true> course(scene, motion);
      System::State y = course.released();
      course.land(0.3);
      for (int k = System::kTheta; k < System::kWork; ++k) y[k] += 0.1 * r.uniform(-1, 1);
      for (PointMode& m : course.system.contact) {
        m.touching = m.below = r.uniform() < 0.7, m.floor = m.below && r.uniform() < 0.8;
        m.slides = m.touching ? int(3 * r.uniform()) - 1 : 0;
      }
      const double t = 0.3 + 0.5 * motion.back().duration;
      Eigen::Matrix<double, n, n> jacobian;
      System::State rate;
      course.system.linearize(t, y, jacobian, rate);
      const BodySystem<kTriple, true, Dual> dual(course.system);
      Eigen::Matrix<Dual, n, 1> x, dx;
      for (int k = 0; k < n; ++k) x[k] = Dual(y[k], k);
      dual.derivative(Dual(t, n), x, dx);
      for (int k = 0; k < n; ++k) {
        const auto exact = dx[k].v.template head<n>().transpose();
        const double scale = 1 + exact.cwiseAbs().maxCoeff() + std::abs(dx[k].v[n]);
        CHECK((exact - jacobian.row(k)).cwiseAbs().maxCoeff() < 1e-6 * scale);
        CHECK(std::abs(dx[k].v[n] - rate[k]) < 1e-5 * scale);
      }
    }
  }
}
