// Eq. 2-4 (common/sea.hpp), term by term against their printed forms, worked out by hand or by differences.
#include "common/sea.hpp"
#include "landing/model/dry_friction.hpp"

#include <catch2/catch.hpp>

#include "common/drive_stability.hpp"
#include "common/jet.hpp"
#include "common/random.hpp"

using namespace ukemi;

namespace {

constexpr std::uint64_t kSeed = 20240604;
constexpr SeaTerms kPlain{false, false}, kLimited{true, false}, kExtended{true, true};

SeaParameters<double> table2() {
  return {.k_p = 50, .k_d = 1, .k_sea = 65, .c_sea = 1.6, .i_motor = 0.085, .tau_max = 20};
}
SeaParameters<double> extended() {
  SeaParameters<double> p = table2();
  p.friction = 0.7, p.k_sea_cubic = 120;
  return p;
}
SeaState<double> random_state(Random& r) {
  return {r.uniform(-1, 1), r.uniform(-1, 1), r.uniform(-9, 9), r.uniform(-9, 9)};
}

}  // namespace

TEST_CASE("sea: the spring's torque, Eq. 2") {
  const SeaState<double> s{.phi = 0.1, .phi_m = 0.3, .dphi = 2, .dphi_m = -1};
  // 65 * 0.2 + 1.6 * -3, and 120 * 0.2^3 where the spring stiffens
  CHECK(spring_torque<kPlain>(table2(), s) == Approx(8.2));
  CHECK(spring_torque<kLimited>(table2(), s) == Approx(8.2));
  CHECK(spring_torque<kExtended>(extended(), s) == Approx(8.2 + 0.96));
  CHECK(spring_torque<kExtended>(table2(), s) == Approx(8.2));  // an absent term is zero
  CHECK(spring_torque<kPlain>(extended(), s) == Approx(8.2));   // and a kernel without it does not know it
  // The motor ahead pulls the link forward; nothing of it without deflection.
  CHECK(spring_torque<kPlain>(table2(), {0, 0.01, 0, 0}) > 0);
  CHECK(spring_torque<kExtended>(extended(), {0.4, 0.4, 3, 3}) == 0);
}

TEST_CASE("sea: the rate of the spring's torque is its derivative in time") {
  INFO("seed " << kSeed);
  for (std::uint64_t i = 0; i < 50; ++i) {
    Random r(kSeed, i);
    const SeaState<double> s = random_state(r);
    const double ddphi = r.uniform(-200, 200), ddphi_m = r.uniform(-200, 200), h = 1e-6;
    const auto along = [&](double t) {  // on parabolas through the state
      return SeaState<double>{s.phi + t * s.dphi + 0.5 * t * t * ddphi, s.phi_m + t * s.dphi_m + 0.5 * t * t * ddphi_m,
                              s.dphi + t * ddphi, s.dphi_m + t * ddphi_m};
    };
    const auto check = [&]<SeaTerms kTerms>(const SeaParameters<double>& p) {
      const double difference = (spring_torque<kTerms>(p, along(h)) - spring_torque<kTerms>(p, along(-h))) / (2 * h);
      CHECK(spring_torque_rate<kTerms>(p, s, ddphi, ddphi_m) == Approx(difference).epsilon(1e-6).margin(1e-5));
    };
    check.operator()<kPlain>(table2());
    check.operator()<kExtended>(extended());
  }
}

TEST_CASE("sea: the torque limit in its three modes") {
  const SeaParameters<double> p = table2();
  for (double torque : {-35.0, -20.0, 3.0, 20.0, 35.0}) {
    CAPTURE(torque);
    CHECK(limited_torque<kLimited>(p, torque, 0) == torque);  // the driver holds the branch: no clamp of its own
    CHECK(limited_torque<kLimited>(p, torque, 1) == 20);
    CHECK(limited_torque<kLimited>(p, torque, -1) == -20);
    for (int saturation : {-1, 0, 1}) CHECK(limited_torque<kPlain>(p, torque, saturation) == torque);
  }
}

TEST_CASE("sea: the motor's torque feeds back the output, Eq. 3, or the motor") {
  const SeaState<double> s{.phi = 0.1, .phi_m = 0.3, .dphi = 2, .dphi_m = -1};
  const Reference<double> ref{-0.4, 0.5};
  CHECK(motor_torque<kPlain>(table2(), s, ref) == Approx(50 * -0.5 + 1 * -1.5));
  SeaParameters<double> p = table2();
  CHECK(motor_torque<kExtended>(p, s, ref) == Approx(-26.5));
  p.feedback = Feedback::kMotor;
  CHECK(motor_torque<kExtended>(p, s, ref) == Approx(50 * -0.7 + 1 * 1.5));
  // Which of both is fed back matters only while the spring is deflected.
  CHECK(motor_torque<kExtended>(p, {0.2, 0.2, 1, 1}, ref) == motor_torque<kPlain>(p, {0.2, 0.2, 1, 1}, ref));
}

TEST_CASE("sea: friction on both sides, by direction, from its breakaway on") {
  SeaParameters<double> p = table2();
  p.friction = 0.7, p.friction_asymmetry = 0.2, p.viscous = 0.3;
  p.output_friction = 0.4, p.output_friction_asymmetry = -0.5, p.output_viscous = 0.1;
  const auto motor = [&](double direction, double v) {
    return coulomb_torque(p, loaded_friction(p.friction, p.spring_loss, 0.0), p.friction_asymmetry, direction, v);
  };
  const auto output = [&](double direction, double v) {
    return coulomb_torque(p, p.output_friction, p.output_friction_asymmetry, direction, v);
  };
  CHECK(motor(1, 2) == Approx(0.7 * 1.2));
  CHECK(motor(-1, -2) == Approx(-0.7 * 0.8));
  CHECK(output(1, 2) == Approx(0.4 * 0.5));
  CHECK(output(-1, -2) == Approx(-0.4 * 1.5));
  CHECK(output(0, 0) == 0);
  CHECK(torque_on_motor<kExtended>(p, 2.0, 5.0, 3.0) == Approx(2 - 0.6));
  CHECK(torque_on_motor<kPlain>(p, 2.0, 5.0, 3.0) == 2);
  CHECK(output_torque<kExtended>(p, 2.0, 8.0) == Approx(8 - 0.2));
  CHECK(output_torque<kPlain>(p, 2.0, 8.0) == 8);
  p.breakaway = 0.5, p.stribeck_speed = 1;
  CHECK(motor(1, 2) == Approx(0.7 * 1.2 * (1 + 0.5 * std::exp(-2.0))));
  CHECK(output(-1, -0.2) == Approx(-0.4 * 1.5 * (1 + 0.5 * std::exp(-0.2))));
  // What the transmission carries rubs on the motor, whichever way it is carried.
  p.breakaway = 0, p.spring_loss = 0.1;
  for (const double tau : {-5.0, 5.0})
    CHECK(loaded_friction(p.friction, p.spring_loss, tau) == Approx(0.7 + 0.1 * 4.99).epsilon(1e-5));
  CHECK(loaded_friction(p.friction, p.spring_loss, 0.0) == 0.7);
}

TEST_CASE("sea: a side at rest stays within its breakaway torque in either direction") {
  SeaParameters<double> p = table2();
  p.breakaway = 0.5;
  const auto starts = [&](double torque) {
    const landing::Hold<double> h(p, 2.0, 0.25, torque);
    return landing::breakaway_direction(h.margin_up(), h.margin_down());
  };
  CHECK(starts(0) == 0);
  CHECK(starts(2 * 1.25 * 1.5) == 0);
  CHECK(starts(2 * 1.25 * 1.5 + 1e-9) == 1);
  CHECK(starts(-2 * 0.75 * 1.5) == 0);
  CHECK(starts(-2 * 0.75 * 1.5 - 1e-9) == -1);
  // At the moment that it breaks loose nothing accelerates it yet.
  CHECK(coulomb_torque(p, 2.0, 0.25, 1.0, 0.0) == landing::Hold<double>(p, 2.0, 0.25, 0.0).up);
  CHECK(coulomb_torque(p, 2.0, 0.25, -1.0, 0.0) == -landing::Hold<double>(p, 2.0, 0.25, 0.0).down);
}

TEST_CASE("sea: the motor's acceleration beside dry friction, Eq. 4") {
  const SeaState<double> s{.phi = 0.1, .phi_m = 0.3, .dphi = 2, .dphi_m = -1};
  const Reference<double> ref{-0.4, 0.5};
  CHECK(motor_acceleration<kPlain>(table2(), s, ref, 8.2) == Approx((-26.5 - 8.2) / 0.085));
  SeaParameters<double> p = extended();
  p.viscous = 0.3;
  CHECK(motor_acceleration<kExtended>(p, s, ref, 9.16) == Approx((-26.5 - 9.16 + 0.3) / 0.085));
}

TEST_CASE("sea: an actuator is extended where an optional term is set") {
  SeaParameters<double> p = table2();
  CHECK(!is_extended(p));
  CHECK(is_extended(extended()));
  p.feedback = Feedback::kMotor;
  CHECK(is_extended(p));
  const SeaParameters<float> q = p.cast<float>();
  CHECK(q.k_sea == 65);
  CHECK(q.tau_max == 20);
  CHECK(q.feedback == Feedback::kMotor);
}

TEST_CASE("sea: Jet derivatives of the motor's acceleration are its central differences") {
  constexpr int kInputs = 13;
  using Jet = ceres::Jet<double, kInputs>;
  // Everything that it depends on: seven constants, the state, the reference. The limit is inside, so tau_max comes in
  // too.
  const auto acceleration = []<class T>(const std::array<T, kInputs>& x, Feedback feedback, int saturation) {
    const SeaParameters<T> p{x[0], x[1], x[2], x[3], x[4], T(20), x[5], x[6], feedback};
    const SeaState<T> s{x[7], x[8], x[9], x[10]};
    const T tau = limited_torque<kExtended>(p, spring_torque<kExtended>(p, s), saturation);
    return motor_acceleration<kExtended>(p, s, {x[11], x[12]}, tau);
  };
  INFO("seed " << kSeed);
  for (std::uint64_t i = 0; i < 60; ++i) {
    Random r(kSeed + 1, i);
    const Feedback feedback = i % 2 == 0 ? Feedback::kOutput : Feedback::kMotor;
    const int saturation = int(i % 3) - 1;
    const SeaState<double> s = random_state(r);
    std::array<double, kInputs> x{50 * r.factor(3),
                                  r.factor(3),
                                  65 * r.factor(3),
                                  1.6 * r.factor(3),
                                  0.085 * r.factor(3),
                                  0.7 * r.factor(3),
                                  120 * r.factor(3),
                                  s.phi,
                                  s.phi_m,
                                  s.dphi,
                                  i % 5 == 0 ? 0.01 * s.dphi_m : s.dphi_m,  // some inside the smoothing
                                  r.uniform(-1, 1),
                                  r.uniform(-5, 5)};
    std::array<Jet, kInputs> j;
    for (int k = 0; k < kInputs; ++k) j[std::size_t(k)] = Jet(x[std::size_t(k)], k);
    const Jet exact = acceleration(j, feedback, saturation);
    CHECK(exact.a == Approx(acceleration(x, feedback, saturation)).epsilon(1e-14));
    for (std::size_t k = 0; k < kInputs; ++k) {
      INFO("draw " << i << ", input " << k << ", saturation " << saturation);
      const double h = 1e-5 * std::max(0.1, std::abs(x[k])) * (k == 10 ? 0.1 : 1);
      std::array<double, kInputs> up = x, down = x;
      up[k] += h, down[k] -= h;
      const double slope =
          (acceleration(up, feedback, saturation) - acceleration(down, feedback, saturation)) / (2 * h);
      CHECK(exact.v[Eigen::Index(k)] == Approx(slope).epsilon(1e-6).margin(1e-13 * (1e3 + std::abs(exact.a)) / h));
    }
  }
}

TEST_CASE("sea: a drive is stable where the Routh criterion says so") {
  // a s^4 + b s^3 + c s^2 + d s + e with a link of inertia M, feedback of the output angle.
  int stable = 0, unstable = 0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    Random r(kSeed, i);
    SeaParameters<double> p = table2();
    for (double* x : {&p.k_p, &p.k_d, &p.k_sea, &p.c_sea, &p.i_motor}) *x *= r.factor(30);
    const double m = 0.01 * r.factor(10), k = p.k_sea, c = p.c_sea, j = p.i_motor;
    const double a4 = m * j, a3 = (m + j) * c, a2 = (m + j) * k + c * p.k_d, a1 = k * p.k_d + c * p.k_p, a0 = k * p.k_p;
    const double routh = a3 * a2 * a1 - a4 * a1 * a1 - a3 * a3 * a0, size = a3 * a2 * a1 + a4 * a1 * a1 + a3 * a3 * a0;
    if (std::abs(routh) < 1e-6 * size) continue;  // too near to call
    INFO("draw " << i);
    CHECK((growth_rate(p, m) > 0) == (routh < 0));
    ++(routh < 0 ? unstable : stable);
  }
  CHECK(std::min(stable, unstable) > 200);
  SeaParameters<double> p = table2();
  CHECK(growth_rate(p, 0.02) < 0);
  p.c_sea = 0;  // no damping in the spring: unstable with any gains
  CHECK(growth_rate(p, 0.02) > 0);
  p.k_p = p.k_d = p.c_sea = p.k_sea = 0;  // nothing acts: it neither grows nor decays
  CHECK(growth_rate(p, 0.02) == 0);
}
