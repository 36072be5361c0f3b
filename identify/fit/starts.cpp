#include "identify/fit/starts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "common/actuator.hpp"
#include "common/checks.hpp"
#include "common/noise.hpp"
#include "common/random.hpp"
#include "identify/logs/trial_checks.hpp"

namespace ukemi::identify {

void StartOptions::validate() const {
  constexpr long kMaxCount = 1'000'000;
  check_count("draws", draws, 1, kMaxCount), check_count("draws_near", draws_near, 1, kMaxCount);
  check_count("steps", steps, 1, kMaxCount), check_positive("accuracy of starts", accuracy);
  check_positive("apart - 1", apart - 1), check_positive("spread - 1", spread - 1);
  check_not_negative("sample_steps", sample_steps), check_not_negative("fit_steps", fit_steps);
  check_not_negative("fit_sample_steps", fit_sample_steps), check_not_negative("fit_starts", fit_starts);
}

namespace {

/// Angular frequency of a log: rms rate over rms deviation, on differences wide enough to see past the noise [rad/s].
double dominant_frequency(const Trial& trial, const std::vector<double>& x) {
  if (x.size() < 20) return 0;
  const std::size_t stride = std::max<std::size_t>(1, x.size() / 250);
  double mean = 0, rate2 = 0, deviation2 = 0;
  for (const double v : x) mean += v / double(x.size());
  std::size_t n = 0;
  for (std::size_t i = 0; i + stride < x.size(); i += stride, ++n) {
    const double dx = (x[i + stride] - x[i]) / (trial.t[i + stride] - trial.t[i]), d = x[i] - mean;
    rate2 += dx * dx, deviation2 += d * d;
  }
  return deviation2 > 0 ? std::sqrt(rate2 / deviation2) : 0;
}

/// Measured deflection of the spring; empty where one side was not logged.
std::vector<double> deflection(const Trial& trial) {
  if (trial.phi.empty() || trial.phi_motor.empty()) return {};
  std::vector<double> out(trial.phi.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = trial.phi_motor[i] - trial.phi[i];
  return out;
}

/// Drive command per unit of angle: the smallest of the controllers' gains and of the ratios of the logged ranges; 1
/// where no command is known.
double command_gain(const Rig& rig, const std::vector<Trial>& trials) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  double gain = kUnknown;
  for (const Trial& trial : trials) {
    const Drive& drive = trial.rig_or(rig).drive;
    const double command = largest_deviation(trial.command), angle = largest_deviation(trial.phi);
    if (drive.kind == Drive::Kind::kController) gain = std::min(gain, drive.gain);
    if (drive.kind == Drive::Kind::kCommand && command > 0 && angle > 0) gain = std::min(gain, command / angle);
  }
  return gain < kUnknown ? gain : 1;
}

}  // namespace

Suggestion suggest(const Rig& rig, const std::vector<Trial>& trials) {
  Suggestion s;
  double largest_deflection = 0, omega = 0, num_p = 0, den_p = 0, num_d = 0, den_d = 0;
  int frequencies = 0;
  struct Balance {
    double torque = 0, torque_t = 0, phi = 0, phi_t = 0, displacement = 0;
  };
  std::vector<Balance> balances;
  for (const Trial& trial : trials) {
    const std::vector<double> spring = deflection(trial);
    const bool command_known = trial.rig_or(rig).drive.kind != Drive::Kind::kGains;
    if (const double w = dominant_frequency(trial, command_known && !spring.empty() ? spring : trial.phi);
        w > 0 && std::isfinite(w))
      omega += w, ++frequencies;
    largest_deflection = std::max(largest_deflection, largest_deviation(spring));
    s.rate = std::max(s.rate, dominant_frequency(trial, spring) * largest_deviation(trial.phi));
    if (trial.force.empty() || trial.phi.empty()) continue;
    Balance b;
    const Rig& own = trial.rig_or(rig);
    const Gravity& gravity = own.gravity;
    const double sag = gravity.moment == 0 ? 0 : trial.phi[0] - (trial.phi_ref.empty() ? 0 : trial.phi_ref[0]);
    const std::vector<double> force = force_at_samples(trial);
    for (std::size_t i = 0; i + 1 < trial.samples(); ++i) {
      const double dt = trial.t[i + 1] - trial.t[i], t = 0.5 * (trial.t[i + 1] + trial.t[i]) - trial.t[0];
      const double ref = trial.phi_ref.empty() ? 0 : trial.phi_ref[i];
      const double phi = 0.5 * (trial.phi[i] + trial.phi[i + 1]) - ref;
      const double torque =
          0.5 * own.length * (std::cos(trial.phi[i]) * force[i] + std::cos(trial.phi[i + 1]) * force[i + 1]) -
          gravity.moment * std::sin(0.5 * (trial.phi[i] + trial.phi[i + 1]) - gravity.hanging);
      b.torque += torque * dt, b.torque_t += torque * t * dt, b.phi += phi * dt, b.phi_t += phi * t * dt;
      b.displacement += (phi - sag) * dt;
    }
    num_p += b.torque * b.phi, den_p += b.phi * b.phi, den_d += b.displacement * b.displacement;
    balances.push_back(b);
  }
  omega = frequencies > 0 ? std::clamp(omega / frequencies, 1.0, 1e3) : 20;
  const double k_p = den_p > 0 ? num_p / den_p : 0;
  for (const Balance& b : balances) num_d += (k_p * b.phi_t - b.torque_t) * b.displacement;
  const double k_d = den_d > 0 ? num_d / den_d : 0;

  const bool gains_known = k_p > 0 && std::isfinite(k_p);
  const double stiffness = rig.inertia * omega * omega;
  s.centre.k_p = gains_known ? k_p : stiffness;
  s.centre.k_d = gains_known && k_d > 0 ? k_d : 0.3 * s.centre.k_p / omega;
  s.centre.k_sea = 2 * std::max(stiffness, 0.5 * s.centre.k_p);
  s.centre.c_sea = 0.3 * s.centre.k_sea / omega;
  s.centre.i_motor = s.centre.k_p / (omega * omega);
  s.centre.k_t = s.centre.k_p / command_gain(rig, trials);
  s.spread_gains = gains_known ? 1.2 : 30;
  s.spread_rest = 10;
  s.torque = s.centre.k_sea * largest_deflection;
  return s;
}

std::vector<SeaParameters<double>> draw_starts(const Suggestion& s, int count, std::uint64_t seed) {
  std::vector<SeaParameters<double>> out(std::size_t(std::max(count, 0)), s.centre);
  std::vector<int> stratum(out.size());
  // Latin hypercube: f(start, position from -1 to 1), the strata in an independent random order for each dimension k
  const auto stratify = [&](std::size_t k, const auto& f) {
    Random random(seed, k);
    std::iota(stratum.begin(), stratum.end(), 0);
    for (std::size_t i = stratum.size(); i > 1; --i)
      std::swap(stratum[i - 1], stratum[std::size_t(random.uniform() * double(i))]);
    for (std::size_t i = 0; i < out.size(); ++i) f(out[i], 2 * (stratum[i] + random.uniform()) / count - 1);
  };
  const std::array<double, kConstants> spread = {s.spread_gains, s.spread_gains * 1.5, s.spread_rest, s.spread_rest,
                                                 s.spread_rest};
  for (std::size_t k = 0; k < kConstants; ++k)
    stratify(k, [&](SeaParameters<double>& sea, double position) {
      auto u = constants(sea);
      const double factor = std::pow(spread[k], position);
      u[k] *= factor;
      set_constants(sea, u);
      if (k == 0) sea.k_t *= factor;  // where the command is known it stands for K_p
    });
  if (!(s.torque > 0 && s.rate > 0)) return out;
  using Sea = SeaParameters<double>;
  std::size_t k = kConstants;
  for (const auto& [friction, typical] : {std::pair(&Sea::friction, s.torque),
                                          {&Sea::output_friction, s.torque},
                                          {&Sea::viscous, s.torque / s.rate},
                                          {&Sea::output_viscous, s.torque / s.rate}})
    stratify(k++, [&, f = friction, middle = typical](Sea& sea, double position) {
      sea.*f = middle * std::pow(s.spread_rest, position);
    });
  return out;
}

}  // namespace ukemi::identify
