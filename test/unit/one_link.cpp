// The rig (identify/rig/one_link.hpp, rollout.hpp) against solutions that share no code with it: the matrix exponential
// where the rig is linear, a fine fixed-step integration with a plain clamp where it is not; and its derivatives
// against differences.
#include "identify/rig/one_link.hpp"

#include <catch2/catch.hpp>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

#include "identify/rollout/rollout.hpp"

using namespace ukemi;
using namespace ukemi::identify;

namespace {

const Rig kRig{
    .length = 0.3, .inertia = 6.09e-3 + 0.806 * 0.15 * 0.15, .tau_max = {}, .gear_ratio = {}, .feedback = {}};
const RolloutOptions kTight{.accuracy = 1e-13};

SeaParameters<double> table2() {
  return {.k_p = 50, .k_d = 1, .k_sea = 65, .c_sea = 1.6, .i_motor = 0.085, .tau_max = 20};
}

/// A trial at 1 kHz; a half sine of `peak` over `width` from t = 5 ms.
Trial pulse(double duration, double peak, double width) {
  Trial trial;
  for (int i = 0; i <= int(std::lround(duration * 1000)); ++i) {
    const double t = i * 1e-3, s = (t - 0.005) / width;
    trial.t.push_back(t);
    trial.force.push_back(s > 0 && s < 1 ? peak * std::sin(std::numbers::pi * s) : 0);
  }
  return trial;
}

/// Eq. 2-5 as printed, clamp and all, by RK4 at 1 us; force linear between samples, reference held. Returns phi at the
/// samples.
std::vector<double> brute_force(const SeaParameters<double>& p, const Trial& trial, double* largest_torque) {
  using Vec4 = Eigen::Vector4d;
  Vec4 y(0, 0, 0, 0);
  if (!trial.phi_ref.empty()) y << trial.phi_ref[0], trial.phi_ref[0], 0, 0;
  std::vector<double> phi{y[0]};
  for (std::size_t i = 0; i + 1 < trial.t.size(); ++i) {
    const double span = trial.t[i + 1] - trial.t[i], ref = trial.phi_ref.empty() ? 0 : trial.phi_ref[i];
    constexpr int kSteps = 1000;
    const double h = span / kSteps;
    const auto f = [&](double u, const Vec4& s) -> Vec4 {
      const double d = s[1] - s[0], free = p.k_sea * d + p.k_sea_cubic * d * d * d + p.c_sea * (s[3] - s[2]);
      *largest_torque = std::max(*largest_torque, std::abs(free));
      const double tau = std::clamp(free, -p.tau_max, p.tau_max);
      const double force = trial.force[i] + (trial.force[i + 1] - trial.force[i]) * u / span;
      const bool motor = p.feedback == Feedback::kMotor;
      const double friction = p.viscous * s[3];
      const double drive = p.k_p * (ref - (motor ? s[1] : s[0])) - p.k_d * (motor ? s[3] : s[2]);
      return {s[2], s[3], (tau + kRig.length * std::cos(s[0]) * force) / kRig.inertia,
              (drive - tau - friction) / p.i_motor};
    };
    for (int k = 0; k < kSteps; ++k) {
      const double u = k * h;
      const Vec4 k1 = f(u, y), k2 = f(u + h / 2, y + h / 2 * k1), k3 = f(u + h / 2, y + h / 2 * k2),
                 k4 = f(u + h, y + h * k3);
      y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    phi.push_back(y[0]);
  }
  return phi;
}

}  // namespace

TEST_CASE("one_link: without force and limit the rollout is the matrix exponential") {
  SeaParameters<double> p = table2();
  p.tau_max = std::numeric_limits<double>::infinity();
  p.feedback = GENERATE(Feedback::kOutput, Feedback::kMotor);
  const double reference = GENERATE(0.0, 0.3);  // constant: deviations from it obey the same equation
  const Nuisance<double> initial{.angle = 0.2, .rate = 3};
  Trial trial;
  for (int i = 0; i <= 400; ++i)
    trial.t.push_back(0.0025 * i + (i % 2 == 0 ? 0 : 0.0004)), trial.phi_ref.push_back(reference);

  Eigen::Matrix4d a = Eigen::Matrix4d::Zero();  // of [phi_1, phi_m, dphi_1, dphi_m]
  a(0, 2) = a(1, 3) = 1;
  a.row(2) << -p.k_sea, p.k_sea, -p.c_sea, p.c_sea;
  a.row(3) = -a.row(2);
  const int fed_back = p.feedback == Feedback::kMotor ? 1 : 0;
  a(3, fed_back) -= p.k_p, a(3, 2 + fed_back) -= p.k_d;
  a.row(2) /= kRig.inertia, a.row(3) /= p.i_motor;
  const Eigen::Vector4d start(initial.angle, initial.angle, initial.rate, 0);

  std::vector<double> phi, phi_m;
  REQUIRE(rollout(kRig, p, initial, PreparedTrial(trial), kTight, phi, phi_m) == RolloutStatus::kDone);
  REQUIRE(phi.size() == trial.t.size());
  for (std::size_t i = 0; i < trial.t.size(); ++i) {
    const Eigen::Matrix4d flow = (a * trial.t[i]).exp();
    const Eigen::Vector4d y = flow * start;
    INFO("t = " << trial.t[i]);
    CHECK(std::abs(phi[i] - (reference + y[0])) < 2e-12);
    CHECK(std::abs(phi_m[i] - (reference + y[1])) < 2e-12);
  }
  // At the default accuracy the error is far below any sensor's resolution.
  REQUIRE(rollout(kRig, p, initial, PreparedTrial(trial), {}, phi, phi_m) == RolloutStatus::kDone);
  double worst = 0;
  for (std::size_t i = 0; i < trial.t.size(); ++i)
    worst = std::max(worst, std::abs(phi[i] - (reference + Eigen::Vector4d((a * trial.t[i]).exp() * start)[0])));
  CHECK(worst < 1e-7);
}

TEST_CASE("one_link: hits, torque limit and optional terms agree with a fine fixed-step integration") {
  SeaParameters<double> p = table2();
  Trial trial = pulse(0.15, 180, 0.012);
  const int variant = GENERATE(0, 1, 2, 3);
  if (variant == 1) p.viscous = 0.6, p.k_sea_cubic = 400;
  if (variant == 2) p.feedback = Feedback::kMotor;
  if (variant == 3)  // a reference that jumps twice, held between samples
    for (double t : trial.t) trial.phi_ref.push_back(t < 0.04 ? 0.1 : (t < 0.09 ? -0.25 : 0.3));
  CAPTURE(variant);
  double largest = 0;
  const std::vector<double> expected = brute_force(p, trial, &largest);
  CHECK(largest > 1.04 * p.tau_max);  // the limit does act
  std::vector<double> phi, phi_m;
  REQUIRE(rollout(kRig, p, {}, PreparedTrial(trial), kTight, phi, phi_m) == RolloutStatus::kDone);
  double worst = 0, size = 0;
  for (std::size_t i = 0; i < phi.size(); ++i) {
    worst = std::max(worst, std::abs(phi[i] - expected[i]));
    size = std::max(size, std::abs(expected[i]));
  }
  CAPTURE(worst, size);
  CHECK(size > 0.1);
  CHECK(worst < 1e-9);
}

TEST_CASE("one_link: Jet derivatives of a rollout are its central differences, through the torque limit too") {
  using Jet = ceres::Jet<double, kLargeJet>;
  const double peak = GENERATE(40.0, 180.0);  // the second trial saturates
  Trial trial = pulse(0.12, peak, 0.012);
  trial.phi_motor.resize(trial.t.size());  // so that its derivatives are asked for
  const PreparedTrial prepared(trial);
  constexpr std::array<const char*, kLargeJet> kNames{
      "k_p",     "k_d",           "k_sea",       "c_sea",      "i_motor",    "angle",      "rate",
      "tau_max", "friction",      "k_sea_cubic", "force gain", "force bias", "time shift", "encoder offset",
      "viscous", "output viscous"};
  const std::array<double, kLargeJet> at{50,  1,  65,  1.6, 0.085, 0.02, 0.3,  20,
                                         0.1, 50, 1.1, 0.5, 2e-4,  0.01, 0.05, 0.02};
  const auto run = [&]<class T>(const std::array<T, kLargeJet>& x) {
    SeaParameters<T> p{x[0], x[1], x[2], x[3], x[4], x[7], x[8], x[9]};
    p.viscous = x[14], p.output_viscous = x[15];
    const Nuisance<T> nuisance{x[5], x[6], x[10], x[11], x[12], x[13]};
    std::vector<T> phi, phi_m;
    REQUIRE(rollout(kRig, p, nuisance, prepared, kTight, phi, phi_m) == RolloutStatus::kDone);
    phi.insert(phi.end(), phi_m.begin(), phi_m.end());
    return phi;
  };
  std::array<Jet, kLargeJet> x;
  for (int k = 0; k < kLargeJet; ++k) x[std::size_t(k)] = Jet(at[std::size_t(k)], k);
  const std::vector<Jet> exact = run(x);
  const std::vector<double> values = run(at);
  for (std::size_t k = 0; k < kLargeJet; ++k) {
    INFO("peak " << peak << " N, derivative by " << kNames[k]);
    // The friction makes small differences of some noisy; that of the stiffening is 1e-10 rad.
    const double h = (k == 6 || k == 8 || k == 9 ? 1e-3 : 1e-5) * at[k];
    std::array<double, kLargeJet> up = at, down = at;
    up[k] += h, down[k] -= h;
    const std::vector<double> high = run(up), low = run(down);
    double size = 0, worst = 0, value = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      const double slope = (high[i] - low[i]) / (2 * h);
      size = std::max(size, std::abs(slope));
      worst = std::max(worst, std::abs(exact[i].v[Eigen::Index(k)] - slope));
      value = std::max(value, std::abs(exact[i].a - values[i]));
    }
    CHECK(value < 1e-11);
    if (k == 7 && peak < 100) {
      CHECK(worst == 0);  // the limit is not reached, so nothing depends on it
      CHECK(size == 0);
    } else {
      CAPTURE(worst, size);
      CHECK(size > 0);
      CHECK(worst < 1e-6 * size);
    }
  }
}

TEST_CASE("one_link: a trial that escapes, and one that cannot be followed, say so") {
  std::vector<double> phi, phi_m;
  // 400 N for 30 ms: more than 20 Nm can stop.
  const Trial hard = pulse(0.5, 400, 0.03);
  CHECK(rollout(kRig, table2(), {}, PreparedTrial(hard), {}, phi, phi_m) == RolloutStatus::kEscaped);
  RolloutOptions multi_turn;
  multi_turn.escape = std::numeric_limits<double>::infinity();
  CHECK(rollout(kRig, table2(), {}, PreparedTrial(hard), multi_turn, phi, phi_m) == RolloutStatus::kDone);
  CHECK(std::abs(phi.back()) > kEscape);

  const Trial soft = pulse(0.2, 40, 0.012);
  CHECK(rollout(kRig, table2(), {}, PreparedTrial(soft), {}, phi, phi_m) == RolloutStatus::kDone);
  SeaParameters<double> stiff = table2();
  stiff.c_sea = 1e8;
  CHECK(rollout(kRig, stiff, {}, PreparedTrial(soft), {}, phi, phi_m) == RolloutStatus::kDiverged);
  SeaParameters<double> broken = table2();
  broken.k_sea = std::numeric_limits<double>::quiet_NaN();
  CHECK(rollout(kRig, broken, {}, PreparedTrial(soft), {}, phi, phi_m) == RolloutStatus::kDiverged);
  CHECK(std::string(name(RolloutStatus::kEscaped)) == "the link escapes");
}

TEST_CASE("one_link: where the rig is linear the exact path is the integrated one, derivatives included") {
  using Jet = ceres::Jet<double, kSmallJet>;
  const std::string kind = GENERATE("even", "uneven", "with gaps", "a reference in steps", "a reference that moves",
                                    "sparse", "stiff damping", "motor side");
  CAPTURE(kind);
  Trial trial = pulse(0.4, 180, 0.012);  // reaches the torque limit
  SeaParameters<double> p = table2();
  if (kind == "uneven" || kind == "with gaps") {
    Trial cut;
    for (std::size_t i = 0; i < trial.t.size(); ++i) {
      if (kind == "with gaps" && i > 30 && i % 60 > 20) continue;
      cut.t.push_back(trial.t[i] + (kind == "uneven" ? 3e-4 * std::sin(1.7 * double(i)) : 0));
      cut.force.push_back(trial.force[i]);
    }
    trial = cut;
  } else if (kind == "sparse") {
    trial = pulse(0.4, 0, 0.012);
    Trial cut;
    for (std::size_t i = 0; i < trial.t.size(); i += 25)
      cut.t.push_back(trial.t[i]), cut.phi_ref.push_back(i == 0 ? 0 : 0.5);
    trial = cut;
    p.tau_max = 4;  // reached between two samples
  } else if (kind.rfind("a reference", 0) == 0) {
    for (const double t : trial.t) {
      trial.phi_ref.push_back(0.2 * std::sin(9 * t));
      if (kind == "a reference that moves") trial.dphi_ref.push_back(1.8 * std::cos(9 * t));
    }
  }
  if (kind == "stiff damping") p.c_sea = 60;
  if (kind == "motor side") p.feedback = Feedback::kMotor;
  trial.phi_motor.resize(trial.t.size());
  SeaParameters<Jet> seeded = p.cast<Jet>();
  Jet* const constants[] = {&seeded.k_p, &seeded.k_d, &seeded.k_sea, &seeded.c_sea, &seeded.i_motor};
  for (int k = 0; k < 5; ++k) constants[k]->v[k] = constants[k]->a;
  const PreparedTrial prepared(trial);
  RolloutOptions options = kTight;
  options.max_steps = 1'000'000;
  std::vector<Jet> exact, exact_m, integrated, integrated_m;
  integrate::Counters few, many;
  options.work = &few;
  REQUIRE(rollout(kRig, seeded, {}, prepared, options, exact, exact_m) == RolloutStatus::kDone);
  options.linear = RolloutOptions::Linear::kIntegrated, options.work = &many;
  REQUIRE(rollout(kRig, seeded, {}, prepared, options, integrated, integrated_m) == RolloutStatus::kDone);
  CHECK(many.events == few.events);
  CHECK(many.events > 0);
  CHECK(2 * few.steps < many.steps);
  double worst = 0, worst_slope = 0;
  for (std::size_t i = 0; i < exact.size(); ++i)
    for (const auto& [a, b] : {std::pair(exact[i], integrated[i]), std::pair(exact_m[i], integrated_m[i])}) {
      worst = std::max(worst, std::abs(a.a - b.a));
      worst_slope = std::max(worst_slope, (a.v - b.v).cwiseAbs().maxCoeff());
    }
  CHECK(worst < 1e-11);
  CHECK(worst_slope < 1e-10);
}
