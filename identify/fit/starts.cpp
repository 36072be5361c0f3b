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
  constexpr long kMost = 1'000'000;
  check_count("draws", draws, 1, kMost), check_count("draws_near", draws_near, 1, kMost);
  check_count("steps", steps, 1, kMost), check_positive("accuracy of starts", accuracy);
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

/// The spring's, measured; empty where one side was not.
std::vector<double> deflection(const Trial& trial) {
  if (trial.phi.empty() || trial.phi_motor.empty()) return {};
  std::vector<double> out(trial.phi.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = trial.phi_motor[i] - trial.phi[i];
  return out;
}

/// Command for a unit of angle, where the command is known: the smallest controller's gain, or as their ranges have it;
/// else 1.
double command_gain(const Rig& rig, const std::vector<Trial>& trials) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  double gain = kNone;
  for (const Trial& trial : trials) {
    const Drive& drive = trial.rig_or(rig).drive;
    const double command = largest_deviation(trial.command), angle = largest_deviation(trial.phi);
    if (drive.kind == Drive::Kind::kController) gain = std::min(gain, drive.gain);
    if (drive.kind == Drive::Kind::kCommand && command > 0 && angle > 0) gain = std::min(gain, command / angle);
  }
  return gain < kNone ? gain : 1;
}

}  // namespace

Suggestion suggest(const Rig& rig, const std::vector<Trial>& trials) {
  Suggestion s;
  double largest_deflection = 0, omega = 0, num_p = 0, den_p = 0, num_d = 0, den_d = 0;
  int with_frequency = 0;
  struct Balance {
    double torque = 0, torque_t = 0, phi = 0, phi_t = 0, moved = 0;
  };
  std::vector<Balance> all;
  for (const Trial& trial : trials) {
    const std::vector<double> spring = deflection(trial);
    const bool known = trial.rig_or(rig).drive.kind != Drive::Kind::kGains;
    if (const double w = dominant_frequency(trial, known && !spring.empty() ? spring : trial.phi);
        w > 0 && std::isfinite(w))
      omega += w, ++with_frequency;
    largest_deflection = std::max(largest_deflection, largest_deviation(spring));
    s.rate = std::max(s.rate, dominant_frequency(trial, spring) * largest_deviation(trial.phi));
    if (trial.force.empty() || trial.phi.empty()) continue;
    Balance m;
    const Gravity& gravity = trial.rig_or(rig).gravity;
    const double sag = gravity.moment == 0 ? 0 : trial.phi[0] - (trial.phi_ref.empty() ? 0 : trial.phi_ref[0]);
    const std::vector<double> force = force_at_samples(trial);
    for (std::size_t i = 0; i + 1 < trial.samples(); ++i) {
      const double dt = trial.t[i + 1] - trial.t[i], t = 0.5 * (trial.t[i + 1] + trial.t[i]) - trial.t[0];
      const double ref = trial.phi_ref.empty() ? 0 : trial.phi_ref[i];
      const double phi = 0.5 * (trial.phi[i] + trial.phi[i + 1]) - ref;
      const double torque =
          0.5 * rig.length * (std::cos(trial.phi[i]) * force[i] + std::cos(trial.phi[i + 1]) * force[i + 1]) -
          gravity.moment * std::sin(0.5 * (trial.phi[i] + trial.phi[i + 1]) - gravity.hanging);
      m.torque += torque * dt, m.torque_t += torque * t * dt, m.phi += phi * dt, m.phi_t += phi * t * dt;
      m.moved += (phi - sag) * dt;
    }
    num_p += m.torque * m.phi, den_p += m.phi * m.phi, den_d += m.moved * m.moved;
    all.push_back(m);
  }
  omega = with_frequency > 0 ? std::clamp(omega / with_frequency, 1.0, 1e3) : 20;
  const double k_p = den_p > 0 ? num_p / den_p : 0;
  for (const Balance& m : all) num_d += (k_p * m.phi_t - m.torque_t) * m.moved;
  const double k_d = den_d > 0 ? num_d / den_d : 0;

  const bool moments = k_p > 0 && std::isfinite(k_p);
  const double stiffness = rig.inertia * omega * omega;
  s.centre.k_p = moments ? k_p : stiffness;
  s.centre.k_d = moments && k_d > 0 ? k_d : 0.3 * s.centre.k_p / omega;
  s.centre.k_sea = 2 * std::max(stiffness, 0.5 * s.centre.k_p);
  s.centre.c_sea = 0.3 * s.centre.k_sea / omega;
  s.centre.i_motor = s.centre.k_p / (omega * omega);
  s.centre.k_t = s.centre.k_p / command_gain(rig, trials);
  s.spread_gains = moments ? 1.2 : 30;
  s.spread_rest = 10;
  s.torque = s.centre.k_sea * largest_deflection;
  return s;
}

std::vector<SeaParameters<double>> draw_starts(const Suggestion& about, int count, std::uint64_t seed) {
  std::vector<SeaParameters<double>> out(std::size_t(std::max(count, 0)), about.centre);
  std::vector<int> layer(out.size());
  // f(a start, its place from -1 to 1) in an order of their own for each k
  const auto in_layers = [&](std::size_t k, const auto& f) {
    Random random(seed, k);
    std::iota(layer.begin(), layer.end(), 0);
    for (std::size_t i = layer.size(); i > 1; --i)
      std::swap(layer[i - 1], layer[std::size_t(random.uniform() * double(i))]);
    for (std::size_t i = 0; i < out.size(); ++i) f(out[i], 2 * (layer[i] + random.uniform()) / count - 1);
  };
  const std::array<double, kConstants> spread = {about.spread_gains, about.spread_gains * 1.5, about.spread_rest,
                                                 about.spread_rest, about.spread_rest};
  for (std::size_t k = 0; k < kConstants; ++k)
    in_layers(k, [&](SeaParameters<double>& sea, double place) {
      auto u = constants(sea);
      const double factor = std::pow(spread[k], place);
      u[k] *= factor;
      set_constants(sea, u);
      if (k == 0) sea.k_t *= factor;  // where the command is known it stands for K_p
    });
  if (!(about.torque > 0 && about.rate > 0)) return out;
  using Sea = SeaParameters<double>;
  std::size_t k = kConstants;
  for (const auto& [friction, typical] : {std::pair(&Sea::friction, about.torque),
                                          {&Sea::output_friction, about.torque},
                                          {&Sea::viscous, about.torque / about.rate},
                                          {&Sea::output_viscous, about.torque / about.rate}})
    in_layers(k++, [&, f = friction, middle = typical](Sea& sea, double place) {
      sea.*f = middle * std::pow(about.spread_rest, place);
    });
  return out;
}

}  // namespace ukemi::identify
