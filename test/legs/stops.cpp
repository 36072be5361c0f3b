// Stops that push back: against closed forms, in lanes, with derivatives, in trials, and where a file is wrong.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "common/degrees.hpp"
#include "common/error.hpp"
#include "common/random.hpp"
#include "landing/body/body_run.hpp"
#include "landing/derivatives/body_gradient.hpp"
#include "landing/lanes/body_batch.hpp"
#include "landing/plan/design_numbers.hpp"
#include "test/folder.hpp"
#include "test/legs/robots.hpp"
#include "test/quotient.hpp"
#include "tools/study/robot_trials.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {

/// A rod that turns about its pin without gravity, at 2 rad/s towards a stop 0.4 rad away.
BodyScene rod(const Stop& stop) {
  BodyScene s;
  s.robot.gravity = 0, s.robot.base = Base::kPinned;
  s.robot.links = {{.name = "rod", .mass = 1.5, .inertia_com = 0.02, .com = {0.2, 0}}};
  Joint j;
  j.name = "pin", j.child = 0, j.kind = DriveKind::kPassive;
  s.robot.joints = {j};
  s.robot.peak = {0.2, 0};
  s.robot.stops = {stop};
  s.floor = false, s.drop.pitch_rate = 2, s.search.resize(1);
  return s;
}
constexpr double kInertia = 0.02 + 1.5 * 0.2 * 0.2, kSpeed = 2, kEnd = 0.4;

/// The hopper with stops that its landings meet.
BodyScene stopped_hopper(double damping = 1.5) {
  BodyScene s = legs::shipped("hopper");
  s.robot.stops = {{.joint = 1, .ends = {-80 * kDegree, -45 * kDegree}, .stiffness = 400, .damping = damping},
                   {.joint = -1, .ends = {0.27, 2}, .stiffness = 3e4, .damping = damping > 0 ? 80.0 : 0.0}};
  s.validate();
  return s;
}

std::vector<BodyMotion> motions_of(const BodyScene& scene, int count, std::uint64_t seed) {
  std::vector<BodyMotion> out;
  for (int k = 0; k < count; ++k) {
    Random r(seed, std::uint64_t(k));
    BodyMotion m = held_posture(scene);
    m[0].phi_f = r.uniform(0.2, 1.4), m[1].phi_f = r.uniform(-2.2, -0.2);
    for (Motion& x : m) x.duration = r.uniform(0.1, 0.5);
    out.push_back(m);
  }
  return out;
}

}  // namespace

TEST_CASE("stops: a joint that runs against one leaves after half a swing of its spring, with its restitution") {
  for (const double damping : {0.0, 1.2}) {
    const double stiffness = 300, w = std::sqrt(stiffness / kInertia), half = damping / (2 * kInertia),
                 ring = std::sqrt(w * w - half * half);
    BodyScene scene = rod({.joint = 0, .ends = {-1, kEnd}, .stiffness = stiffness, .damping = damping});
    // From 0 at kSpeed: delta = kSpeed / ring exp(-half t) sin(ring t). It leaves where K delta + C ddelta = 0, which
    // is tan(ring t) = -C ring / (K - C half).
    const double leaves = damping == 0
                              ? std::numbers::pi / ring
                              : (std::numbers::pi - std::atan(damping * ring / (stiffness - damping * half))) / ring;
    const double out =
        kSpeed * std::exp(-half * leaves) * (std::cos(ring * leaves) - half / ring * std::sin(ring * leaves));
    scene.t_end = kEnd / kSpeed + leaves + 0.05;
    const BodyLanding l = simulate(scene, held_posture(scene), {.accuracy = 1e-11}, 1000);
    REQUIRE(!l.trajectory.empty());
    CHECK(l.trajectory.back().dphi[0] == Approx(out).epsilon(1e-8));
    CHECK(l.energy_residual < 1e-8);
    const double deepest = std::atan2(ring, half) / ring;
    CHECK(l.demands[0].phi_max ==
          Approx(kEnd + kSpeed / ring * std::exp(-half * deepest) * std::sin(ring * deepest)).epsilon(1e-4));
  }
}

TEST_CASE("stops: a rail's stop carries the robot, and a joint's its link") {
  BodyScene scene = legs::shipped("hopper");
  scene.robot.stops = {{.joint = -1, .ends = {0.5, 3}, .stiffness = 1e5, .damping = 2e3}};
  scene.t_end = 4;
  const BodyLanding l = simulate(scene, held_posture(scene), {.accuracy = 1e-9}, 100);
  CHECK(l.touches.empty());  // the stop is higher than the leg is long
  const BodySample& last = l.trajectory.back();
  CHECK(last.y[0] == Approx(0.5 - scene.robot.mass() * scene.robot.gravity / 1e5).epsilon(1e-6));
  CHECK(last.acc == Approx(0).margin(1e-4));
}

TEST_CASE("stops: a landing against them balances its energy, in lanes as one by one") {
  const BodyScene scene = stopped_hopper(), free = legs::shipped("hopper");
  const std::vector<BodyMotion> motions = motions_of(scene, 40, 20261126);
  std::vector<BodyBatchCase> cases;
  for (const BodyMotion& m : motions) cases.push_back({&scene, &m});
  std::vector<BodyLanding> lanes(cases.size());
  body_batch_peaks(cases, lanes, {.accuracy = 1e-8}, 2);
  int met = 0, off = 0;
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const BodyLanding one = peak_acceleration(scene, motions[k], {.accuracy = 1e-10});
    off += !(std::abs(lanes[k].peak / one.peak - 1) < 1e-5);
    met += std::abs(one.peak / peak_acceleration(free, motions[k], {.accuracy = 1e-10}).peak - 1) > 1e-3;
    if (k >= 5) continue;
    const BodyLanding l = simulate(scene, motions[k], {.accuracy = 1e-10}, 0);
    CHECK(l.energy_residual < 1e-6);
    CHECK(l.peak == Approx(one.peak).epsilon(1e-6));
  }
  CHECK(met > 15);  // the stops have a say
  CHECK(off <= 2);
}

TEST_CASE("stops: gradients through them are those of difference quotients") {
  constexpr SimulateOptions kTight{.accuracy = 1e-13, .rest = SimulateOptions::Rest::kIgnore};
  for (const double damping : {0.0, 1.5}) {
    BodyScene scene = stopped_hopper(damping);
    BodyMotion motion = motions_of(scene, 3, 5)[2];
    const std::vector<BodyParameter> all = parameters_of(scene, motion);
    const BodyGradients g = gradients(scene, motion, all, kTight, 2);
    REQUIRE(!g.peaks.empty());
    CHECK(g.peaks[0].value == Approx(peak_acceleration(scene, motion, kTight).peak).epsilon(1e-8));
    const double size = g.peaks[0].d.head(13).cwiseAbs().maxCoeff();
    int right = 0;
    for (std::size_t k : {std::size_t(1), std::size_t(2), std::size_t(11), std::size_t(12)}) {
      double& x = number(scene, motion, all[k]);
      const double x0 = x;
      const Quotient q = central(1, 1e-7, [&](double by) {
        x = x0 + by;
        return peak_acceleration(scene, motion, kTight).peak;
      });
      x = x0;
      INFO(name(all[k], scene.robot) << ": " << g.peaks[0].d[Eigen::Index(k)] << ", quotient " << q.value);
      if (q.error > 1e-6 * size) continue;
      CHECK(std::abs(q.value - g.peaks[0].d[Eigen::Index(k)]) < 1e-5 * size);
      ++right;
    }
    CHECK(right >= 2);
  }
}

TEST_CASE("stops: they are read, kept as numbers of a design, and refused with their place") {
  const test::Folder f;
  const std::string robot = test::read(UKEMI_DATASETS "/robots/hopper.toml"),
                    scene = test::replaced(test::read(UKEMI_DATASETS "/scenes/hopper.toml"), "robot = \"../robots/",
                                           "robot = \"");
  const auto read = [&](const std::string& more) {
    (void)f.write("hopper.toml", robot + more);
    return read_body_scene(f.write("scene.toml", scene));
  };
  BodyScene s = read(
      "[stop.knee]\nphi_deg = [-140, -5]\nstiffness = 500\ndamping = 2\n[stop.rail]\ns = [0.1, 100]\n"
      "stiffness = 1e4\n");
  REQUIRE(s.robot.stops.size() == 2);
  CHECK(s.robot.stops[0].joint == -1);
  CHECK(s.robot.stops[0].damping == 0);
  CHECK(std::isinf(s.robot.stops[0].ends[1]));
  CHECK(design_number(s, "stop.knee.high_deg") == Approx(-5));
  set_design_number(s, "stop.rail.low", 0.15);
  CHECK(s.robot.stops[0].ends[0] == 0.15);
  CHECK_THROWS_WITH(set_design_number(s, "stop.knee.low_deg", 10), Catch::Contains("the lower first"));
  const auto refused = [&](const std::string& more, const std::string& rule) {
    INFO(more);
    CHECK_THROWS_WITH(read(more), Catch::Contains("hopper.toml:") && Catch::Contains(rule));
  };
  refused("[stop.kne]\nphi_deg = [-1, 0]\nstiffness = 1\n", "kne");
  refused("[stop.knee]\nstiffness = 1\n", "phi_deg = [LOW, HIGH] is needed");
  refused("[stop.knee]\nphi_deg = [0, -1]\nstiffness = 1\n", "the lower first");
  refused("[stop.knee]\nphi_deg = [-1, 0]\nstiffness = 0\n", "above 0");
  refused("[stop.knee]\nphi_deg = [-1, 0]\nstiffness = 1\ndamping = -1\n", "at least 0");
  refused("[stop.rail]\nphi_deg = [-1, 0]\nstiffness = 1\n", "'s' is missing");
  std::string crowded;
  for (int k = 0; k < 6; ++k)
    crowded += fmt::format("[[robot.contact]]\nname = \"c{}\"\nlink = \"shank\"\nat = [0.1, 0]\n", k);
  for (const char* at : {"hip", "knee"})
    crowded += fmt::format("[stop.{}]\nphi_deg = [-170, 170]\nstiffness = 1\n", at);
  refused(crowded, "13 contacts and ends of stops: at most 12 are needed");
  for (int k = 0; k < 12; ++k) s.robot.contacts.push_back(s.robot.contacts[0]);
  s.robot.contacts.resize(kMaxContacts);
  CHECK_THROWS_WITH(s.robot.validate(), Catch::Contains("contacts and ends of stops"));
}

TEST_CASE("stops: a rig of one link as a robot tells its stop's stiffness, damping and angle where it hits it",
          "[driven]") {
  // J ddphi = K_P (ref - phi) - K_D dphi - max(0, K delta + C ddelta) beyond the stop, by Heun's method.
  constexpr double kP = 20, kD = 0.6, kArmature = 0.01, kStiffness = 350, kDamping = 1.4, kHigh = 22 * kDegree,
                   kNoise = 2e-4, kRow = 2e-3, kStep = 5e-6;
  const auto acceleration = [](double phi, double dphi, double ref) {
    const double deep = phi - kHigh, push = deep > 0 ? std::max(0.0, kStiffness * deep + kDamping * dphi) : 0;
    return (kP * (ref - phi) - kD * dphi - push) / (kInertia + kArmature);
  };
  Random random(20261127, 5);
  double phi = 0, dphi = 0;
  std::string log = "t,phi_arm,phi_ref_arm\n";
  int beyond = 0;
  for (int k = 0; k < 700; ++k) {
    const double ref = 0.5 * std::sin(9 * kRow * k) + 0.2 * std::sin(23 * kRow * k);
    log += fmt::format("{},{:.9g},{:.17g}\n", kRow * k, phi + kNoise * random.normal(), ref);
    beyond += phi > kHigh;
    for (int i = 0; i < int(kRow / kStep + 0.5); ++i) {
      const double a = acceleration(phi, dphi, ref), p = phi + kStep * dphi, v = dphi + kStep * a;
      phi += 0.5 * kStep * (dphi + v), dphi += 0.5 * kStep * (a + acceleration(p, v, ref));
    }
  }
  REQUIRE(beyond > 50);
  const test::Folder f;
  const tools::DrivenRobot robot = tools::read_driven_robot(f.write(
      "robot.toml", fmt::format("[robot]\ngravity = 0\nbase = \"pinned\"\n[[robot.link]]\nname = \"arm\"\njoint = "
                                "\"arm\"\nmass = 1.5\ninertia_com = 0.02\ncom = [0.2, 0]\n[drive.arm]\nkind = "
                                "\"geared\"\nk_p = {}\nk_d = {}\ni_motor = {}\n[stop.arm]\nphi_deg = [-360, "
                                "25]\nstiffness = 200\ndamping = 0.5\n",
                                kP, kD, kArmature)));
  const auto trials = tools::read_robot_trials(f.write("log.csv", log), robot.scene.robot, {.columns = ""});
  tools::RobotFitOptions options;
  options.terms = tools::robot_terms(robot, trials), options.threads = 2;
  options.terms.free = {"stop.arm.stiffness", "stop.arm.damping", "stop.arm.high_deg"};
  const tools::RobotFit fit = tools::fit_robot(robot, trials, options);
  REQUIRE(fit.converged);
  for (const auto& [name, truth, part] : {std::tuple("stop.arm.stiffness", kStiffness, 0.02),
                                          {"stop.arm.damping", kDamping, 0.05},
                                          {"stop.arm.high_deg", kHigh / kDegree, 0.002}}) {
    const identify::Estimate* e = identify::find_constant(fit, name);
    REQUIRE((e && e->std));
    INFO(name << " " << e->value << " +- " << *e->std << ", true " << truth);
    CHECK(std::abs(e->value - truth) < 4 * *e->std);
    CHECK(*e->std < part * truth);
  }
  CHECK(fit.rms[kAngle] == Approx(kNoise).epsilon(0.1));
}
