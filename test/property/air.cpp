// The move in the air and what comes before a landing: nothing but gravity acts from outside.
#include <catch2/catch.hpp>

#include "common/random.hpp"
#include "landing/judge/limit.hpp"
#include "landing/lanes/batch.hpp"
#include "landing/model/release.hpp"
#include "landing/run/simulate.hpp"
#include "test/paper.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace test;

namespace {

constexpr std::uint64_t kSeed = 20261123;

Motion draw(std::uint64_t i) {
  Random r(kSeed, i);
  Motion m{r.uniform(-1.5, 0), r.uniform(-1.5, 0), r.uniform(0.1, 0.4)};
  m.reposition = Reposition{r.uniform(-1.5, 0), r.uniform(-3, 3), r.uniform(0, 0.1), r.uniform(0.12, 0.25)};
  return m;
}

/// Angular momentum about the centre of mass, from its definition; and the centre of mass.
struct Momentum {
  double angular;
  Eigen::Vector2d centre, speed;
};
Momentum momentum(const TwoLink<double>& robot, const Sample& s) {
  const double half = 0.5 * robot.link_length, a = s.phi0, b = s.phi0 + s.phi1, wa = s.dphi0, wb = s.dphi0 + s.dphi1;
  const Eigen::Vector2d r0(s.x0, s.y0), v0(s.dx0, s.dy0), to_knee(half * std::sin(a), -half * std::cos(a)),
      to_shank(half * std::sin(b), -half * std::cos(b)), knee_speed(half * wa * std::cos(a), half * wa * std::sin(a)),
      shank_speed(half * wb * std::cos(b), half * wb * std::sin(b));
  const Eigen::Vector2d r1 = r0 + to_knee + to_shank, v1 = v0 + knee_speed + shank_speed;
  const double m0 = robot.mass[0], m1 = robot.mass[1], whole = m0 + m1;
  const Eigen::Vector2d centre = (m0 * r0 + m1 * r1) / whole, speed = (m0 * v0 + m1 * v1) / whole;
  const auto moment = [&](double m, const Eigen::Vector2d& r, const Eigen::Vector2d& v) {
    const Eigen::Vector2d d = r - centre, w = v - speed;
    return m * (d.x() * w.y() - d.y() * w.x());
  };
  return {moment(m0, r0, v0) + moment(m1, r1, v1) + robot.inertia_com[0] * wa + robot.inertia_com[1] * wb, centre,
          speed};
}

}  // namespace

TEST_CASE("air: the centre of mass falls freely and the angular momentum stays, while the leg moves") {
  for (std::uint64_t i = 0; i < 12; ++i) {
    Scene scene = paper();
    Random r(kSeed, 100 + i);
    scene.drop.pitch_rate = i % 2 ? r.uniform(-2, 2) : 0;
    scene.drop.vertical_speed = i % 3 ? 0 : r.uniform(-1, 0.5);
    const Landing l = simulate(scene, table2_sea(), draw(i), {.accuracy = 1e-13}, 1000);
    REQUIRE(!l.touches.empty());
    INFO("seed " << kSeed << ", draw " << i);
    const Momentum first = momentum(scene.robot, l.trajectory[0]);
    double turned = 0;
    for (const Sample& s : l.trajectory) {
      if (s.t > l.touches[0].t_touchdown) break;
      const Momentum now = momentum(scene.robot, s);
      const Eigen::Vector2d fallen(0, -0.5 * scene.robot.gravity * s.t * s.t);
      CHECK(std::abs(now.angular - first.angular) < 1e-10);
      CHECK((now.centre - first.centre - first.speed * s.t - fallen).norm() < 1e-10);
      turned = std::max(turned, std::abs(s.phi0 - l.trajectory[0].phi0));
    }
    CHECK(turned > 1e-3);  // the thigh turns as the shank moves
  }
}

TEST_CASE("air: a move over no distance is no move, in the scalar path and in lanes") {
  const Scene scene = paper();
  const SeaParameters<double> sea = table2_sea();
  for (std::uint64_t i = 0; i < 10; ++i) {
    Motion still = draw(i), moved = still;
    still.reposition.reset();
    moved.reposition->phi = moved.phi_i, moved.reposition->rate = 0;
    INFO("seed " << kSeed << ", draw " << i);
    const double closed = peak_acceleration(scene, sea, still, {.accuracy = 1e-12}).peak;
    CHECK(peak_acceleration(scene, sea, moved, {.accuracy = 1e-12}).peak == Approx(closed).epsilon(1e-8));
    const BatchCase c{&scene, &sea, moved};
    LandingPeak lanes;
    batch_peaks({&c, 1}, {&lanes, 1}, {.accuracy = 1e-7});
    CHECK(lanes.peak == Approx(closed).epsilon(1e-4));
  }
}

TEST_CASE("air: a floor that comes first is followed truly, the reference never jumps") {
  Scene scene = paper();
  Motion m{-0.4, -1.2, 0.2};
  m.reposition = Reposition{-1.1, 0, 0.2, 0.6};  // touchdown at some 0.29 s
  for (const double delay : {0.0, 0.01}) {
    scene.detection_delay = delay;
    const Landing l = simulate(scene, table2_sea(), m, {.accuracy = 1e-11}, 20'000);
    REQUIRE(!l.touches.empty());
    const double start = l.touches[0].t_touchdown + delay;
    double before = l.trajectory[0].phi_ref, at_start = 0;
    for (const Sample& s : l.trajectory) {
      CHECK(std::abs(s.phi_ref - before) < 1e-3);
      before = s.phi_ref;
      if (s.t <= start) at_start = s.phi_ref;
      if (s.t > start + m.duration) CHECK(s.phi_ref == Approx(m.phi_f));
    }
    CHECK(at_start > -1.1 + 0.01);
    CHECK(at_start < m.phi_i - 0.01);
  }
}

TEST_CASE("air: landing gains act from the first touchdown on, gains of 1 are none, a late start is late") {
  const Scene scene = paper();
  const SeaParameters<double> sea = table2_sea();
  Motion m{-0.6, -1.1, 0.3};
  const double plain = peak_acceleration(scene, sea, m).peak;
  m.gain_p = 0.5, m.gain_d = 2;
  const double changed = peak_acceleration(scene, sea, m).peak;
  CHECK(changed != Approx(plain).epsilon(1e-3));
  // Before the touchdown nothing moves here, so an actuator with these gains lands the same.
  SeaParameters<double> other = sea;
  other.k_p *= 0.5, other.k_d *= 2;
  CHECK(peak_acceleration(scene, other, {-0.6, -1.1, 0.3}).peak == Approx(changed).epsilon(1e-9));
  Scene late = scene;
  late.detection_delay = 0.02;
  const Landing a = simulate(scene, sea, m, {}, 1000), b = simulate(late, sea, m, {}, 1000);
  const double touchdown = a.touches[0].t_touchdown;
  for (const Sample& s : b.trajectory)
    if (s.t < touchdown + 0.02) CHECK(s.phi_ref == m.phi_i);
  CHECK(a.peak != Approx(b.peak).epsilon(1e-6));
}

TEST_CASE("air: no motion without a move in the air is below the limit of the first touchdown") {
  for (const char* name : {"paper", "paper_soft", "tilted"}) {
    const Scene scene = read_scene(std::string(UKEMI_DATASETS "/scenes/") + name + ".toml");
    const TouchdownLimit limit = touchdown_limit(scene, table2_sea());
    REQUIRE(limit.found);
    CHECK(limit.first_contact >= limit.jump);
    std::vector<SeaParameters<double>> sea{table2_sea()};
    std::vector<BatchCase> cases;
    for (std::uint64_t i = 0; i < 2'000; ++i) {
      Motion m = draw(i);
      m.reposition.reset();
      Random r(kSeed, 5'000 + i);
      for (double& b : m.bumps) b = r.uniform(-2, 2);
      cases.push_back({&scene, &sea[0], m});
    }
    std::vector<LandingPeak> peaks(cases.size());
    batch_peaks(cases, peaks, {});
    for (const LandingPeak& p : peaks) CHECK(p.peak >= limit.jump * (1 - 1e-4));
    if (std::string(name) != "paper") continue;
    CHECK(limit.jump == Approx(89.8).margin(0.1));  // near -50 deg
    CHECK(limit.jump_phi == Approx(-50 * 0.01745).margin(0.05));
    CHECK(limit.first_contact == Approx(104.5).margin(1));  // near -60 deg
  }
}
