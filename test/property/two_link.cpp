// The reduced form of Eq. 1 (two_link.hpp) held against a generic H(q) ddq + c + g = S tau + J^T F from body Jacobians;
// landings of the paper's robot held against conserved quantities of flight, the power balance of contacts, and the
// mirror.
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <numbers>

#include "common/integrate/hybrid.hpp"
#include "common/integrate/tableaus.hpp"
#include "common/random.hpp"
#include "landing/body/body_system.hpp"
#include "landing/body/by_links.hpp"
#include "landing/run/simulate.hpp"
#include "test/paper.hpp"
#include "test/property/two_link.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace test;
using Catch::Matchers::WithinRel;

namespace {

constexpr std::uint64_t kSeed = 20240601;
using Vec4 = Eigen::Vector4d;
using Mat4 = Eigen::Matrix4d;
using Jacobian = Eigen::Matrix<double, 2, 4>;

TwoLink<double> random_robot(Random& r) {
  return {{r.uniform(0.2, 3), r.uniform(0.2, 3)},
          {r.uniform(1e-3, 0.05), r.uniform(1e-3, 0.05)},
          r.uniform(0.1, 1),
          r.uniform(0, 20)};
}
Motion random_motion(Random& r, const SearchRange& s) {
  return {r.uniform(s.phi[0], s.phi[1]), r.uniform(s.phi[0], s.phi[1]), r.uniform(s.duration[0], s.duration[1])};
}

// --- Eq. 1 built generically, q = [x_0 y_0 phi_0 phi_1], from the geometry alone
// -----------------------------------------

/// A point on the robot: r_0 + b0 u(phi_0) + b1 u(phi_0 + phi_1), its Jacobian, and that Jacobian's time derivative.
struct Station {
  Eigen::Vector2d position;
  Jacobian jacobian, jacobian_rate;
};
Station station(const Vec4& q, const Vec4& dq, double b0, double b1) {
  const double t0 = q[2], t1 = q[2] + q[3], w0 = dq[2], w1 = dq[2] + dq[3];
  const Eigen::Vector2d u0(std::sin(t0), -std::cos(t0)), n0(std::cos(t0), std::sin(t0)),
      u1(std::sin(t1), -std::cos(t1)), n1(std::cos(t1), std::sin(t1));
  Station s;
  s.position = q.head<2>() + b0 * u0 + b1 * u1;
  s.jacobian << Eigen::Matrix2d::Identity(), b0 * n0 + b1 * n1, b1 * n1;
  s.jacobian_rate << Eigen::Matrix2d::Zero(), -b0 * w0 * u0 - b1 * w1 * u1, -b1 * w1 * u1;  // dn/dt = -w u
  return s;
}

struct Generic {
  std::array<Station, 2> com;            ///< centres of mass
  std::array<Station, kPoints> contact;  ///< hip, knee, foot
  Mat4 h;                                ///< H(q)
  Vec4 c, g;                             ///< c(q, dq), g(q)
};
Generic generic(const TwoLink<double>& robot, const Vec4& q, const Vec4& dq) {
  const double l = robot.link_length, a = 0.5 * l;
  Generic out{{station(q, dq, 0, 0), station(q, dq, a, a)},
              {station(q, dq, -a, 0), station(q, dq, a, 0), station(q, dq, a, l)},
              Mat4::Zero(),
              Vec4::Zero(),
              Vec4::Zero()};
  const std::array<Vec4, 2> spin{Vec4(0, 0, 1, 0), Vec4(0, 0, 1, 1)};  // w_i = spin_i . dq, constant
  for (std::size_t i = 0; i < 2; ++i) {
    const Station& s = out.com[i];
    out.h += robot.mass[i] * s.jacobian.transpose() * s.jacobian + robot.inertia_com[i] * spin[i] * spin[i].transpose();
    out.c += robot.mass[i] * s.jacobian.transpose() * (s.jacobian_rate * dq);
    out.g += robot.mass[i] * robot.gravity * s.jacobian.row(1).transpose();
  }
  return out;
}

/// The reduced state of the same configuration, from its definition: R is the mass-weighted mean of both centres.
Pose<double> reduced(const TwoLink<double>& robot, const Generic& g, const Vec4& q, const Vec4& dq) {
  const double m0 = robot.mass[0], m1 = robot.mass[1], m = m0 + m1, t0 = q[2], t1 = q[2] + q[3];
  const Eigen::Vector2d at = (m0 * g.com[0].position + m1 * g.com[1].position) / m,
                        rate = (m0 * g.com[0].jacobian * dq + m1 * g.com[1].jacobian * dq) / m;
  return {at.x(),       at.y(),       rate.x(),     rate.y(), std::sin(t0),
          std::cos(t0), std::sin(t1), std::cos(t1), dq[2],    dq[2] + dq[3]};
}

/// |a - b| against the larger of |b| and the sizes that cancel in it.
void check_close(double a, double b, double scale, double tolerance = 1e-12) {
  CHECK(std::abs(a - b) <= tolerance * std::max(std::abs(b), scale));
}

}  // namespace

TEST_CASE("two_link: the reduced form solves the generic equation of motion") {
  INFO("seed " << kSeed);
  for (std::uint64_t i = 0; i < 300; ++i) {
    INFO("draw " << i);
    Random r(kSeed, i);
    const TwoLink<double> robot = random_robot(r);
    const Vec4 q(r.uniform(-2, 2), r.uniform(-2, 2), r.uniform(-4, 4), r.uniform(-4, 4)),
        dq(r.uniform(-5, 5), r.uniform(-5, 5), r.uniform(-20, 20), r.uniform(-20, 20));
    const double tau = r.uniform(-50, 50);
    const Generic eq1 = generic(robot, q, dq);
    const TwoLinkDynamics<double> link(robot);
    const Pose<double> pose = reduced(robot, eq1, q, dq);

    Vec4 force = Vec4(0, 0, 0, tau);
    Loads<double> load;
    for (int j = 0; j < kPoints; ++j) {
      const Eigen::Vector2d f(r.uniform(-300, 300), r.uniform(-300, 300));
      force += eq1.contact[std::size_t(j)].jacobian.transpose() * f;
      load.add(link, pose, j, f.x(), f.y());
    }
    const Vec4 ddq = eq1.h.ldlt().solve(force - eq1.c - eq1.g);
    const Accelerations<double> acc = solve(link, pose, tau, load);
    const double angular = ddq.tail<2>().norm(),
                 linear = ddq.head<2>().norm() + robot.link_length * (angular + dq.tail<2>().squaredNorm());

    // Accelerations of the angles, and of the thigh's centre of mass.
    check_close(acc.theta0, ddq[2], angular);
    check_close(acc.theta1, ddq[2] + ddq[3], angular);
    const Vector2<double> thigh = thigh_acceleration(link, pose, acc);
    check_close(thigh.x(), ddq[0], linear);
    check_close(thigh.y(), ddq[1], linear);
    const Vector2<double> r0 = thigh_position(link, pose), v0 = thigh_velocity(link, pose);
    CHECK((r0 - q.head<2>()).norm() <= 1e-14 * (1 + q.norm()));
    CHECK((v0 - dq.head<2>()).norm() <= 1e-14 * (1 + dq.norm()));
    // Kinematics of the contact points, and the kinetic energy.
    for (int j = 0; j < kPoints; ++j) {
      INFO(kPointNames[std::size_t(j)]);
      const Station& s = eq1.contact[std::size_t(j)];
      const Eigen::Vector2d v = s.jacobian * dq;
      const double a_y = (s.jacobian * ddq + s.jacobian_rate * dq).y();
      check_close(place(link, pose, j), s.position.x(), 4);
      check_close(height(link, pose, j), s.position.y(), 4);
      check_close(velocity_x(link, pose, j), v.x(), dq.norm());
      check_close(velocity_y(link, pose, j), v.y(), dq.norm());
      check_close(acceleration_y(link, pose, acc, j), a_y, linear);
    }
    check_close(kinetic_energy(link, pose), 0.5 * dq.dot(eq1.h * dq), 0);
  }
}

TEST_CASE("two_link: both mass matrices are symmetric and positive definite") {
  INFO("seed " << kSeed);
  for (std::uint64_t i = 0; i < 300; ++i) {
    INFO("draw " << i);
    Random r(kSeed + 1, i);
    const TwoLink<double> robot = random_robot(r);
    const Vec4 q(0, 0, r.uniform(-4, 4),
                 i % 10 == 0 ? 0 : r.uniform(-4, 4));  // some straight, where the links couple most
    const Generic eq1 = generic(robot, q, Vec4::Zero());
    CHECK((eq1.h - eq1.h.transpose()).norm() <= 1e-15 * eq1.h.norm());
    CHECK(Eigen::LLT<Mat4>(eq1.h).info() == Eigen::Success);

    // The library's matrix, polarised from its kinetic energy: [A C; C B].
    const TwoLinkDynamics<double> link(robot);
    const auto rotation = [&](double w0, double w1) {
      Pose<double> p = reduced(robot, eq1, q, Vec4::Zero());
      p.omega0 = w0, p.omega1 = w1;
      return kinetic_energy(link, p);
    };
    const double a = 2 * rotation(1, 0), b = 2 * rotation(0, 1), c = rotation(1, 1) - rotation(1, 0) - rotation(0, 1);
    CHECK(a > 0);
    CHECK(a * b - c * c > 0);
    // R separates: the change of coordinates has unit determinant, so det H = m^2 det [A C; C B].
    CHECK_THAT(eq1.h.determinant(), WithinRel(link.total_mass * link.total_mass * (a * b - c * c), 1e-11));
  }
}

TEST_CASE("two_link: flight keeps energy and momentum") {
  // An undamped actuator that feeds back its own motor is conservative: K_p and both springs store, nothing dissipates.
  const SeaParameters<double> sea{
      .k_p = 50, .k_d = 0, .k_sea = 65, .c_sea = 0, .i_motor = 0.085, .k_sea_cubic = 40, .feedback = Feedback::kMotor};
  using System = BodySystem<kPair, false>;
  constexpr int kTheta0 = System::kTheta, kTheta1 = kTheta0 + 1, kOmega0 = System::kOmega, kOmega1 = kOmega0 + 1,
                kPhiM = System::kPhiM, kVx = System::kVx, kVy = System::kVy, kX = System::kX, kY = System::kY,
                kOmegaM = System::kOmegaM;
  INFO("seed " << kSeed);
  for (std::uint64_t i = 0; i < 20; ++i) {
    INFO("draw " << i);
    Random r(kSeed + 2, i);
    Scene scene = paper();
    scene.floor.reset();
    scene.robot = random_robot(r);
    const Motion held{-0.5, -0.5, 1};
    const TwoLinkLanding links(scene, sea, held);
    System system(links.scene.robot, 0);
    system.body.contacts = 0;
    system.piece[0] = constant_reference(held.phi_i);
    System::State y = System::State::Zero();
    for (int k = 0; k < kVx; ++k) y[k] = r.uniform(-2, 2);
    for (int k = kVx; k <= kOmegaM; ++k) y[k] = r.uniform(-5, 5);

    // Angular momentum about the centre of mass from the definition: sum m_i (r_i - R) x v_i + I_i w_i.
    const auto angular = [&](const System::State& s) {
      const double l = scene.robot.link_length, k1 = scene.robot.mass[1] / (scene.robot.mass[0] + scene.robot.mass[1]);
      const Eigen::Vector2d u0(std::sin(s[kTheta0]), -std::cos(s[kTheta0])),
          u1(std::sin(s[kTheta1]), -std::cos(s[kTheta1])), n0(-u0.y(), u0.x()), n1(-u1.y(), u1.x());
      const Eigen::Vector2d d = 0.5 * l * (u0 + u1),
                            v = 0.5 * l * (s[kOmega0] * n0 + s[kOmega1] * n1);  // r_1 - r_0, its rate
      const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        return a.x() * b.y() - a.y() * b.x();
      };
      return scene.robot.mass[0] * k1 * k1 * cross(d, v) + scene.robot.mass[1] * (1 - k1) * (1 - k1) * cross(d, v) +
             scene.robot.inertia_com[0] * s[kOmega0] + scene.robot.inertia_com[1] * s[kOmega1];
    };
    const auto energy = [&](const System::State& s) {
      const double d = s[kPhiM] - (s[kTheta1] - s[kTheta0]), lag = held.phi_i - s[kPhiM];
      return system.link_energy(s) + 0.5 * sea.i_motor * s[kOmegaM] * s[kOmegaM] + 0.5 * sea.k_sea * d * d +
             0.25 * sea.k_sea_cubic * d * d * d * d + 0.5 * sea.k_p * lag * lag;
    };
    const double e0 = energy(y), l0 = angular(y), vx0 = y[kVx], vy0 = y[kVy], x0 = y[kX], y0 = y[kY];
    const TwoLinkDynamics<double> link(scene.robot);
    const double size = kinetic_energy(system.body, system.pose(y)) + 0.5 * sea.i_motor * y[kOmegaM] * y[kOmegaM] + 60;
    const double spin = (link.inertia0 + link.inertia1) * 20;

    constexpr double kUntil = 2;
    integrate::Integrator<integrate::DormandPrince853, System> run(system, 0, y, {.accuracy = 1e-12});
    double moved = 0;
    for (int n = 0; run.time() < kUntil && n < 100000; ++n) {
      const integrate::Outcome o = run.step(kUntil);
      REQUIRE(o.status <= integrate::Status::kReached);
      const System::State& s = run.state();
      moved = std::max(moved, std::abs(s[kOmega1] - y[kOmega1]));
      REQUIRE(std::abs(energy(s) - e0) <= 1e-9 * size);
      REQUIRE(std::abs(angular(s) - l0) <= 1e-10 * spin);
      REQUIRE(s[kVx] == vx0);  // no horizontal force: exactly
    }
    const double g = scene.robot.gravity;
    CHECK(moved > 1);  // the links did exchange momentum through the actuator
    CHECK(run.time() == kUntil);
    CHECK(run.state()[kVy] == Approx(vy0 - g * kUntil).margin(1e-11));
    CHECK(run.state()[kX] == Approx(x0 + vx0 * kUntil).margin(1e-11));
    CHECK(run.state()[kY] == Approx(y0 + vy0 * kUntil - 0.5 * g * kUntil * kUntil).margin(1e-10));
  }
}

TEST_CASE("two_link: in contact the energy changes by the work done") {
  const Scene scene = paper();
  INFO("seed " << kSeed);
  const auto residual = [&](const Motion& m, double accuracy) {
    const Landing landing = simulate(scene, table2_sea(), m, {.accuracy = accuracy});
    REQUIRE(landing.end == End::kRest);
    REQUIRE(landing.touches.size() >= 3);
    return landing.energy_residual;
  };
  double worst = 0;
  for (std::uint64_t i = 0; i < 12; ++i) {
    Random r(kSeed + 3, i);
    const Motion m =
        i == 0 ? Motion{-0.25 * std::numbers::pi, -0.25 * std::numbers::pi, 1} : random_motion(r, scene.search);
    INFO("motion " << m.phi_i << " " << m.phi_f << " " << m.duration);
    const double e = residual(m, 1e-9);  // the default accuracy
    CHECK(e < 1e-7);
    CHECK(e > 0);
    worst = std::max(worst, e);
    CHECK(residual(m, 1e-12) < 1e-10);  // it is the integrator's error, so it follows the tolerance
  }
  CAPTURE(worst);
}

TEST_CASE("two_link: a landing mirrored left to right has the same peak") {
  INFO("seed " << kSeed);
  for (std::uint64_t i = 0; i < 20; ++i) {
    Random r(kSeed + 5, i);
    const Scene scene = paper();
    const Motion m = random_motion(r, scene.search);
    INFO("motion " << m.phi_i << " " << m.phi_f << " " << m.duration);
    Scene mirrored = scene;
    mirrored.drop.forward_speed *= -1, mirrored.drop.pitch *= -1;
    const LandingPeak a = peak_acceleration(scene, table2_sea(), m),
                      b = peak_acceleration(mirrored, table2_sea(), {-m.phi_i, -m.phi_f, m.duration});
    REQUIRE(a.end == End::kRest);
    CHECK(b.end == a.end);
    CHECK_THAT(b.peak, WithinRel(a.peak, 1e-9));
    CHECK_THAT(b.t_peak, WithinRel(a.t_peak, 1e-9));
    // Mirroring the motion alone is another landing.
    CHECK(peak_acceleration(scene, table2_sea(), {-m.phi_i, -m.phi_f, m.duration}).peak != a.peak);
  }
}
