// A rig whose link hangs (identify/rig/rig.hpp, Gravity): where it rests, how it swings, what a fit makes of it.
#include <catch2/catch.hpp>
#include <cmath>

#include "common/actuator.hpp"
#include "common/error.hpp"
#include "common/jet.hpp"
#include "identify/fit/fit.hpp"
#include "identify/rollout/rollout.hpp"
#include "test/folder.hpp"

using namespace ukemi;
using namespace ukemi::identify;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

const Rig kHanging{
    .length = 0.3, .inertia = 0.024, .tau_max = {}, .gear_ratio = {}, .feedback = {}, .gravity = {2.5, 0.3}};
const SeaParameters<double> kTruth{.k_p = 50, .k_d = 1, .k_sea = 65, .c_sea = 1.6, .i_motor = 0.085};

Trial at_reference(double phi_ref, double seconds = 1) {
  Trial out;
  out.file = "hit";
  for (int i = 0; i <= int(seconds * 1000); ++i) out.t.push_back(i * 1e-3);
  out.phi_ref.assign(out.t.size(), phi_ref);
  out.phi_motor.resize(out.t.size());
  return out;
}
Trial hit(double phi_ref, double newton) {
  Trial out = at_reference(phi_ref);
  for (const double t : out.t) out.force.push_back(t > 0.05 && t < 0.07 ? newton * std::sin((t - 0.05) * 157.08) : 0);
  return out;
}

struct Rolled {
  std::vector<double> phi, phi_m;
};
Rolled rolled(const Rig& rig, const SeaParameters<double>& p, const Trial& trial, const Nuisance<double>& n = {}) {
  Rolled out;
  REQUIRE(rollout(rig, p, n, PreparedTrial(trial), {.accuracy = 1e-12}, out.phi, out.phi_m) == RolloutStatus::kDone);
  return out;
}

}  // namespace

TEST_CASE("gravity: at rest spring and motor carry the link, and it stays there") {
  for (const Feedback feedback : {Feedback::kOutput, Feedback::kMotor})
    for (const double stiffening : {0.0, 40.0}) {
      SeaParameters<double> p = kTruth;
      p.feedback = feedback, p.k_sea_cubic = stiffening;
      const Rolled r = rolled(kHanging, p, at_reference(-0.4, 2));
      const double phi = r.phi.front(), phi_m = r.phi_m.front(), d = phi_m - phi,
                   pull = kHanging.gravity.moment * std::sin(phi - kHanging.gravity.hanging);
      CHECK(std::abs(phi + 0.4) > 0.01);  // it sags
      CHECK_THAT(65 * d + stiffening * d * d * d, WithinRel(pull, 1e-12));
      CHECK_THAT(50 * (-0.4 - (feedback == Feedback::kMotor ? phi_m : phi)), WithinRel(pull, 1e-12));
      for (std::size_t i = 0; i < r.phi.size(); i += 50) CHECK_THAT(r.phi[i], WithinAbs(phi, 1e-10));
    }
}

TEST_CASE("gravity: without a spring the link is a pendulum") {
  SeaParameters<double> p{.k_p = 0, .k_d = 0, .k_sea = 0, .c_sea = 0, .i_motor = 0.085};
  const Trial trial = at_reference(0.3 + 0.9, 2);  // 0.9 rad off where it hangs; nothing carries it
  const Rolled r = rolled(kHanging, p, trial);
  // Its energy is conserved, and its period is that of a pendulum: 4 K(sin(0.45)) sqrt(I / G).
  const double period = 4 * std::comp_ellint_1(std::sin(0.45)) * std::sqrt(0.024 / 2.5);
  std::size_t turns = 1;
  while (r.phi[turns + 1] >= r.phi[turns] || trial.t[turns] < 0.6 * period) ++turns;  // back at the top
  CHECK_THAT(trial.t[turns], WithinAbs(period, 2e-3));
  CHECK_THAT(r.phi[turns], WithinAbs(1.2, 1e-3));
}

TEST_CASE("gravity: derivatives, through where the link rests, against differences") {
  SeaParameters<double> p = kTruth;
  p.friction = 0.2;
  const Trial trial = hit(0.5, 60);
  SeaParameters<ceres::Jet<double, kSmallJet>> jets = p.cast<ceres::Jet<double, kSmallJet>>();
  jets.k_p.v[0] = jets.k_sea.v[1] = jets.friction.v[2] = 1;
  std::vector<ceres::Jet<double, kSmallJet>> phi, phi_m;
  REQUIRE(rollout(kHanging, jets, {}, PreparedTrial(trial), {.accuracy = 1e-12}, phi, phi_m) == RolloutStatus::kDone);
  double SeaParameters<double>::*const constants[] = {&SeaParameters<double>::k_p, &SeaParameters<double>::k_sea,
                                                      &SeaParameters<double>::friction};
  for (int k = 0; k < 3; ++k) {
    const double step = 1e-5 * p.*constants[k];
    SeaParameters<double> more = p, less = p;
    more.*constants[k] += step, less.*constants[k] -= step;
    const Rolled a = rolled(kHanging, more, trial), b = rolled(kHanging, less, trial);
    double worst = 0, largest = 0;
    for (std::size_t i = 0; i < a.phi.size(); ++i) {
      worst = std::max(worst, std::abs((a.phi[i] - b.phi[i]) / (2 * step) - phi[i].v[k]));
      largest = std::max(largest, std::abs(phi[i].v[k]));
    }
    CAPTURE(k, largest);
    CHECK(worst < 1e-6 * largest);
  }
}

TEST_CASE("gravity: a fit recovers the constants of a hanging leg, and is wrong without it") {
  std::vector<Trial> logs;
  for (const double phi_ref : {0.0, 0.5, -0.4})
    for (const double newton : {60.0, -90.0}) {
      logs.push_back(hit(phi_ref, newton));
      logs.back().phi = rolled(kHanging, kTruth, logs.back()).phi;
      logs.back().phi_motor.clear();
    }
  const Fit known = fit(kHanging, logs, std::nullopt, {}, {});
  REQUIRE(known.converged);
  for (std::size_t k = 0; k < kConstants; ++k) {
    CAPTURE(k);
    CHECK_THAT(known.parameters[k].value, WithinRel(std::array{50.0, 1.0, 65.0, 1.6, 0.085}[k], 1e-6));
  }
  Rig horizontal = kHanging;
  horizontal.gravity = {};
  CHECK(fit(horizontal, logs, kTruth, {}, {}).rms > 0.01);
}

TEST_CASE("gravity: rig files, read and refused") {
  const test::Folder folder;
  const auto rig = [&](const std::string& more) {
    return read_rig(folder.write("rig.toml", "[rig]\nlength = 0.3\ninertia_joint = 0.02\n" + more));
  };
  CHECK(rig("").gravity.moment == 0);
  CHECK(rig("gravity_moment = 2.5\nhanging_deg = 90\n").gravity.moment == 2.5);
  CHECK_THAT(rig("gravity_moment = 2.5\nhanging_deg = 90\n").gravity.hanging, WithinRel(1.5707963267948966, 1e-15));
  CHECK_THROWS_AS(rig("gravity_moment = -1\n"), InputError);
  CHECK_THROWS_AS(rig("hanging_deg = 90\n"), InputError);
}
