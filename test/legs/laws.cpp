// Robots of any joints: what does not depend on how the equations were derived, and closed forms of the contact laws.
#include <catch2/catch.hpp>
#include <cmath>

#include "common/degrees.hpp"
#include "common/integrate/hybrid.hpp"
#include "common/integrate/tableaus.hpp"
#include "common/random.hpp"
#include "landing/body/body_run.hpp"
#include "landing/body/body_system.hpp"
#include "test/legs/robots.hpp"
#include "test/legs/trees.hpp"
#include "test/property/two_link.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using legs::random_state, legs::random_tree, legs::State, legs::System;

namespace {

constexpr std::uint64_t kSeed = 20261124;

State after(const System& s, State y, double seconds) {
  integrate::Integrator<integrate::DormandPrince853, System> driver(s, 0, y, {.accuracy = 1e-12});
  for (integrate::Outcome o{integrate::Status::kStepped}; o.status == integrate::Status::kStepped;)
    o = driver.step(seconds);
  REQUIRE(driver.time() == seconds);
  return driver.state();
}

/// A block that cannot turn: one link on a rail along x, or free with a contact below its centre of mass.
BodyScene block(const ContactLaw& law, double slope = 0) {
  BodyScene out;
  out.robot.links.push_back({"block", -1, {}, 2.0, 1e3, {}});  // too heavy to turn
  out.robot.contacts.push_back({"foot", 0, {}, law, {}});
  out.slope = slope, out.floor = true;
  return out;
}
constexpr double kGravity = 9.81;
/// Followed to t_end whatever happens.
BodyLanding land(const BodyScene& scene, double accuracy) {
  return simulate(scene, {}, {.accuracy = accuracy, .rest = SimulateOptions::Rest::kIgnore});
}

}  // namespace

TEST_CASE("legs: the paper's two links are an instance: accelerations within 1e-12, in the air and on the floor") {
  Scene scene;
  scene.robot = {{0.806, 0.7}, {6.09e-3, 5e-3}, 0.3, kGravity};
  scene.contacts = {true, true, true};
  scene.floor = Floor<double>{6880, 123, 0.19};
  const SeaParameters<double> sea{50, 1, 65, 1.6, 0.085, 20};
  Robot robot;
  robot.links = {{"thigh", -1, {}, 0.806, 6.09e-3, {0.15, 0}}, {"shank", 0, {0.3, 0}, 0.7, 5e-3, {0.15, 0}}};
  robot.joints = {{.name = "knee", .child = 1, .sea = sea}};
  const ContactLaw law{.stiffness = 6880, .damping_normal = 123, .damping_tangential = 0.19};
  robot.contacts = {{"hip", 0, {}, law, {}}, {"knee", 0, {0.3, 0}, law, {}}, {"foot", 1, {0.3, 0}, law, {}}};
  robot.peak = {0.15, 0};
  System leg(robot, 0);
  leg.piece[0] = constant_reference(-0.8);
  const test::TwoLinkDynamics<double> two(scene.robot);
  Random r(kSeed, 1);
  for (int n = 0; n < 1000; ++n) {
    State x = State::Zero();
    for (const int k : {int(System::kX), int(System::kY), int(System::kVx), int(System::kVy), int(System::kTheta),
                        int(System::kTheta) + 1, int(System::kOmega), int(System::kOmega) + 1, int(System::kOmegaM)})
      x[k] = r.uniform(-1, 1);
    x[System::kPhiM] = r.uniform(-0.1, 0.1);
    const double theta0 = x[System::kTheta], theta1 = x[System::kTheta + 1], omega0 = x[System::kOmega],
                 omega1 = x[System::kOmega + 1];
    const test::Pose<double> pose{
        x[System::kX],    x[System::kY],    x[System::kVx],   x[System::kVy], std::sin(theta0),
        std::cos(theta0), std::sin(theta1), std::cos(theta1), omega0,         omega1};
    test::Loads<double> load;
    for (int j = 0; j < kPoints; ++j) {
      const bool touching = r.uniform() < 0.5;
      leg.contact[std::size_t(j)] = {.touching = touching, .below = touching, .floor = touching};
      if (touching)
        load.add(
            two, pose, j, -scene.floor->damping_tangential * velocity_x(two, pose, j),
            -scene.floor->stiffness * height(two, pose, j) - scene.floor->damping_normal * velocity_y(two, pose, j));
    }
    const double phi = theta1 - theta0, dphi = omega1 - omega0, phi_m = x[System::kPhiM], dphi_m = x[System::kOmegaM];
    const double tau = sea.k_sea * (phi_m - phi) + sea.c_sea * (dphi_m - dphi);  // Eq. 2, 4
    const test::Accelerations<double> acc = solve(two, pose, tau, load);
    const double motor = (sea.k_p * (-0.8 - phi) - sea.k_d * dphi - tau) / sea.i_motor;  // Eq. 2, 3
    const State dx = leg.derivative(0, x);
    const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-12 * (1 + std::abs(a)); };
    CHECK(near(acc.x, dx[System::kVx]));
    CHECK(near(acc.y, dx[System::kVy]));
    CHECK(near(acc.theta0, dx[System::kOmega]));
    CHECK(near(acc.theta1, dx[System::kOmega + 1]));
    CHECK(near(motor, dx[System::kOmegaM]));
    CHECK(near(thigh_acceleration(two, pose, acc).squaredNorm(), leg.peak_square(x, dx)));
  }
}

TEST_CASE("legs: random trees keep their energy, a free one its momentum, and falls as a stone does") {
  for (const Base base : {Base::kFree, Base::kRail, Base::kPinned})
    for (int n = 0; n < 20; ++n) {
      Random r(kSeed, std::uint64_t(100 * int(base) + n));
      const Robot robot = random_tree(r, kMaxLinks, base);
      const System s(robot, base == Base::kFree ? 0.1 : 0);
      const State y = random_state(r, robot), end = after(s, y, 0.5);
      INFO("base " << int(base) << ", tree " << n << " of " << robot.links.size() << " links");
      CHECK(std::abs(s.link_energy(end) - s.link_energy(y)) < 1e-8 * (1 + kinetic_energy(s.body, s.pose(y))));
      if (base != Base::kFree) continue;
      CHECK(std::abs(end[System::kVy] - y[System::kVy] - 0.5 * s.gravity[1]) < 1e-11);
      const auto spin = [&](const State& at) {
        const auto p = s.pose(at);
        std::array<double, MassMatrix<double, kAny>::kMax> ignored{};
        const MassMatrix<double, kAny> m(s.body, p, ignored);
        double out = 0;
        for (int j = 0; j < s.body.bodies; ++j)
          for (int k = 0; k < s.body.bodies; ++k) out += (k <= j ? m.m[j][k] : m.m[k][j]) * p.omega[k];
        return out;
      };
      CHECK(std::abs(spin(end) - spin(y)) < 1e-9 * (1 + std::abs(spin(y))));
    }
}

TEST_CASE("legs: a tree in a mirror moves as its image does") {
  for (const Base base : {Base::kFree, Base::kRail, Base::kPinned})
    for (int n = 0; n < 100; ++n) {
      Random r(kSeed, std::uint64_t(1000 + 100 * int(base) + n));
      const Robot robot = random_tree(r, kMaxLinks, base);
      Robot image = robot;
      for (Link& l : image.links) l.at.across *= -1, l.com.across *= -1;
      image.peak.across *= -1;
      const State y = random_state(r, robot);
      State z = y;
      for (int i = 0; i < kMaxLinks; ++i) z[System::kTheta + i] *= -1, z[System::kOmega + i] *= -1;
      if (base == Base::kFree) z[System::kX] *= -1, z[System::kVx] *= -1;
      System one(robot, 0), other(image, 0);
      const State dy = one.derivative(0, y), dz = other.derivative(0, z);
      for (int i = 0; i < int(robot.links.size()); ++i)
        CHECK(dz[System::kOmega + i] ==
              Approx(-dy[System::kOmega + i]).epsilon(1e-11).margin(1e-11 * dy.cwiseAbs().maxCoeff()));
      if (base == Base::kRail) CHECK(dz[System::kVx] == Approx(dy[System::kVx]).epsilon(1e-11));  // it is upright
    }
}

TEST_CASE("legs: a locked joint makes one link of two") {
  Random r(kSeed, 7);
  for (int n = 0; n < 50; ++n) {
    Robot two = random_tree(r, 2, Base::kFree);
    two.joints[0].kind = DriveKind::kLocked, two.joints[0].phi = r.uniform(-2, 2);
    // By hand: both centres of mass in the frame of the first link.
    const Link &a = two.links[0], &b = two.links[1];
    const double c = std::cos(two.joints[0].phi), s = std::sin(two.joints[0].phi);
    const Place of_b{b.at.along + b.com.along * c - b.com.across * s, b.at.across + b.com.along * s + b.com.across * c};
    const double mass = a.mass + b.mass;
    const Place com{(a.mass * a.com.along + b.mass * of_b.along) / mass,
                    (a.mass * a.com.across + b.mass * of_b.across) / mass};
    const double apart = std::pow(a.com.along - of_b.along, 2) + std::pow(a.com.across - of_b.across, 2);
    const double inertia = a.inertia_com + b.inertia_com + a.mass * b.mass / mass * apart;
    const Body<double, kAny> body = body_of<kAny>(two);
    CHECK(body.bodies == 1);
    CHECK(body.n[0][0] == Approx(inertia).epsilon(1e-12));
    CHECK(body.first.a[0] == Approx(-com.along).margin(1e-14));
    CHECK(body.first.b[0] == Approx(-com.across).margin(1e-14));
  }
}

TEST_CASE("legs: a block on a slope stays where friction holds it, and slides by its law where it does not") {
  const double slope = 20 * kDegree;
  for (const double mu : {0.5, 0.3}) {  // tan 20 deg = 0.364
    BodyScene scene = block({.stiffness = 2e4,
                             .damping_normal = 200,
                             .damping_tangential = 100,
                             .stiffness_tangential = 2e4,
                             .friction = mu},
                            slope);
    const auto place = [&](double t) {
      scene.t_end = t;
      return land(scene, 1e-11).base[0];
    };
    const double early = place(4), late = place(14);
    if (mu > std::tan(slope)) {
      CHECK(std::abs(late - early) < 1e-9);
    } else {
      const double down = -kGravity * (std::sin(slope) - mu * std::cos(slope));
      const double middle = place(9);
      CHECK(late - 2 * middle + early == Approx(25 * down).epsilon(1e-6));
    }
  }
}

TEST_CASE("legs: a sliding block stops after v^2 / (2 mu g)") {
  BodyScene scene = block({.stiffness = 1e5,
                           .damping_normal = 1e3,
                           .damping_tangential = 200,
                           .stiffness_tangential = 1e5,
                           .friction = 0.4});
  const double weight = 2 * kGravity, v = 1.5;
  scene.robot.contacts[0].at = {weight / 1e5, 0};  // it hangs so deep that the floor carries it
  scene.drop.forward_speed = v, scene.t_end = 2;
  scene.drop.height = 0;
  const BodyLanding l = land(scene, 1e-11);
  // Released on the surface it sinks first: the work of friction is mu times the impulse's path, to a part in 1e3.
  CHECK(l.base[0] == Approx(v * v / (2 * 0.4 * kGravity)).epsilon(2e-3));
}

TEST_CASE("legs: a block on a steep rail slides by the rail's dry friction, on a flat one it stays") {
  for (const double degrees : {60.0, 10.0}) {
    BodyScene scene = block({});
    scene.robot.base = Base::kRail, scene.robot.rail_direction = degrees * kDegree;
    scene.robot.rail_friction = 1.5, scene.robot.rail_load_friction = 0.2;
    scene.robot.contacts.clear(), scene.floor = false;
    const auto travel = [&](double t) {
      scene.t_end = t;
      return land(scene, 1e-11).base[0];
    };
    const double early = travel(0.4), middle = travel(0.6), late = travel(0.8), pull = std::sin(degrees * kDegree),
                 most = 1.5 / 2 / kGravity + 0.2 * std::cos(degrees * kDegree);
    if (pull > most)
      CHECK(late - 2 * middle + early == Approx(-0.04 * kGravity * (pull - most)).epsilon(1e-4));
    else
      CHECK(late == 0);
  }
}

TEST_CASE("legs: a rail's friction grows with the force across it, which it changes in turn") {
  Random r(kSeed, 11);
  for (int n = 0; n < 100; ++n) {
    Robot robot = random_tree(r, 4, Base::kRail);
    robot.rail_direction = r.uniform(-3, 3), robot.rail_viscous = r.uniform(0, 3);
    robot.rail_friction = r.uniform(0, 5), robot.rail_load_friction = r.uniform(0, 0.3);
    System s(robot, 0);
    const State y = random_state(r, robot);
    s.rail_slip = y[System::kVx] > 0 ? 1 : -1;
    const State dy = s.derivative(0, y);
    const auto momentum = [&](double h) -> Eigen::Vector2d {
      const State at = y + h * dy;
      auto p = s.pose(at);
      const Eigen::Vector2d own = s.body.mass * Eigen::Vector2d(p.vx, p.vy);
      p.vx = p.vy = 0;
      return own + velocity(s.body.moment, p, s.body.bodies);
    };
    const double h = 1e-6;
    const Eigen::Vector2d force =
        (momentum(h) - momentum(-h)) / (2 * h) + Eigen::Vector2d(0, s.body.mass * robot.gravity);
    const Eigen::Vector2d e(std::cos(robot.rail_direction), std::sin(robot.rail_direction));
    const double v = y[System::kVx], across = e[0] * force[1] - e[1] * force[0],
                 dry = robot.rail_friction + robot.rail_load_friction * std::abs(across);
    CHECK(force.dot(e) == Approx(-robot.rail_viscous * v - dry * s.rail_slip).epsilon(1e-6).margin(1e-6));
  }
}

TEST_CASE("legs: a ball under Hunt and Crossley's law bounces with its restitution") {
  // e = v_out / v_in solves  c (v_in + v_out) = log((1 + c v_in) / (1 - c v_out)),  whatever K, p and the mass.
  const double c = 0.3, height = 0.5, v_in = std::sqrt(2 * kGravity * height);
  BodyScene scene = block({.stiffness = 1e14, .hunt_crossley = true, .exponent = 1.5, .dissipation = c});
  scene.drop.height = height, scene.t_end = std::sqrt(2 * height / kGravity) + 0.02;
  const BodyLanding l = land(scene, 1e-12);
  double low = 0, high = v_in;
  for (int i = 0; i < 200; ++i) {
    const double m = 0.5 * (low + high);
    (c * (v_in + m) < std::log((1 + c * v_in) / (1 - c * m)) ? high : low) = m;
  }
  const double flown = *scene.t_end - l.touches.back().t_liftoff;
  CHECK(l.speed[1] + kGravity * flown == Approx(low).epsilon(1e-4));  // but for gravity while it touches
}

TEST_CASE("legs: a stuck foot rings at the frequency of its spring") {
  BodyScene scene = block({.stiffness = 1e5,
                           .damping_normal = 1e3,
                           .damping_tangential = 0.1,
                           .stiffness_tangential = 800,
                           .friction = 10});
  scene.drop.forward_speed = 1e-3, scene.t_end = 3;
  const auto at = [&](double t) {
    scene.t_end = t;
    return land(scene, 1e-11).base[0];
  };
  // x'' + w^2 (x - x0) = 0 but for the damper, 2 zeta w = 0.05 1/s: three places a quarter of a period apart.
  const double w = std::sqrt(800 / 2.0), quarter = std::numbers::pi / (2 * w);
  const double a = at(2), b = at(2 + quarter), d = at(2 + 2 * quarter), e = at(2 + 4 * quarter);
  CHECK(a - e == Approx(0).margin(0.02 * (std::abs(a) + std::abs(b) + std::abs(d))));
  CHECK(a + d == Approx(b + at(2 + 3 * quarter)).margin(1e-6));
}

TEST_CASE("legs: a pad that bottoms out goes as deep as its energy says, one that does not rests on its spring") {
  const double mass = 2, thick = 0.02, floor = 2e4;
  for (const double pad : {500.0, 3000.0}) {
    BodyScene scene = block({.stiffness = floor});
    scene.robot.contacts[0].pad = Pad{thick, pad, 0};
    scene.drop.height = 0.3;
    // Without damping: m g (height + depth) = K_p depth^2 / 2 + K (depth - d)^2 / 2, the depth from the pad's surface.
    const double a = (pad + floor) / 2, b = -floor * thick - mass * kGravity,
                 c = floor * thick * thick / 2 - mass * kGravity * scene.drop.height;
    const double depth = (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
    REQUIRE(depth > thick);
    scene.t_end = 0.5;
    CHECK(land(scene, 1e-11).peak == Approx((pad * depth + floor * (depth - thick)) / mass - kGravity).epsilon(1e-8));
  }
  // Stiff enough for the weight, and damped: it comes to rest on the pad alone, d - m g / K_p over the floor.
  BodyScene scene = block({.stiffness = floor, .damping_normal = 100});
  scene.robot.contacts[0].pad = Pad{thick, 3000, 60};
  scene.drop.height = 0.05, scene.t_end = 5;
  CHECK(land(scene, 1e-11).base[1] == Approx(thick - mass * kGravity / 3000).margin(1e-9));
}

TEST_CASE("legs: the energy of what falls, slides and bounces only falls") {
  for (const double slope : {0.0, 15 * kDegree, -15 * kDegree}) {
    const double stiffness = 2e4;
    BodyScene scene =
        block({.stiffness = stiffness, .damping_normal = 40, .damping_tangential = 50, .friction = 0.4}, slope);
    scene.drop.height = 0.2, scene.drop.forward_speed = 1.5, scene.t_end = 1.5;
    const BodyLanding l = simulate(scene, held_posture(scene), {.accuracy = 1e-11}, 2000);
    REQUIRE(l.touches.size() > 2);
    double before = std::numeric_limits<double>::infinity(), first = 0, last = 0;
    for (const BodySample& row : l.trajectory) {
      // The floor's spring holds some while the floor pushes; where it lets go what is left of it is lost.
      const double over = row.contact_y[0] * std::cos(slope) - row.contact_x[0] * std::sin(slope);
      const bool pushes = std::hypot(row.force_x[0], row.force_y[0]) > 0;
      const double energy = row.energy + (pushes && over < 0 ? 0.5 * stiffness * over * over : 0);
      INFO(slope << ", " << row.t << " s");
      CHECK(energy <= before + 1e-8);
      if (!std::isfinite(before)) first = energy;
      before = last = energy;
    }
    CHECK(last < first - 1);  // much of it is gone
  }
}

TEST_CASE("legs: landings under Hunt and Crossley's law end, at every accuracy") {
  BodyScene scene = legs::shipped("hopper");  // its slider meets the floor straight down: friction begins at a tie
  for (ContactPoint& c : scene.robot.contacts) c.law.hunt_crossley = true, c.law.dissipation = 0.3;
  Random random(20261125);
  for (int n = 0; n < 60; ++n) {
    BodyMotion m = held_posture(scene);
    for (std::size_t i = 0; i < m.size(); ++i) {
      const auto [low, high] = scene.search[i].phi;
      m[i].phi_i = random.uniform(low, high), m[i].phi_f = random.uniform(low, high);
      m[i].duration = random.uniform(0.1, 0.5);
    }
    for (const double accuracy : {1e-5, 1e-6, 1e-7, 1e-9}) {
      const BodyLanding l = peak_acceleration(scene, m, {.accuracy = accuracy});
      INFO(n << ", " << accuracy << ", until " << l.t_end);
      CHECK_FALSE(no_landing(l.end));
      CHECK(l.work.steps < 5000);
    }
  }
}
