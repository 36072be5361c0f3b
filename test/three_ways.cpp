#include "test/three_ways.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/degrees.hpp"
#include "common/parallel.hpp"
#include "common/random.hpp"
#include "landing/judge/sensitivity.hpp"
#include "landing/lanes/batch.hpp"

namespace ukemi::landing {

StabilityCase random_motion(const Scene& scene, const SeaParameters<double>& sea, std::uint64_t seed,
                            std::uint64_t index) {
  Random r(seed, index);
  const auto& [phi, duration] = scene.search;
  const double phi_i = r.uniform(phi[0], phi[1]), phi_f = r.uniform(phi[0], phi[1]);
  return {scene.name, std::to_string(index), scene, sea, {phi_i, phi_f, r.uniform(duration[0], duration[1])}};
}

StabilityCase random_landing(const Scene& base, const SeaParameters<double>& sea, std::uint64_t seed,
                             std::uint64_t index) {
  Random r(seed, index);
  StabilityCase c{"random scene", std::to_string(index), base, sea, {}};
  TwoLink<double>& robot = c.scene.robot;
  robot.link_length *= r.factor(3);
  for (int k = 0; k < 2; ++k) {
    robot.mass[std::size_t(k)] *= r.factor(3);
    robot.inertia_com[std::size_t(k)] *= r.factor(3);
  }
  Floor<double>& floor = *c.scene.floor;
  floor.stiffness *= r.factor(10), floor.damping_normal *= r.factor(10);
  floor.damping_tangential = 10 * r.factor(100);
  for (double* x : {&c.sea.k_p, &c.sea.k_d, &c.sea.k_sea, &c.sea.c_sea, &c.sea.i_motor}) *x *= r.factor(3);
  c.sea.tau_max = r.uniform() < 0.2 ? std::numeric_limits<double>::infinity() : 20 * r.factor(5);
  Drop& drop = c.scene.drop;
  drop.height = 0.4 * r.factor(5), drop.forward_speed = r.uniform(-2, 2), drop.pitch = r.uniform(-90, 90) * kDegree;
  if (r.uniform() < 0.25) drop.pitch_rate = r.uniform(-3, 3);
  if (r.uniform() < 0.1) c.scene.contacts[std::size_t(r.uniform(0, kPoints))] = false;
  c.motion = {r.uniform(-120, 30) * kDegree, r.uniform(-120, 30) * kDegree, 0.3 * r.factor(4)};
  return c;
}

StabilityCase with_drive_terms(StabilityCase c, std::uint64_t seed, std::uint64_t index) {
  constexpr std::uint64_t kApart = 0xd51fe;  // from the draws of the landing
  Random r(seed ^ kApart << 32, index);
  const auto maybe = [&](double& x, double value) {
    if (r.uniform() < 0.5) x = value;
  };
  SeaParameters<double>& sea = c.sea;
  maybe(sea.friction, r.uniform(0, 1)), maybe(sea.friction_asymmetry, r.uniform(-0.5, 0.5));
  maybe(sea.output_friction, r.uniform(0, 2)), maybe(sea.output_friction_asymmetry, r.uniform(-0.5, 0.5));
  maybe(sea.viscous, r.uniform(0, 0.2)), maybe(sea.output_viscous, r.uniform(0, 0.2));
  maybe(sea.breakaway, r.uniform(0, 1)), maybe(sea.stribeck_speed, 0.05 * r.factor(4));
  maybe(sea.spring_loss, r.uniform(0, 0.4)), maybe(sea.k_sea_cubic, r.uniform(0, 200));
  if (r.uniform() < 0.5) sea.feedback = Feedback::kMotor;
  c.factor += ", every term of the drive";
  return c;
}

namespace {

CrossCheck cross_check(const StabilityCase& c, const LandingPeak& lanes) {
  const auto play = [&](double accuracy) {
    return peak_acceleration(c.scene, c.sea, c.motion, {.accuracy = accuracy});
  };
  constexpr double kTight = 1e-11;
  const LandingPeak scalar = play(SimulateOptions{}.accuracy), tight = play(kTight);
  CrossCheck out{.scalar = scalar.peak, .lanes = lanes.peak, .tight = tight.peak};
  for (const LandingPeak* p : {&scalar, &tight, &lanes})
    if (p->end == End::kFailed) {
      const bool refused = p->failure == Failure::kIntegration || p->failure == Failure::kSteps;
      out.verdict = refused ? Verdict::kRefused : Verdict::kWrong, out.reason = reason(*p);
      return out;
    }
  out.scalar_difference = std::abs(scalar.peak / tight.peak - 1);
  out.lanes_difference = std::abs(lanes.peak / tight.peak - 1);
  const double largest = std::max(out.scalar_difference, out.lanes_difference);
  if (largest <= kCliff) {
    out.verdict = Verdict::kPass;
    return out;
  }
  const Sensitivity s = sensitivity(c.scene, c.sea, c.motion, {.accuracy = 100 * kTight}, tight.peak, 64);
  out.sensitivity = s.change;
  LandingPeak finer;
  const BatchCase again{&c.scene, &c.sea, c.motion};
  batch_peaks({&again, 1}, {&finer, 1}, {.accuracy = 1e-7});
  const bool coarse = out.scalar_difference <= kCliff && std::abs(finer.peak / tight.peak - 1) <= kCliff;
  out.verdict = s.sensitive ? Verdict::kSensitive : coarse ? Verdict::kCoarse : Verdict::kWrong;
  if (out.verdict == Verdict::kWrong)
    out.reason = out.scalar_difference > kCliff ? "the scalar path's peak is another" : "the lanes' peak is another";
  return out;
}

}  // namespace

std::vector<CrossCheck> cross_check(std::span<const StabilityCase> cases, int threads) {
  std::vector<BatchCase> batch;
  for (const StabilityCase& c : cases) batch.push_back({&c.scene, &c.sea, c.motion});
  std::vector<LandingPeak> lanes(cases.size());
  batch_peaks(batch, lanes, {.accuracy = 1e-6}, threads);
  std::vector<CrossCheck> out(cases.size());
  parallel_for(int(cases.size()), threads,
               [&](int i) { out[std::size_t(i)] = cross_check(cases[std::size_t(i)], lanes[std::size_t(i)]); });
  return out;
}

}  // namespace ukemi::landing
